# SPDX-License-Identifier: BSD-3-Clause
"""A case drawn to scale, as an inline SVG."""

from __future__ import annotations

from slipfront.files import is_number
from slipfront.opened import Opened
from slipfront.report.page import words
from slipfront.report.setup import edge, has_base, is_uniform
from slipfront.units import quantity

WIDTH, HEIGHT = 460.0, 300.0  # of the bodies at most
LEFT, TOP, RIGHT, BOTTOM = 80.0, 46.0, 26.0, 44.0  # of the labels around them
RIGID = 12.0  # of the strip that stands for a plane
PUSHER = 8.0  # of the block that stands for it
PLATE, BASE, TRIGGER, LINE = "#dce8f4", "#ece4d2", "#d55e00", "#333"
MOST_NAMES = 12


def text(x: float, y: float, told: str, anchor: str = "middle", colour: str = "#111") -> str:
    return f'<text x="{x:.1f}" y="{y:.1f}" text-anchor="{anchor}" fill="{colour}">{words(told)}</text>'


def line(x1: float, y1: float, x2: float, y2: float, look: str) -> str:
    return f'<line x1="{x1:.1f}" y1="{y1:.1f}" x2="{x2:.1f}" y2="{y2:.1f}" {look}/>'


def arrow(x1: float, y1: float, x2: float, y2: float) -> str:
    return line(x1, y1, x2, y2, f'stroke="{LINE}" stroke-width="1.6" marker-end="url(#arrow)"')


def border(x1: float, y1: float, x2: float, y2: float, kind: str) -> str:
    """An edge in the look of what it does."""
    looks = {
        "absorbing": f'stroke="{LINE}" stroke-width="2" stroke-dasharray="5 3"',
        "periodic": f'stroke="{LINE}" stroke-width="1.2" stroke-dasharray="1 3"',
        "free of traction": f'stroke="{LINE}" stroke-width="1"',
    }
    return line(x1, y1, x2, y2, looks.get(kind, f'stroke="{LINE}" stroke-width="4"'))


def body(run: Opened, table: str, x: float, y: float, w: float, h: float) -> str:
    """A rectangle, its three edges off the interface, and their words."""
    is_plate = table == "plate"
    fill, far = (PLATE, "top") if is_plate else (BASE, "bottom")
    y_far = y if is_plate else y + h
    sides, end = edge(run, table, "sides"), edge(run, table, far)
    return "".join(
        [
            f'<rect x="{x:.1f}" y="{y:.1f}" width="{w:.1f}" height="{h:.1f}" fill="{fill}"/>',
            border(x, y, x, y + h, sides),
            border(x + w, y, x + w, y + h, sides),
            border(x, y_far, x + w, y_far, end),
        ]
    )


def driven_m(run: Opened, width_m: float) -> tuple[float, float] | None:
    """Where the trigger or the patch acts, within the plate."""
    if run.kind in ("left", "right"):
        zone_m = run.entry("event", "trigger_zone_m")
        if not is_number(zone_m):
            return None
        return (0.0, min(zone_m, width_m)) if run.kind == "left" else (max(0.0, width_m - zone_m), width_m)
    if run.kind != "nucleation":
        return None
    x_m, half_m, taper_m = (run.entry("nucleation", key) for key in ("x_m", "half_length_m", "taper_m"))
    if not (is_number(x_m) and is_number(half_m) and is_number(taper_m)):
        return None
    from_m, to_m = max(0.0, x_m - half_m - taper_m), min(width_m, x_m + half_m + taper_m)
    return (from_m, to_m) if from_m < to_m else None


def probes(run: Opened, x0: float, y0: float, scale: float) -> str:
    """Dots at the places of [probes], with their names where there are few."""
    places = [run.entry("probes", key) for key in ("x_m", "y_m", "names")]
    if not all(isinstance(values, list) for values in places):
        return ""
    x_m, y_m, names = places
    names = names or [str(k + 1) for k in range(len(x_m))]
    drawn = []
    for x, y, name in zip(x_m, y_m, names, strict=False):
        if not (is_number(x) and is_number(y)):
            continue
        at_x, at_y = x0 + scale * x, y0 - scale * y
        label = text(at_x, at_y - 6, str(name)) if len(x_m) <= MOST_NAMES else ""
        drawn.append(f'<circle cx="{at_x:.1f}" cy="{at_y:.1f}" r="3" fill="#111"/>{label}')
    return "".join(drawn)


def pusher_m(run: Opened) -> tuple[float, float] | None:
    """The heights between which the left side is pushed."""
    from_m, to_m = (run.entry("loading", f"pusher_{end}_m") for end in ("from", "to"))
    return (from_m, to_m) if is_number(from_m) and is_number(to_m) and to_m > from_m else None


