# SPDX-License-Identifier: BSD-3-Clause
"""Fits of a case's keys to records: what they find, what they say is not determined, and what they refuse."""

from __future__ import annotations

import argparse
import json
from dataclasses import replace

import numpy as np
import pandas as pd
import pytest
import slipfront
from common import built
from package_cases import PLATE, TILT, blocks, results_of, write_case
from scipy.integrate import quad
from scipy.special import gammainc
from slipfront.compare.misfit import Observed
from slipfront.compare.onsets import onsets_at
from slipfront.files import read_toml
from slipfront.fit.combinations import combinations, findings
from slipfront.fit.command import events, main, parse, restarted
from slipfront.fit.emulator import Emulator
from slipfront.fit.likelihood import alike_of, log_gammainc, part_of
from slipfront.fit.mesh import Finer
from slipfront.fit.outcome import mesh_doubts
from slipfront.fit.posterior import marginals, sampled
from slipfront.fit.space import space_of, spread_out
from slipfront.sweep.definition import flattened

# Coarse, of a few hundredths of a second.
CASE = blocks(2.5e-3, 0.2e-6, d_c_m=4e-6, half_length_m=0.025, end_s=180e-6)
FREE = {"friction.mu_k": "0.2:0.35", "friction.d_c_m": "2e-6:8e-6:log"}
TRUTH = {"friction.mu_k": 0.3, "friction.d_c_m": 4e-6}
PLACES_M = np.linspace(0.07, 0.14, 12)
ERROR_S = 0.5e-6


# The likelihood


def observed(measured, error, **how) -> Observed:
    n = len(measured)
    return Observed("part", "s", [str(k) for k in range(n)], np.asarray(measured, dtype=float),
                    np.full(n, error), np.zeros(n), **how)  # fmt: skip


def part(measured, error=np.nan, **how):
    return part_of(observed(measured, error, **how), "part", (0, 0), np.full(len(measured), True))


def test_gamma_function_where_it_underflows():
    x = np.array([1e-3, 1.0, 5.0, 50.0, 300.0])
    for a in (0.5, 3.0, 60.0):
        exact = gammainc(a, x)
        known = exact > 1e-280
        np.testing.assert_allclose(log_gammainc(a, x)[known], np.log(exact[known]), rtol=1e-10, atol=1e-12)
    far = log_gammainc(400.0, np.array([1.0, 2.0, 4.0]))  # below 1e-800
    assert np.isfinite(far).all() and np.diff(far) == pytest.approx(400 * np.log(2), abs=4)


def test_discrepancy_is_integrated():
    """Over s from 1 on, with the prior ds/s: s^-n exp(-S/(2 s^2))."""
    of = part(np.zeros(6), 2.0)
    squares = np.array([0.5, 4.0, 9.0, 80.0])
    found = of.log_likelihood(squares, 1.0)
    exact = [np.log(quad(lambda s, S=S: s ** -(of.n + 1) * np.exp(-S / (2 * s**2)), 1, np.inf)[0])
             for S in squares]  # fmt: skip
    np.testing.assert_allclose(found - found[0], np.array(exact) - exact[0], rtol=1e-6)
    # Within its errors a part is as Gaussian; far beyond them an outlier counts by its logarithm alone.
    near, far = of.log_likelihood(np.array([[1.0, 1.2], [1e4, 2e4]]), 1.0)
    assert near[0] - near[1] == pytest.approx(0.1, rel=0.5)
    assert far[0] - far[1] == pytest.approx(3 * np.log(2), rel=1e-6)


def test_unknown_constant_and_gain_do_not_count():
    rng = np.random.default_rng(1)
    measured = rng.normal(size=20)
    run = measured + 0.1 * rng.normal(size=20)
    for offset, gain in ((True, False), (True, True)):
        of = part(measured, 1.0, has_offset=offset, has_gain=gain)

        def squares(of=of, of_run=run, factor=1.0, constant=0.0):
            record = of.reduced(of.measured)
            return (of.left(record, of.reduced(factor * of_run + constant)) ** 2).sum()

        assert squares(constant=7.0) == pytest.approx(squares(), rel=1e-9)
        assert (abs(squares(factor=3.0) - squares()) < 1e-9) == gain
        assert of.freedom == 20 - offset - gain


