# SPDX-License-Identifier: BSD-3-Clause
"""A sweep that is done, from sweep.json and sweep.csv: what maps and the report are drawn from."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Any

import numpy as np

from slipfront.files import DataError, Table, exists, number, read_json_table, read_table
from slipfront.folder import located, result_file
from slipfront.sweep.folder import DEFINITION
from slipfront.sweep.outcome import QUANTITIES, Quantity
from slipfront.sweep.tables import TABLE
from slipfront.sweep.values import as_array, value_of
from slipfront.sweep.work import DONE

WAVES = ("c_R", "c_S", "c_L")


@dataclass(frozen=True)
class Results:
    """The table of a sweep. `keys` are those that vary."""

    folder: Path
    definition: dict[str, Any]
    table: Table

    @property
    def keys(self) -> list[str]:
        return list(self.definition["vary"])

    @property
    def is_grid(self) -> bool:
        return bool(self.definition["combine"] == "grid")

    @property
    def quantities(self) -> list[Quantity]:
        """Those that the table has."""
        return [quantity for quantity in QUANTITIES if quantity.name in self.table.header]

    @cached_property
    def values(self) -> dict[str, np.ndarray]:
        """By key, its value at each point: numbers, or texts where one is no number. [points]"""
        return {key: as_array([value_of(text) for text in self.table.texts(key)]) for key in self.keys}

    def axis(self, key: str) -> np.ndarray:
        """Each value of a key once, in ascending order of numbers, texts in the order of the table."""
        values = self.values[key]
        if values.dtype == object:
            return np.array(list(dict.fromkeys(values)), dtype=object)
        return np.unique(values)

    @cached_property
    def waves_over_c_L(self) -> dict[str, float]:
        """The plate's wave speeds over c_L by their names, ascending; none where the material varies or no
        run is there any more to tell them."""
        if any(key.startswith("material.") for key in self.keys):
            return {}
        states = zip(self.table.texts("folder"), self.table.texts("status"), strict=True)
        files = (self.folder / place / "run.json" for place, status in states if status == DONE)
        file = next((file for file in files if exists(located(file))), None)
        if file is None:
            return {}
        info = read_json_table(result_file(file))
        speeds = [number(file, info, f"wave_speeds.{wave}_m_per_s") for wave in WAVES]
        return {wave: speed / speeds[-1] for wave, speed in zip(WAVES, speeds, strict=True)}

    def waves_of(self, quantity: Quantity) -> dict[str, float]:
        """Wave speeds to be marked in the scale of a quantity: of speeds over c_L alone."""
        return self.waves_over_c_L if quantity.name.endswith("_over_c_L") else {}

    def column(self, quantity: Quantity) -> np.ndarray:
        """Numbers, NaN where undefined; of words their place in the quantity's list, NaN without. [points]"""
        if not quantity.words:
            return self.table.numbers(quantity.name)
        places = {word: float(k) for k, word in enumerate(quantity.words)}
        return np.array([places.get(text, np.nan) for text in self.table.texts(quantity.name)])


def is_sweep(folder: Path) -> bool:
    return exists(folder / DEFINITION) and exists(located(folder / TABLE))


def read_results(folder: Path) -> Results:
    """Compared with the folder's checksums. Raises DataError."""
    if not exists(folder / DEFINITION):
        raise DataError(f"{folder}: holds no sweep")
    if not is_sweep(folder):
        raise DataError(f"{folder}: the sweep is not done; slipfront sweep --restart {folder}")
    definition = read_json_table(result_file(folder / DEFINITION))
    vary, combine = definition.get("vary"), definition.get("combine")
    if not isinstance(vary, dict) or not vary or not isinstance(combine, str):
        raise DataError(f"{folder / DEFINITION}: not the definition of a sweep")
    return Results(folder, definition, read_table(result_file(folder / TABLE)))
