# SPDX-License-Identifier: BSD-3-Clause
"""Snapshots of any mesh as pictures of square pixels."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from slipfront.read import Fields

LONG_SIDE = 180  # pixels
EMPTY = 255  # code of a pixel without material
WHITE = EMPTY - 1  # code of the scale's end


@dataclass(frozen=True)
class Points:
    """Points inside the cells of similar size: their pixels and the shares of their cells' nodes."""

    cells: np.ndarray  # [cells, 4]
    shares: np.ndarray  # [points of a cell, 4]
    pixels: np.ndarray  # [cells, points of a cell]


@dataclass(frozen=True)
class PixelGrid:
    """Pixels over all bodies; y = 0, the interface, is a border between two rows."""

    x_m: np.ndarray  # middles [columns]
    y_m: np.ndarray  # middles, upward [rows]
    points: list[Points]
    n_points: np.ndarray  # in each pixel, row by row

    def means(self, nodal: np.ndarray) -> np.ndarray:
        """Mean of a nodal field in each pixel, NaN where there is no material. [rows, columns]"""
        total = np.zeros(len(self.n_points))
        for points in self.points:
            values = nodal[points.cells] @ points.shares.T
            total += np.bincount(points.pixels.ravel(), values.ravel(), minlength=len(total))
        with np.errstate(invalid="ignore"):
            return (total / np.where(self.n_points > 0, self.n_points, np.nan)).reshape(
                len(self.y_m), len(self.x_m)
            )


def corner_shares(n: int) -> np.ndarray:
    """Bilinear shares of the four corners at n times n points, evenly in the cell. [points, 4]"""
    middles = (np.arange(n) + 0.5) / n
    a, b = (v.ravel() for v in np.meshgrid(middles, middles))
    return np.column_stack([(1 - a) * (1 - b), a * (1 - b), a * b, (1 - a) * b])


def pixel_grid(fields: Fields) -> PixelGrid:
    """Every cell has as many points as it takes to reach every pixel that it covers."""
    low, high = fields.points_m.min(axis=0), fields.points_m.max(axis=0)
    side_m = float(np.max(high - low)) / LONG_SIDE
    first_row = int(np.floor(low[1] / side_m + 1e-6))
    n_columns = int(np.ceil((high[0] - low[0]) / side_m - 1e-6))
    n_rows = int(np.ceil(high[1] / side_m - 1e-6)) - first_row
    corners = fields.points_m[fields.cells]
    sizes = np.max(np.ptp(corners, axis=1), axis=1) / side_m
    n_points = np.maximum(1, np.ceil(1.5 * sizes)).astype(int)  # a cell may lie askew
    found = []
    for n in np.unique(n_points):
        cells = fields.cells[n_points == n]
        shares = corner_shares(int(n))
        place = np.einsum("pk,ckd->cpd", shares, fields.points_m[cells]) / side_m
        columns = np.clip(np.floor(place[..., 0] - low[0] / side_m).astype(int), 0, n_columns - 1)
        rows = np.clip(np.floor(place[..., 1]).astype(int) - first_row, 0, n_rows - 1)
        found.append(Points(cells, shares, rows * n_columns + columns))
    counts = sum(np.bincount(p.pixels.ravel(), minlength=n_rows * n_columns) for p in found)
    return PixelGrid(
        x_m=low[0] + side_m * (np.arange(n_columns) + 0.5),
        y_m=side_m * (first_row + np.arange(n_rows) + 0.5),
        points=found,
        n_points=np.asarray(counts),
    )


def codes(values: np.ndarray, largest: float) -> np.ndarray:
    """Values of 0 to `largest` and more as 0 to WHITE on a scale of square roots; EMPTY for NaN."""
    shares = np.sqrt(np.clip(values / largest, 0, 1))
    return np.where(np.isnan(values), EMPTY, np.round(WHITE * np.nan_to_num(shares))).astype(np.uint8)
