# SPDX-License-Identifier: BSD-3-Clause
"""Studies of a case from the command line: what they find, and how they go on."""

import json
import re
import signal
import sys

import pytest
from common import ROOT, finished, refusal, require_done, require_same_bytes, rows_of, sets, wait_until
from slipfront.figures import interface_step
from slipfront.figures.convergence import read_study
from slipfront.folder import verify_checksums

SIZES = "5e-3,2.5e-3,2e-3"
LEFT = ("--set", "event.kind=left")
TABLES = ("convergence.csv", "convergence.json")


@pytest.fixture(autouse=True)
def package(monkeypatch):
    monkeypatch.setenv("SLIPFRONT_PYTHON", sys.executable)
    monkeypatch.setenv("PYTHONPATH", str(ROOT / "python"))


@pytest.fixture
def converge(program, coarse):
    """The command of a study of the coarse case."""
    return lambda *options, out="out": ("study", "convergence", coarse, "-o", out, *options)


def starts(folder):
    """When each run of a study was done, by its name."""
    return {file.parent.name: file.stat().st_mtime_ns for file in folder.glob("runs/points/*/run.json")}


@pytest.mark.parametrize("event, n_quiet", [("left", 0), ("none", 9)])
def test_convergence_study_and_its_figure_agree(program, converge, tmp_path, event, n_quiet):
    """The medians that the figure draws from the table are those that the study tells."""
    options = ("--set", f"event.kind={event}", "--threads", "2", "--element-sizes", SIZES)
    printed = require_done(program(*converge(*options))).stdout
    assert f"\n9 runs, {n_quiet} of which ended before time.end_s since nothing moved\n" in printed
    assert ("note: no front of the case's own run" in printed) == (event == "none")
    assert verify_checksums(tmp_path / "out") == []
    written = json.loads((tmp_path / "out/convergence.json").read_text())
    assert (written["n_runs"], written["n_quiet"]) == (9, n_quiet)  # 3 + 4 + 4, the case itself in all three
    if event == "none":
        return
    study = read_study(tmp_path / "out")
    assert [s.parameter for s in study.sequences] == [s["parameter"] for s in written["sequences"]]
    compared = 0
    for entry, sequence in zip(written["sequences"], study.sequences, strict=True):
        for direction in study.directions():
            error = entry[f"direction_{direction:+d}"]["median_relative_error"]
            if error is not None:
                # Ten digits in the table.
                assert sequence.median_error(direction)[sequence.own] == pytest.approx(error, rel=1e-6)
                compared += 1
    assert compared >= 3


@pytest.mark.slow
def test_a_study_goes_on_and_adds_to_what_it_has(program, converge, tmp_path):
    out = tmp_path / "out"
    require_done(program(*converge(*LEFT, "--element-sizes", SIZES, "--threads", "1", "-q")))
    before, tables = starts(out), {name: (out / name).read_bytes() for name in TABLES}
    require_done(program(*converge(*LEFT, "--element-sizes", SIZES, "--threads", "2", "-q")))
    assert starts(out) == before and {name: (out / name).read_bytes() for name in TABLES} == tables
    require_done(program(*converge(*LEFT, "--element-sizes", f"{SIZES},1e-3", "-q")))
    after = starts(out)
    assert len(after) == 10 and {name: after[name] for name in before} == before
    # Another case takes the folder only where that is wanted, and leaves nothing of the earlier one.
    other = ("--element-sizes", SIZES, "--set", "event.kind=right")
    line = refusal(program(*converge(*other)))
    assert "out/runs: holds a sweep of other settings" in line and "--overwrite" in line
    require_done(program(*converge(*other, "--overwrite", "-q")))
    assert len(starts(out)) == 9 and min(starts(out).values()) > max(after.values())
    assert verify_checksums(out) == []


@pytest.mark.slow
def test_an_interrupted_study_goes_on_to_the_same(program, converge, tmp_path):
    options = (*LEFT, "--element-sizes", f"{SIZES},1e-3", "--threads", "1")
    process = program.start(*converge(*options))
    wait_until(lambda: starts(tmp_path / "out"), process)
    process.send_signal(signal.SIGINT)
    ended = finished(process)
    assert ended.returncode == 130
    last = ended.stderr.splitlines()[-1]
    assert last.endswith("interrupted; runs that are done are kept: the same command goes on")
    done = starts(tmp_path / "out")
    assert 0 < len(done) < 10 and not (tmp_path / "out/convergence.json").exists()
    require_done(program(*converge(*options, "-q")))
    assert done.items() <= starts(tmp_path / "out").items()
    require_done(program(*converge(*options, "-q", out="alone")))
    require_same_bytes(tmp_path / "out", tmp_path / "alone", *TABLES)


