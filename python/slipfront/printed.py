# SPDX-License-Identifier: BSD-3-Clause
"""How results of the compiled module are printed: the name, value, unit and meaning of each attribute. To
import this module is enough."""

from __future__ import annotations

import tomllib
from collections.abc import Callable, Iterator
from typing import Any

from slipfront import _core
from slipfront.units import unit_of

LISTED = (
    _core.ExponentialFit, _core.Info, _core.Loads, _core.MeshChoice, _core.NodeSpread, _core.Ratio,
    _core.Rupture, _core.Spread, _core.WaveSpeeds, _core.WellPosedness,
)  # fmt: skip
INDENT = "  "


def attributes(value: Any) -> dict[str, property]:
    """Those of a result, in the order in which they are defined."""
    return {name: found for name, found in vars(type(value)).items() if isinstance(found, property)}


def meaning_of(attribute: property) -> str:
    """Of one without a text the module gives its signature."""
    told = (attribute.__doc__ or "").strip()
    return "" if told.startswith("(self") else told


def words(value: Any) -> str:
    return f"{value:.6g}" if isinstance(value, float) else str(value)


def rows(value: Any, indent: str) -> Iterator[tuple[str, str, str]]:
    """Name, value with its unit, and meaning; those of a result inside one come below it."""
    for name, attribute in attributes(value).items():
        inner = getattr(value, name)
        meaning = "" if isinstance(inner, str) else meaning_of(attribute)
        if isinstance(inner, LISTED):
            yield indent + name, "", meaning
            yield from rows(inner, indent + INDENT)
            continue
        unit = unit_of(name) if isinstance(inner, float) else "1"
        yield indent + name, words(inner) + ("" if unit == "1" else f" {unit}"), meaning


def listing(value: Any) -> str:
    lines = list(rows(value, INDENT))
    wide, wider = (max(len(line[k]) for line in lines) for k in (0, 1))
    wider = min(wider, 24)  # a sentence has no column beside it
    told = [f"{name:<{wide}}  {cell:<{wider}}  {meaning}".rstrip() for name, cell, meaning in lines]
    return "\n".join([type(value).__name__, *told])


def estimate(value: _core.Estimate) -> str:
    return f"{value.value:.6g} ({value.low:.6g} to {value.high:.6g})"


def front(value: _core.Front) -> str:
    x, way = value.x_m, "+x" if value.direction > 0 else "-x"
    path = f"{x[0]:.6g} to {x[-1]:.6g} m" if len(x) else "no points"
    return f"<front {value.id} to {way}: {path}, {len(x)} points, {value.mode}, ends: {value.end}>"


def batch_event(value: _core.BatchEvent) -> str:
    end = f", {value.reason}" if value.blew_up else ""
    return f"<event: {len(value.fronts)} fronts, {len(value.onset_s)} onsets{end}>"


def velocities(value: _core.Velocities) -> str:
    return f"<velocities at t = {value.time_s:.6g} s: {len(value.x_m_per_s)} nodes>"


def case(value: _core.Case) -> str:
    return f"<case '{tomllib.loads(value.toml)['title']}'>"


def interface_state(value: _core.InterfaceState) -> str:
    return f"<interface at step {value.step}, t = {value.time_s:.6g} s: {len(value.x_m)} nodes>"


PRINTED: dict[type, Callable[[Any], str]] = {
    **dict.fromkeys(LISTED, listing),
    _core.BatchEvent: batch_event,
    _core.Case: case,
    _core.Estimate: estimate,
    _core.Front: front,
    _core.InterfaceState: interface_state,
    _core.Velocities: velocities,
}
for kind, shown in PRINTED.items():
    kind.__repr__ = shown  # type: ignore[method-assign, assignment]
