# SPDX-License-Identifier: BSD-3-Clause
"""`slipfront sweep`: points, refusals, and sweeps of a coarse case with the built program."""

import json
import os
import re
import shutil
import signal
import subprocess
import sys
from contextlib import nullcontext, suppress
from pathlib import Path

import numpy as np
import pandas as pd
import pytest
import slipfront
from common import (
    COARSE,
    HANG_S,
    WITH_PACKAGE,
    as_from_a_terminal,
    built,
    notes_of,
    rows_of,
    sets,
    start,
    wait_until,
    wait_until_or_over,
)
from distributed import LocalCluster
from slipfront.figures.__main__ import main as draw_figures
from slipfront.files import DataError
from slipfront.folder import verify_checksums
from slipfront.sweep import maps, notebook, report
from slipfront.sweep.command import main, share_of
from slipfront.sweep.definition import Sweep, lines_of, read_sweep
from slipfront.sweep.folder import as_json, has_value, is_done, place_of, read_definition, thin_out
from slipfront.sweep.outcome import QUANTITIES, read_outcome
from slipfront.sweep.points import Range, folder_name, grid, range_of, sample, values_of, zipped
from slipfront.sweep.sweeping import CHEAP, Needs, require_disk, require_memory
from slipfront.sweep.tables import read_dataset, table_lines

TWO_BY_TWO = {"friction.mu_k": [0.5, 0.7], "friction.alpha_m2_per_s2": [0.05, 0.1]}
TWO = ["--vary", "friction.mu_k=0.5,0.7"]
UNSTABLE = ["--vary", "time.step_factor=0.9,1.5", "--set", "time.allow_unstable=true"]  # the second blows up


@pytest.fixture(scope="module")
def swept(tmp_path_factory):
    """Makes the sweep of a coarse case once. @return its folder, which no test may change"""
    made: dict[tuple, Path] = {}

    def sweep(*arguments, code=0):
        if arguments not in made:
            place = tmp_path_factory.mktemp("swept")
            (place / "coarse.toml").write_text(COARSE)
            with pytest.MonkeyPatch.context() as patched:
                patched.setenv("SLIPFRONT_PROGRAM", str(built()))
                patched.chdir(place)
                assert main(["coarse.toml", *arguments, "-o", "out", "-q"]) == code
            made[arguments] = place / "out"
        return made[arguments]

    return sweep


@pytest.fixture
def case(tmp_path, monkeypatch):
    """A coarse case in a folder of its own, and the program to run it."""
    monkeypatch.setenv("SLIPFRONT_PROGRAM", str(built()))
    monkeypatch.chdir(tmp_path)
    file = tmp_path / "coarse.toml"
    file.write_text(COARSE)
    return file


@pytest.fixture
def two(case, swept):
    """The case, and its sweep TWO in `out`, which is done."""
    shutil.copytree(swept(*TWO), "out")
    return case


def table_of(folder="out"):
    return rows_of(f"{folder}/sweep.csv")


def states_of(folder="out"):
    """Each file of the points with the time of its last change."""
    files = sorted(path for path in Path(folder, "points").rglob("*") if path.is_file())
    return {path: path.stat().st_mtime_ns for path in files if path.suffix != ".error"}


# --- Values and points


@pytest.mark.parametrize(
    ("spec", "values"),
    [
        ("0.4:1.2:9", [0.4, 0.5, 0.6, 0.7, 0.8, 0.9, 1.0, 1.1, 1.2]),
        ("0.01:1:3:log", [0.01, 0.1, 1.0]),
        ("1:4:4", [1, 2, 3, 4]),
        ("left, right", ["left", "right"]),
        ([1e-3, 2, "7e-1"], [1e-3, 2, 0.7]),
    ],
)
def test_values_are_lists_steps_or_logarithmic_steps(spec, values):
    assert values_of("k", spec) == values


@pytest.mark.parametrize(
    ("spec", "said"),
    [
        ("1:2", "FROM:TO:COUNT"),
        ("1:2:1", "from 2 to 1000000"),
        ("1:2:1000000000", "from 2 to 1000000"),
        ("1:1:3", "equal"),
        ("0:1:3:log", "greater than 0"),
        ("a:b:3", "numbers"),
        ("1,,2", "missing"),
        ([], "missing"),
        ("1e-3,0.001", "twice"),
        ([1, 1.0], "twice"),
    ],
)
def test_values_that_make_no_sense_are_refused(spec, said):
    with pytest.raises(DataError, match=said):
        values_of("friction.mu_k", spec)


def test_a_grid_has_all_combinations_and_names_them():
    """One name for one number, however it was written."""
    points = grid({"friction.mu_k": values_of("", "0.50,7e-5"), "event.kind": ["left", "right"]})
    names = ["mu_k=0.5,kind=left", "mu_k=0.5,kind=right", "mu_k=7e-05,kind=left", "mu_k=7e-05,kind=right"]
    assert [point.name for point in points] == names
    assert points[1].settings() == ["friction.mu_k=0.5", "event.kind=right"]


def test_names_of_folders_hold_no_path_and_are_unlike_for_unlike_values():
    names = {folder_name({"friction.file": value}) for value in ("../a.csv", "b/c", "x" * 300)}
    assert len(names) == 3
    assert all("/" not in name and len(name) <= 120 for name in names)
    assert folder_name({"plate.height_m": 0.1, "base.height_m": 2.0}) == "plate.height_m=0.1,base.height_m=2"
    assert len({point.name for point in grid({"a.x": values_of("a.x", "1:1.000001:3")})}) == 3


def test_zipped_lists_go_together():
    points = zipped({"a.x": [1, 2], "b.y": [3, 4]})
    assert [p.values for p in points] == [{"a.x": 1, "b.y": 3}, {"a.x": 2, "b.y": 4}]
    with pytest.raises(DataError, match=r"a.x has 2, b.y has 1"):
        zipped({"a.x": [1, 2], "b.y": [3]})
    for vary, said in (([0.5, 0.5], "the point a.x = 0.5, b.y = 1 is there twice"), ([1, 2], "")):
        sweep = Sweep(Path("case"), {"a.x": vary, "b.y": [1, 1]}, combine="zip")
        with pytest.raises(DataError, match=said) if said else nullcontext():
            assert [p.values["b.y"] for p in sweep.points()] == [1, 1]


def test_a_latin_hypercube_meets_each_part_of_each_range_once():
    ranges = {"a.x": Range(0.0, 10.0, False), "b.y": range_of("b.y", "0.01:100:log")}
    points = sample(ranges, 10, seed=3)
    assert sorted(int(point.values["a.x"]) for point in points) == list(range(10))
    assert sorted(int((np.log10(point.values["b.y"]) + 2) / 0.4) for point in points) == list(range(10))
    assert sample(ranges, 10, seed=3) == points != sample(ranges, 10, seed=4)


