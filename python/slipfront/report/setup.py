# SPDX-License-Identifier: BSD-3-Clause
"""What a run was of, in words and engineering units, as pieces of HTML."""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from slipfront.files import is_number
from slipfront.opened import Opened, OpenRun
from slipfront.read import entry
from slipfront.report.page import words
from slipfront.units import name_of, quantity, unit_of, velocity

MU_S, MU_K = "μ<sub>s</sub>", "μ<sub>k</sub>"
WAVES = {"c_L": "c<sub>L</sub>", "c_S": "c<sub>S</sub>", "c_R": "c<sub>R</sub>"}
EDGES = {
    "free": "free of traction",
    "periodic": "periodic",
    "absorbing": "absorbing",
    "held": "held",
    "loaded": "displacement prescribed",
}


def si(run: Opened, table: str, key: str, digits: int = 4) -> str:
    """A number of the case in engineering units."""
    value = run.entry(table, key)
    return quantity(value, unit_of(key), digits) if is_number(value) else "not given"


def is_set(run: Opened, table: str, key: str) -> bool:
    """Whether a number of the case is neither zero nor infinite."""
    value = run.entry(table, key)
    return is_number(value) and value != 0


def has_base(run: Opened) -> bool:
    return run.entry("base", "kind") == "body"


def is_uniform(run: Opened) -> bool:
    """Whether the tractions were prescribed, and equal along the interface."""
    return run.prescribed and not run.entry("prestress", "file")


def edge(run: Opened, table: str, key: str) -> str:
    told = str(run.entry(table, key))
    if told == "loaded" and run.prescribed and not is_set(run, "loading", "shear_speed_m_per_s"):
        return "held"
    return words(EDGES.get(told, told))


def material(run: Opened, table: str) -> str:
    parts = [
        f"E = {si(run, table, 'youngs_modulus_Pa')}",
        f"ν = {si(run, table, 'poissons_ratio')}",
        f"ρ = {si(run, table, 'density_kg_per_m3')}",
    ]
    damped = is_set(run, table, "stiffness_damping_s")
    damping = f"stiffness damping {si(run, table, 'stiffness_damping_s')}" if damped else "no damping"
    return ", ".join([*parts, damping])


def plate(run: Opened) -> str:
    size = f"{si(run, 'plate', 'width_m')} × {si(run, 'plate', 'height_m')}"
    plane = f"plane {words(run.entry('material', 'plane'))}"
    edges = f"upper edge {edge(run, 'plate', 'top')}, sides {edge(run, 'plate', 'sides')}"
    corner = run.entry("plate", "corner")
    rounded = {
        "relief": f"; lower corners relieved over {si(run, 'plate', 'relief_length_m')}",
        "fillet": f"; lower corners rounded, radius {si(run, 'plate', 'fillet_radius_m')}",
    }
    return f"{size}, {plane}; {material(run, 'material')}; {edges}{rounded.get(str(corner), '')}"


def base(run: Opened) -> str:
    if not has_base(run):
        return "rigid plane"
    size = f"{si(run, 'plate', 'width_m')} × {si(run, 'base', 'height_m')}"
    edges = f"lower edge {edge(run, 'base', 'bottom')}, sides {edge(run, 'base', 'sides')}"
    return f"{size}; {material(run, 'base')}; {edges}"


def waves(run: Opened) -> str:
    def told(speeds: Any) -> str:
        speeds = speeds if isinstance(speeds, dict) else {}
        found = ((name, speeds.get(f"{wave}_m_per_s")) for wave, name in WAVES.items())
        return ", ".join(f"{name} = {v:.0f} m/s" for name, v in found if is_number(v))

    of_plate = told(run.info.get("wave_speeds"))
    below = run.info.get("base")
    if not isinstance(below, dict):
        return of_plate
    joint = below.get("generalised_rayleigh_speed_m_per_s")
    of_both = f"c<sub>GR</sub> = {joint:.0f} m/s" if is_number(joint) else "none, the bodies differ too much"
    of_base = told(below.get("wave_speeds"))
    if of_base == of_plate:
        return f"both bodies: {of_plate}"
    return f"plate: {of_plate}<br>base: {of_base}<br>generalised Rayleigh speed: {of_both}"


