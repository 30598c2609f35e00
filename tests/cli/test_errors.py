# SPDX-License-Identifier: BSD-3-Clause
"""What a user may do wrong: exit code 2, one line that says where and what to do, nothing written."""

import pytest
from test_commands import one_line

GOOD = """\
[plate]
element_size_m = 5e-3

[friction]
mu_s = 1.3
"""


def line_number(text, part):
    numbers = [k for k, line in enumerate(text.splitlines(), 1) if part in line]
    assert len(numbers) == 1, part
    return numbers[0]


# What is wrong, the case file, the part of it that stands in the line to be named, and words that tell what
# to do.
CASES = [
    ("unknown_key", "[plate]\nelement_size_mm = 5e-3\n", "element_size_mm", ["element_size_m?"]),
    ("unknown_key_of_no_likeness", "[plate]\nqqqqqqqqqqqqqqqqq = 1\n", "qqqqqqqqqqqqqqqqq", ["keys"]),
    ("key_in_another_table", "[plate]\nmu_s = 1.3\n", "mu_s", ["friction.mu_s"]),
    ("key_outside_all_tables", "width_m = 0.2\n", "width_m", ["plate.width_m"]),
    ("unknown_table", "[plates]\nwidth_m = 0.2\n", "[plates]", ["[plate]"]),
    ("number_as_text", '[plate]\nwidth_m = "0.2"\n', "width_m", ["number", "width_m = 0.2"]),
    ("text_as_number", "title = 3\n", "title", ["string"]),
    ("fraction_for_an_integer", "[time]\ninterface_rows = 2.5\n", "interface_rows", ["integer"]),
    ("word_for_a_flag", '[time]\nallow_unstable = "yes"\n', "allow_unstable", ["true or false"]),
    ("unknown_word", '[event]\nkind = "lefft"\n', "lefft", ["left", "right", "spontaneous", "none"]),
    ("unknown_law", '[friction]\nlaw = "amontons"\n', "amontons", ["coulomb", "velocity_weakening"]),
    ("negative_length", "[plate]\nwidth_m = -0.2\n", "width_m", ["greater than 0"]),
    ("poissons_ratio", "[material]\npoissons_ratio = 0.5\n", "poissons_ratio", ["less than 0.5"]),
    ("not_a_number", "[friction]\nmu_s = nan\n", "mu_s", ["at least"]),
    ("infinite", "[time]\nend_s = inf\n", "end_s", ["finite"]),
    ("weakening_backwards", "[friction]\nmu_s = 0.5\nmu_k = 0.6\n", "mu_s", ["mu_k", "mu_s"]),
    (
        "parameter_of_another_law",
        '[friction]\nlaw = "coulomb"\nmu_k = 0.6\n',
        "mu_k",
        ["velocity_weakening", "remove"],
    ),
    ("snapshots_in_disorder", "[output]\nsnapshot_times_s = [2e-5, 1e-5]\n", "snapshot_times_s", ["ascend"]),
    ("step_factor", "[time]\nstep_factor = 1.01\n", "step_factor", ["at most 1", "allow_unstable"]),
    ("zero_step", "[time]\nstep_factor = 0\n", "step_factor", ["greater than 0"]),
    ("syntax", "[plate]\nwidth_m = = 0.2\n", "width_m", ["TOML"]),
    ("unclosed_table", "[plate\nwidth_m = 0.2\n", "[plate", ["TOML"]),
    ("unclosed_text", 'title = "coarse\n', "title", ["TOML"]),
    (
        "key_twice",
        "[plate]\nwidth_m = 0.2\nheight_m = 0.1\nwidth_m = 0.3 # again\n",
        "again",
        ["one of the two"],
    ),
    ("element_does_not_divide", "[plate]\nelement_size_m = 3e-3\n", "element_size_m", ["nearest", "0.00"]),
    ("element_larger_than_plate", "[plate]\nelement_size_m = 0.3\n", "element_size_m", ["at most"]),
    (
        "relief_too_high",
        "[plate]\nelement_size_m = 5e-3\nrelief_height_m = 4e-3\n",
        "relief_height_m",
        ["at most half"],
    ),
    (
        "relief_too_long",
        "[plate]\nelement_size_m = 5e-3\nrelief_length_m = 0.1\n",
        "relief_length_m",
        ["less than 0.1"],
    ),
    (
        "fillet_too_large",
        '[plate]\nelement_size_m = 5e-3\ncorner = "fillet"\nfillet_radius_m = 0.2\n',
        "fillet_radius_m",
        ["at most"],
    ),
    (
        "fillet_too_small",
        '[plate]\nelement_size_m = 5e-3\ncorner = "fillet"\nfillet_radius_m = 1e-3\n',
        "fillet_radius_m",
        ["at least"],
    ),
    (
        "tilt_beyond_the_plate",
        "[loading]\ntilt_left_m = 0.1\n",
        "tilt_left_m",
        ["less than"],
    ),
    ("l_star_beyond_the_plate", "[fronts]\nl_star_m = 1e6\n", "l_star_m", ["less than"]),
    (
        "too_many_rows",
        "[plate]\nelement_size_m = 5e-3\n[time]\ninterface_rows = 20\n",
        "interface_rows",
        ["fewer"],
    ),
]