FILE = """\
# runs of a case
case = "case.toml"
keep = "tables"

[set]
time.end_s = 1e-4
output.snapshot_times_s = [
    1e-5,
    2e-5,
]

[vary]
friction.mu_k = "0.4:1.2:9"
"event.kind" = [  # words
    "left",
    "right",
]
"""


def test_a_file_says_what_the_command_line_says(tmp_path):
    (tmp_path / "sweep.toml").write_text(FILE)
    sweep = read_sweep(tmp_path / "sweep.toml")
    assert sweep == Sweep(
        case=tmp_path / "case.toml",
        vary={"friction.mu_k": "0.4:1.2:9", "event.kind": ["left", "right"]},
        set={"time.end_s": 1e-4, "output.snapshot_times_s": [1e-5, 2e-5]},
        keep="tables",
    )
    assert len(sweep.points()) == 18
    assert sweep.settings() == ["time.end_s=0.0001", "output.snapshot_times_s=[1e-05, 2e-05]"]


def test_lines_of_a_file_are_those_of_its_keys():
    text = 'a = {b = 1}\nt = """\nb = 2\n[c]\n"""\n[d.e]\nf = 3'
    assert lines_of(text) == {"a": 1, "a.b": 1, "t": 2, "d": 6, "d.e": 6, "d.e.f": 7}


@pytest.mark.parametrize(
    ("old", "new", "line", "said"),
    [
        ("[vary]", "[vary", 12, "not TOML: Expected ']'"),
        ('    "right",\n]', '    "right",\n', 16, "not TOML: Invalid value at the end of the file"),
        ("keep =", "kep =", 3, "unknown entry 'kep'"),
        ('"tables"', '"some"', 3, "keep is one of all, tables, not 'some'"),
        ('"tables"', "5", 3, "keep is a text"),
        ('"case.toml"', '"none.toml"', 2, "none.toml: No such file or directory"),
        ('"case.toml"', '""', 2, "case names the case file"),
        ('keep = "tables"', "sample = 5", 3, "sample is a table"),
        ('"0.4:1.2:9"', '"0.4:1.2"', 13, "values are A,B,C or FROM:TO:COUNT"),
        ('"0.4:1.2:9"', "[0.5, 0.50]", 13, "the value 0.5 is there twice"),
        ("friction.mu_k", "time.end_s", 6, "time.end_s both varies and is set"),
        ("[vary]", "[sample]\nseed = 1\n[vary]", 15, "friction.mu_k=0.4:1.2:9: a sample takes ranges"),
        ("[vary]", "[sample]\ncount = 2\nsed = 1\n[vary]", 14, "unknown entry 'sample.sed'"),
        ("[vary]", "[sample]\ncount = true\n[vary]", 13, "sample.count is a whole number"),
        ('keep = "tables"', 'combine = "zip"\nsample.count = 1', 3, "exclude each other"),
        ('keep = "tables"', 'combine = "zip"', 12, "lists that go together have as many values each"),
        ("time.end_s = 1e-4", "time.end_s = 2026-01-01", 6, "time.end_s is a date or a time"),
        ('"0.4:1.2:9"', "[07:30:00]", 13, "friction.mu_k is a date or a time"),
        ('"event.kind" =', '"friction.mu_k" =', 13, "friction.mu_k is there twice in [vary]"),
    ],
)
@pytest.mark.parametrize("newline", ["\n", "\r\n"])
def test_mistakes_of_a_file_are_told_with_their_line(tmp_path, newline, old, new, line, said):
    (tmp_path / "case.toml").write_text(COARSE)
    file = tmp_path / "sweep.toml"
    assert old in FILE
    file.write_bytes(FILE.replace(old, new, 1).replace("\n", newline).encode())
    with pytest.raises(DataError) as error:
        read_sweep(file).require_sound()
    assert str(error.value).startswith(f"{file}:{line}: ")
    assert said in str(error.value)


@pytest.mark.parametrize("text", ["0/4", "5/4", "1", "a/b"])
def test_shares_are_from_1_to_n(text):
    with pytest.raises(DataError, match="K from 1 to N"):
        share_of(text)


def test_infinity_and_lists_are_values_like_others():
    case = {"a.x": np.inf, "a.y": [1e-5, 2e-5], "a.z": 2.0, "a.word": "left"}
    assert has_value(case, "a.x", "inf") and has_value(case, "a.x", np.inf)
    assert has_value(case, "a.y", [1e-5, 2e-5]) and not has_value(case, "a.y", [1e-5])
    assert has_value(case, "a.z", 2) and not has_value(case, "a.z", 2.5)
    assert has_value(case, "a.word", "left") and not has_value(case, "a.none", 1)
    assert as_json({"a": [np.inf, 1.0]}) == {"a": ["inf", 1.0]}


# --- Needs


def test_runs_that_do_not_fit_are_refused(tmp_path):
    needs = Needs(n_points=8, n_at_once=2, memory_bytes=2e15, disk_bytes=1e18, time_s=10)
    with pytest.raises(DataError, match="2 runs at a time need 2e.06 GB of memory"):
        require_memory(needs)
    with pytest.raises(DataError, match=r"may need 1e.09 GB"):
        require_disk(needs, tmp_path / "not/there/yet")


@pytest.mark.parametrize(
    ("key", "is_cheap"),
    [("friction.mu_k", True), ("event.kind", True), ("title", True), ("loading.tilt_left_m", True),
     ("plate.element_size_m", False), ("loading.method", False), ("time.end_s", False)],
)  # fmt: skip
def test_only_keys_that_leave_size_and_steps_alone_are_cheap(key, is_cheap):
    assert bool(CHEAP.fullmatch(key)) == is_cheap


# --- Sweeps


def refused(capsys, *arguments):
    """The one line that a refused sweep prints."""
    assert main([str(a) for a in arguments]) == 2
    (line,) = capsys.readouterr().err.splitlines()
    return line