def test_a_run_that_blows_up_has_no_fronts(program, converge, tmp_path):
    """Beyond the stable step, with which the case is run as well."""
    keys = ("time.interface_substeps=1", "time.step_factor=1.5", "time.allow_unstable=true")
    printed = require_done(program(*converge(*LEFT, *sets(*keys), "--element-sizes", SIZES))).stdout
    told = json.loads((tmp_path / "out/convergence.json").read_text())["warnings"]
    assert [f"note: {warning}" for warning in told] == re.findall(r"^note: .*", printed, re.MULTILINE)
    assert any(warning.startswith("time.step_factor = 1.5: ") for warning in told)
    assert not any(warning.startswith("time.step_factor = 0.75: ") for warning in told)
    assert told[-1].endswith("nothing is compared")


@pytest.mark.parametrize(
    "options, said",
    [
        (("--element-sizes", "5e-3,7e-3,2.5e-3"), "--element-sizes: point plate.element_size_m = 0.007"),
        (("--element-sizes", "5e-3,2.5e-3"), "at least three different sizes"),
        (("--element-sizes", "4e-3,2e-3,1e-3"), "the case's own plate.element_size_m = 0.005"),
        (("--element-sizes", "5e-3,2.5e-3,-1e-3"), "'5e-3,2.5e-3,-1e-3' is no number greater than 0"),
        (("--tolerance", "nan"), "--tolerance: 'nan' is no number greater than 0"),
        (("--threads", "0"), "--threads: '0' is no whole number greater than 0"),
        (("--set", "friction.mu_k=900"), "it must be at least 0 and at most 100"),
        (("--set", "friction.mk=9"), "did you mean friction.mu_k?"),
    ],
)
def test_what_is_wrong_is_told_in_one_line_before_anything_is_run(program, converge, tmp_path, options, said):
    line = refusal(program(*converge(*options)))
    assert line.startswith("slipfront study convergence: error: ") and said in line
    assert not (tmp_path / "out").exists()


def test_a_folder_of_something_else_is_left_alone(program, converge, tmp_path):
    (tmp_path / "out").mkdir()
    (tmp_path / "out/mine.txt").write_text("mine")
    assert "holds no study; choose another folder" in refusal(program(*converge("--overwrite")))
    assert [file.name for file in (tmp_path / "out").iterdir()] == ["mine.txt"]


@pytest.mark.slow
def test_interface_step_study_writes_a_case_that_runs(program, coarse, tmp_path):
    # 400 rows do not fit.
    options = ("--rows", "2,4,400", "--substeps", "4,8", "--tolerance", "0.5", *LEFT)
    result = require_done(program("study", "interface-step", coarse, "-o", "out", *options))
    assert "cheapest within 50 %" in result.stdout
    rows = rows_of(tmp_path / "out/interface_step.csv")
    kinds = [row["kind"] for row in rows]
    assert kinds == ["plain"] * 4 + ["layer"] * 4 + ["extrapolated"] * 2
    cost = [float(row["cost_over_plain"]) for row in rows]
    assert cost[:4] == pytest.approx([1, 2, 4, 8], rel=1e-5)
    # 2 rows of cells hold three rows of nodes of 20 that move: 3 (n - 1)/20 more, corners and sides alike.
    assert cost[4:6] == pytest.approx([1 + 3 * 3 / 20, 1 + 3 * 7 / 20], abs=2e-3)
    assert cost[8] == pytest.approx(cost[4] + cost[5], rel=1e-5)
    # Smaller steps come nearer to the limit.
    errors = [float(row["median_error"]) for row in rows]
    assert errors[:4] == sorted(errors[:4], reverse=True) and errors[0] > 0.01
    assert all(float(row["p90_error"]) >= error for row, error in zip(rows, errors, strict=True))

    picture = tmp_path / "picture.png"
    assert interface_step.main([str(picture), str(tmp_path / "out")]) == 0
    assert picture.is_file()
    require_done(program("run", "out/chosen.toml", "-o", "again", "-q"))
    chosen = json.loads((tmp_path / "out/interface_step.json").read_text())["chosen"]
    assert chosen["p90_error"] <= 0.5
    # A study that chooses nothing leaves no case of an earlier one.
    options = ("--rows", "2,4", "--substeps", "4,8", "--tolerance", "1e-9", *LEFT)
    require_done(program("study", "interface-step", coarse, "-o", "out", "-q", *options))
    assert not (tmp_path / "out/chosen.toml").exists() and verify_checksums(tmp_path / "out") == []
