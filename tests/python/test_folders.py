# SPDX-License-Identifier: BSD-3-Clause
"""Folders with checksums, with half-moved sets, and with runs that did not come to their end."""

from __future__ import annotations

import shutil
import subprocess

import h5py
import numpy as np
import pytest
from draw import draw_all
from drawing import events, setup
from drawing.html import figure_html, write_report
from drawing.results import read_results
from refusals import change_json, error_of_paper, flip, one_error, read_run
from slipfront import read
from slipfront.figures import balance
from slipfront.figures.__main__ import main
from slipfront.files import DataError
from slipfront.opened import drawn_history
from slipfront.read import verify_checksums
from synthetic import (
    ENERGY_HEADER,
    OPEN_HEAD,
    energy_rows,
    interrupt,
    reopen_history,
    seal,
    set_status,
    write_checksums,
    write_csv,
    write_output,
)


@pytest.fixture(scope="module")
def pristine(tmp_path_factory):
    return write_output(
        tmp_path_factory.mktemp("reproduction") / "out", columns=20, rows=10, n_times=11, snapshots=5
    )


@pytest.fixture
def output(pristine, tmp_path):
    return shutil.copytree(pristine, tmp_path / "out")


@pytest.fixture
def run(output):
    return output / "left"


# Checksums


def test_a_sealed_reproduction_is_read(output, capsys):
    seal(output)
    results = read_results(output)
    assert results.mark == "" and results.remarks == []
    assert main([str(output / "left")]) == 0
    assert "note:" not in capsys.readouterr().out


RUN_FILES = "run.json case.resolved.toml static.csv fronts.csv energy.csv interface.h5 fields.vtkhdf"


@pytest.mark.parametrize(
    "name",
    ["analysis.json", "scorecard.json", "timings.json", *(f"right/{name}" for name in RUN_FILES.split())],
)
def test_a_file_that_is_not_as_listed_is_refused(output, capsys, name):
    seal(output)
    for damage, says in ((flip, "does not match checksums"), (lambda file: file.unlink(), "missing")):
        damage(output / name)
        error = error_of_paper(capsys, output)
        assert f"{output / name}: {says}" in error and "run the case again" in error
        assert not (output / "figures").exists()
    if name == "right/energy.csv":  # of a single run as well
        assert "energy.csv: missing" in one_error(capsys, output / "right")


def test_a_file_of_another_set_is_left_alone(run):
    """Such as the snapshots of an earlier run with more of them."""
    write_checksums(run, leave_out=("fields.vtkhdf",))
    assert read_run(run).fields is None


@pytest.mark.parametrize("name", ["fronts.csv", "interface.h5"])
def test_a_list_without_a_file_that_every_set_has_is_refused(run, name):
    write_checksums(run, leave_out=(name,))
    with pytest.raises(DataError, match=f"{name}: not in checksums.sha256"):
        read_run(run)
    assert verify_checksums(run) == [f"{run / name}: not in checksums.sha256: not of this set of results"]


def test_a_damaged_list_is_refused(run):
    file = write_checksums(run)
    text = file.read_text()
    for damaged in (text[:70], text.replace("  ", " ", 1), "", "x"):
        file.write_text(damaged)
        with pytest.raises(DataError, match="checksums.sha256"):
            read_run(run)


def test_the_lists_are_those_of_sha256sum(output):
    seal(output)
    subprocess.run(["sha256sum", "--quiet", "-c", "checksums.sha256"], cwd=output / "left", check=True)


def test_checksums_of_all_folders_are_compared(output, capsys):
    seal(output)
    assert verify_checksums(output) == []
    assert read.main([str(output)]) == 0
    assert "all files match" in capsys.readouterr().out
    files = [output / "left/fields.vtkhdf", output / "right/energy.csv"]
    flip(files[0])
    files[1].unlink()
    problems = verify_checksums(output)
    assert [p.split(":")[0] for p in problems] == [str(file) for file in files]
    assert read.main([str(output)]) == 1
    assert capsys.readouterr().out.splitlines() == problems


