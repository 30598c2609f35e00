# SPDX-License-Identifier: BSD-3-Clause
"""The table of a recorder's channels: what each measures, where, and how a recorded number becomes that.
docs/records.md"""

from __future__ import annotations

import math
import re
from collections.abc import Mapping
from dataclasses import dataclass, replace
from difflib import get_close_matches
from pathlib import Path
from typing import Any, NamedTuple

from slipfront.errors import one_line
from slipfront.files import DataError, is_number, read_table, read_toml
from slipfront.gauges import STRAINS
from slipfront.onsets import LENGTHS, PRESSURES, TIMES, in_si, name_and_unit

FREQUENCIES = {"Hz": 1.0, "kHz": 1e3, "MHz": 1e6, "GHz": 1e9}
VOLTAGES = {"V": 1.0, "mV": 1e-3, "uV": 1e-6}
FORCES = {"N": 1.0, "kN": 1e3, "MN": 1e6}
#: Arms that see the strain, of a bridge's four.
ACTIVE_ARMS = {"quarter": 1, "half": 2, "full": 4}


class Kind(NamedTuple):
    """What a channel may measure."""

    unit: str  # CF conventions
    long_name: str
    is_zeroed: bool = True  # its mean before the event is subtracted
    units: Mapping[str, float] = {}  # of recorded numbers, that the file may name
    factor: float | None = None  # where none is given


KINDS = {
    "strain": Kind("1", "strain along the arm of a gauge", units=STRAINS),
    "strain_xx": Kind("1", "strain along x", units=STRAINS),
    "strain_yy": Kind("1", "strain along y", units=STRAINS),
    "strain_xy": Kind("1", "shear strain, half the engineering one", units=STRAINS),
    "gamma_xy": Kind("1", "shear strain, half the engineering one", units=STRAINS),
    "stress_xx": Kind("Pa", "stress along x, positive in tension", units=PRESSURES),
    "stress_yy": Kind("Pa", "stress along y, positive in tension", units=PRESSURES),
    "stress_xy": Kind("Pa", "shear stress", units=PRESSURES),
    "displacement": Kind("m", "displacement", units=LENGTHS),
    "slip": Kind("m", "slip", units=LENGTHS),
    "force_shear": Kind("N", "shear force", False, FORCES),
    "force_normal": Kind("N", "normal force", False, FORCES),
    "contact_area": Kind("1", "contact area, or light through it", False, factor=1.0),
    "acceleration": Kind("m s-2", "acceleration"),
    "trigger": Kind("1", "trigger", False, factor=1.0),
}
STRAIN_BRIDGES = ("strain", "strain_xx", "strain_yy")  # kinds whose calibration may be that of a bridge
TEXTS = ("name", "column", "kind", "gauge", "bridge", "time", "file")
PLAIN = ("factor", "gain", "gauge_factor", "polarity", "dead")
#: Keys that end with a unit, and what it may be.
WITH_UNIT: dict[str, tuple[str, Mapping[str, float]]] = {
    "x": ("x_m", LENGTHS),
    "y": ("y_m", LENGTHS),
    "angle": ("angle_deg", {"deg": 1.0}),
    "excitation": ("excitation_V", VOLTAGES),
    "sample_rate": ("sample_rate_Hz", FREQUENCIES),
    "first_time": ("first_time_s", TIMES),
    "clock_offset": ("clock_offset_s", TIMES),
    "bandwidth": ("bandwidth_Hz", FREQUENCIES),
    "time": ("time", TIMES),  # a column: the unit of what it holds
}
KEYS = (*TEXTS, *PLAIN, *(key for key, _ in WITH_UNIT.values() if key != "time"))
BRIDGE = ("excitation_V", "gain", "gauge_factor", "bridge")
ABOVE_0 = ("excitation_V", "gain", "gauge_factor", "sample_rate_Hz", "bandwidth_Hz")
CLOCKS = ("time", "sample_rate_Hz", "first_time_s")


@dataclass(frozen=True)
class Wiring:
    """A channel of the table. What is not given is None, or empty, but places, which are NaN."""

    where: str  # in messages
    name: str
    kind: str
    column: str = ""
    gauge: str = ""
    x_m: float = math.nan
    y_m: float = math.nan
    angle_deg: float = math.nan
    factor: float | None = None
    excitation_V: float | None = None
    gain: float | None = None
    gauge_factor: float | None = None
    bridge: str = ""
    polarity: float = 1.0
    time: str = ""
    time_unit: str = ""
    sample_rate_Hz: float | None = None
    first_time_s: float = 0.0
    clock_offset_s: float = 0.0
    bandwidth_Hz: float = math.nan
    dead: bool = False
    file: str = ""  # a pattern of the names of its files

    def per_recorded(self, unit: str) -> float:
        """Of the kind's unit per unit recorded; `unit`: what the file says of that."""
        share = 0.5 if self.kind == "gamma_xy" else 1.0
        if self.factor is not None:
            return self.polarity * self.factor * share
        if self.bridge:
            if unit and unit not in VOLTAGES:
                raise DataError(
                    f"{self.where}: by the file it is recorded in {one_line(unit)}, not in volts; give "
                    "factor in place of the bridge"
                )
            values = (self.excitation_V, self.gain, self.gauge_factor)
            assert None not in values
            of = math.prod(v for v in values if v is not None) * ACTIVE_ARMS[self.bridge]
            return self.polarity * 4 / of * VOLTAGES[unit or "V"]
        kind = KINDS[self.kind]
        if unit in kind.units and unit:
            return self.polarity * kind.units[unit] * share
        if kind.factor is not None:
            return self.polarity * kind.factor
        bridge = f" or {', '.join(BRIDGE)}" if self.kind in STRAIN_BRIDGES else ""
        raise DataError(
            f"{self.where}: how a recorded number becomes {self.kind} is not known: give factor{bridge}; "
            f"factor = 1 if the file holds {self.kind.partition('_')[0]} in {kind.unit}"
        )

    @property
    def of_gauge(self) -> bool:
        return self.kind.startswith(("strain", "gamma", "stress"))

    @property
    def stored_kind(self) -> str:
        return "strain_xy" if self.kind == "gamma_xy" else self.kind


