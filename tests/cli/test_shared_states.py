# SPDX-License-Identifier: BSD-3-Clause
"""`slipfront run --state-dir`: runs that share the state before the event."""

import json

import pytest

MEASURED = ("wall_s", "node_updates_per_s")


def results(folder):
    """All files of a run but its checksums, without what is measured."""
    files = {path.name: path.read_bytes() for path in folder.iterdir() if path.is_file()}
    del files["checksums.sha256"]
    run = json.loads(files["run.json"])
    for key in MEASURED:
        del run[key]
    del run["statics"]["wall_s"]
    return files | {"run.json": run}


def states(folder):
    return sorted(path.name for path in folder.iterdir())


@pytest.mark.parametrize("event", ["spontaneous", "left"])
def test_a_shared_state_changes_no_bit(program, coarse, tmp_path, event):
    case = [coarse, "--set", f"event.kind={event}"]
    for out, options in [("alone", []), ("first", ["--state-dir", "s"]), ("second", ["--state-dir", "s"])]:
        assert program("run", *case, "-o", out, *options).returncode == 0
    assert len(states(tmp_path / "s")) == 1
    alone = results(tmp_path / "alone")
    assert results(tmp_path / "first") == alone
    assert results(tmp_path / "second") == alone
    walls = [
        json.loads((tmp_path / out / "run.json").read_text())["statics"]["wall_s"]
        for out in ("first", "second")
    ]
    assert walls[0] == walls[1]  # it was taken, not solved again


def test_only_runs_of_one_plate_and_strength_share(program, coarse, tmp_path):
    for out, settings in [
        ("a", ["friction.mu_k=0.5"]),
        ("b", ["friction.mu_k=0.9"]),
        ("c", ["friction.mu_s=1.2"]),
    ]:
        options = [part for setting in settings for part in ("--set", setting)]
        assert program("run", coarse, *options, "-o", out, "--state-dir", "s").returncode == 0
    assert len(states(tmp_path / "s")) == 2


def test_a_damaged_state_is_told_and_solved_again(program, coarse, tmp_path):
    assert program("run", coarse, "-o", "first", "--state-dir", "s").returncode == 0
    file = tmp_path / "s" / states(tmp_path / "s")[0]
    whole = file.read_bytes()
    file.write_bytes(whole[:100] + b"x" + whole[101:])
    result = program("run", coarse, "-o", "second", "--state-dir", "s")
    assert result.returncode == 0
    assert "is damaged" in result.stderr and "solved again" in result.stderr
    assert results(tmp_path / "second") == results(tmp_path / "first")
    assert file.read_bytes() != whole[:100] + b"x" + whole[101:]


def test_a_folder_that_cannot_be_made_is_told(program, coarse, tmp_path):
    (tmp_path / "s").write_text("a file")
    result = program("run", coarse, "-o", "out", "--state-dir", "s")
    assert result.returncode == 1
    assert result.stderr.splitlines()[-1].startswith("slipfront: s")