def spread(values: np.ndarray, unit: str) -> str:
    low, high = float(values.min()), float(values.max())
    if f"{low:.3g}" == f"{high:.3g}":
        return quantity(low, unit, 3)
    return f"{quantity(low, unit, 3)} to {quantity(high, unit, 3)}"


def forces(found: dict[str, Any]) -> list[str]:
    """Those that a case gives, in words; none of other cases."""
    names = ("normal_force", "shear_force", "critical_shear_force")
    keys = ("mean_pressure_Pa", *(f"{name}_N_per_m" for name in names))
    numbers = [float(found[key]) for key in keys if is_number(found.get(key))]
    if len(numbers) < len(keys):
        return []
    mean, normal, shear, critical = numbers
    # Slow slip leads to the state in which its event begins; none is critical.
    share = f", {shear / critical:.4g} of the critical one" if shear != critical else ""
    return [
        f"normal force {quantity(normal, 'N/m')}, a mean pressure of {quantity(mean, 'Pa')}",
        f"shear force {quantity(shear, 'N/m')}{share}",
    ]


def machine(run: Opened) -> str:
    """Stiffness and path of what loads the plate, in words; empty of a rigid machine at a constant speed."""
    along_x, down = (run.entry("loading", f"{name}_stiffness_Pa_per_m") for name in ("shear", "normal"))
    times_s, shears_m = (run.entry("sequence", name) for name in ("times_s", "shears_m"))
    parts = []
    if is_number(along_x) and math.isfinite(along_x):
        parts.append(f"machine of stiffness {quantity(along_x, 'Pa/m')} along x")
    if is_number(down) and math.isfinite(down):
        parts.append(f"stiffness {quantity(down, 'Pa/m')} downwards" if down else "dead load")
    if isinstance(times_s, list) and isinstance(shears_m, list) and times_s and shears_m:
        end = f"{quantity(shears_m[-1], 'm')} at {quantity(times_s[-1], 's')}"
        parts.append(f"loaded along a path of {len(times_s)} points to {end}")
    return "".join(f"; {part}" for part in parts)


def motion(run: Opened) -> str:
    """How the upper edge or the machine moves on, in words."""
    speed = run.entry("loading", "shear_speed_m_per_s")
    moves = f"; upper edge moves to +x at {velocity(speed, 3)}" if is_number(speed) and speed else ""
    return moves + machine(run)


def loads_of_case(run: Opened) -> str:
    """What presses and shears, as the case says it."""
    names = {"mean_pressure_Pa": "mean pressure", "normal_force_N_per_m": "normal force"}
    given = [
        f"{name} {si(run, 'loading', key)}" for key, name in names.items() if is_set(run, "loading", key)
    ]
    left, right = (si(run, "loading", f"tilt_{side}_m") for side in ("left", "right"))
    pressed = given[0] if given else f"upper edge pressed down {left} at its left end, {right} at its right"
    return pressed + motion(run)


