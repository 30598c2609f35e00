# SPDX-License-Identifier: BSD-3-Clause
"""The file of a laboratory's recorder, SYNTHETIC: a run's probes as the volts of rosettes' bridges.

usage: python recorder.py RUN daq.h5
Arms at -45, 90 and 45 degrees, quarter bridges at 5 V, gauge factor 2.1, gain 1000, amplifiers of 500 kHz,
12 bits over 10 V at 2 MHz, 1 ue of noise; the event is at 0.35 s of the recorder's clock, its trigger 100 us
later."""

import sys

import h5py
import numpy as np
import slipfront

RATE_HZ, EVENT_S, NOISE, BANDWIDTH_HZ = 2e6, 0.35, 1e-6, 500e3
VOLTS_PER_STRAIN = 2.1 * 5 * 1000 / 4
DIGIT_V = 10 / 2**12

gauges = slipfront.gauges_of(slipfront.open(sys.argv[1]))
time_s = np.arange(EVENT_S - 2e-3, EVENT_S + gauges[0].time_s[-1], 1 / RATE_HZ)
rng = np.random.default_rng(1)
with h5py.File(sys.argv[2], "w") as file:
    file["daq/t"] = time_s
    file["daq/t"].attrs["units"] = "s"
    for gauge in gauges:
        xx, yy, xy = (gauge.values[part] for part in ("xx", "yy", "xy"))
        for arm, strain in (("-45", (xx + yy) / 2 - xy), ("90", yy), ("45", (xx + yy) / 2 + xy)):
            kept = np.exp(-2 * np.pi * BANDWIDTH_HZ * np.diff(gauge.time_s).mean())
            passed = strain.copy()
            for k in range(1, len(passed)):
                passed[k] = kept * passed[k - 1] + (1 - kept) * strain[k]
            recorded = np.interp(time_s - EVENT_S, gauge.time_s, passed) + 200e-6 * rng.standard_normal()
            volts = VOLTS_PER_STRAIN * (recorded + NOISE * rng.standard_normal(len(time_s)))
            file[f"daq/{gauge.name}_{arm}"] = DIGIT_V * np.round(volts / DIGIT_V)
    file["daq/trig"] = np.where(time_s > EVENT_S + 100e-6, 5.0, 0.0)
