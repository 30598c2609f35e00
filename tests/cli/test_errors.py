# SPDX-License-Identifier: BSD-3-Clause
"""What a user may do wrong: exit code 2, one line that says where and what to do, nothing written."""

import re

import pytest
from common import one_line, refusal, require_done, require_same_bytes, sets

GOOD = """\
[plate]
element_size_m = 5e-3

[friction]
mu_s = 1.3
"""


# The case file, the part of it that stands in the line to be named, and words that tell what to do. What else
# the schema, its relations and the mesh refuse: tests/input and tests/mesh.
CASES = [
    ("[plate]\nelement_size_mm = 5e-3\n", "element_size_mm", ["element_size_m?"]),
    ('[plate]\nwidth_m = "0.2"\n', "width_m", ["number", "width_m = 0.1"]),
    ('[friction]\nlaw = "coulomb"\nmu_k = 0.6\n', "mu_k", ["slip_weakening", "remove"]),
    ("[friction]\nmu_s = 0.5\ncohesion_Pa = 1e4\n", "cohesion_Pa", ["loading.method = prestress", "remove"]),
    ("[plate]\nwidth_m = = 0.2\n", "width_m", ["TOML"]),
    ("[plate]\nelement_size_m = 3e-3\n", "element_size_m", ["nearest", "0.00"]),
]


@pytest.mark.parametrize("text, part, words", CASES)
def test_wrong_case(program, write_case, tmp_path, text, part, words):
    case = write_case(text)
    (number,) = [k for k, line in enumerate(text.splitlines(), 1) if part in line]
    line = refusal(program("run", case, "-o", "out"))
    assert line.startswith(f"{case}:{number}: ")
    for word in words:
        assert word in line
    assert not (tmp_path / "out").exists()
    for command in ("validate", "info"):
        assert refusal(program(command, case)) == line


def test_place_is_the_path_as_it_was_given(program, write_case):
    write_case("[plate]\nwidth = 1\n", "short.toml")
    assert refusal(program("validate", "short.toml")).startswith("short.toml:2: ")


@pytest.mark.parametrize(
    "override, words",
    [
        ("friction.mu_kk=1.0", ["unknown key", "friction.mu_k?"]),
        ("friction.mu_k=200", ["at most 100"]),
        ("plate.element_size_m=3e-3", ["nearest"]),
        ("", ["of the form key=value"]),
    ],
)
def test_wrong_override(program, write_case, tmp_path, override, words):
    case = write_case(GOOD)
    line = refusal(program("run", case, "-o", "out", "--set", override))
    assert line.startswith(f"--set {override}: ")
    for word in words:
        assert word in line
    assert not (tmp_path / "out").exists()


def test_binary_file_as_case(program, write_case):
    case = write_case(bytes(range(256)) * 10)
    assert refusal(program("validate", case)).startswith(f"{case}:")


@pytest.mark.parametrize("command", ["run", "validate", "info"])
@pytest.mark.parametrize("size", ["1e-5", "1e-300"])
def test_too_fine_a_mesh_is_refused_before_it_is_built(program, write_case, tmp_path, command, size):
    """The first of them, 200 million nodes, would take 100 GB."""
    case = write_case(f"[plate]\nelement_size_m = {size}\n")
    arguments = ["-o", "out"] if command == "run" else []
    line = refusal(program(command, case, *arguments, memory_bytes=4 << 30))
    assert line.startswith(f"{case}:2: ")
    assert "GB" in line or "nodes" in line
    assert "larger" in line
    assert not (tmp_path / "out").exists()


# --- Output folder


def tree(folder):
    """Everything below a folder."""
    return {path: path.read_bytes() if path.is_file() else path.is_symlink() for path in folder.rglob("*")}


@pytest.mark.parametrize(
    "place, expected",
    [
        ("coarse.toml/out", "choose another place"),
        ("/proc/none", "choose another place"),
        ("/proc/none/deeper", "choose another place"),
        ("coarse.toml", "is a file"),
        ("", "output folder"),
        ("filled", "is not empty"),
        ("lost", "choose another place"),
    ],
)
def test_output_folder_that_is_refused(program, coarse, tmp_path, place, expected):
    (tmp_path / "filled").mkdir()
    (tmp_path / "filled/notes.txt").write_text("mine")
    (tmp_path / "lost").symlink_to("nowhere")
    before = tree(tmp_path)
    line = refusal(program("run", "coarse.toml", "-o", place))
    assert place in line and expected in line
    assert ("--overwrite" in line) == (place == "filled")
    assert tree(tmp_path) == before


def test_no_space_from_the_start_is_no_mistake_of_the_users(program, coarse):
    result = program("run", coarse, "-o", "out", file_bytes=1)
    assert (result.returncode, result.stdout) == (1, "")
    assert re.fullmatch(r"slipfront: output folder out: cannot be .*; free space there\n", result.stderr)


def test_output_folder_that_is_a_link(program, coarse, tmp_path):
    (tmp_path / "target").mkdir()
    (tmp_path / "link").symlink_to("target")
    require_done(program("run", coarse, "-o", "link", "-q"))
    assert (tmp_path / "target/checksums.sha256").is_file()


# Found when the case is read, and by the statics.
@pytest.mark.parametrize("wrong", ["plate.element_size_m=3e-3", "loading.edge_margin_m=0.0999"])
def test_wrong_case_does_not_cost_earlier_results(program, coarse, tmp_path, wrong):
    require_done(program("run", coarse, "-o", "out", "-q"))
    before = tree(tmp_path)
    refusal(program("run", coarse, "-o", "out", "--overwrite", "--set", wrong))
    assert tree(tmp_path) == before