def test_without_a_list_nothing_is_vouched_for(output, tmp_path):
    assert "nothing to compare with" in verify_checksums(output)[0]
    assert "no such folder" in verify_checksums(tmp_path / "nowhere")[0]
    assert read.main([str(output)]) == 1


def test_a_file_that_changes_after_it_was_read_is_summed_again(run):
    write_checksums(run)
    read_run(run)
    flip(run / "static.csv")
    with pytest.raises(DataError, match="static.csv: does not match"):
        read_run(run)


# A set that is being moved into place


def test_a_half_moved_set_is_read_as_a_whole(run):
    """The new run has more rows of energy; the old files are those of the earlier run."""
    new = run / "publishing"
    new.mkdir()
    for name in ("run.json", "static.csv", "fronts.csv", "case.resolved.toml", "interface.h5"):
        shutil.copy(run / name, new / name)
    write_csv(new / "energy.csv", ENERGY_HEADER, energy_rows(9))
    write_checksums(new)
    set_status(run, "interrupted", "the earlier one")
    old = read_run(run)
    assert old.status == "complete" and len(old.balance.time_s) == 9 and old.fields is None
    (new / "energy.csv").replace(run / "energy.csv")  # moved: the list is still in publishing/
    assert len(read_run(run).balance.time_s) == 9
    flip(run / "energy.csv")
    with pytest.raises(DataError, match="energy.csv: does not match"):
        read_run(run)


# Runs that did not come to their end


@pytest.mark.parametrize(
    "status, words, has_fields",
    [
        ("interrupted", "interrupted at t = 250", True),
        ("blew_up", "blew up at t = 250", True),
        ("failed", "failed at t = 250", False),
        ("running", "still running or killed, results up to t = 250", False),
    ],
)
def test_an_unfinished_run_is_read_and_marked(pristine, output, capsys, status, words, has_fields):
    interrupt(output / "left", status, "why")
    whole, run = read_run(pristine / "left"), read_run(output / "left")
    assert (run.status, run.place.reason, run.name) == (status, "why", "left")
    for name in ("time_s", "x_m", "slip_rate_m_per_s", "p_Pa"):
        np.testing.assert_array_equal(run.history[name], whole.history[name])
    assert len(run.front_list) == len(whole.front_list) and (run.fields is not None) == has_fields

    note = f"note: {output / 'left/unfinished'}: {words} us (why): the figures show what there is"
    assert main([str(output / "left")]) == 0
    assert note in capsys.readouterr().out.splitlines()
    assert balance.balance_of_run(output / "left")[0].mark == f"{words} µs"


def test_unfinished_runs_are_marked_in_every_figure_of_a_reproduction(pristine, output):
    interrupt(output / "left", "blew_up", "why")
    interrupt(output / "right", "running")
    results = read_results(output)
    places = [str(output / run / "unfinished") for run in ("left", "right")]
    assert [remark.split(": ")[0] for remark in results.remarks] == places
    marks = ["left: blew up at t = 250 µs", "right: still running or killed, results up to t = 250 µs"]
    for drawing in draw_all(results):
        assert drawing.mark == "\n".join(marks)
        assert "\n".join(marks) in [text.get_text() for text in drawing.figure.texts]
    html = figure_html(drawing, results, b"")
    assert f'<span class="mark">{"; ".join(marks)}.</span>' in html
    html = write_report(results, [], output).read_text(encoding="utf-8")
    assert html.count('<p class="mark">') == 2
    assert read_results(pristine).mark == ""


@pytest.mark.parametrize(
    "end, status", [("interrupted", "interrupted"), ("blow_up", "blew_up"), ("quiet", "complete")]
)
def test_an_older_folder_tells_its_end(run, end, status):
    change_json(run / "run.json", lambda info: info.update(end=end))
    assert read_run(run).status == status


def test_an_unknown_status_is_refused(run):
    set_status(run, "well", "")
    with pytest.raises(DataError, match="run.json: 'status' is not one of complete, interrupted"):
        read_run(run)