@pytest.mark.parametrize("what, text, part, words", CASES, ids=[case[0] for case in CASES])
def test_wrong_case(program, write_case, tmp_path, what, text, part, words):
    case = write_case(text)
    line = one_line(program("run", case, "-o", "out"))
    assert line.startswith(f"{case}:{line_number(text, part)}: ")
    for word in words:
        assert word in line
    assert not (tmp_path / "out").exists()
    for command in ("validate", "info"):
        assert one_line(program(command, case)) == line


def test_place_is_the_path_as_it_was_given(program, write_case):
    write_case("[plate]\nwidth = 1\n", "short.toml")
    assert one_line(program("validate", "short.toml")).startswith("short.toml:2: ")


@pytest.mark.parametrize(
    "override, words",
    [
        ("friction.mu_kk=1.0", ["unknown key", "friction.mu_k?"]),
        ("mu_k=1.0", ["friction.mu_k"]),
        ("friction.mu_k=fast", ["number"]),
        ("friction.mu_k=-1", ["at least 0"]),
        ("friction.mu_k=", ["number"]),
        ("friction.mu_k=2", ["mu_s"]),
        ("friction.mu=0.9", ["coulomb"]),
        ("plate=1", ["plate"]),
        ("plate.element_size_m=3e-3", ["nearest"]),
        ("time.step_factor=1.4", ["allow_unstable"]),
        ("event.kind=top", ["left"]),
    ],
)
def test_wrong_override(program, write_case, tmp_path, override, words):
    case = write_case(GOOD)
    line = one_line(program("run", case, "-o", "out", "--set", override))
    assert line.startswith(f"--set {override}: ")
    for word in words:
        assert word in line
    assert not (tmp_path / "out").exists()


@pytest.mark.parametrize("override", ["friction.mu_k", "", "=1", "friction.mu_k 1"])
def test_override_without_key_or_value(program, write_case, tmp_path, override):
    line = one_line(program("run", write_case(GOOD), "-o", "out", "--set", override))
    assert line.startswith("--set")
    assert "key=value" in line.lower()
    assert not (tmp_path / "out").exists()


def test_binary_file_as_case(program, write_case):
    case = write_case(bytes(range(256)) * 10)
    assert one_line(program("validate", case)).startswith(f"{case}:")


@pytest.mark.parametrize("command", ["run", "validate", "info"])
@pytest.mark.parametrize("size", ["1e-5", "1e-300"])
def test_too_fine_a_mesh_is_refused_before_it_is_built(program, write_case, tmp_path, command, size):
    """The first of them, 200 million nodes, would take 100 GB."""
    case = write_case(f"[plate]\nelement_size_m = {size}\n")
    arguments = ["-o", "out"] if command == "run" else []
    line = one_line(program(command, case, *arguments, memory_bytes=4 << 30))
    assert line.startswith(f"{case}:2: ")
    assert "GB" in line or "nodes" in line
    assert "larger" in line
    assert not (tmp_path / "out").exists()


# --- Output folder


def tree(folder):
    return {
        str(path.relative_to(folder)): path.read_bytes() if path.is_file() else None
        for path in folder.rglob("*")
    }


