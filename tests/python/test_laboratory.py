# SPDX-License-Identifier: BSD-3-Clause
"""The chain of docs/recorder-to-gamma.md: volts of a synthetic recorder to events, onsets, speed and Gamma;
measured stick-slips beside a sequence."""

from __future__ import annotations

import os
import subprocess
import sys

import pytest
import slipfront
from common import ROOT, rows_of
from package_cases import program
from slipfront.__main__ import main
from slipfront.onsets import read_onsets

LAB = ROOT / "examples/laboratory"
MATERIAL = ["--youngs-modulus-pa", "5.65e9", "--poissons-ratio", "0.33", "--density-kg-per-m3", "1180"]


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    """With the run and its records.nc."""
    made = tmp_path_factory.mktemp("laboratory")
    assert program("run", LAB / "rosettes.toml", "-q", "-o", "out", cwd=made).returncode == 0
    here = os.environ | {"PYTHONPATH": str(ROOT / "python")}
    subprocess.run([sys.executable, LAB / "recorder.py", "out", "daq.h5"], cwd=made, env=here, check=True)
    window = ["--trigger", "trig", "--before-s", "1e-3", "--after-s", "90e-6", "--zero-s=-1e-3,-200e-6"]
    channels = ["--channels", str(LAB / "channels.csv")]
    assert main(["records", str(made / "daq.h5"), *channels, *window, "-o", str(made / "records.nc")]) == 0
    return made


def test_the_recorder_gives_the_strains_of_the_run(folder):
    (event,) = slipfront.read_records(folder / "records.nc")
    assert event.time_s == pytest.approx(0.3501, abs=1e-6)
    assert all(
        of.noise == pytest.approx(1e-6, rel=0.15) for of in event.channels.values() if of.kind == "strain"
    )
    found = slipfront.compare_traces(event.gauges(), slipfront.open(folder / "out"), within_s=2e-4)
    assert float(found.shift_s) == pytest.approx(100e-6, abs=0.5e-6)
    # What the noise of 1 ue, and digits of 0.9 ue, leave of strains of 10 to 30 ue.
    assert 0.04 < float(found.misfit_of_all) < 0.08


def test_onsets_make_the_speed_of_the_front(folder):
    picks, fronts = folder / "picks.csv", folder / "fronts.csv"
    assert main(["picks", str(folder / "records.nc"), "-o", str(picks)]) == 0
    assert main(["fronts", str(picks), "-o", str(fronts), *MATERIAL]) == 0
    row = rows_of(fronts)[0]
    # By the run 780 m/s at the first gauge and 1050 m/s at the last.
    assert 780 < float(row["speed_m_per_s"]) < 1100
    found = slipfront.compare_onsets(slipfront.open(folder / "out"), read_onsets(picks, event=1))
    assert float(found.misfit_of_all) < 1.5e-6
    assert abs(float(found.time_ratio) - 1) < 3 * float(found.time_ratio_error)


def test_gamma_of_all_gauges_is_that_of_the_case(folder):
    table = folder / "fits.csv"
    given = [str(folder / "records.nc"), "--zone", "slip", *MATERIAL]
    assert main(["gauges", *given, "-o", str(table)]) == 0
    together = [row for row in rows_of(table) if row["together"] == "4"]
    known = slipfront.open(folder / "out").fracture
    for row in together:
        assert float(row["Gamma_J_per_m2"]) == pytest.approx(1.1, rel=0.1)  # (mu_s - mu_k) p d_c/2
        at = int(abs(known.x_m.to_numpy() - float(row["x_m"])).argmin())
        assert float(row["cohesive_zone_m"]) == pytest.approx(float(known.cohesive_zone_m[at]), rel=0.25)
    assert len(together) == 4


def test_measured_stick_slips_beside_the_sequence(tmp_path):
    assert program("run", LAB / "machine.toml", "-q", "-o", "machine", cwd=tmp_path).returncode == 0
    table = tmp_path / "misfits.csv"
    given = [str(tmp_path / "machine"), str(LAB / "events.csv")]
    assert main(["compare", *given, "--table", str(table)]) == 0
    (row,) = rows_of(table)
    assert float(row["misfit"]) == pytest.approx(0.031, abs=0.01) and row["unit"] == "1"
