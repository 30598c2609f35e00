# SPDX-License-Identifier: BSD-3-Clause
"""What a case asks for is predicted, and refused where it cannot be; legal cases do not blow up."""

import random
import re
import sys

import pytest
from common import PEAK_BYTES, call, one_line, refusal, require_done, settings


def test_a_history_too_large_for_the_disk_is_refused(program, coarse, tmp_path):
    case = settings({"time.end_s": 1e5, "output.energy_interval_s": 1e4})
    message = refusal(program("run", coarse, "-o", "out", "-q", *case))
    assert "GB on disk" in message
    assert "output.history_interval_s" in message
    assert not (tmp_path / "out").exists()


def test_overload_is_not_blamed_on_the_step(program, coarse):
    trigger = settings({"event.kind": "right", "event.trigger_over_missing": 1e6})
    message = one_line(program("run", coarse, "-o", "out", "-q", *trigger), 3)
    assert "the work of the loads accounts for the energy" in message
    assert "event.trigger_over_missing" in message and "step_factor" not in message


PRESSED = {"plate.corner": "none", "loading.method": "prestress", "event.kind": "none"}
# Of 1e10 nodes.
LARGE = {
    "plate.width_m": 141.421,
    "plate.height_m": 70.71,
    "plate.element_size_m": 1e-3,
    "prestress.t_Pa": 4e5,
    "prestress.p_Pa": 1e6,
    "output.snapshot_times_s": [1e-5],
    "time.end_s": 1e-4,
}


@pytest.mark.slow
def test_a_plate_that_no_process_holds_is_foretold(program, coarse):
    case = settings(PRESSED | LARGE)
    info = require_done(program("info", coarse, *case, "--processes", "10")).stdout
    printed = dict(re.findall(r"^ *(.+?) {2,}(.+)$", info, re.MULTILINE))
    n_nodes = 141422 * 70711
    assert printed["nodes"] == f"{n_nodes} (141422 on the interface)"
    assert printed["cells"] == str(141421 * 70710)
    snapshot_gb = float(re.search(r"1 snapshots ([\d.e+]+)", printed["disk"])[1])
    # Places and cells, displacements and velocities, strain and stress.
    assert snapshot_gb == pytest.approx(n_nodes * (24 + 41 + 32 + 56) * 1e-9, rel=0.3)


def random_case(seed):
    """A legal case of a small plate: tractions from nothing to much, all laws, edges and triggers."""
    r = random.Random(seed)

    def power(low, high):
        return 10 ** r.uniform(low, high)

    case = {
        "plate.width_m": 0.04,
        "plate.height_m": 0.02,
        "plate.element_size_m": 2e-3,
        "plate.corner": "none",
    }
    case["loading.method"] = r.choice(["prestress"] * 6 + ["direct"])
    pressed = case["loading.method"] == "prestress"
    sides = "free"
    if pressed:
        p = power(*r.choice([(-6, -3), (-3, 0), (0, 6)]))
        case["prestress.p_Pa"] = p
        case["prestress.t_Pa"] = r.choice([0, r.uniform(-1, 1) * p, r.uniform(0, 0.6) * p])
        case["plate.sides"] = sides = r.choice(["free", "periodic", "absorbing"])
        case["plate.top"] = r.choice(["loaded", "free", "absorbing"])
        case["loading.shear_speed_m_per_s"] = r.choice([0, power(-15, -9), power(-9, -1)])
    else:
        tilt = power(*r.choice([(-12, -4), (-5, -4)]))
        case |= {"loading.tilt_left_m": tilt, "loading.tilt_right_m": tilt * r.uniform(0.3, 1)}
        case |= {"loading.shear_speed_m_per_s": power(-9, -3), "loading.edge_margin_m": 4e-3}
    case["material.plane"] = r.choice(["stress", "strain"])
    case["material.poissons_ratio"] = r.uniform(-0.2, 0.45)
    h_over_c_s = 2e-3 / 1500
    case["material.stiffness_damping_s"] = r.choice([0, 0, 0.3, 1]) * h_over_c_s
    law = r.choice(["velocity_weakening", "coulomb", "slip_weakening", "slip_weakening_healing"])
    case["friction.law"] = law
    mu_s = r.uniform(0.1, 0.6)
    if law == "coulomb":
        case["friction.mu"] = mu_s
    else:
        case |= {"friction.mu_s": mu_s, "friction.mu_k": mu_s * r.uniform(0, 1)}
        case["friction.d_c_m" if "slip" in law else "friction.alpha_m2_per_s2"] = power(-8, -4)
    case["contact.algorithm"] = r.choice(["direct", "predictor_corrector"])
    if r.random() < 0.4:
        case["friction.regularisation"] = r.choice(["strength", "pressure"])
        case["friction.relaxation_time_s"] = power(-1, 2) * h_over_c_s
    kinds = ["none", "nucleation"]
    if sides != "periodic":
        kinds += ["left", "right"]
    if not pressed:
        kinds.append("spontaneous")
    case["event.kind"] = kind = r.choice(kinds)
    if kind in ("left", "right"):
        case |= {
            "event.trigger_zone_m": r.choice([2e-3, 8e-3]),
            "event.trigger_over_missing": r.uniform(0, 5),
        }
        case["event.trigger_ramp_s"] = r.choice([0, 5, 50]) * h_over_c_s
    if kind == "nucleation":
        case["nucleation.form"] = r.choice(["weakened", "overstress"])
        case |= {"nucleation.x_m": 0.02, "nucleation.half_length_m": r.choice([2e-3, 6e-3])}
        if case["nucleation.form"] == "overstress":
            case["nucleation.overstress_Pa"] = case.get("prestress.p_Pa", 1e5) * r.uniform(0, 2)
    case["time.interface_substeps"] = r.choice([1, 4, 18])
    if sides == "free":
        case["time.precision"] = r.choice(["double", "single"])
    case["time.step_factor"] = r.choice([0.9, r.uniform(0.1, 1)])
    end_s = r.choice([100, 1000]) * h_over_c_s
    case |= {"time.end_s": end_s, "time.quiet_s": end_s, "output.history_interval_s": end_s / 10}
    case["output.energy_interval_s"] = end_s / r.choice([7, 50])
    return case