@pytest.mark.parametrize(
    ("old", "new", "line", "said"),
    [
        ("friction.mu_k", "friction.mk", 6, "unknown key friction.mk; did you mean friction.mu_k?"),
        ("0.7", "140", 6, "it must be at least 0 and at most 100"),
        ("time.end_s", "time.end", 3, "unknown key time.end"),
    ],
)
def test_what_the_program_has_against_a_file_is_told_with_its_line(case, capsys, old, new, line, said):
    file = case.with_name("sweep.toml")
    text = 'case = "coarse.toml"\n[set]\ntime.end_s = 1e-4\n\n[vary]\nfriction.mu_k = [0.5, 0.7]\n'
    file.write_text(text.replace(old, new))
    told = refused(capsys, "sweep.toml", "-o", "out")
    assert told.startswith(f"slipfront sweep: error: sweep.toml:{line}: point friction.m") and said in told
    # What the command line says is not the file's.
    told = refused(capsys, "sweep.toml", "--vary", "friction.mu_k=900", "--set", "time.end_s=1", "-o", "out")
    assert "sweep.toml" not in told or old != "0.7"
    assert not Path("out").exists()


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        (["--vary", "friction.mu_k=0.6,140"], "error: point friction.mu_k = 140: --set friction.mu_k=140: "),
        (["--vary", "friction.mk=0.6"], "friction.mk"),
        (["--vary", "friction.mu_k"], "is not KEY=VALUE"),
        (["--vary", "friction.mu_k=0.6", "--vary", "friction.mu_k=0.7"], "is there twice"),
        ([], "nothing varies"),
        (["--vary", "friction.mu_k=0.6", "--zip", "--sample", "3"], "exclude each other"),
        (["--vary", "friction.mu_k=0.6", "--seed", "1"], "--seed is of a sample"),
        (["--vary", "friction.mu_k=0.6:0.7", "--sample", "3", "--seed", "-1"], "seed is a whole number"),
        (["--vary", "friction.mu_k=0.6", "--workers", "0"], "--workers is a whole number"),
        (["--vary", "friction.mu_k=0.6", "--restart", "out"], "--restart DIR goes on"),
    ],
)
def test_what_is_wrong_is_told_in_one_line_before_anything_is_run(case, capsys, arguments, said):
    assert said in refused(capsys, case, *arguments, "-o", "out")
    assert not Path("out").exists()


@pytest.mark.parametrize(
    "entry", [{"vary": 5}, {"vary": {"friction.mu_k": None}}, {"set": None}, {"count": "1"}]
)
def test_a_damaged_definition_is_refused(two, capsys, entry):
    file = Path("out/sweep.json")
    file.write_text(json.dumps(json.loads(file.read_text()) | entry))
    assert "not the definition of a sweep" in refused(capsys, "--restart", "out")


def test_a_limit_of_threads_is_told(case, capsys, monkeypatch):
    def fail(*_, **__):
        raise RuntimeError("can't start new thread")

    monkeypatch.setattr("subprocess.Popen", fail)
    assert "as by ulimit -u" in refused(capsys, case, *TWO, "-o", "out")
    assert not Path("out").exists()


def test_a_folder_of_something_else_is_left_alone(case, capsys):
    Path("out").mkdir()
    Path("out/mine.txt").write_text("mine")
    assert "holds something" in refused(capsys, case, *TWO, "-o", "out")
    assert [p.name for p in Path("out").iterdir()] == ["mine.txt"]


@pytest.mark.parametrize(
    "name", ["points", "points/mu_k=0.5", "states", ".sweep.lock", "sweep.json", "unfinished", "publishing"]
)
def test_no_link_in_its_folder_is_followed(two, capsys, name):
    """Be the folder itself one, as its user wants it."""
    shutil.copytree("out", "elsewhere")
    before = states_of("elsewhere")
    Path("out").rename("place")
    Path("out").symlink_to("place")
    link = Path("place", name)
    if link.is_dir():
        shutil.rmtree(link)
    link.unlink(missing_ok=True)
    target = Path("elsewhere", name).absolute()
    link.symlink_to(target if target.exists() else target.parent / "points")
    said = "not a regular file" if name == "sweep.json" else "is a link, which is not followed"
    assert said in refused(capsys, two, *TWO, "--keep", "tables", "-o", "out")
    assert link.is_symlink() and states_of("elsewhere") == before


def test_a_sweep_by_dask_and_its_tables(case):
    """2 x 2 points by Dask's workers; the numbers are those of the runs."""
    with LocalCluster(n_workers=1, threads_per_worker=2, processes=False, dashboard_address=None) as cluster:
        address = cluster.scheduler_address
        data = notebook.run(case, TWO_BY_TWO, "out", scheduler=address, quiet=True)
    assert verify_checksums(Path("out")) == []
    assert dict(data.sizes) == {"mu_k": 2, "alpha_m2_per_s2": 2}
    assert data.mu_k.attrs["key"] == "friction.mu_k"
    assert data.alpha_m2_per_s2.attrs["units"] == "m2/s2"
    assert (data.status == "done").all()
    for row in table_of():
        assert row["status"] == "done"
        found = read_outcome(Path("out", row["folder"]))
        values = {name: float(row[column.attrs["key"]]) for name, column in data.coords.items()}
        at = data.sel(values)
        for name, value in found.items():
            assert value == at[name].item() or np.isnan(value)
            is_text = isinstance(value, str)
            assert row[name] == (value if is_text else "" if np.isnan(value) else f"{value:.12g}")
    # Friction takes the more the lower mu_k is: fronts run farther, and slip is larger.
    assert (data.friction_work_J_per_m.sel(mu_k=0.5) < data.friction_work_J_per_m.sel(mu_k=0.7)).all()
    assert not Path("out/states").exists()


def test_points_are_the_runs_of_the_program(two):
    subprocess.run([built(), "run", two, "--set", "friction.mu_k=0.5", "-o", "alone", "-q"], check=True)
    for name in ("case.resolved.toml", "fronts.csv", "energy.csv", "interface.h5", "static.csv"):
        assert Path("out/points/mu_k=0.5", name).read_bytes() == Path("alone", name).read_bytes()


@pytest.mark.parametrize("keep", ["all", "tables"])
def test_a_sweep_that_is_done_runs_nothing_again_and_more_values_only_theirs(case, keep):
    text = f'case = "coarse.toml"\nkeep = "{keep}"\n[vary]\nfriction.mu_k = [0.50, 7e-1]\n'
    Path("sweep.toml").write_text(text)
    assert main(["sweep.toml", "-o", "out", "-q"]) == 0
    assert len(list(Path("out").rglob("interface.h5"))) == (2 if keep == "all" else 0)
    assert verify_checksums(Path("out")) == []
    before = states_of()
    for again in (["--restart", "out"], ["sweep.toml", "-o", "out"]):
        assert main([*again, "-q"]) == 0
        assert states_of() == before
    assert main(["sweep.toml", "--vary", "friction.mu_k=0.5,0.6,0.70", "-o", "out", "-q"]) == 0
    after = states_of()
    assert {path: after[path] for path in before} == before
    assert [row["folder"] for row in table_of()] == [f"points/mu_k={value}" for value in (0.5, 0.6, 0.7)]
    assert list(notebook.open_sweep("out").mu_k) == [0.5, 0.6, 0.7]


@pytest.mark.parametrize(
    "other", [["friction.alpha_m2_per_s2=0.2,0.3"], ["friction.mu_k=0.5"], ["friction.mu_k=0.5,0.700001"]]
)
def test_a_sweep_that_would_lose_points_is_refused(two, capsys, other):
    table = Path("out/sweep.csv").read_bytes()
    assert "which this one has not" in refused(capsys, two, "--vary", *other, "-o", "out")
    assert Path("out/sweep.csv").read_bytes() == table


