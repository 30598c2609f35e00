# SPDX-License-Identifier: BSD-3-Clause
"""`slipfront run --state-dir`: runs that share the state before the event."""

import pytest
from common import refusal, require_done, run_json, sets
from hostile.trials import alone

SHARED = ("--state-dir", "s")


def states(folder):
    return sorted((folder / "s").iterdir())


@pytest.mark.parametrize("event", ["spontaneous", "left"])
def test_a_shared_state_changes_no_bit(program, coarse, tmp_path, event):
    case = [coarse, "--set", f"event.kind={event}"]
    for out, options in (("alone", ["-q"]), ("first", SHARED), ("second", SHARED)):
        require_done(program("run", *case, "-o", out, *options))
    assert len(states(tmp_path)) == 1
    assert alone(tmp_path / "first") == alone(tmp_path / "second") == alone(tmp_path / "alone")
    wall_s = [run_json(tmp_path / out)["statics"]["wall_s"] for out in ("first", "second")]
    assert wall_s[0] == wall_s[1]  # it was taken, not solved again


def test_only_runs_of_one_plate_and_strength_share(program, coarse, tmp_path):
    for out, setting in (("a", "friction.mu_k=0.5"), ("b", "friction.mu_k=0.9"), ("c", "friction.mu_s=1.2")):
        require_done(program("run", coarse, *sets(setting), "-o", out, *SHARED))
    assert len(states(tmp_path)) == 2


def test_a_sequence_shares_none(program, coarse, tmp_path):
    """Its first state is its own."""
    case = [coarse, *sets("event.kind=spontaneous", "sequence.max_events=2")]
    for out, options in (("alone", ()), ("shared", SHARED)):
        require_done(program("run", *case, "-o", out, *options))
    assert not (tmp_path / "s").exists()
    for name in ("events.csv", "loading.csv", "events/0002/interface.h5"):
        assert (tmp_path / "alone" / name).read_bytes() == (tmp_path / "shared" / name).read_bytes()


def test_a_damaged_state_is_told_and_solved_again(program, coarse, tmp_path):
    require_done(program("run", coarse, "-o", "first", *SHARED))
    (file,) = states(tmp_path)
    whole = file.read_bytes()
    damaged = whole[:100] + b"x" + whole[101:]
    file.write_bytes(damaged)
    printed = require_done(program("run", coarse, "-o", "second", *SHARED)).stderr
    assert "is damaged" in printed and "solved again" in printed
    assert alone(tmp_path / "second") == alone(tmp_path / "first")
    assert file.read_bytes() != damaged


def test_a_folder_of_states_that_cannot_be_is_refused_at_once(program, coarse, tmp_path):
    (tmp_path / "file").write_text("mine")
    for place in ("file", "file/s", "/proc/s"):
        line = refusal(program("run", coarse, "-o", "out", "--state-dir", place))
        assert f"folder of states {place}: is no folder that can be written" in line
        assert not (tmp_path / "out").exists()