@pytest.mark.slow
def test_random_legal_cases_do_not_blow_up(program, write_case):
    file = write_case('title = "random"\n')
    n_run = 0
    for seed in range(60):
        case = settings(random_case(seed))
        result = program("run", file, *case, "-o", "out", "-q", "--overwrite", "--threads", "1")
        # Some statics have no critical shear.
        assert result.returncode in (0, 2), result
        n_run += result.returncode == 0
    assert n_run > 45


# Of 0.2 to 0.4 GB each: a factorisation, an iteration with a base, motion without statics.
SHORT = {"time.end_s": 2e-7, "output.snapshot_times_s": [0.0]}
SIZED = {
    "direct": {"plate.element_size_m": 4e-4, **SHORT},
    "iterative": {
        "plate.element_size_m": 2.5e-4,
        "loading.solver": "iterative",
        "base.kind": "body",
        "base.height_m": 0.1,
        "base.youngs_modulus_Pa": 2.6e9,
        "base.poissons_ratio": 0.37,
        "base.density_kg_per_m3": 1200.0,
        "base.stiffness_damping_s": 1e-7,
        **SHORT,
    },
    "moving": {
        "plate.element_size_m": 1.25e-4,
        **PRESSED,
        "prestress.t_Pa": 4e6,
        "prestress.p_Pa": 5e6,
        "event.kind": "nucleation",
        "nucleation.x_m": 0.1,
        **SHORT,
    },
}


def test_a_limit_of_the_process_counts(program, coarse):
    """`ulimit -v`, of which the program itself takes some."""
    case = settings(SIZED["direct"])
    printed = refusal(program("run", coarse, "-o", "out", *case, memory_bytes=300_000_000))
    assert "needs about" in printed
    available = re.search(r"(\S+) GB are available", printed)
    assert 0.1 < float(available[1]) < 0.3


@pytest.mark.parametrize("name", ["direct", pytest.param("iterative", marks=pytest.mark.slow), "moving"])
def test_memory_is_foretold(program, coarse, tmp_path, name):
    """Within 30 % of what the process takes."""
    case = settings(SIZED[name])
    printed = program("info", coarse, *case).stdout
    announced = 1e9 * float(re.search(r"^memory +(\S+) GB", printed, re.MULTILINE)[1])
    run = (program.path, "run", coarse, "-o", tmp_path / "out", "-q", *case)
    peak = int(require_done(call(sys.executable, "-c", PEAK_BYTES, *run)).stdout)
    assert peak > 0.15e9, "too small a case to tell"
    assert announced == pytest.approx(peak, rel=0.3)