def test_damaged_and_foreign_results_are_run_again(two):
    place = Path("out/points/mu_k=0.5")
    whole = (place / "fronts.csv").read_bytes()
    (place / "fronts.csv").write_bytes(whole[:-10])
    assert verify_checksums(Path("out")) != []
    assert main(["--restart", "out", "-q"]) == 0
    shutil.rmtree(place)
    shutil.copytree("out/points/mu_k=0.7", place)
    assert main(["--restart", "out", "-q"]) == 0
    assert (place / "fronts.csv").read_bytes() == whole
    assert verify_checksums(Path("out")) == []


def test_another_case_or_program_is_refused_a_sweeps_folder(two, capsys, monkeypatch):
    assert "of other settings" in refused(capsys, two, *TWO, "--set", "time.end_s=1e-4", "-o", "out")
    two.write_text(COARSE.replace("mu_s = 1.3", "mu_s = 1.2"))
    assert "of another case file" in refused(capsys, two, *TWO, "-o", "out")
    other = shutil.copy(os.environ["SLIPFRONT_PROGRAM"], "other")
    with open(other, "ab") as file:
        file.write(b"0")
    monkeypatch.setenv("SLIPFRONT_PROGRAM", other)
    assert "begun by another build of the program" in refused(capsys, two, *TWO, "-o", "out")
    Path("out/sweep.json").write_text("{")
    assert "not JSON" in refused(capsys, "--restart", "out")


def test_one_point_that_fails_leaves_the_others(case, capsys):
    """A step far above the stable one blows up."""
    assert main([str(case), *UNSTABLE, "-o", "out"]) == 1
    printed = capsys.readouterr().out.splitlines()
    assert printed[-1] == "results: out" and printed[-2].startswith("failed: time.step_factor = 1.5: ")
    assert [line.split()[:2] for line in printed[-4:-2]] == [["0.9", "done"], ["1.5", "failed"]]
    good, bad = table_of()
    assert good["status"] == "done" and float(good["n_fronts"]) >= 1
    notes = notes_of(json.loads(Path("out", good["folder"], "run.json").read_text()))
    assert notes and good["message"] == "; ".join(notes)
    assert draw_figures(["out"]) == 2 and "slipfront.sweep.maps PICTURE DIR" in capsys.readouterr().err
    assert bad["status"] == "failed" and bad["n_fronts"] == "" and "energy" in bad["message"]
    data = notebook.open_sweep("out")
    assert np.isnan(data.n_fronts.sel(step_factor=1.5)) and data.n_fronts.sel(step_factor=0.9) >= 1
    assert verify_checksums(Path("out")) == []
    before = states_of()
    assert main(["--restart", "out", "-q"]) == 1  # it would blow up again: told, not run
    assert states_of() == before and table_of()[0] == good and table_of()[1]["status"] == "failed"


def test_what_cannot_be_printed_costs_no_results(case, capsys, monkeypatch):
    for arguments in ([str(case), *TWO, "-o", "out"], ["--restart", "out"]):
        with open("/dev/full", "w") as full, monkeypatch.context() as patched:
            patched.setattr(sys, "stdout", full)
            assert main(arguments) == 1
        told = "slipfront sweep: error: standard output: No space left on device"
        assert capsys.readouterr().err.splitlines()[-1] == told
        assert len(table_of()) == 2


def test_shares_make_a_whole(case, capsys):
    for k in (1, 2):
        assert main([str(case), *TWO, "-o", "out", "-q", "--share", f"{k}/2"]) == 0
    assert not Path("out/sweep.csv").exists()
    assert maps.main(["map.png", "out"]) == 2
    assert "the sweep is not done; slipfront sweep --restart out" in capsys.readouterr().err
    before = states_of()
    assert len(list(Path("out").rglob("run.json"))) == 2
    assert main(["--restart", "out", "-q"]) == 0  # makes the tables
    assert states_of() == before
    assert [row["status"] for row in table_of()] == ["done"] * 2


def test_a_script_for_slurm_runs_the_shares(case):
    assert main([str(case), *TWO, "-o", "out", "--slurm", "sweep.sh"]) == 0
    assert "#SBATCH --array=1-2\n" in Path("sweep.sh").read_text() and not states_of()
    for k in "12":
        subprocess.run(["bash", "sweep.sh"], env=os.environ | {"SLURM_ARRAY_TASK_ID": k}, check=True)
    assert len(list(Path("out").rglob("run.json"))) == 2


# --- Results of a run

FRONT_HEADER = "front_id,x_m,onset_s,direction,v_tip_m_per_s,t_s_Pa,p_s_Pa,t_d_Pa,p_d_Pa,t_r_Pa,p_r_Pa,"
FRONT_HEADER += "U_s_J_per_m3,U_r_J_per_m3,speed_kind\n"
C_L = 1000.0
SPONTANEOUS = '[event]\nkind = "spontaneous"\n'
TRIGGER = '[event]\nkind = "left"\ntrigger_zone_m = 0.1\n'


def write_results(place, case, fronts, ends=None, **facts):
    """A run with nodes every 10 mm, in contact from 0.1 to 0.9 m. fronts: rows (x, speed, kind) of each;
    ends: why each ends; facts: further entries of run.json."""
    place.mkdir()
    ends = ends or ["contact_end"] * len(fronts)
    told, rows = [], []
    for k, (points, end) in enumerate(zip(fronts, ends, strict=True)):
        direction = 1 if points[-1][0] > points[0][0] else -1
        told.append({"id": k, "direction": direction, "end": end, "mode": "crack"})
        rows += [
            f"{k},{x:.17g},{1e-5 * n},{direction},{v or ''},1,1,,,1,1,,,{kind}\n"
            for n, (x, v, kind) in enumerate(points)
        ]
    text = FRONT_HEADER + "".join(rows)
    if not any(kind for points in fronts for _, _, kind in points):  # of an older program
        text = re.sub(r",\w*$", "", text, flags=re.MULTILINE)
    (place / "fronts.csv").write_text(text)
    x_m = np.arange(101) / 100
    pressed = (x_m > 0.095) & (x_m < 0.905)
    static = [f"{x},1,{p:d}\n" for x, p in zip(x_m, pressed, strict=True)]
    (place / "static.csv").write_text("x_m,t_s_Pa,p_s_Pa\n" + "".join(static))
    (place / "case.resolved.toml").write_text("[fronts]\nl_star_m = 0.02\nmin_length_m = 0.02\n" + case)
    terms = ("strain", "kinetic", "friction_work", "trigger_work", "damping_work")
    energies = {f"{term}_J_per_m": 0.0 for term in terms}
    info = {"wave_speeds": {"c_L_m_per_s": C_L}, "fronts": told, "time_s": 1e-3, "end": "quiet"}
    info |= {"energy_at_start": energies, "energy_at_end": energies}
    (place / "run.json").write_text(json.dumps(info | facts))
    return read_outcome(place)