def plain_key(where: str, key: str) -> tuple[str, float, str]:
    """A key without another unit than its own, the factor to that, and the unit that was there."""
    if key in KEYS:
        return key, 1.0, ""
    bare, unit = name_and_unit(key)
    if bare in WITH_UNIT and unit in WITH_UNIT[bare][1]:
        return WITH_UNIT[bare][0], WITH_UNIT[bare][1][unit], unit
    near = get_close_matches(key, KEYS, n=1)
    hint = f"did you mean {near[0]}?" if near else f"it is one of {', '.join(KEYS)}"
    raise DataError(f"{where}: unknown key '{one_line(key)}'; {hint}")


def checked(where: str, key: str, value: Any) -> Any:
    """A value of a key, in the key's own unit."""
    of = f"{where}: {key} is {one_line(repr(value))}"
    if key in ("column", "time") and isinstance(value, int) and not isinstance(value, bool):
        value = str(value)
    if key in TEXTS:
        if not isinstance(value, str) or not value.strip():
            raise DataError(f"{of}; it must be a text")
        return value.strip()
    if key == "dead":
        if not isinstance(value, bool):
            raise DataError(f"{of}; it must be true or false")
        return value
    if not is_number(value):
        raise DataError(f"{of}; it must be a number")
    if key in ABOVE_0 and not value > 0:
        raise DataError(f"{of}; it must be above 0")
    if (key == "factor" and value == 0) or (key == "polarity" and abs(value) != 1):
        raise DataError(f"{of}; it must {'not be 0' if key == 'factor' else 'be 1 or -1'}")
    return float(value)


def values_of(where: str, table: Mapping[str, Any]) -> dict[str, Any]:
    """The keys of a channel, or of [recorder], in their own units."""
    made: dict[str, Any] = {}
    for given, value in table.items():
        key, factor, unit = plain_key(where, given)
        if key in made:
            raise DataError(f"{where}: {key} is given twice, once as '{one_line(given)}': leave one out")
        made[key] = checked(where, key, value)
        if key == "time":
            made["time_unit"] = unit
        elif factor != 1:
            made[key] = in_si(made[key], factor)
    if "time" in made and "sample_rate_Hz" in made:
        raise DataError(f"{where}: has both a column of times and sample_rate_Hz: leave one out")
    if "first_time_s" in made and "sample_rate_Hz" not in made:
        raise DataError(f"{where}: first_time_s is of times by sample_rate_Hz: give that, too")
    return made


def wiring_of(where: str, own: dict[str, Any], defaults: dict[str, Any]) -> Wiring:
    if "name" not in own:
        raise DataError(f"{where}: has no name: give each channel one")
    where = f"{where.partition(' channel ')[0]}: channel '{one_line(own['name'])}'"
    if any(key in own for key in CLOCKS[:2]):  # its own clock is all its own
        defaults = {key: value for key, value in defaults.items() if key not in (*CLOCKS, "time_unit")}
    kind = own.get("kind", defaults.get("kind"))
    if kind not in KINDS:
        near = get_close_matches(str(kind), KINDS, n=1)
        hint = f"did you mean {near[0]}?" if near else f"it is one of {', '.join(KINDS)}"
        raise DataError(f"{where}: {f'unknown kind {one_line(kind)!r}' if kind else 'has no kind'}; {hint}")
    strange = [key for key in BRIDGE if key in own]
    if strange and kind not in STRAIN_BRIDGES:
        raise DataError(f"{where}: {strange[0]} is of strain gauges; give factor for {kind}")
    if strange and "factor" in own:
        raise DataError(f"{where}: has both factor and {strange[0]}: leave one out")
    if "factor" in own or kind not in STRAIN_BRIDGES:
        defaults = {key: value for key, value in defaults.items() if key not in BRIDGE}
    elif strange:
        defaults = {key: value for key, value in defaults.items() if key != "factor"}
    made = Wiring(where, **{"kind": kind} | defaults | own)
    has = [key for key in BRIDGE if getattr(made, key)]
    if has and made.factor is None and len(has) < len(BRIDGE):
        missing = ", ".join(key for key in BRIDGE if key not in has)
        raise DataError(f"{where}: the bridge is not complete: give {missing}")
    if made.bridge and made.bridge not in ACTIVE_ARMS:
        raise DataError(
            f"{where}: bridge is '{one_line(made.bridge)}'; it is one of {', '.join(ACTIVE_ARMS)}"
        )
    if re.fullmatch(r"time(_\d+)?|\.+", made.name) or "/" in made.name or not made.name.isprintable():
        raise DataError(
            f"{where}: no channel of records.nc has such a name: give another, and this as column"
        )
    if kind == "strain" and math.isnan(made.angle_deg):
        raise DataError(f"{where}: give angle_deg of the arm, from +x towards +y")
    if kind != "strain" and "angle_deg" in own:
        raise DataError(f"{where}: angle_deg is of kind strain alone: leave it out")
    if made.of_gauge and not made.dead and (math.isnan(made.x_m) or math.isnan(made.y_m)):
        raise DataError(f"{where}: give its place, x_m and y_m")
    if made.of_gauge and made.y_m == 0:
        raise DataError(f"{where}: y_m is 0, on the interface; give its height above it, below 0 beneath it")
    return replace(made, column=made.column or made.name, gauge=made.gauge or made.name)