def test_residuals_of_neighbours_that_are_alike_count_as_fewer():
    rng = np.random.default_rng(2)
    white = rng.normal(size=400)
    smooth = np.convolve(white, np.ones(10) / 10, mode="same")
    of = part(np.zeros(400), 1.0)
    assert alike_of(of, white) < 1.5 and 6 < alike_of(of, smooth) < 20
    assert alike_of(replace(of, is_series=False), smooth) == 1
    assert replace(of, alike=4.0).freedom == of.freedom / 4


# Points, emulator, samples


def test_shares_are_those_of_the_ranges():
    space = space_of(FREE)
    assert space.keys == list(FREE)
    np.testing.assert_allclose(space.values(np.array([0.5, 0.5])), [0.275, 4e-6])
    some = np.random.default_rng(0).random((7, 2))
    np.testing.assert_allclose(space.shares(space.values(some)), some, atol=1e-12)
    first = space.sobol(32)
    assert space_of({"friction.mu_k": "0.35:0.2"}).ranges["friction.mu_k"] == space.ranges["friction.mu_k"]
    assert np.array_equal(first[:16], space.sobol(16)) and len(np.unique(first, axis=0)) == 32


def test_runs_are_spread_over_what_is_not_known():
    line = np.column_stack([np.linspace(0, 1, 101), np.zeros(101)])
    found = spread_out(line, np.zeros((1, 2)), 2)
    assert sorted(found[:, 0]) == [0.5, 1.0]
    assert len(spread_out(line[:3], line[:3], 2)) == 0


def model(shares):
    """Two parts of values of two keys, smooth."""
    x, y = shares[..., 0, None], shares[..., 1, None]
    t = np.linspace(0, 1, 15)
    return np.exp(-x * t) + y * t**2, np.sin(3 * x + t) * (1 + y)


def test_emulator_between_runs():
    truth, rng = np.array([0.4, 0.6]), np.random.default_rng(3)
    noise = 0.01
    parts = [part(of + noise * rng.normal(size=15), noise) for of in model(truth)]
    shares = space_of(FREE).sobol(64)
    lost = np.array([[0.95, 0.95]])
    kept = shares[np.hypot(*(shares - lost[0]).T) > 0.1]
    made = Emulator(parts, kept, model(kept), lost, margin=0.1)
    some = truth + 0.006 * rng.normal(size=(40, 2))
    exact = np.zeros(40)
    for of, rows in zip(parts, model(some), strict=True):
        left = of.left(of.reduced(of.measured), of.reduced(rows))
        exact += of.log_likelihood((left**2).sum(axis=1), 1.0)
    near = exact > exact.max() - 10
    assert near.sum() > 5
    np.testing.assert_allclose(made.log_likelihood(some)[near], exact[near], atol=0.2)
    # Nothing is known where the nearest point has no run, nor beyond the box.
    assert made.log_likelihood(np.array([[0.96, 0.96], [0.5, 2.0]])).tolist() == [-np.inf, -np.inf]


def test_samples_of_a_known_posterior():
    centre, sigma = np.array([0.5, 0.3]), np.array([0.1, 0.02])

    def log_likelihood(shares):
        return -0.5 * (((shares - centre) / sigma) ** 2).sum(axis=1)

    rng = np.random.default_rng(4)
    start = centre + sigma * rng.normal(size=(10, 2))
    samples, n = sampled(log_likelihood, start, 1000, rng)
    assert n > 300
    np.testing.assert_allclose(samples.mean(axis=0), centre, atol=5 * sigma.max() / np.sqrt(n))
    np.testing.assert_allclose(samples.std(axis=0), sigma, rtol=0.15)
    # Uniform on the range where records tell nothing.
    flat, _ = sampled(lambda s: np.zeros(len(s)), start, 1000, rng)
    assert flat.min() >= 0 and flat.max() <= 1
    np.testing.assert_allclose(np.quantile(flat[:, 0], [0.1, 0.5, 0.9]), [0.1, 0.5, 0.9], atol=0.06)