def path(from_cm, to_cm, v=500.0, kind="front"):
    """Nodes every 10 mm."""
    step = 1 if to_cm > from_cm else -1
    return [(k / 100, v, kind) for k in range(from_cm, to_cm + step, step)]


def test_a_trigger_zone_is_no_part_of_a_front(tmp_path):
    """A front that leaves the zone, and one to the edge that the trigger makes all by itself."""
    zone = TRIGGER + '[plate]\nsides = "free"\n'
    right = [*path(15, 20, None, "triggered"), *path(21, 70)]
    left = path(14, 9, None, "triggered")
    found = write_results(tmp_path / "left", zone, [left, right])
    assert found["n_fronts"] == 1
    assert found["longest_front_direction"] == 1
    assert found["longest_front_length_m"] == pytest.approx(0.5)
    assert found["slipped_length_m"] == pytest.approx(0.5)
    assert found["slipped_share"] == pytest.approx(0.5 / 0.7)
    assert found["reached_ends"] == "none"
    # Without a trigger both are fronts.
    found = write_results(tmp_path / "free", SPONTANEOUS, [left, right])
    assert found["n_fronts"] == 2
    assert found["slipped_length_m"] == pytest.approx(0.6 - 0.01)
    assert found["slipped_share"] == pytest.approx(0.59 / 0.8)
    assert found["reached_ends"] == "left"
    # Of an event in which nothing leaves the zone there is no front.
    found = write_results(tmp_path / "none", zone, [left])
    assert (found["n_fronts"], found["longest_front_end"], found["slipped_share"]) == (0, "none", 0)


@pytest.mark.parametrize("x_m", [0.5, 0.12])
def test_a_nucleation_patch_is_no_part_of_the_fronts(tmp_path, x_m):
    """Of a periodic plate it may go on at the other edge."""
    patch = f"[nucleation]\nx_m = {x_m}\nhalf_length_m = 0.1\ntaper_m = 0.05\n"
    case = f'[event]\nkind = "nucleation"\n{patch}[plate]\nsides = "periodic"\nwidth_m = 1.0\n'
    middle = round(100 * x_m)
    found = write_results(tmp_path / "run", case, [path(middle, 80), path(middle, 10)])
    whole_m = 0.8 - 0.3 if x_m == 0.5 else 0.9 - 0.27
    ahead_m = 0.8 - x_m - 0.15
    behind_m = 0.25 if x_m == 0.5 else 0.0
    assert found["n_fronts"] == (2 if behind_m else 1)
    assert found["longest_front_length_m"] == pytest.approx(max(ahead_m, behind_m))
    assert found["slipped_share"] == pytest.approx((ahead_m + behind_m) / whole_m)


PATCH = '[event]\nkind = "nucleation"\n[nucleation]\nx_m = 0.5\nhalf_length_m = 0.1\ntaper_m = 0.05\n'
RIGHT = (50, 90, "contact_end")


@pytest.mark.parametrize(
    ("case", "fronts", "reached"),
    [
        (SPONTANEOUS, [RIGHT, (50, 10, "contact_end")], "both"),
        (SPONTANEOUS, [RIGHT, (50, 11, "arrest")], "right"),
        # Met by a front from the edge, in neighbouring nodes, and with a node between.
        (SPONTANEOUS, [RIGHT, (50, 16, "meets_front"), (10, 15, "meets_front")], "both"),
        (SPONTANEOUS, [RIGHT, (50, 16, "arrest"), (10, 15, "arrest")], "both"),
        (SPONTANEOUS, [RIGHT, (50, 16, "arrest"), (10, 14, "arrest")], "right"),
        # Met by slip from the edge that is too short for a front, 20 mm, and by slip that is none from there.
        (SPONTANEOUS, [RIGHT, (50, 12, "meets_front")], "both"),
        (SPONTANEOUS, [RIGHT, (50, 13, "meets_front")], "right"),
        # A front that has come to an end by itself.
        (SPONTANEOUS, [(20, 60, "arrest"), (80, 90, "contact_end")], "none"),
        (SPONTANEOUS, [(10, 60, "arrest")], "left"),
        # Nodes beyond the contact are none of it.
        (SPONTANEOUS, [(30, 95, "contact_end")], "right"),
        (SPONTANEOUS, [RIGHT, (50, 11, "arrest"), (10, 8, "contact_end")], "both"),
        # From the edge of a patch or a trigger zone on; an end in the zone is none that slip runs to.
        (PATCH, [(66, 90, "contact_end"), (50, 20, "arrest")], "right"),
        (PATCH, [(67, 90, "contact_end"), (50, 10, "contact_end")], "left"),
        (PATCH, [(50, 60, "arrest")], "none"),
        (TRIGGER, [(15, 90, "contact_end"), (15, 10, "contact_end")], "right"),
        (TRIGGER, [(15, 60, "meets_front"), (90, 61, "meets_front")], "right"),
        (TRIGGER, [(22, 90, "contact_end")], "none"),
    ],
)
def test_an_end_is_reached_where_slip_comes_to_it_without_a_gap(tmp_path, case, fronts, reached):
    paths, ends = [path(*ends) for *ends, _ in fronts], [end for *_, end in fronts]
    assert write_results(tmp_path / "run", case, paths, ends)["reached_ends"] == reached


def test_what_is_expected_of_the_rupture_is_run_jsons(tmp_path):
    """Lengths are null under a law that does not weaken over a slip."""
    rupture = {"strength_excess_S": {"min": 0.5, "median": 1.5, "max": 4.0}, "nucleation_length_m": 0.02}
    names = ("strength_excess_S_median", "nucleation_length_m", "critical_crack_length_m")
    for k, (facts, expected) in enumerate(
        [
            ({"rupture": rupture | {"griffith_half_length_m": 0.03}}, [1.5, 0.02, 0.06]),
            ({"rupture": rupture | {"griffith_half_length_m": None}}, [1.5, 0.02, np.nan]),
            ({"rupture": {"strength_excess_S": {"median": None}}}, [np.nan] * 3),
            ({}, [np.nan] * 3),
        ]
    ):
        found = write_results(tmp_path / str(k), SPONTANEOUS, [path(20, 40)], **facts)
        np.testing.assert_array_equal([found[name] for name in names], expected)
    units = {quantity.name: quantity.unit for quantity in QUANTITIES}
    assert [units[name] for name in names] == ["1", "m", "m"]


def test_only_speeds_are_taken_for_speeds(tmp_path):
    """Not what another kind of row may hold, and not next to an absorbing edge."""
    front = [
        *path(10, 20, 9e3, "simultaneous"),
        *path(21, 98, 500.0),
        (0.99, 4e3, "front"),
        (1, 5e3, "path_end"),
    ]
    for sides, largest in (("free", 4.0), ("absorbing", 0.5)):
        case = SPONTANEOUS + f'[plate]\nsides = "{sides}"\n'
        found = write_results(tmp_path / sides, case, [front])
        assert found["v_tip_largest_over_c_L"] == largest
        assert found["longest_front_v_tip_largest_over_c_L"] == largest
        assert found["longest_front_v_tip_median_over_c_L"] == 0.5
    base = SPONTANEOUS + '[base]\nsides = "absorbing"\n'
    assert write_results(tmp_path / "base", base, [front])["v_tip_largest_over_c_L"] == 0.5
    # An older program did not tell them apart.
    older = [(x, v, "") for x, v, _ in front]
    assert write_results(tmp_path / "older", SPONTANEOUS, [older])["v_tip_largest_over_c_L"] == 9.0