def pusher(x: float, from_y: float, to_y: float) -> str:
    """A block at the left side, and an arrow of where it moves."""
    return (
        f'<rect x="{x - PUSHER:.1f}" y="{to_y:.1f}" width="{PUSHER}" height="{from_y - to_y:.1f}" '
        f'fill="{LINE}"/>'
    ) + arrow(x - PUSHER - 30, 0.5 * (from_y + to_y), x - PUSHER - 2, 0.5 * (from_y + to_y))


def load(run: Opened, x: float, w: float, y: float) -> str:
    """Arrows of what presses and, unless a side is pushed, shears, above the plate."""
    p, t = (run.entry("prestress", f"{name}_Pa") for name in "pt")
    known = is_uniform(run) and is_number(p) and is_number(t)
    pressure = f"p = {quantity(p, 'Pa')}" if known else "p"
    shear = f"t = {quantity(abs(t), 'Pa')}" if known else "t"
    forward = not known or t >= 0
    from_x, to_x = (x + 0.6 * w, x + 0.6 * w + 46) if forward else (x + 0.6 * w + 46, x + 0.6 * w)
    parts = [arrow(x + 0.3 * w + k * 12, y - 32, x + 0.3 * w + k * 12, y - 8) for k in (-1, 0, 1)]
    parts.append(text(x + 0.3 * w - 20, y - 20, pressure, "end"))
    if pusher_m(run) is None and (not known or t != 0):
        parts += [arrow(from_x, y - 16, to_x, y - 16), text(x + 0.6 * w + 23, y - 24, shear)]
    return "".join(parts)


def sketch(run: Opened) -> str:
    """Nothing where the case lacks the sizes."""
    width_m, height_m = (run.entry("plate", key) for key in ("width_m", "height_m"))
    base_m = run.entry("base", "height_m") if has_base(run) else 0.0
    if not (is_number(width_m) and is_number(height_m) and is_number(base_m)):
        return ""
    scale = min(WIDTH / width_m, HEIGHT / (height_m + base_m))
    w, h, depth = scale * width_m, scale * height_m, scale * base_m if base_m else RIGID
    x, y = LEFT, TOP
    interface = y + h
    below = (
        body(run, "base", x, interface, w, depth)
        if base_m
        else f'<rect x="{x:.1f}" y="{interface:.1f}" width="{w:.1f}" height="{RIGID}" fill="url(#hatch)"/>'
    )
    driven = driven_m(run, width_m)
    zone = ""
    if driven is not None:
        from_x, to_x = (x + scale * at for at in driven)
        zone = line(from_x, interface, to_x, interface, f'stroke="{TRIGGER}" stroke-width="6"')
        zone += text(0.5 * (from_x + to_x), interface + 17, "trigger", colour="#a04000")
    pushed = pusher_m(run)
    size = (x - 8, "end") if pushed is None else (x + 8, "start")  # beside the pusher there is no room
    more = "" if pushed is None else " At the left: the pusher."
    bottom = interface + depth
    parts = [
        '<defs><marker id="arrow" viewBox="0 0 8 8" refX="7" refY="4" markerWidth="6" markerHeight="6" '
        f'orient="auto"><path d="M0 0 8 4 0 8z" fill="{LINE}"/></marker>'
        '<pattern id="hatch" width="6" height="6" patternUnits="userSpaceOnUse" '
        'patternTransform="rotate(45)">'
        f'<line x1="0" y1="0" x2="0" y2="6" stroke="{LINE}"/></pattern></defs>',
        body(run, "plate", x, y, w, h),
        below,
        line(x, interface, x + w, interface, 'stroke="#111" stroke-width="2"'),
        zone,
        load(run, x, w, y),
        probes(run, x, interface, scale),
        "" if pushed is None else pusher(x, *(interface - scale * at for at in pushed)),
        text(size[0], y + 0.5 * h + 5, quantity(height_m, "m"), size[1]),
        text(x - 8, interface + 0.5 * depth + 5, quantity(base_m, "m") if base_m else "rigid", "end"),
        text(x + 0.5 * w, bottom + 20, quantity(width_m, "m")),
        arrow(x, bottom + 34, x + 34, bottom + 34),
        text(x + 44, bottom + 39, "x"),
    ]
    full_w, full_h = LEFT + w + RIGHT, bottom + BOTTOM
    return (
        f'<figure class="sketch"><svg viewBox="0 0 {full_w:.0f} {full_h:.0f}" width="{full_w:.0f}" '
        f'height="{full_h:.0f}" role="img" aria-label="The case, to scale">{"".join(parts)}</svg>'
        "<figcaption>To scale. Edges: thick, displacement prescribed or held; dashed, absorbing; dotted, "
        f"periodic; thin, free of traction. Dots: probes.{more}</figcaption></figure>"
    )