def test_what_is_not_determined_is_named():
    """Of mu_k and d_c only the fracture energy."""
    space = space_of(
        {"friction.mu_k": "0.1:0.4", "friction.d_c_m": "1e-6:1e-4:log", "friction.mu_s": "0.5:0.7"}
    )
    rng = np.random.default_rng(5)
    mu_k = 0.3 + 0.005 * rng.normal(size=4000)
    d_c_m = 8e-6 * (0.6 - 0.3) / (0.6 - mu_k) * (1 + 1e-4 * rng.normal(size=4000))
    samples = space.shares(np.column_stack([mu_k, d_c_m, rng.uniform(0.5, 0.7, 4000)]))
    case = {"friction.law": "slip_weakening", "prestress.p_Pa": 5e6, "friction.mu_s": 0.6}
    keys = marginals(space, samples)
    assert [of.is_determined for of in keys] == [True, True, False]
    told = findings(space, samples, keys, combinations(case, space, samples))
    assert told[0] == (
        "friction.mu_s is not determined: its interval of 90 % is most of the range that it was given"
    )
    assert told[1].startswith("friction.mu_k and friction.d_c_m trade off (correlation 1.00): where")
    two = space_of({"friction.mu_k": "0.1:0.4", "friction.d_c_m": "1e-6:1e-4:log"})
    keys = marginals(two, samples[:, :2])
    told = findings(two, samples[:, :2], keys, combinations(case, two, samples[:, :2]))
    energy = [line for line in told if "fracture energy (mu_s - mu_k) p d_c/2 = 6" in line]
    assert len(energy) == 1 and energy[0].endswith("J/m2")


def test_events_of_a_command_line():
    assert events("3,5-7") == (3, 5, 6, 7)
    wrong = {"3-": "is not N,M-K", "1-2000000000": "of seven digits at most", "5-3": "ranges rise",
             "0-3": "from 1", "2,1-3": "names an event twice"}  # fmt: skip
    for text, told in wrong.items():
        with pytest.raises(argparse.ArgumentTypeError, match=told):
            events(text)


# The command


@pytest.fixture(scope="module")
def place(tmp_path_factory):
    """A folder with a case, and onsets of the truth on a clock of their own."""
    folder = tmp_path_factory.mktemp("fit")
    write_case(folder, CASE)
    run = slipfront.run(CASE, output=folder / "truth")
    noise_s = ERROR_S * np.random.default_rng(6).normal(size=len(PLACES_M))
    onsets = {"x_m": PLACES_M, "time_s": onsets_at(run, PLACES_M) + 30e-6 + noise_s, "error_s": ERROR_S}
    assert np.isfinite(onsets["time_s"]).all()
    pd.DataFrame(onsets).to_csv(folder / "onsets.csv", index=False)
    return folder


def free(of=FREE) -> list[str]:
    return [part for key, text in of.items() for part in ("--free", f"{key}={text}")]


def called(monkeypatch, place, *arguments) -> int:
    monkeypatch.setenv("SLIPFRONT_PROGRAM", str(built()))
    monkeypatch.chdir(place)
    return main([str(argument) for argument in arguments])


@pytest.fixture(scope="module")
def fitted(place):
    """A fit of both keys, its result, and what was printed."""
    with pytest.MonkeyPatch.context() as patch:
        assert called(patch, place, "case.toml", "onsets.csv", *free(), "-o", "out", "-q") == 0
    return place / "out", json.loads((place / "out/fit.json").read_text())


def test_fit_finds_the_truth(fitted):
    folder, found = fitted
    samples = pd.read_csv(folder / "posterior.csv")
    assert list(samples) == list(FREE)
    for key, truth in TRUTH.items():
        of = found["parameters"][key]
        low, high = of["interval_90"]
        assert low < of["median"] < high
        assert abs(samples[key].mean() - truth) < 4 * samples[key].std()
    assert not any("do not agree" in note for note in found["notes"])
    ((name, quality),) = found["parts"].items()
    assert name == "onsets.csv, onsets" and quality["values"] == 12
    assert quality["rms_left"] < 2 * ERROR_S and quality["probability_of_chi2"] > 1e-3