@pytest.mark.parametrize("command", [["run", "coarse.toml"], ["reproduce", "--quick"]], ids=lambda c: c[0])
class TestOutputFolder:
    @pytest.mark.parametrize("place", ["coarse.toml/out", "/proc/nonexistent", "/proc/nonexistent/deeper"])
    def test_that_cannot_be_made(self, program, coarse, tmp_path, command, place):
        before = tree(tmp_path)
        line = one_line(program(*command, "-o", place))
        assert place in line
        assert "choose another place" in line
        assert tree(tmp_path) == before

    def test_that_is_a_file(self, program, coarse, tmp_path, command):
        before = tree(tmp_path)
        line = one_line(program(*command, "-o", "coarse.toml"))
        assert "coarse.toml: is a file" in line
        assert tree(tmp_path) == before

    def test_with_an_empty_name(self, program, coarse, tmp_path, command):
        before = tree(tmp_path)
        assert "output folder" in one_line(program(*command, "-o", ""))
        assert tree(tmp_path) == before

    def test_that_holds_something(self, program, coarse, tmp_path, command):
        (tmp_path / "out").mkdir()
        (tmp_path / "out/notes.txt").write_text("mine")
        before = tree(tmp_path)
        line = one_line(program(*command, "-o", "out"))
        assert "out: is not empty" in line
        assert "--overwrite" in line
        assert tree(tmp_path) == before


@pytest.mark.parametrize(
    "wrong",
    [
        "plate.element_size_m=3e-3",  # found when it is read
        "loading.edge_margin_m=0.0999",  # found by the statics
    ],
)
def test_wrong_case_does_not_cost_earlier_results(program, coarse, tmp_path, wrong):
    assert program("run", coarse, "-o", "out", "-q").returncode == 0
    before = tree(tmp_path)
    one_line(program("run", coarse, "-o", "out", "--overwrite", "--set", wrong))
    assert tree(tmp_path) == before


def test_overwrite_leaves_other_files(program, coarse, tmp_path):
    assert program("run", coarse, "-o", "out", "-q", "--set", "output.snapshot_times_s=[0]").returncode == 0
    for name in ("notes.txt", "interface.h5.part"):
        (tmp_path / "out" / name).write_text("mine")
    assert (tmp_path / "out/fields.vtkhdf").exists()
    assert program("run", coarse, "-o", "out", "-q", "--overwrite").returncode == 0
    for name in ("notes.txt", "interface.h5.part"):
        assert (tmp_path / "out" / name).read_text() == "mine"
    # The earlier run's fields are not this run's.
    assert not (tmp_path / "out/fields.vtkhdf").exists()


def test_result_name_taken_by_a_folder(program, coarse, tmp_path):
    (tmp_path / "out/run.json").mkdir(parents=True)
    line = one_line(program("run", coarse, "-o", "out", "--overwrite"))
    assert "run.json" in line
    assert (tmp_path / "out/run.json").is_dir()


def write_error(result):
    """The only line on standard error of a call that could not write."""
    assert result.returncode == 1, result
    lines = result.stderr.splitlines()
    assert len(lines) == 1, result.stderr
    return lines[0]


@pytest.mark.parametrize(
    "file_bytes, settings, file",
    [
        (1024, [], "case.resolved.toml"),
        (1 << 16, [], "state/history.raw"),
        (1 << 18, ["output.snapshot_times_s=[0, 1e-5, 2e-5, 3e-5]"], "state/snapshots.raw"),
    ],
)
def test_file_that_cannot_grow(program, coarse, tmp_path, file_bytes, settings, file):
    """A full disk, played by a limit on the size of files: when a file is made, and while the run goes."""
    settings = [*settings, "plate.element_size_m=2e-3", "output.history_interval_s=1e-5"] if settings else []
    arguments = [part for setting in settings for part in ("--set", setting)]
    line = write_error(program("run", coarse, "-o", "out", "-q", *arguments, file_bytes=file_bytes))
    assert f"out/unfinished/{file}" in line
    assert "File too large" in line
    if file.startswith("state"):  # the event had begun
        assert "slipfront run --restart out continues the run" in line
        assert program("run", "--restart", "out", "-q").returncode == 0
        assert program("run", coarse, "-o", "again", "-q", *arguments).returncode == 0
        for name in ("interface.h5", "fronts.csv", "energy.csv"):
            assert (tmp_path / "out" / name).read_bytes() == (tmp_path / "again" / name).read_bytes()
    else:
        assert not (tmp_path / "out").exists()


