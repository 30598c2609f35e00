# SPDX-License-Identifier: BSD-3-Clause
"""Speed of the particles in a run's snapshots, of both bodies where there are two.

usage: python -m slipfront.figures.fields PICTURE DIR, output folder of `slipfront run` with snapshots;
a PICTURE that ends with .gif or .mp4 is an animation of all of them"""

from __future__ import annotations

import sys
from io import BytesIO
from pathlib import Path
from typing import Any

import matplotlib
import numpy as np
from matplotlib.axes import Axes
from matplotlib.cm import ScalarMappable
from matplotlib.colors import PowerNorm
from matplotlib.tri import Triangulation
from PIL import Image

from slipfront import command
from slipfront.figures import style
from slipfront.figures.drawing import ENDINGS, Drawing, command_to_draw, guarded, write_results
from slipfront.files import DataError
from slipfront.folder import belongs
from slipfront.read import Fields, read_fields

MOST_PANELS = 6
COLOURS = "magma"
FRAME_MS = 120
FRAME_DPI = 110


def triangles(fields: Fields) -> Triangulation:
    """Every cell as two triangles; lengths in mm."""
    halves = np.concatenate([fields.cells[:, [0, 1, 2]], fields.cells[:, [0, 2, 3]]])
    x_mm, y_mm = style.mm(fields.points_m).T
    return Triangulation(x_mm, y_mm, halves)


def largest_speed(fields: Fields, steps: list[int]) -> float:
    """All but the fastest thousandth of the nodes are below it in every step."""
    return max(float(np.quantile(fields.speed_m_per_s(step), 0.999)) for step in steps)


def draw_step(ax: Axes, grid: Triangulation, fields: Fields, step: int, norm: PowerNorm) -> ScalarMappable:
    """One snapshot; the interface is a white line where a body lies below it; returns the picture."""
    picture = ax.tripcolor(
        grid,
        fields.speed_m_per_s(step),
        norm=norm,
        cmap=COLOURS,
        shading="gouraud",
        rasterized=True,
        gid=f"step:{step}",
    )
    low, high = fields.points_m.min(axis=0), fields.points_m.max(axis=0)
    if low[1] < 0:
        ax.axhline(0, color="white", linewidth=0.4, gid="interface")
    ax.set(
        xlim=style.mm([low[0], high[0]]), ylim=style.mm([low[1], high[1]]), aspect="equal", ylabel="$y$ (mm)"
    )
    ax.set_title(f"$t$ = {1e6 * fields.time_s[step]:.3g} µs", loc="left", pad=2)
    ax.locator_params(nbins=4)
    return picture


def chosen_steps(n_steps: int) -> list[int]:
    """At most MOST_PANELS of the steps, evenly, the last one among them."""
    return sorted({round(k) for k in np.linspace(0, n_steps - 1, min(n_steps, MOST_PANELS))})


def read(folder: Path) -> Fields:
    if not belongs(folder / "fields.vtkhdf"):
        raise DataError(f"{folder}: holds no snapshots (fields.vtkhdf); run with output.snapshot_times_s")
    fields = read_fields(folder / "fields.vtkhdf")
    if len(fields.time_s) == 0:
        raise DataError(f"{fields.file}: holds no snapshot")
    return fields


def panel_height_mm(fields: Fields, width_mm: float) -> float:
    size = np.ptp(fields.points_m, axis=0)
    return width_mm * size[1] / size[0] + 9