def test_overwrite_leaves_other_files(program, coarse, tmp_path):
    require_done(program("run", coarse, "-o", "out", "-q", "--set", "output.snapshot_times_s=[0]"))
    for name in ("notes.txt", "interface.h5.part"):
        (tmp_path / "out" / name).write_text("mine")
    assert (tmp_path / "out/fields.vtkhdf").exists()
    require_done(program("run", coarse, "-o", "out", "-q", "--overwrite"))
    for name in ("notes.txt", "interface.h5.part"):
        assert (tmp_path / "out" / name).read_text() == "mine"
    # The earlier run's fields are not this run's.
    assert not (tmp_path / "out/fields.vtkhdf").exists()


def test_result_name_taken_by_a_folder(program, coarse, tmp_path):
    (tmp_path / "out/run.json").mkdir(parents=True)
    line = refusal(program("run", coarse, "-o", "out", "--overwrite"))
    assert "run.json" in line
    assert (tmp_path / "out/run.json").is_dir()


RESULTS = ("interface.h5", "fronts.csv", "fracture.csv", "energy.csv")


@pytest.mark.parametrize(
    "file_bytes, snapshots, file",
    [
        (1024, None, "case.resolved.toml"),
        (1 << 17, "[]", "interface.h5"),
        (1 << 18, "[0, 1e-5, 2e-5, 3e-5]", "fields.vtkhdf"),
    ],
)
def test_file_that_cannot_grow(program, coarse, tmp_path, file_bytes, snapshots, file):
    """A full disk, played by a limit on the size of files: when a file is made, and while the run goes."""
    fine = sets("plate.element_size_m=2e-3", "output.history_interval_s=1e-5")
    case = [coarse, "-q", *(fine + sets(f"output.snapshot_times_s={snapshots}") if snapshots else [])]
    line = one_line(program("run", *case, "-o", "out", file_bytes=file_bytes), 1)
    assert f"out/unfinished/{file}" in line and "File too large" in line
    if snapshots:  # the event had begun
        assert "slipfront run --restart out continues the run" in line
        (tmp_path / "out/figures").mkdir()
        assert "holds unfinished work" in refusal(program("run", coarse, "-o", "out"))
        require_done(program("run", "--restart", "out", "-q"))
        require_done(program("run", *case, "-o", "again"))
        require_same_bytes(tmp_path / "out", tmp_path / "again", *RESULTS)
    else:
        assert not (tmp_path / "out").exists()


def test_full_disk_does_not_cost_earlier_results(program, coarse, tmp_path):
    require_done(program("run", coarse, "-o", "out", "-q"))
    before = tree(tmp_path / "out")
    one_line(program("run", coarse, "-o", "out", "-q", "--overwrite", file_bytes=1 << 16), 1)
    after = tree(tmp_path / "out")
    assert {path: data for path, data in after.items() if "unfinished" not in path.parts} == before


def test_work_is_kept_where_a_result_cannot_be_made(program, coarse, tmp_path):
    """The rows of fields.vtkhdf just fit, what lies behind them does not."""
    case = (coarse, "-q", *sets("output.history_interval_s=1e-5", "output.snapshot_times_s=[0, 1e-5]"))
    require_done(program("run", *case, "-o", "whole"))
    most = (tmp_path / "whole/fields.vtkhdf").stat().st_size - 1
    assert "fields.vtkhdf" in one_line(program("run", *case, "-o", "out", file_bytes=most), 1)
    require_done(program("run", "--restart", "out", "-q"))
    require_same_bytes(tmp_path / "out", tmp_path / "whole", *RESULTS, "fields.vtkhdf")


# --- Runs that go on


@pytest.mark.parametrize(
    "arguments",
    [
        ["--restart", "out", "-o", "other"],
        ["--restart", "out", "--overwrite"],
        ["--restart", "out", "--set", "friction.mu_k=0.2"],  # nothing to set it in
        ["-o", "out"],
    ],
)
def test_restart_takes_no_other_folder_and_no_changes(program, tmp_path, arguments):
    assert "--restart" in refusal(program("run", *arguments))
    assert not (tmp_path / "out").exists()


def test_a_small_stack(program, coarse, tmp_path):
    line = refusal(program("run", coarse, "-o", "out", stack_bytes=128 << 10))
    assert "a stack of 128 KiB is too small" in line
    assert not (tmp_path / "out").exists()
    require_done(program("run", coarse, "-o", "out", "-q", "--threads", "2", stack_bytes=1 << 20))


def test_restart_where_there_is_nothing(program, tmp_path):
    assert "holds no unfinished run" in refusal(program("run", "--restart", "out"))
    assert not (tmp_path / "out").exists()


def test_restart_of_a_complete_run_is_told(program, coarse, tmp_path):
    require_done(program("run", coarse, "-o", "out", "-q"))
    before = tree(tmp_path)
    for arguments in (["--restart", "out"], [coarse, "--restart", "out"]):
        again = program("run", *arguments)
        assert (again.returncode, again.stdout) == (0, "out: is complete\n")
    other = program("run", coarse, "--restart", "out", "--set", "friction.mu_k=0.7")
    assert "is another case" in refusal(other) and "mu_k = 0.6" in other.stderr
    assert tree(tmp_path) == before


@pytest.mark.parametrize("megabytes", [10, 12])
def test_a_limit_on_data_is_refused_as_one_on_memory_is(program, coarse, tmp_path, megabytes):
    line = refusal(program("run", coarse, "-o", "out", data_bytes=megabytes << 20, memory_bytes=None))
    assert "memory" in line
    assert not (tmp_path / "out").exists()
