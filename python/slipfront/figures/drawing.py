# SPDX-License-Identifier: BSD-3-Clause
"""Finished figures and how they become files: whole or not at all, the same bytes from the same results."""

from __future__ import annotations

import argparse
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from io import BytesIO
from pathlib import Path
from typing import Any, TypeVar

import matplotlib
from matplotlib.figure import Figure

from slipfront import command
from slipfront.figures.style import RC
from slipfront.files import DataError, one_line, open_file

MARK_COLOUR = "#b2182b"
Drawn = TypeVar("Drawn")
#: Kinds of pictures, each with the entry without which the same figure gives the same file.
KINDS: dict[str, dict[str, str | None]] = {
    "png": {"Software": None},
    "pdf": {"CreationDate": None},
    "svg": {"Date": None},
}
ENDINGS = [f".{kind}" for kind in KINDS]
BEGINNINGS = (b"\x89PNG", b"%PDF", b"<?xml", b"<svg")  # of their files


@dataclass(frozen=True)
class Drawing:
    """A finished figure; its name is that of its files, its caption a piece of HTML."""

    name: str
    figure: Figure
    caption: str
    mark: str = ""  # what the whole figure is not to be taken without, such as an interrupted run

    def marked(self, mark: str) -> Drawing:
        """The same with a title above all else, outside the figure's own frame."""
        if not mark:
            return self
        lines = "\n".join(map(plain, mark.split("\n")))
        look: dict[str, Any] = {"ha": "center", "va": "bottom", "color": MARK_COLOUR, "fontweight": "bold"}
        self.figure.text(0.5, 1.01, lines, gid="mark", **look)
        return replace(self, mark=mark)

    def rendered(self, kind: str) -> bytes:
        """The file of a kind."""
        stream = BytesIO()
        tight = "tight" if self.mark else None  # the mark is outside the frame
        # The names of an SVG's parts are random otherwise.
        with matplotlib.rc_context({"svg.hashsalt": "slipfront"}):
            self.figure.savefig(stream, format=kind, metadata=KINDS[kind], bbox_inches=tight)
        return stream.getvalue()

    def save(self, folder: Path, kinds: Sequence[str] = ("png", "pdf")) -> None:
        """Writes a file of each kind, all or none."""
        pictures = {}
        for kind in kinds:
            file = folder / f"{self.name}.{kind}"
            pictures[file] = self.guarded_rendering(file, kind)
            self.figure.set_layout_engine("none")  # the layout is found; once is enough
        for file, picture in pictures.items():
            file.write_bytes(picture)

    def guarded_rendering(self, file: Path, kind: str) -> bytes:
        return guarded(file, lambda: self.rendered(kind))


def plain(text: str) -> str:
    """Text of a case or a folder's name: no formula, one line."""
    return one_line(text).replace("$", r"\$")


def guarded(source: Path, draw: Callable[[], Drawn]) -> Drawn:
    """What `draw` returns; Matplotlib and NumPy refuse absurd numbers with exceptions of many kinds."""
    try:
        return draw()
    except (DataError, OSError):
        raise
    except Exception as error:
        text = one_line(str(error)) or type(error).__name__
        raise DataError(f"{source}: cannot be drawn from these numbers: {text}") from None


def checked(picture: Path) -> Path:
    """The path, unless it does not name a picture, or names what is no regular file."""
    if picture.suffix.lower() not in ENDINGS:
        raise DataError(f"{picture}: the picture's name must end with {', '.join(ENDINGS)}")
    if command.replaceable(picture).exists() and picture.stat().st_size > 0:
        with open_file(picture) as stream:
            beginning = stream.read(len(max(BEGINNINGS, key=len)))
        if not beginning.startswith(BEGINNINGS):
            raise DataError(f"{picture}: is there and no picture: not replaced; give another name")
    return picture


def write_drawing(picture: Path, drawing: Drawing) -> None:
    """Writes a picture whose kind its name's ending tells."""
    image = drawing.guarded_rendering(picture, checked(picture).suffix.lower()[1:])
    with command.publishing_into(picture.parent) as folder:
        (folder / picture.name).write_bytes(image)


def write_figure(picture: Path, figure: Figure) -> None:
    """The same of a figure of Matplotlib."""
    write_drawing(picture, Drawing(picture.stem, figure, ""))


def write_results(picture: Path, folder: Path, draw: Callable[[Path], Drawing]) -> list[str]:
    """Draws a folder of results in the style of all figures; returns what to print.

    A path that is refused is so before the drawing."""
    checked(picture)
    with matplotlib.rc_context(RC):
        write_drawing(picture, guarded(folder, lambda: draw(folder)))
    return [f"figure: {picture}"]


def list_of(kinds: Sequence[str]) -> str:
    """Kinds of pictures in words."""
    return " and ".join(kind.upper() for kind in kinds)


def parser_of_kinds(prog: str, purpose: str, results: str) -> argparse.ArgumentParser:
    """Of a command that draws a folder of results into its folder figures."""
    parser = argparse.ArgumentParser(prog=prog, description=purpose)
    parser.add_argument("dir", metavar="DIR", type=Path, help=f"output folder of {results}")
    kinds = "kind of the pictures, may be given more than once (default: png and pdf)"
    parser.add_argument("--format", choices=KINDS, action="append", help=kinds)
    return parser


def kinds_of(options: argparse.Namespace) -> tuple[str, ...]:
    """Those that such a command is to draw, each once."""
    return tuple(dict.fromkeys(options.format or ("png", "pdf")))


def command_to_draw(
    module: str,
    purpose: str,
    results: str,
    write: Callable[[Path, Any], list[str]],
    kinds: str = ".png, .pdf or .svg",
    several: bool = False,
) -> Callable[[list[str] | None], int]:
    """The `main` of a module that writes the picture of a folder of results, or of a list of several."""

    def main(arguments: list[str] | None = None) -> int:
        parser = argparse.ArgumentParser(prog=f"python -m {module}", description=purpose)
        parser.add_argument("picture", metavar="PICTURE", type=Path, help=f"the file to write: {kinds}")
        nargs = "+" if several else None
        what = f"output folder of {results}"
        parser.add_argument("folder", metavar="DIR", type=Path, nargs=nargs, help=what)
        options = parser.parse_args(arguments)
        return command.run("slipfront.figures", lambda: write(options.picture, options.folder))

    return main