def test_files_of_a_fit(fitted, place):
    folder, found = fitted
    assert (folder / "corner.png").read_bytes().startswith(b"\x89PNG")
    page = (folder / "fit.html").read_text()
    assert page.startswith("<!DOCTYPE html><!-- slipfront fit -->") and "friction.d_c_m" in page
    best = flattened(read_toml(folder / "best.toml"))
    assert {key: best[key] for key in FREE} == pytest.approx(found["best"]["values"])
    assert (folder / found["best"]["folder"] / "run.json").is_file()


def test_same_command_runs_nothing_again(fitted, place, monkeypatch):
    folder, found = fitted
    points = sorted((folder / "runs/points").iterdir())
    before = [file.stat().st_mtime_ns for file in points]
    for arguments in (["--restart", "out"], ["./case.toml", place / "onsets.csv", *free(), "-o", "out"]):
        (folder / "fit.json").unlink()
        assert called(monkeypatch, place, *arguments, "-q") == 0
        assert json.loads((folder / "fit.json").read_text()) == found
        assert [file.stat().st_mtime_ns for file in points] == before


def test_a_folder_is_of_one_fit(fitted, place, monkeypatch, capsys):
    folder, _ = fitted
    before = {file: file.read_bytes() for file in folder.iterdir() if file.is_file()}
    other = [*free(FREE | {"friction.mu_k": "0.25:0.35"}), "--clock", "run"]
    assert called(monkeypatch, place, "case.toml", "onsets.csv", *other, "-o", "out") == 2
    assert "holds a fit with another --free and --clock" in capsys.readouterr().err
    assert before == {file: file.read_bytes() for file in folder.iterdir() if file.is_file()}


def test_places_that_hold_no_folder(place, tmp_path, monkeypatch, capsys):
    (tmp_path / "letter").write_text("kept")
    (tmp_path / "link").symlink_to(tmp_path / "nowhere")
    for where in ("letter", "letter/below", "link", "/dev/full", "/proc/nothing"):
        arguments = ["case.toml", "onsets.csv", *free(), "-o", tmp_path / where]
        assert called(monkeypatch, place, *arguments) == 2
        (line,) = capsys.readouterr().err.splitlines()
        assert str(tmp_path / where) in line
    assert (tmp_path / "letter").read_text() == "kept" and not (tmp_path / "nowhere").exists()


def test_no_more_runs_than_allowed(place, tmp_path, monkeypatch):
    """Nor are they beyond the ranges, whose lower end is the most probable mu_k."""
    narrow = FREE | {"friction.mu_k": "0.302:0.35"}
    arguments = ["case.toml", "onsets.csv", *free(narrow), "-o", tmp_path / "fit", "-q"]
    found = {}
    for most in (38, 120):
        assert called(monkeypatch, place, *arguments, "--most", most) == 0
        found = json.loads((tmp_path / "fit/fit.json").read_text())
        assert found["runs"]["all"] <= most
        if most == 38:  # no round tells whether runs are as expected
            assert found["finer_mesh"] is None
            assert found["notes"][0].startswith("what the mesh moves is not known: runs and what was")
    assert found["finer_mesh"] is not None
    for point in (tmp_path / "fit/runs/points").iterdir():
        case = flattened(read_toml(point / "case.resolved.toml"))
        assert 0.302 <= case["friction.mu_k"] <= 0.35 and 2e-6 <= case["friction.d_c_m"] <= 8e-6
    cut = "the lower end of its range cuts the posterior of friction.mu_k: widen the range"
    assert cut in found["notes"]


def test_a_script_for_slurm_replaces_its_like_alone(place, tmp_path, monkeypatch, capsys):
    arguments = ["case.toml", "onsets.csv", *free(), "-o", tmp_path / "fit", "--slurm"]
    before = (place / "case.toml").read_text()
    assert called(monkeypatch, place, *arguments, "case.toml") == 2
    assert "not a script of slipfront for Slurm: not replaced" in capsys.readouterr().err
    assert (place / "case.toml").read_text() == before and not (tmp_path / "fit").exists()
    for _ in range(2):
        assert called(monkeypatch, place, *arguments, tmp_path / "jobs") == 0
    script = (tmp_path / "jobs").read_text()
    assert script.startswith("#!/bin/bash\n") and f"fit --restart {tmp_path / 'fit'}" in script
    assert '--share "$SLURM_ARRAY_TASK_ID/32"' in script
    # The fit goes on from there, without a script.
    given = restarted(parse(["--restart", str(tmp_path / "fit")]))
    assert given.slurm is None and given.records == [place / "onsets.csv"]


