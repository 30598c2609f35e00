# SPDX-License-Identifier: BSD-3-Clause
"""A picture in a file that the caller names."""

from __future__ import annotations

import argparse
from collections.abc import Callable
from pathlib import Path
from typing import Any

import matplotlib
from matplotlib.figure import Figure

from slipfront import command
from slipfront.figures.drawing import WITHOUT_DATE, Drawing, guarded
from slipfront.figures.style import RC
from slipfront.files import DataError

#: By the ending of a picture's name.
KINDS = {f".{kind}": without for kind, without in WITHOUT_DATE.items()}
FIXED_NAMES: dict[Any, Any] = {
    "svg.hashsalt": "slipfront"
}  # of the parts of an SVG, which are random otherwise


def checked(picture: Path) -> Path:
    """The path, unless it does not name a picture, or names what is no regular file."""
    if picture.suffix.lower() not in KINDS:
        raise DataError(f"{picture}: the picture's name must end with {', '.join(KINDS)}")
    return command.replaceable(picture)


def write_drawing(picture: Path, drawing: Drawing) -> None:
    """Writes the picture, whole or not at all."""
    kind = checked(picture).suffix.lower()
    with matplotlib.rc_context(FIXED_NAMES):
        image = guarded(picture, lambda: drawing.rendered(kind[1:], **KINDS[kind]))
    with command.publishing_into(picture.parent) as folder:
        (folder / picture.name).write_bytes(image)


def write_figure(picture: Path, figure: Figure) -> None:
    write_drawing(picture, Drawing(picture.stem, figure, ""))


def write_picture(picture: Path, draw: Callable[[], Drawing]) -> list[str]:
    """Draws and writes it; a path that is refused is so before the drawing. Returns what to print."""
    checked(picture)
    write_drawing(picture, draw())
    return [f"figure: {picture}"]


def write_results(picture: Path, folder: Path, draw: Callable[[Path], Drawing]) -> list[str]:
    """Draws a folder of results in the style of all figures; returns what to print."""
    with matplotlib.rc_context(RC):
        return write_picture(picture, lambda: guarded(folder, lambda: draw(folder)))


def command_to_draw(
    module: str,
    purpose: str,
    results: str,
    write: Callable[[Path, Any], list[str]],
    arguments: list[str] | None,
    kinds: str = ".png, .pdf or .svg",
    several: bool = False,
) -> int:
    """Exit code of a module that writes the picture of a folder of results, or of a list of several."""
    parser = argparse.ArgumentParser(prog=f"python -m {module}", description=purpose)
    parser.add_argument("picture", metavar="PICTURE", type=Path, help=f"the file to write: {kinds}")
    nargs = "+" if several else None
    parser.add_argument("folder", metavar="DIR", type=Path, nargs=nargs, help=f"output folder of {results}")
    options = parser.parse_args(arguments)
    return command.run("slipfront.figures", lambda: write(options.picture, options.folder))
