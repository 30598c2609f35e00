# SPDX-License-Identifier: BSD-3-Clause
"""Random legal cases: their energies balance, and their files do not depend on the number of threads."""

import json
import random

from common import rows_of

from .cases import KINDS
from .trials import Trial, Wrong, alone, remove, require, require_same

#: Largest imbalance over the largest term. Every sub-step adds products that are rounded to 1.1e-16 of
#: themselves; N of them leave at most N times that, and here N stays below 1e5.
BOUND = 1e-11
#: Where rows of the plate are single numbers: 6e-8, and below 1e4 steps.
SINGLE_BOUND = 6e-4


def draw(dice):
    """A case that may be legal."""
    settings = {}

    def put(key, value):
        settings[key] = value

    def choose(key, *values):
        put(key, dice.choice(values))
        return settings[key]

    size = choose("plate.element_size_m", 5e-3, 4e-3, 2.5e-3)
    method = dice.choices(("direct", "prestress", "ramp"), (5, 6, 1))[0]
    put("loading.method", method)
    if method == "prestress":
        put("plate.width_m", 40 * size)
        put("plate.height_m", size * dice.choice((1, 2, 8, 12)))
        choose("plate.sides", "free", "periodic", "absorbing")
        choose("plate.top", "loaded", "free", "absorbing")
        put("prestress.p_Pa", 5e6)
        put("prestress.t_Pa", dice.uniform(-2.9e6, 2.9e6))
        put("loading.shear_speed_m_per_s", dice.choice((0.0, 1.6e-3, 0.16)))
        kind = choose("event.kind", "none", "nucleation", "nucleation", "left", "right")
    else:
        choose("loading.top_during_tilt", "held", "free")
        if method == "ramp":
            put("plate.element_size_m", 5e-3)
        else:
            choose("plate.sides", "free", "free", "absorbing")
        kind = choose("event.kind", "none", "spontaneous", "left", "right", "nucleation")
    corner = choose("plate.corner", "none", "none", "relief", "fillet")
    if corner == "fillet":
        put("plate.fillet_radius_m", dice.uniform(5e-3, 2e-2))
    if dice.random() < 0.4:
        put("plate.coarsenings", dice.randint(1, 2))
        put("plate.fine_height_m", size * dice.choice((2, 4, 8)))
    choose("material.plane", "stress", "strain")
    choose("material.stiffness_damping_s", 0.0, 1e-8, 1e-7, 1e-6)

    law = choose("friction.law", "velocity_weakening", "coulomb", "slip_weakening", "slip_weakening_healing")
    mu_s = dice.uniform(0.7, 1.3) if method != "prestress" else dice.uniform(0.6, 1.0)
    if law == "coulomb":
        put("friction.mu", mu_s)
    else:
        put("friction.mu_s", mu_s)
        put("friction.mu_k", mu_s * dice.uniform(0.3, 1))
        if law == "velocity_weakening":
            put("friction.alpha_m2_per_s2", 10 ** dice.uniform(-3, 1))
        else:
            put("friction.d_c_m", 10 ** dice.uniform(-6.5, -4.5))
    if choose("friction.regularisation", "none", "none", "strength", "pressure") != "none":
        put("friction.relaxation_time_s", 10 ** dice.uniform(-7, -5))
    choose("contact.algorithm", "direct", "direct", "predictor_corrector")
    if kind == "nucleation":
        choose("nucleation.form", "weakened", "overstress")
        put("nucleation.x_m", dice.uniform(0, 0.2))
        put("nucleation.half_length_m", dice.uniform(5e-3, 2e-2))
        put("nucleation.overstress_Pa", dice.uniform(-4e6, 4e6))
    if kind in ("left", "right"):
        put("event.trigger_over_missing", dice.uniform(0.5, 6))
    if kind not in ("none", "spontaneous") and dice.random() < 0.3:
        put("event.trigger_duration_s", dice.uniform(5e-6, 5e-5))
    put("time.step_factor", dice.uniform(0.3, 0.95))
    put("time.interface_rows", dice.randint(1, 5))
    put("time.interface_substeps", dice.choice((1, 2, 5, 18)))
    choose("time.local_steps", True, True, False)
    if dice.random() < 0.15:
        put("time.precision", "single")
    put("time.end_s", dice.uniform(1e-4, 3e-4))
    put("output.energy_interval_s", 1e-5)
    if dice.random() < 0.2:
        put("output.snapshot_times_s", [5e-5])
    return settings


def draw_legal(bench, dice):
    """@return the settings and the case file, of the first draw that is valid"""
    for _ in range(100):
        settings = draw(dice)
        case = bench.case(settings)
        if bench.run("validate", case).returncode == 0:
            return settings, case
    raise Wrong("no legal case among 100")


def rest_J_per_m(settings):
    """Energy of a plate in which nothing moves: its tractions p, each rounded to 1.1e-16 of itself, leave so
    much of the p^2 / E per area that they would store."""
    youngs_modulus_Pa = 2.6e9  # the default
    width_m, height_m = settings.get("plate.width_m", 0), settings.get("plate.height_m", 0)
    return 1.1e-16**2 * settings.get("prestress.p_Pa", 0) ** 2 / youngs_modulus_Pa * width_m * height_m


def relative_imbalance(folder, settings):
    rows = rows_of(folder / "energy.csv")
    names = [name for name in rows[0] if name.endswith("_J_per_m") and name != "imbalance_J_per_m"]
    largest = max(abs(float(row[name])) for row in rows for name in names)
    imbalance = max(abs(float(row["imbalance_J_per_m"])) for row in rows)
    return imbalance / largest if imbalance > rest_J_per_m(settings) else 0.0


def balance(bench, seed):
    """Draws until a case has an event: not all that is legal has an equilibrium to begin from."""
    dice = random.Random(seed)
    for _ in range(20):
        settings, case = draw_legal(bench, dice)
        folder = bench.folder()
        process = bench.run("run", case, "-o", folder, "-q")
        if process.returncode != 2:
            break
    require(process.returncode == 0, f"{process} of {json.dumps(settings)}")
    bound = SINGLE_BOUND if settings.get("time.precision") == "single" else BOUND
    found = relative_imbalance(folder, settings)
    require(found < bound, f"imbalance {found:.3g} of {json.dumps(settings)}")
    remove(folder.parent)


def same_for_threads(bench, kind):
    case = bench.case(KINDS[kind])
    one, two, three = (alone(bench.result(case, "--threads", n)) for n in (1, 2, 3))
    require_same(two, one, "two threads")
    require_same(three, one, "three threads")


def balance_trials(bench, n, seed=1):
    for k in range(seed, seed + n):
        yield Trial(f"seed {k}", lambda k=k: balance(bench, k))


def thread_trials(bench, kinds=tuple(KINDS)):
    for kind in kinds:
        yield Trial(kind, lambda kind=kind: same_for_threads(bench, kind))
