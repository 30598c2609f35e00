# SPDX-License-Identifier: BSD-3-Clause
"""Finished figures and how they become files."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import partial
from io import BytesIO
from pathlib import Path
from typing import Any, TypeVar

from matplotlib.figure import Figure

from slipfront.files import DataError, one_line

MARK_COLOUR = "#b2182b"
Drawn = TypeVar("Drawn")
#: Kinds of pictures, each with the entry without which the same figure gives the same file.
WITHOUT_DATE: dict[str, dict[str, str | None]] = {
    "png": {"Software": None},
    "pdf": {"CreationDate": None},
    "svg": {"Date": None},
}


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

    def rendered(self, kind: str, **metadata: str | None) -> bytes:
        stream = BytesIO()
        tight = "tight" if self.mark else None  # the mark is outside the frame
        self.figure.savefig(stream, format=kind, metadata=metadata, bbox_inches=tight)
        return stream.getvalue()

    def save(self, folder: Path, kinds: Sequence[str] = ("png", "pdf")) -> None:
        """Writes a file of each kind, all or none."""
        pictures = {}
        for kind in kinds:
            file = folder / f"{self.name}.{kind}"
            pictures[file] = guarded(file, partial(self.rendered, kind, **WITHOUT_DATE[kind]))
            self.figure.set_layout_engine("none")  # the layout is found; once is enough
        for file, picture in pictures.items():
            file.write_bytes(picture)


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