def test_medians_of_a_crack_are_those_beyond_the_trigger_where_its_breakdown_ended(tmp_path):
    place = tmp_path / "run"
    names = (
        "fracture_energy_median_J_per_m2",
        "G_slip_over_fracture_energy_median",
        "cohesive_zone_median_m",
    )
    nodes = path(19, 24)  # the first two of them in the zone

    def found():
        cells = read_outcome(place)
        return [cells[f"longest_front_{name}"] for name in names]

    write_results(place, TRIGGER, [nodes])
    np.testing.assert_array_equal(found(), [np.nan] * 3)  # of an older program
    energies, by_slip, zones = [9, 9, 1, 2, 4, 9], ["", "", 3, "", 4, 9], [9, 9, 0.1, 0.2, 0.3, 9]
    head = "front_id,x_m,breakdown_work_J_per_m2,breakdown_complete,cohesive_zone_m,G_slip_J_per_m2\n"
    cells = zip(nodes, energies, [1] * 5 + [0], zones, by_slip, strict=True)
    rows = [f"0,{x:.17g},{gamma},{end},{size},{g}\n" for (x, _, _), gamma, end, size, g in cells]
    (place / "fracture.csv").write_text(head + "".join(rows))
    assert found() == [2, 2, 0.2]


# --- Sequences of events

SEQUENCE = ["--set", "plate.element_size_m=4e-3", "--set", "event.kind=spontaneous"]
THREE_EVENTS = [*SEQUENCE, "--set", "sequence.max_events=3"]
SEQUENCES = ["--vary", "friction.mu_k=0.5,0.7", "--vary", "material.stiffness_damping_s=1e-7,4e-7"]


def test_a_sweep_of_sequences_has_the_numbers_of_their_events(case, capsys):
    assert main([str(case), *SEQUENCES, *THREE_EVENTS, "-o", "out"]) == 0
    printed = capsys.readouterr().out.splitlines()
    assert "of a sequence time and disk are those of one event" in printed[0]
    assert printed[1].startswith("note: 4 runs have notes")
    assert printed[2].split()[2:4] == ["events", "global"]
    assert verify_checksums(Path("out")) == []
    data = notebook.open_sweep("out")
    assert dict(data.sizes) == {"mu_k": 2, "stiffness_damping_s": 2}
    for row in table_of():
        sequence = slipfront.open(Path("out", row["folder"]))
        events = sequence.events
        before = events.friction_before.cumulative("event").max()
        are_global = events.is_global == 1
        first = events.event[are_global].min().item()
        assert row["n_events"] == "3" and int(row["n_global_events"]) == are_global.sum()
        assert int(row["first_global_event"]) == first
        earlier = events.length_m[events.event < first]
        for name, value in (
            ("largest_friction", before.sel(event=first)),
            ("friction_at_rest_median", events.friction_after[are_global].median()),
            ("longest_precursor_m", max(earlier.to_numpy(), default=0)),
            ("global_mean_slip_median_m", events.mean_slip_m[are_global].median()),
            ("imbalance_over_largest_energy", sequence.info["imbalance_over_largest_energy"]),
        ):
            at = data[name].sel({key: float(row[c.attrs["key"]]) for key, c in data.coords.items()})
            assert at == value and row[name] == f"{float(value):.12g}"
        notes = [[note.text for note in run.notes] for run in sequence.runs]
        assert row["message"] in notes[0] and all(row["message"] in other for other in notes)
    assert "n_fronts" not in data and "end_reason" not in table_of()[0]
    # Friction at rest is the higher the higher mu_k is.
    assert (data.friction_at_rest_median.sel(mu_k=0.5) < data.friction_at_rest_median.sel(mu_k=0.7)).all()
    drawn = maps.draw(Path("out")).figure.findobj(lambda a: a.get_gid() == "friction_at_rest_median")
    cells = np.ravel(drawn[0].get_array())
    assert cells.tolist() == data.friction_at_rest_median.to_numpy().ravel().tolist()
    page = (data, Path("out"), Path("out/report.html"))
    assert "median mean slip of global events" in report.sweep_section(*page)
    assert "fronts" not in report.same_everywhere(report.sweep_data(*page))


@pytest.mark.parametrize("keep", ["all", "tables"])
def test_sequences_and_runs_are_points_of_one_sweep(case, keep):
    """A column of the other kind is empty. What is done is not run again; a damaged event is."""
    arguments = [str(case), "--vary", "sequence.max_events=1,2", *SEQUENCE, "--keep", keep, "-o", "out", "-q"]
    assert main(arguments) == 0
    run, sequence = table_of()
    assert (sequence["n_events"], sequence["n_fronts"], sequence["longest_front_slip"]) == ("2", "", "")
    assert run["n_events"] == "" and run["n_fronts"] != "" and run["longest_front_slip"] != ""
    assert verify_checksums(Path("out")) == []
    assert len(list(Path("out").rglob("interface.h5"))) == (3 if keep == "all" else 0)
    place = Path("out", sequence["folder"])
    assert slipfront.open(place).runs[1].status == "complete"
    before = states_of()
    assert main(["--restart", "out", "-q"]) == 0
    assert states_of() == before
    fronts = place / "events/0002/fronts.csv"
    whole = fronts.read_bytes()
    fronts.write_bytes(whole[:-10])
    assert main(["--restart", "out", "-q"]) == 0
    assert fronts.read_bytes() == whole and table_of() == [run, sequence]


def test_thinning_out_a_sequence_may_be_cut_off(case, monkeypatch):
    """At each file that it writes or removes; no list is wrong meanwhile, and the next one goes on."""

    def lines_under(folder):  # in any order
        return {path: sorted(path.read_bytes().split(b"\n")) for path in folder.rglob("*") if path.is_file()}

    assert main([str(case), "--vary", "sequence.max_events=2", *SEQUENCE, "-o", "out", "-q"]) == 0
    (point,) = read_definition(Path("out")).points()
    place = place_of(Path("out"), point)
    shutil.copytree(place, "whole")
    thin_out(place)
    thinned = lines_under(place)
    n_cut = 0
    for n_steps in range(100):
        shutil.rmtree(place)
        shutil.copytree("whole", place)
        left = iter(range(n_steps))

        def cut(step, left=left):
            def stepped(*arguments, **options):
                if next(left, None) is None:
                    raise KeyboardInterrupt
                return step(*arguments, **options)

            return stepped

        with monkeypatch.context() as patched:
            patched.setattr(os, "replace", cut(os.replace))
            patched.setattr(Path, "unlink", cut(Path.unlink))
            with suppress(KeyboardInterrupt):
                thin_out(place)
                break
        n_cut += 1
        assert is_done(Path("out"), point)
        thin_out(place)
        assert lines_under(place) == thinned
    assert n_cut > 4