def test_a_wrong_case_is_told(place, monkeypatch):
    """A weakening length a quarter of the record's, at which fronts are faster whatever mu_k is."""
    arguments = ("--free", "friction.mu_k=0.2:0.35", "--set", "friction.d_c_m=1e-6", "--most", 40)
    assert called(monkeypatch, place, "case.toml", "onsets.csv", *arguments, "-o", "wrong", "-q") == 0
    found = json.loads((place / "wrong/fit.json").read_text())
    assert any(line.startswith("the model does not explain onsets.csv") for line in found["findings"])


def test_what_a_finer_mesh_would_change(place, monkeypatch, tmp_path):
    """Fitted with elements twice as large: what is expected of the finer mesh is nearer to the truth."""
    key, truth = "friction.d_c_m", TRUTH["friction.d_c_m"]
    run = slipfront.open(place / "truth")
    onsets = {"x_m": PLACES_M, "time_s": onsets_at(run, PLACES_M), "error_s": 0.2 * ERROR_S}
    pd.DataFrame(onsets).to_csv(tmp_path / "onsets.csv", index=False)
    arguments = [*free({key: FREE[key]}), "--set", "plate.element_size_m=5e-3", "-o", tmp_path / "fit", "-q"]
    assert called(monkeypatch, place, "case.toml", tmp_path / "onsets.csv", *arguments) == 0
    found = json.loads((tmp_path / "fit/fit.json").read_text())
    assert found["finer_mesh"]["element_size_m"] == 2.5e-3
    off = abs(found["parameters"][key]["median"] / truth - 1)
    assert off > 0.02
    assert abs(found["finer_mesh"][key]["median"] / truth - 1) < 0.5 * off


def test_a_mesh_that_moves_keys_is_told():
    space = space_of(FREE)
    samples = np.random.default_rng(3).normal(0.5, 0.05, (4000, 2))
    samples += 0.5 - np.median(samples, axis=0)
    moved = samples + np.array([-0.1, 0.01])
    (note,) = mesh_doubts(space, samples, Finer(1e-3, moved))
    assert (
        note == "plate.element_size_m = 0.001 would move friction.mu_k to 0.26, by 2 of its standard "
        "deviations: fit again with it"
    )
    assert mesh_doubts(space, samples, Finer(1e-3, samples + 0.02)) == []
    assert mesh_doubts(space, samples, "out of memory") == ["what the mesh moves is not known: out of memory"]


REFUSED = {
    "is both free and set": [*free(), "--set", "friction.mu_k=0.3"],
    "a sample takes ranges": ["--free", "friction.mu_k=0.2"],
    "the ends of the range are equal": ["--free", "friction.mu_k=0.2:0.2"],
    "unknown key": ["--free", "friction.mu_kk=0.2:0.3"],
    "--predict-events needs --fit-events": [*free(), "--predict-events", "2"],
    "no record has an event 3": [*free(), "--fit-events", "3"],
    "--thickness-m counts with": [*free(), "--thickness-m", "0.1"],
    "is a whole number from 1 on": [*free(), "--most", "0"],
    "--most is 20 runs: fewer than --first, 32, and 6 of the last check": [*free(), "--most", "20"],
    "--most is 99999999999 runs; 1000000 at most": [*free(), "--most", "99999999999"],
    "friction.mu_k=-1e308:1e308: the range is too wide": ["--free", "friction.mu_k=-1e308:1e308"],
    "friction.mu_k=1e-300:1e300:log: the range is too wide": ["--free", "friction.mu_k=1e-300:1e300:log"],
    "--gain counts with traces alone": [*free(), "--gain", "free"],
    "--free KEY=FROM:TO: not given": [],
}  # fmt: skip


@pytest.mark.parametrize("told", REFUSED)
def test_what_is_refused(place, tmp_path, monkeypatch, capsys, told):
    arguments = ["case.toml", "onsets.csv", *REFUSED[told], "-o", tmp_path / "new"]
    assert called(monkeypatch, place, *arguments) == 2
    (line,) = capsys.readouterr().err.splitlines()
    assert line.startswith("slipfront fit: error: ") and told in line
    assert not (tmp_path / "new").exists()


