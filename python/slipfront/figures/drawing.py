# SPDX-License-Identifier: BSD-3-Clause
from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

from matplotlib.figure import Figure


@dataclass(frozen=True)
class Drawing:
    """A finished figure; its name is that of its files, its caption a piece of HTML."""

    name: str
    figure: Figure
    caption: str

    def save(self, folder: Path) -> None:
        # Without the date, the same results give the same files.
        self.figure.savefig(folder / f"{self.name}.png", metadata={"Software": None})
        self.figure.set_layout_engine("none")  # the layout is found; once is enough
        self.figure.savefig(folder / f"{self.name}.pdf", metadata={"CreationDate": None})