def write_events(place, rows):
    """A sequence whose events are global or not, have a length, and friction before and after."""
    place.mkdir()
    lines = [f"{k},{','.join(map(str, row))},1e-6\n" for k, row in enumerate(rows, start=1)]
    head = "event,is_global,length_m,friction_before,friction_after,mean_slip_m\n"
    (place / "events.csv").write_text(head + "".join(lines))
    (place / "sequence.json").write_text(json.dumps({"imbalance_over_largest_energy": 0}))
    cells = read_outcome(place)
    return [cells[f"{name}"] for name in ("first_global_event", "largest_friction", "longest_precursor_m",
                                          "friction_at_rest_median", "n_global_events")]  # fmt: skip


def test_precursors_come_before_the_first_global_event(tmp_path):
    one, two = (0, 0.03, 0.6, 0.59), (0, 0.05, 0.7, 0.68)
    whole, next_one, later = (1, 0.2, 0.8, 0.5), (0, 0.1, 0.9, 0.89), (1, 0.2, 0.6, 0.4)
    all_of_them = [one, two, whole, next_one, later]
    assert write_events(tmp_path / "all", all_of_them) == [3, 0.8, 0.05, pytest.approx(0.45), 2]
    for name, rows, found in (
        ("precursors", [two, one], [np.nan, 0.7, 0.05, np.nan, 0]),
        ("at_once", [whole, next_one], [1, 0.8, 0, 0.5, 1]),
        ("none", [], [np.nan, np.nan, 0, np.nan, 0]),
    ):
        np.testing.assert_array_equal(write_events(tmp_path / name, rows), found)


# --- Printed


def test_a_small_table_tells_what_is_asked_first():
    """At most 30 rows; what is left out is told."""
    texts = {"longest_front_slip": "crack", "longest_front_end": "arrest", "reached_ends": "none"}
    numbers = {"n_fronts": 2.0, "longest_front_length_m": 0.15000000000000002, "slipped_share": 1 / 3}
    cells = texts | numbers | {"longest_front_v_tip_median_over_c_L": np.nan, "message": ""}
    rows = [{"folder": "", "friction.mu_k": str(k), "status": "done"} | cells for k in range(31)]
    _, heads, *lines, last = table_lines(pd.DataFrame(rows), Path("out"))
    assert heads.split() == ["mu_k", "fronts", "slip", "length_m", "V_tip/c_L", "end", "slipped", "reached"]
    assert len(lines) == 30 and lines[-1].split()[2:6] == ["crack", "0.15", "-", "arrest"]
    assert last == f"... 1 more in {Path('out/sweep.csv')}"


# --- Interruptions

LONG = ["--vary", "friction.mu_k=0.5,0.7", "--set", "time.end_s=10", "--set", "time.quiet_s=inf",
        "--set", "output.history_interval_s=1e-3", "--set", "output.energy_interval_s=1e-3"]  # fmt: skip


def started(*arguments):
    """A sweep, and its runs, in a group of their own as of a terminal."""
    options = {"env": WITH_PACKAGE | {"SLIPFRONT_PROGRAM": str(built())}, "preexec_fn": as_from_a_terminal}
    return start(sys.executable, "-m", "slipfront", "sweep", *arguments, start_new_session=True, **options)


def runs_under_way(out):
    """run.json of each run that has come to its event."""
    return [p.with_name("run.json") for p in out.glob("points/*/unfinished/energy.csv")]


@pytest.mark.slow
def test_an_interrupted_sweep_goes_on_with_its_checkpoints(case, tmp_path):
    """Ctrl-C as a terminal sends it, to the whole group; points half done are kept and gone on with."""
    process = started(case, *LONG, "-o", "out", "--workers", "2")
    out = tmp_path / "out"
    wait_until(lambda: len(runs_under_way(out)) == 2, process)
    os.killpg(process.pid, signal.SIGINT)
    errors = process.communicate(timeout=HANG_S)[1]
    assert process.returncode == 130
    assert errors.splitlines()[-1] == (
        "slipfront sweep: error: interrupted, 2 points are left; slipfront sweep --restart out"
    )
    assert "Traceback" not in errors
    assert not (out / "sweep.csv").exists()
    assert len(list(out.glob("points/*/unfinished/state/checkpoint-*.bin"))) == 2

    process = started("--restart", "out", "--workers", "2")
    wait_until(lambda: all('"sessions": 2' in p.read_text() for p in runs_under_way(out)), process)
    assert process.poll() is None
    os.killpg(process.pid, signal.SIGINT)
    assert process.wait(timeout=HANG_S) == 130


def test_runs_end_when_their_sweep_is_killed(case, tmp_path):
    """A kill leaves no run behind, and the folder can be gone on with at once."""
    process = started(case, *LONG, "-o", "out", "--share", "1/2")
    out = tmp_path / "out"
    wait_until(lambda: len(runs_under_way(out)) == 1, process)
    process.kill()
    process.communicate()
    (place,) = (out / "points").iterdir()
    wait_until(lambda: '"interrupted"' in (place / "unfinished/run.json").read_text())
    assert list(place.glob("unfinished/state/checkpoint-*.bin"))


def test_an_interrupted_sweep_goes_on_with_its_sequences(case, tmp_path):
    """Between events or in one; the results are those of a sequence that was never stopped."""
    settings = [*SEQUENCE[2:], "--set", "plate.element_size_m=2.5e-3", "--set", "sequence.max_events=8"]
    place = tmp_path / "out/points/mu_k=0.5"
    n_done = 0
    while not 1 <= n_done < 8:  # again where it was over before
        shutil.rmtree("out", ignore_errors=True)
        process = started(case, "--vary", "friction.mu_k=0.5", *settings, "-o", "out")
        wait_until_or_over((place / "unfinished/events/0001/checksums.sha256").exists, process)
        with suppress(ProcessLookupError):
            os.killpg(process.pid, signal.SIGINT)
        process.communicate(timeout=HANG_S)
        assert process.returncode in (0, 130)
        n_done = len(list(place.glob("unfinished/events/*/checksums.sha256")))
    assert main(["--restart", "out", "-q"]) == 0
    assert slipfront.open(place).info["sessions"] == 2
    alone = [built(), "run", case, "--set", "friction.mu_k=0.5", *settings, "-o", "alone", "-q"]
    subprocess.run(alone, check=True)
    for name in ("events.csv", "loading.csv", "events/0001/fronts.csv", "events/0008/interface.h5"):
        assert (place / name).read_bytes() == Path("alone", name).read_bytes()