def test_full_disk_does_not_cost_earlier_results(program, coarse, tmp_path):
    assert program("run", coarse, "-o", "out", "-q").returncode == 0
    before = tree(tmp_path / "out")
    write_error(program("run", coarse, "-o", "out", "-q", "--overwrite", file_bytes=1 << 16))
    after = {name: data for name, data in tree(tmp_path / "out").items() if not name.startswith("unfinished")}
    assert after == before


# --- Measured points for claim E1


@pytest.mark.parametrize(
    "text, line, words",
    [
        ("a,b\n1,2\n", 1, ["static_ratio"]),
        ("static_ratio,v_over_c_L\n1,fast\n", 2, ["v_over_c_L", "number"]),
        ("static_ratio,v_over_c_L\n1\n", 2, ["v_over_c_L", "number"]),
        ("# none\nstatic_ratio,v_over_c_L\n", None, ["no points"]),
    ],
)
def test_wrong_experiment_file(program, tmp_path, text, line, words):
    points = tmp_path / "points.csv"
    points.write_text(text)
    told = one_line(program("reproduce", "--quick", "-o", "out", "--experiment", points))
    assert told.startswith(f"{points}:{line}: " if line else f"{points}: ")
    for word in words:
        assert word in told
    assert not (tmp_path / "out").exists()


def test_missing_experiment_file(program, tmp_path):
    told = one_line(program("reproduce", "--quick", "-o", "out", "--experiment", "missing.csv"))
    assert told.startswith("missing.csv: ")
    assert not (tmp_path / "out").exists()


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
    assert "--restart" in one_line(program("run", *arguments))
    assert not (tmp_path / "out").exists()


def test_restart_where_there_is_nothing(program, tmp_path):
    assert "holds no unfinished run" in one_line(program("run", "--restart", "out"))
    assert not (tmp_path / "out").exists()


def test_restart_of_a_complete_run_is_told(program, coarse, tmp_path):
    assert program("run", coarse, "-o", "out", "-q").returncode == 0
    before = tree(tmp_path)
    for arguments in (["--restart", "out"], [coarse, "--restart", "out"]):
        again = program("run", *arguments)
        assert (again.returncode, again.stdout) == (0, "out: is complete\n")
    other = program("run", coarse, "--restart", "out", "--set", "friction.mu_k=0.7")
    assert "is another case" in one_line(other) and "mu_k = 0.6" in other.stderr
    assert tree(tmp_path) == before


def test_unfinished_work_is_told_before_other_files(program, coarse, tmp_path):
    settings = ("--set", "output.history_interval_s=1e-5", "--set", "plate.element_size_m=2e-3")
    write_error(program("run", coarse, "-o", "out", "-q", *settings, file_bytes=1 << 16))
    (tmp_path / "out/figures").mkdir()
    assert "holds unfinished work" in one_line(program("run", coarse, "-o", "out"))


def test_work_is_kept_where_a_result_cannot_be_made(program, coarse, tmp_path):
    """history.raw just fits, interface.h5 does not."""
    settings = ("--set", "output.history_interval_s=1e-5")
    assert program("run", coarse, "-o", "whole", "-q", *settings).returncode == 0
    most = (tmp_path / "whole/interface.h5").stat().st_size - 1
    assert "interface.h5" in write_error(
        program("run", coarse, "-o", "out", "-q", *settings, file_bytes=most)
    )
    assert program("run", "--restart", "out", "-q").returncode == 0
    for name in ("interface.h5", "fronts.csv", "energy.csv"):
        assert (tmp_path / "out" / name).read_bytes() == (tmp_path / "whole" / name).read_bytes()


def test_output_folder_that_is_a_link(program, coarse, tmp_path):
    (tmp_path / "target").mkdir()
    (tmp_path / "link").symlink_to("target")
    assert program("run", coarse, "-o", "link", "-q").returncode == 0
    assert (tmp_path / "target/checksums.sha256").is_file()
    (tmp_path / "lost").symlink_to("nowhere")
    assert "choose another place" in one_line(program("run", coarse, "-o", "lost"))
    assert (tmp_path / "lost").is_symlink()
