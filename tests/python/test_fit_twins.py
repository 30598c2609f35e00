# SPDX-License-Identifier: BSD-3-Clause
"""Fits to runs of known values with noise, and to other codes' solutions."""

from __future__ import annotations

import numpy as np
import pytest
import slipfront
from common import ROOT, built, loaded_script

for package in ("emcee", "sklearn"):
    pytest.importorskip(package)


@pytest.fixture
def scripts(monkeypatch):
    monkeypatch.setenv("SLIPFRONT_PROGRAM", str(built()))
    monkeypatch.syspath_prepend(str(ROOT / "scripts"))
    return loaded_script


@pytest.mark.slow  # a minute or two
def test_truths_are_within_four_deviations(scripts, tmp_path):
    script = scripts("scripts/fit-twins.py")
    fits = script.fit_twins(2, tmp_path)
    assert len(fits) == 2
    for twin, found in fits:
        for key, truth in twin.truth.items():
            off = script.off_by(found, tmp_path / f"fit_{twin.number:02d}", key, truth)
            assert abs(off) < 4, (twin, key)
            assert script.width(found, key) < 0.5, (twin, key)


def test_records_are_on_clocks_of_their_own_with_the_noise_that_is_told(scripts, tmp_path):
    script = scripts("scripts/fit-twins.py")
    (twin,) = script.twins(1, tmp_path)
    run = slipfront.open(tmp_path / "truth")
    onsets = script.pd.read_csv(twin.records[0])
    late = onsets.time_s - script.onsets_at(run, onsets.x_m.to_numpy())
    assert abs(late.mean()) > 10 * script.ONSET_ERROR_S
    assert late.std() == pytest.approx(script.ONSET_ERROR_S, rel=0.6)
    gauges = script.pd.read_csv(twin.records[1])
    for name, of in gauges.groupby("gauge"):
        (own,) = [gauge for gauge in script.gauges_of(run) if gauge.name == str(name)]
        for part, values in own.values.items():
            clean = np.interp(of.time_s - of.time_s.iloc[0] + own.time_s[0], own.time_s, values)
            noise = of[f"strain_{part}"] - clean
            assert noise.std() == pytest.approx(script.NOISE * np.ptp(values), rel=0.2)


def test_records_of_other_codes_hold_what_these_computed(scripts, tmp_path):
    script = scripts("scripts/fit-references.py")
    problem = script.PROBLEMS[0]
    script.write_onsets(problem, tmp_path / "onsets.csv")
    script.write_slip(problem, tmp_path / "slip.nc")
    onsets = script.pd.read_csv(tmp_path / "onsets.csv")
    assert len(onsets) == 18
    x_m = onsets.x_m - problem.centre_m
    assert set(np.round(1e3 * np.abs(x_m))) == {60, 70, 80, 90, 100, 110, 120, 130, 140}
    assert np.all(np.diff(onsets.time_s[x_m > 0]) > 0)
    slip = slipfront.read_records(tmp_path / "slip.nc")
    (event,) = slip
    assert sorted(event.channels) == ["slip_+100", "slip_+60", "slip_-100", "slip_-60"]
    # Slip begins when the front comes.
    for name, channel in event.channels.items():
        begin_s = channel.time_s[np.argmax(channel.values > 1e-8)]
        (arrival_s,) = onsets.time_s[np.isclose(onsets.x_m, channel.x_m)]
        assert begin_s == pytest.approx(arrival_s, abs=2e-6), name