def tables_of_csv(file: Path) -> list[tuple[str, dict[str, Any]]]:
    table = read_table(file, by_hand=True, separators=";\t,")
    found = []
    for line, cells in table.rows:
        where = f"{file}:{line}"
        row: dict[str, Any] = {}
        for key, cell in zip(table.header, cells, strict=True):
            if not cell:
                continue
            plain = plain_key(where, key)[0]
            if plain in TEXTS:
                row[key] = cell
            elif plain == "dead":
                row[key] = {"true": True, "false": False}.get(cell.lower(), cell)
            else:
                row[key] = table.number(line, key, cell, True)
        found.append((where, row))
    return found


def tables_of_toml(file: Path) -> tuple[list[tuple[str, dict[str, Any]]], dict[str, Any]]:
    read = read_toml(file)
    channels, defaults = read.get("channel", []), read.get("recorder", {})
    if unknown := [key for key in read if key not in ("channel", "recorder")]:
        raise DataError(f"{file}: unknown '{one_line(unknown[0])}'; a table has [recorder] and [[channel]]")
    if not isinstance(defaults, dict):
        raise DataError(f"{file}: 'recorder' is not a table [recorder]")
    if not isinstance(channels, list) or not all(isinstance(c, dict) for c in channels):
        raise DataError(f"{file}: 'channel' is not a list of tables [[channel]]")
    return [(f"{file}: channel {k}", c) for k, c in enumerate(channels, start=1)], defaults


def require_gauges(file: Path, wirings: list[Wiring]) -> None:
    """Refuses gauges whose parts do not belong together."""
    by_gauge: dict[str, list[Wiring]] = {}
    for wiring in wirings:
        if wiring.of_gauge:
            by_gauge.setdefault(wiring.gauge, []).append(wiring)
    for gauge, parts in by_gauge.items():
        of = f"{file}: gauge '{one_line(gauge)}'"
        kinds = {"arm" if p.kind == "strain" else p.stored_kind.partition("_")[0] for p in parts}
        if len(kinds) > 1:
            raise DataError(f"{of} mixes arms, strain or stress: give each its own name of gauge")
        names = [f"{p.angle_deg % 180:g}" if p.kind == "strain" else p.stored_kind for p in parts]
        if len(set(names)) < len(names):
            raise DataError(f"{of} has two channels of one {'angle' if kinds == {'arm'} else 'component'}")
        if len(parts) > 3:
            raise DataError(f"{of} has {len(parts)} arms; a rosette has three")
        if kinds != {"arm"} and len({(p.x_m, p.y_m) for p in parts if not p.dead}) > 1:
            raise DataError(f"{of} is at more than one place; arms alone have places of their own")
        if len({p.y_m > 0 for p in parts if p.y_m == p.y_m}) > 1:
            raise DataError(f"{of} is on both sides of the interface")


def read_channels(file: Path) -> list[Wiring]:
    """The table of channels, TOML or CSV."""
    defaults: dict[str, Any] = {}
    if file.suffix.lower() == ".toml":
        tables, defaults = tables_of_toml(file)
    else:
        tables = tables_of_csv(file)
    defaults = values_of(f"{file}: [recorder]", defaults)
    if strange := [key for key in defaults if key in ("name", "column", "gauge", "dead")]:
        raise DataError(f"{file}: [recorder] has {strange[0]}, which is of each channel")
    made = [wiring_of(where, values_of(where, table), defaults) for where, table in tables]
    if not made:
        raise DataError(f"{file}: has no channels")
    names = [wiring.name for wiring in made]
    if twice := [name for name in names if names.count(name) > 1]:
        raise DataError(f"{file}: two channels '{one_line(twice[0])}'")
    require_gauges(file, made)
    return made