def loads(run: OpenRun) -> str:
    """p and t before the event, and where they come from."""
    moves = motion(run)
    if is_uniform(run):
        p, t = si(run, "prestress", "p_Pa"), si(run, "prestress", "t_Pa")
        return f"pressure p = {p}, shear t = {t}, prescribed, uniform{moves}"
    t_s, p_s = (run.tractions[name].to_numpy() for name in ("t_s_Pa", "p_s_Pa"))
    pressed = p_s > 0
    of_nodes = "no contact"
    if pressed.any():
        p, t = spread(p_s[pressed], "Pa"), spread(t_s[pressed], "Pa")
        of_nodes = f"pressure p {p}, shear t {t} along x"
    if run.prescribed:
        return f"{of_nodes}, prescribed by a table{moves}"
    found = entry(run.info, "statics", "loads")
    found = found if isinstance(found, dict) else {}

    def told(key: str) -> str:
        return quantity(found[key], unit_of(key)) if is_number(found.get(key)) else si(run, "loading", key)

    left, right = told("tilt_left_m"), told("tilt_right_m")
    sheared = entry(run.info, "statics", "common_shear_m")
    by = f"by {quantity(sheared, 'm')} " if is_number(sheared) else ""
    pushed = left if left == right else f"{left} at its left end, {right} at its right"
    to_m = run.entry("loading", "pusher_to_m")
    if is_number(to_m) and to_m > 0:
        heights = f"{si(run, 'loading', 'pusher_from_m')} to {si(run, 'loading', 'pusher_to_m')}"
        moved = f"left side pushed {by}to +x at heights of {heights}"
    else:
        moved = f"moved {by}to +x"
    moves = f"upper edge pressed down {pushed}, then {moved}"
    return "; ".join([*forces(found), moves, of_nodes])


def table_of_mu(run: Opened, over: str, unit: str) -> str:
    places, mu = (run.entry("friction", key) for key in (over, "table_mu"))
    factor = run.entry("friction", "mu_factor")
    if not (isinstance(places, list) and isinstance(mu, list) and is_number(factor)):
        return "not given"
    rows = zip(places, mu, strict=False)
    return ", ".join(
        f"{factor * m:.3g} at {quantity(x, unit)}" for x, m in rows if is_number(x) and is_number(m)
    )


def law(run: Opened) -> str:
    def number(key: str) -> str:
        return si(run, "friction", key)

    def both() -> str:
        return f"{MU_S} = {number('mu_s')}, {MU_K} = {number('mu_k')}"

    match run.entry("friction", "law"):
        case "velocity_weakening":
            return f"weakens with the slip rate: {both()}, α = {number('alpha_m2_per_s2')}"
        case "coulomb":
            return f"constant: μ = {number('mu')}"
        case "slip_weakening":
            return f"weakens linearly with slip: {both()}, d<sub>c</sub> = {number('d_c_m')}"
        case "slip_weakening_healing":
            told = f"{both()}, d<sub>c</sub> = {number('d_c_m')}"
            return f"weakens linearly with slip, heals where a node sticks: {told}"
        case "slip_table":
            return f"μ over slip: {table_of_mu(run, 'table_slip_m', 'm')}"
        case "slip_rate_table":
            return f"μ over slip rate: {table_of_mu(run, 'table_slip_rate_m_per_s', 'm/s')}"
        case other:  # a law that was added
            settings = run.case.get("friction")
            found = settings.items() if isinstance(settings, dict) else ()
            parts = (f"{name_of(k)} = {quantity(v, unit_of(k))}" for k, v in found if is_number(v) and v)
            return words(f"{other}: {', '.join(parts)}")


def friction(run: Opened) -> str:
    parts = [law(run)]
    delayed = run.entry("friction", "regularisation")
    if delayed in ("strength", "pressure"):
        follows = "strength follows" if delayed == "strength" else "pressure in the strength follows"
        rates = {
            "relaxation_time_s": "t* =",
            "relaxation_length_m": "L =",
            "relaxation_slip_rate_m_per_s": "v* =",
        }
        told = [
            f"{name} {si(run, 'friction', key)}"
            for key, name in rates.items()
            if is_set(run, "friction", key)
        ]
        parts.append(f"{follows} with a delay, {', '.join(told)}")
    if run.entry("friction", "file"):
        parts.append("parameters vary along x by a table")
    varied = run.entry("friction", "random_key")
    if isinstance(varied, str) and varied not in ("", "none"):
        share = run.entry("friction", "random_share")
        by = f" by {100 * share:.3g} %" if is_number(share) else ""
        length = si(run, "friction", "random_correlation_length_m")
        parts.append(words(f"{name_of(varied)} varies at random{by}, correlation length {length}"))
    return "; ".join(parts)