def test_a_table_of_events_beside_one_event(place, tmp_path, monkeypatch, capsys):
    table = tmp_path / "events.csv"
    pd.DataFrame({"begin_s": [1.0, 2.0, 3.0], "slip_m": 1e-6}).to_csv(table, index=False)
    assert called(monkeypatch, place, "case.toml", table, *free(), "-o", tmp_path / "new") == 2
    told = "events.csv: is compared with a sequence of events, and case.toml has one event"
    assert told in capsys.readouterr().err and not (tmp_path / "new").exists()


def test_a_record_under_two_names_is_refused(place, tmp_path, monkeypatch, capsys):
    copy = tmp_path / "again.csv"
    copy.write_bytes((place / "onsets.csv").read_bytes())
    assert called(monkeypatch, place, "case.toml", "onsets.csv", copy, *free(), "-o", tmp_path / "new") == 2
    assert f"{copy}: holds what onsets.csv holds; leave it out" in capsys.readouterr().err


def test_folders_that_are_refused(place, tmp_path, monkeypatch, capsys):
    (tmp_path / "letter").write_text("kept")
    assert called(monkeypatch, place, "case.toml", "onsets.csv", *free(), "-o", tmp_path) == 2
    assert "holds something, and no fit" in capsys.readouterr().err
    assert called(monkeypatch, place, "--restart", tmp_path) == 2
    assert "holds no fit" in capsys.readouterr().err
    assert called(monkeypatch, place, "--restart", tmp_path, *free()) == 2
    assert "leave out --free" in capsys.readouterr().err


def test_events_are_fitted_and_others_predicted(tmp_path, monkeypatch, capsys):
    """Precursors of the paper's plate, whose intervals and slip tell mu_k."""
    case = f"""{PLATE}{TILT}plate.element_size_m = 5e-3
friction.mu_k = 0.9
event.kind = "spontaneous"
sequence.max_events = 8
"""
    write_case(tmp_path, case)
    (tmp_path / "truth").mkdir()
    truth = slipfront.open(results_of(tmp_path / "truth", case))
    events, rng = truth.events, np.random.default_rng(7)
    begin_s = events.begin_s.to_numpy()
    slip_m = np.tile(events.mean_slip_m.to_numpy(), 2) * (1 + 0.01 * rng.normal(size=16))
    table = {"begin_s": np.concatenate([begin_s, begin_s + 500]), "slip_m": slip_m}  # twice
    pd.DataFrame(table).to_csv(tmp_path / "events.csv", index=False)
    arguments = ("case.toml", "events.csv", "--free", "friction.mu_k=0.7:1.1", "--skip-events", 1)
    chosen = ("--fit-events", "2-8", "--predict-events", "10-16")
    assert called(monkeypatch, tmp_path, *arguments, *chosen, "-o", "out", "--most", 24) == 0
    printed = capsys.readouterr().out
    assert "predicted: events.csv, events 10-16: misfit" in printed
    found = json.loads((tmp_path / "out/fit.json").read_text())
    assert found["predicted"] == ["events.csv, events 10-16"]
    low, high = found["parameters"]["friction.mu_k"]["interval_90"]
    assert low - (high - low) < 0.9 < high + (high - low)
    assert list(found["parts"]) == ["events.csv, events 2-8, events"]


def test_ends_of_runs_are_data(place, monkeypatch, tmp_path):
    """Points that the program refuses, mu_k above mu_s, and ruptures that stop."""
    wide = FREE | {"friction.mu_k": "0.2:0.6"}
    arguments = ("case.toml", "onsets.csv", *free(wide), "-o", tmp_path / "wide", "-q", "--most", 80)
    assert called(monkeypatch, place, *arguments) == 0
    found = json.loads((tmp_path / "wide/fit.json").read_text())
    assert found["runs"]["left_out"] > 0
    assert any("runs are left out; the first, at friction.mu_k = " in line for line in found["findings"])
    low, high = found["parameters"]["friction.mu_k"]["interval_90"]
    assert 0.2 < low < 0.3 < 0.36 and high < 0.4