def test_complete_results_win_over_an_unfinished_run(output, capsys):
    shutil.copytree(output / "left", output / "left/unfinished")
    set_status(output / "left/unfinished", "running", "")
    assert read_run(output / "left").mark == ""
    assert main([str(output / "left")]) == 0
    assert f"note: {output / 'left/unfinished'}: another run, not finished" in capsys.readouterr().out


def test_a_list_without_its_files_does_not_hide_behind_an_unfinished_run(output):
    """The complete results are gone: this is told, not the other run shown in their place."""
    write_checksums(output / "left")
    shutil.copytree(output / "left", output / "left/unfinished")
    (output / "left/run.json").unlink()
    with pytest.raises(DataError, match="left/run.json: missing, though"):
        read_run(output / "left")


def test_last_rows_that_are_cut_off_are_passed_over(pristine, run):
    unfinished = interrupt(run, "running")
    with open(unfinished / "energy.csv", "a") as stream:
        stream.write("2.6e-4,380.0,1.")
    history = unfinished / "interface.h5"
    history.write_bytes(history.read_bytes()[:-8])
    now = read_run(run)
    np.testing.assert_array_equal(now.balance.time_s, read_run(pristine / "left").balance.time_s)
    assert len(now.history.time_s) == 10


def test_a_cut_row_of_a_complete_run_is_refused(run):
    file = run / "energy.csv"
    file.write_bytes(file.read_bytes().rstrip()[:-1])
    with pytest.raises(DataError, match="energy.csv: the last line is cut off"):
        read_run(run)


def test_a_run_that_has_only_begun(run):
    unfinished = interrupt(run, "running")
    (unfinished / "fronts.csv").unlink()
    assert read_run(run).front_list == []
    (unfinished / "interface.h5").write_bytes(OPEN_HEAD)
    with pytest.raises(DataError, match="interface.h5: fewer than two times"):
        drawn_history(read_run(run))


def test_a_run_that_was_killed_while_it_finished_its_files_is_read_by_their_rows(pristine, run):
    unfinished = interrupt(run, "complete")
    for name in ("interface.h5", "fields.vtkhdf"):
        (unfinished / name).write_bytes(OPEN_HEAD)
    whole = read_run(pristine / "left")
    shutil.copy(pristine / "left/interface.h5", unfinished)
    reopen_history(unfinished)
    now = read_run(run)
    np.testing.assert_array_equal(now.history.p_Pa, whole.history.p_Pa)
    assert now.fields is None


def test_a_blown_up_run_is_shown_as_far_as_it_has_numbers(run):
    unfinished = interrupt(run, "blew_up")
    with h5py.File(unfinished / "interface.h5", "r+") as hdf5:
        hdf5["slip_rate_m_per_s"][-2, 3] = np.nan
    blown_up = [1.0, "inf", *["nan"] * (len(ENERGY_HEADER) - 2)]
    write_csv(unfinished / "energy.csv", ENERGY_HEADER, [*energy_rows(), blown_up])
    now = read_run(run)
    assert len(now.history.time_s) == 9 and len(now.balance.time_s) == 6
    set_status(unfinished, "interrupted", "")
    with pytest.raises(DataError, match="is not"):
        read_run(run)


# Without snapshots


def test_runs_without_snapshots_are_drawn(output):
    for run in ("left", "spontaneous"):
        (output / run / "fields.vtkhdf").unlink()
    results = read_results(output)
    assert results.runs["left"].fields is None
    set_up, three = setup.setup(results), events.three_events(results)
    assert "no snapshots" in set_up.caption
    missing = [any(a.get_gid() == "no_fields" for a in ax.findobj()) for ax in three.figure.axes[:3]]
    assert missing == [True, True, False]


def test_files_of_two_runs_are_told_apart(output, pristine, tmp_path):
    other = write_output(tmp_path / "other", columns=16, rows=8, n_times=11, snapshots=5)
    shutil.copy(other / "left/interface.h5", output / "left/interface.h5")
    with pytest.raises(DataError, match="its nodes are not those of static.csv"):
        read_run(output / "left")