def test_a_sequence_that_blew_up_is_not_run_again(case, capsys):
    """Its other points are."""
    assert main([str(case), *UNSTABLE, *THREE_EVENTS, "-o", "out", "-q"]) == 1
    good, bad = table_of()
    assert (good["status"], good["n_events"], bad["status"], bad["n_events"]) == ("done", "3", "failed", "")
    assert "event 1" in bad["message"]
    before = states_of()
    assert main(["--restart", "out", "-q"]) == 1
    assert states_of() == before and table_of()[0] == good and table_of()[1]["status"] == "failed"


# --- Maps and page


@pytest.fixture
def done(case, swept):
    """A sweep of a number and a word, two points of which fail."""
    arguments = (*UNSTABLE, "--vary", "event.kind=left,spontaneous")
    return shutil.copytree(swept(*arguments, code=1), Path("out"))


def test_a_map_has_the_numbers_of_the_table(done):
    figure = maps.draw(done, ("friction_work_J_per_m",)).figure
    (cells,) = figure.axes[0].findobj(lambda a: a.get_gid() == "friction_work_J_per_m")
    work = [float(row["friction_work_J_per_m"] or "nan") for row in table_of()]
    np.testing.assert_allclose(np.ma.filled(cells.get_array(), np.nan).ravel(), work, rtol=1e-11)
    assert np.isfinite(work).tolist() == [True, True, False, False]


@pytest.mark.parametrize("how", [["--zip"], ["--vary", "event.kind=left"]])
def test_other_sweeps_are_drawn(case, how):
    vary = ["--vary", "friction.mu_k=0.5,0.7", "--vary", "event.kind=left,right"]
    assert main([str(case), *vary[: 4 if how == ["--zip"] else 2], *how, "-o", "out", "-q"]) == 0
    assert maps.main(["map.png", "out"]) == 0
    assert Path("map.png").read_bytes().startswith(b"\x89PNG")


def test_wave_speeds_are_marked_in_scales_of_speeds(done):
    data = read_dataset(done)
    waves = maps.waves_of(data, "v_tip_largest_over_c_L")
    nu = 0.37  # of the default material, in plane stress
    assert list(waves) == ["c_R", "c_S", "c_L"] and waves["c_L"] == 1
    assert waves["c_S"] == pytest.approx(np.sqrt((1 - nu) / 2)) and 0.9 < waves["c_R"] / waves["c_S"] < 0.96
    assert maps.waves_of(data, "slipped_share") == {}
    told_all = report.sweep_data(data, done, done / "report.html")["quantities"]
    (told,) = (q for q in told_all if q["name"] == "v_tip_largest_over_c_L")
    assert {wave["name"]: wave["level"] for wave in told["waves"]} == waves


def test_edges_lie_half_way_between_centres():
    assert maps.edges(np.array([1.0, 2.0, 4.0]), False).tolist() == [0.5, 1.5, 3.0, 5.0]
    assert maps.edges(np.array([1.0]), False).tolist() == [0.5, 1.5]
    assert np.allclose(maps.edges(np.array([1.0, 100.0]), True), [0.1, 10, 1000])


def test_a_page_has_the_table_and_what_failed(done):
    dataset = read_dataset(done)
    data = report.sweep_data(dataset, done, done / "report.html")
    assert [key["axis"] for key in data["keys"]] == [[0.9, 1.5], ["left", "spontaneous"]]
    by_values = {tuple(point["values"].values()): point for point in data["points"]}
    for row in table_of():
        point = by_values[float(row["time.step_factor"]), row["event.kind"]]
        text = row["friction_work_J_per_m"]
        assert point["cells"]["friction_work_J_per_m"] == pytest.approx(float(text) if text else None)
        assert point["status"] == row["status"]
    html = report.sweep_section(dataset, done, done / "report.html")
    assert "4 runs, 2 without results" in html and html.count("<td>points/") == 2 + 4
    assert report.is_kind(done) and not report.is_kind(done / "points")
    assert "</script>" not in report.embedded({"message": "</script><script>"})


def test_the_table_of_a_page_leads_to_the_reports_that_are_there(done, tmp_path):
    dataset = read_dataset(done)
    place = table_of()[0]["folder"]
    (done / place / "report.html").write_text("a page")
    beside = f"{place.replace('=', '%3D').replace(',', '%2C')}/report.html"
    elsewhere = tmp_path / "elsewhere" / "page.html"
    for page, address in ((done / "report.html", beside), (elsewhere, f"../out/{beside}")):
        points = report.sweep_data(dataset, done, page)["points"]
        assert [point["report"] for point in points if point["report"]] == [address]
        html = report.sweep_section(dataset, done, page)
        assert f'<a href="{address}">{place}</a>' in html and html.count("<td><a href") == 1


def test_axes_have_engineering_units_and_what_is_the_same_is_a_sentence(case):
    vary = ["--vary", "event.trigger_zone_m=0.02,0.03", "--vary", "prestress.t_Pa=2.1e6,2.3e6"]
    keys = "plate.corner=none loading.method=prestress prestress.p_Pa=4e6 friction.mu_k=0.3 event.kind=left"
    assert main([str(case), *vary, *sets(*keys.split()), "-o", "out", "-q"]) == 0
    dataset = read_dataset(Path("out"))
    told = report.sweep_data(dataset, Path("out"), Path("out/report.html"))
    labels = {key["label"]: key["factor"] for key in told["keys"]}
    assert labels == {"trigger zone (mm)": 1e3, "t (MPa)": 1e-6}
    same = {q["name"]: q["constant"] for q in told["quantities"]}
    assert same["end_reason"] == "end time" and same["friction_work_J_per_m"] is None
    html = report.sweep_section(dataset, Path("out"), Path("out/report.html"))
    assert "why the event ended: end time" in html and "<th>t (MPa)</th>" in html
    # A map: the values in its cells; what is the same below all.
    drawn = maps.draw(Path("out"), ("friction_work_J_per_m", "end_reason")).figure
    (panel, bar) = drawn.axes
    work = [float(row["friction_work_J_per_m"]) for row in table_of()]
    assert sorted(text.get_text() for text in panel.texts) == sorted(f"{v:.3g}" for v in work)
    assert (panel.get_xlabel(), panel.get_ylabel()) == ("t (MPa)", "trigger zone (mm)")
    assert panel.get_xticks().tolist() == pytest.approx([2.1, 2.3])
    assert drawn.get_supxlabel() == "the same at all points: why the event ended: end time"
    with pytest.raises(DataError, match="nothing to draw: the same at all points"):
        maps.draw(Path("out"), ("end_reason",))


def test_a_damaged_table_is_refused(done, capsys):
    (done / "sweep.nc").write_bytes(b"changed")
    assert maps.main(["map.png", str(done)]) == 2
    assert "sweep.nc: does not match checksums.sha256" in capsys.readouterr().err
