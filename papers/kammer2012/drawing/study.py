# SPDX-License-Identifier: BSD-3-Clause
"""The parameter studies of analysis.json."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Any

from slipfront.files import DataError, is_number

SPREADS = ("t_s_over_p_s", "t_d_over_p_d", "energy")
SMALL_LENGTH_M = 1e-4  # where all values are below it, they are shown in µm


@dataclass(frozen=True)
class MainFront:
    """The longest front of an event in its direction."""

    start_x_m: float
    end_x_m: float
    end: str
    mode: str
    mean_over_c_L: float | None
    max_over_c_L: float | None


@dataclass(frozen=True)
class StudyPoint:
    """One value of the parameter; None where a number is undefined."""

    value: str
    number: float | None
    fronts: dict[tuple[str, int], MainFront]  # by event and direction
    change: dict[str, float | None]  # by event: median change of V_tip against the reference run
    rms_over_c_L: float | None  # about the own fit of V_tip against the energy rise
    share_in_paper_band: float | None
    spread: dict[str, float | None]  # by the names in SPREADS


@dataclass(frozen=True)
class Study:
    name: str
    parameter: str  # key of the case file
    why: str
    points: list[StudyPoint]

    @property
    def unit(self) -> tuple[str, float]:
        """Unit that the parameter is shown in, and the factor to it from SI."""
        is_small = all(point.number is not None and point.number < SMALL_LENGTH_M for point in self.points)
        for ending, unit in (
            ("_m2_per_s2", ("m²/s²", 1.0)),
            ("_m", ("µm", 1e6) if is_small else ("mm", 1e3)),
            ("_s", ("µs", 1e6)),
        ):
            if self.parameter.endswith(ending):
                return unit
        return ("", 1.0)

    @property
    def numeric(self) -> bool:
        return all(point.number is not None for point in self.points)

    def shown(self, point: StudyPoint) -> str:
        """The value as text, in the unit shown."""
        if self.numeric and point.number is not None:
            return f"{point.number * self.unit[1]:.3g}"
        return point.value.replace("_", " ")


def optional(value: Any) -> float | None:
    """A number or nothing."""
    if value is not None and not is_number(value):
        raise TypeError(f"{value} is not a number")
    return value


def needed(value: Any) -> float:
    if not is_number(value):
        raise TypeError(f"{value} is not a number")
    return value


def read_point(point: dict[str, Any]) -> StudyPoint:
    fronts: dict[tuple[str, int], MainFront] = {}
    for event in point["events"]:
        for f in sorted(event["fronts"], key=lambda f: abs(needed(f["end_x_m"]) - needed(f["start_x_m"]))):
            fronts[str(event["event"]), f["direction"]] = MainFront(  # the longest comes last
                f["start_x_m"],
                f["end_x_m"],
                str(f["end"]),
                str(f["mode"]),
                optional(f["mean_v_over_c_L"]),
                optional(f["max_v_over_c_L"]),
            )
    return StudyPoint(
        value=str(point["value"]),
        number=optional(point["number"]),
        fronts=fronts,
        change={
            str(e["event"]): optional(e["speed_change"]["median"])
            for e in point["events"]
            if "speed_change" in e
        },
        rms_over_c_L=optional(point["fit"]["rms_over_c_L"]) if point["fit"] is not None else None,
        share_in_paper_band=optional(point["share_in_paper_band"]),
        spread={name: optional(point["spread"][name]) for name in SPREADS},
    )


def read_studies(file: Path, analysis: dict[str, Any]) -> list[Study]:
    """The studies of analysis.json; none where it has no such list."""
    listed = analysis.get("studies", [])
    if not isinstance(listed, list):
        raise DataError(f"{file}: 'studies' is not a list")
    studies = []
    for i, study in enumerate(listed):
        try:
            points = [read_point(point) for point in study["points"]]
            studies.append(Study(str(study["name"]), str(study["parameter"]), str(study["why"]), points))
        except KeyError as error:
            raise DataError(f"{file}: study {i + 1} has no {error}") from None
        except (TypeError, AttributeError):
            raise DataError(f"{file}: study {i + 1} is not as expected") from None
    return studies