def rise(run: Opened) -> str:
    ramp = (
        f", rising over {si(run, 'event', 'trigger_ramp_s')}"
        if is_set(run, "event", "trigger_ramp_s")
        else ""
    )
    ends = (
        f", for {si(run, 'event', 'trigger_duration_s')}"
        if is_set(run, "event", "trigger_duration_s")
        else ""
    )
    return ramp + ends


def start(run: Opened) -> str:
    """What starts the event: form, zone, amount."""

    def amount(over: str) -> str:
        return str(run.entry("event", f"trigger_over_{over}"))

    match run.kind, run.entry("event", "trigger_form"):
        case "none", _:
            return "nothing but the loads"
        case "spontaneous", _:
            if str(run.entry("friction", "law")).startswith("rate_and_state"):
                return "spontaneous: slip is as fast as inertia counts"
            return "spontaneous: the shear just exceeds the critical one"
        case ("left" | "right") as side, form:
            forms = {
                "added": f"shear added, {amount('missing')} times what is missing to {MU_S}p{rise(run)}",
                "raised": f"shear raised to {amount('strength')} {MU_S}p{rise(run)}",
                "weakened": f"μ = {MU_K} from the start",
                "unloaded": f"{run.entry('event', 'trigger_unloading')} p taken away{rise(run)}",
            }
            zone = si(run, "event", "trigger_zone_m")
            return f"trigger over {zone} at the {side} edge: {forms.get(str(form), words(form))}"
        case "nucleation", _:
            patch = (
                f"patch around x = {si(run, 'nucleation', 'x_m')}, {si(run, 'nucleation', 'half_length_m')} "
                f"to each side and a taper of {si(run, 'nucleation', 'taper_m')}"
            )
            if run.entry("nucleation", "form") == "overstress":
                return f"{patch}: shear of {si(run, 'nucleation', 'overstress_Pa')} added{rise(run)}"
            if run.entry("nucleation", "form") == "unloaded":
                return f"{patch}: pressure of {si(run, 'nucleation', 'unloading_Pa')} taken away{rise(run)}"
            return f"{patch}: μ = {MU_K} from the start"
        case kind, _:
            return words(kind)


def rupture(run: Opened) -> str:
    """S before the event, and what it lets expect; of runs that tell it."""
    told = run.info.get("rupture")
    if not isinstance(told, dict):
        return "not given"
    S = told.get("strength_excess_S")
    spread = [S.get(key) if isinstance(S, dict) else None for key in ("min", "median", "max")]
    least, median, most = (f"{v:.3g}" if is_number(v) else "not given" for v in spread)
    of_S = f"S {median}" if least == most else f"S {least} to {most}, median {median}"
    lengths = [
        f"{name} {quantity(factor * told[key], 'm', 3)}"
        for key, name, factor in (
            ("nucleation_length_m", "nucleation length", 1),
            ("griffith_half_length_m", "critical crack length", 2),
            ("process_zone_m", "process zone", 1),
        )
        if is_number(told.get(key))
    ]
    parts = [of_S, *lengths, str(told.get("regime", ""))]
    return words("; ".join(part for part in parts if part))


def rows_of_case(run: Opened) -> list[tuple[str, str]]:
    """What is known without an event."""
    return [
        ("Case", words(run.title or "without a title")),
        ("Plate", plate(run)),
        ("Base", base(run)),
        ("Loads", loads_of_case(run)),
        ("Friction", friction(run)),
        ("Start", start(run)),
        ("Wave speeds", waves(run)),
    ]


def rows(run: OpenRun) -> list[tuple[str, str]]:
    return [
        ("Case", words(run.info.get("title", "") or "without a title")),
        ("Plate", plate(run)),
        ("Base", base(run)),
        ("Loads", loads(run)),
        ("Friction", friction(run)),
        ("Start", start(run)),
        ("Wave speeds", waves(run)),
        ("Expected before the event", rupture(run)),
    ]
