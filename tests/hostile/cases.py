# SPDX-License-Identifier: BSD-3-Clause
"""Cases that take a moment, of every kind of state that a run carries."""

#: That of Kammer et al. (2012).
_PLATE = {
    "plate.width_m": 0.2,
    "plate.height_m": 0.1,
    "plate.corner": "relief",
    "base.kind": "rigid",
    "loading.tilt_left_m": 0.37e-3,
    "loading.tilt_right_m": 0.037e-3,
    "friction.law": "velocity_weakening",
}
# Elements of 5 mm and two snapshots: a tenth of a second.
COARSE = _PLATE | {
    "plate.element_size_m": 5e-3,
    "event.kind": "left",
    "output.snapshot_times_s": [2e-5, 1e-4],
}
# What a folder may hold before.
EARLIER = _PLATE | {"plate.element_size_m": 5e-3, "friction.mu_k": 0.9}

_PRESTRESSED = {
    "base.kind": "rigid",
    "plate.element_size_m": 1e-3,
    "plate.width_m": 0.1,
    "plate.height_m": 0.02,
    "plate.corner": "none",
    "plate.top": "absorbing",
    "loading.method": "prestress",
    "prestress.t_Pa": 2.2e6,
    "prestress.p_Pa": 5e6,
    "friction.law": "slip_weakening",
    "event.kind": "nucleation",
    "nucleation.x_m": 0.04,
    "nucleation.half_length_m": 0.015,
    "output.snapshot_times_s": [1e-5, 3e-5],
}
_COARSER = _PLATE | {"plate.element_size_m": 4e-3}
_TRIGGERED = _COARSER | {"event.kind": "left", "output.snapshot_times_s": [1e-5, 5e-5, 1e-4]}
_FINER = _TRIGGERED | {"plate.element_size_m": 2.5e-3}
_GRADED = _FINER | {"plate.fine_height_m": 0.02, "plate.corner": "none"}

#: By name: settings, with elements so coarse that a run takes a moment.
KINDS = {
    "triggered": _TRIGGERED,
    "spontaneous": _COARSER | {"event.kind": "spontaneous", "friction.mu_k": 1.0},
    "fillet": _FINER | {"plate.corner": "fillet", "plate.fillet_radius_m": 0.01},
    "graded": _GRADED | {"plate.coarsenings": 2},
    "graded_one_step": _GRADED | {"plate.coarsenings": 1, "time.local_steps": False},
    "predictor_corrector": _TRIGGERED | {"contact.algorithm": "predictor_corrector"},
    "single_precision": _TRIGGERED | {"time.precision": "single"},
    "ramp": _PLATE | {"plate.element_size_m": 5e-3, "loading.method": "ramp"},
    "coulomb": _TRIGGERED | {"friction.law": "coulomb", "friction.mu": 1.0},
    "delayed_strength": _TRIGGERED
    | {"friction.regularisation": "strength", "friction.relaxation_time_s": 2e-6},
    "prestressed_periodic": _PRESTRESSED | {"plate.sides": "periodic"},
    "prestressed_absorbing": _PRESTRESSED
    | {"plate.sides": "absorbing", "friction.regularisation": "pressure", "friction.relaxation_time_s": 2e-6},
    "overstressed_healing": _PRESTRESSED
    | {"plate.sides": "periodic", "friction.law": "slip_weakening_healing", "nucleation.form": "overstress"}
    | {"nucleation.overstress_Pa": 1.5e6, "event.trigger_duration_s": 2e-5},
    "plain_steps": _TRIGGERED | {"time.interface_substeps": 1},
}

#: End of the events that are to go on for about a second, s; of the others below.
_LONG_S = {"fillet": 3e-3}
_LONG_S |= dict.fromkeys(("prestressed_periodic", "prestressed_absorbing", "overstressed_healing"), 2e-3)


def long(kind):
    """A case of this kind that goes on for about a second whatever happens, with snapshots to its end."""
    end_s = _LONG_S.get(kind, 0.02)
    return KINDS[kind] | {
        "time.end_s": end_s,
        "time.quiet_s": float("inf"),
        "output.history_interval_s": end_s / 2000,
        "output.energy_interval_s": end_s / 100,
        "output.snapshot_times_s": [end_s * k / 10 for k in range(10)],
    }