def draw(folder: Path) -> Drawing:
    """The snapshots side by side, with one scale of colours."""
    fields = read(folder)
    steps = chosen_steps(len(fields.time_s))
    columns = min(2, len(steps))
    rows = -(-len(steps) // columns)
    height = min(220.0, rows * panel_height_mm(fields, 0.42 * style.PAGE_MM) + 10)
    figure = style.new_figure(style.PAGE_MM, height)
    axes = figure.subplots(rows, columns, squeeze=False, sharex=True, sharey=True)
    norm = PowerNorm(0.5, 0, largest_speed(fields, steps) or 1.0)
    grid = triangles(fields)
    for ax, step in zip(axes.flat, steps, strict=False):
        picture = draw_step(ax, grid, fields, step, norm)
    for ax in axes.flat[len(steps) :]:
        ax.axis("off")
    for ax in axes[-1]:
        ax.set_xlabel("$x$ (mm)")
    bar = figure.colorbar(picture, ax=axes, shrink=0.6, pad=0.02)
    bar.set_label("speed of the particles (m/s)")
    return Drawing(
        "fields", figure, "Speed of the particles, above the interface and, where a body is there, below it."
    )


def frames(folder: Path) -> list[Image.Image]:
    """A picture per snapshot, all of one size."""
    fields = read(folder)
    steps = list(range(len(fields.time_s)))
    norm = PowerNorm(0.5, 0, largest_speed(fields, steps) or 1.0)
    grid = triangles(fields)
    pictures = []
    for step in steps:
        figure = style.new_figure(style.TEXT_MM, panel_height_mm(fields, 0.75 * style.TEXT_MM) + 10)
        ax = figure.subplots()
        bar = figure.colorbar(draw_step(ax, grid, fields, step, norm), ax=ax, shrink=0.8)
        bar.set_label("speed (m/s)")
        ax.set_xlabel("$x$ (mm)")
        picture = BytesIO()
        figure.savefig(picture, format="png", dpi=FRAME_DPI)
        pictures.append(Image.open(picture).convert("RGB"))
    return pictures


def as_gif(pictures: list[Image.Image], file: Path) -> None:
    pictures[0].save(file, format="GIF", save_all=True, append_images=pictures[1:], duration=FRAME_MS, loop=0)


def encoder() -> Any:
    """The package that brings ffmpeg."""
    try:
        import imageio_ffmpeg
    except ModuleNotFoundError:
        raise DataError(
            "an MP4 needs the Python package imageio-ffmpeg: install it with "
            f"'{sys.executable} -m pip install imageio-ffmpeg', or write a .gif"
        ) from None
    return imageio_ffmpeg


def as_mp4(pictures: list[Image.Image], file: Path) -> None:
    """H.264 with colours that every player knows, which takes even numbers of pixels."""
    width, height = (n - n % 2 for n in pictures[0].size)
    # Without the encoder's name the same snapshots give the same file.
    out = encoder().write_frames(
        str(file),
        (width, height),
        fps=1000 / FRAME_MS,
        codec="libx264",
        quality=8,
        macro_block_size=2,
        output_params=["-fflags", "+bitexact", "-flags:v", "+bitexact", "-movflags", "+faststart"],
    )
    out.send(None)
    for picture in pictures:
        out.send(picture.crop((0, 0, width, height)).tobytes())
    out.close()
    if not file.is_file() or file.stat().st_size == 0:
        raise DataError("ffmpeg has written no film")


ANIMATIONS = {".gif": as_gif, ".mp4": as_mp4}


def write(picture: Path, folder: Path) -> list[str]:
    kind = picture.suffix.lower()
    if kind in ENDINGS:
        return write_results(picture, folder, draw)
    if kind not in ANIMATIONS:
        raise DataError(f"{picture}: the picture's name must end with {', '.join(ENDINGS)}, .gif or .mp4")
    command.replaceable(picture)
    if kind == ".mp4":
        encoder()  # what lacks is told before the drawing
    with matplotlib.rc_context(style.RC):
        pictures = guarded(folder, lambda: frames(folder))
    with command.publishing_into(picture.parent) as made:
        guarded(folder, lambda: ANIMATIONS[kind](pictures, made / picture.name))
    return [f"animation: {picture}"]


main = command_to_draw(
    "slipfront.figures.fields",
    "Draws the speed of the particles in a run's snapshots; into a .gif or .mp4 as an animation.",
    "`slipfront run` with snapshots",
    write,
    kinds=".png, .pdf, .svg, .gif or .mp4",
)


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
