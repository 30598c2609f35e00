# SPDX-License-Identifier: BSD-3-Clause
"""Results that are changed, what commands that draw say of them, and what they draw."""

from __future__ import annotations

import json

import draw
from matplotlib.figure import Figure
from slipfront.figures.__main__ import main
from slipfront.opened import open_run


def replace(file, old, new) -> None:
    """The first of its kind."""
    text = file.read_text()
    assert old in text
    file.write_text(text.replace(old, new, 1))


def flip(file) -> None:
    """A bit of the byte in the middle."""
    data = bytearray(file.read_bytes())
    data[len(data) // 2] ^= 1
    file.write_bytes(data)


def change_json(file, change) -> None:
    """Rewrites a file after change(content)."""
    content = json.loads(file.read_text())
    change(content)
    file.write_text(json.dumps(content))


def read_run(folder):
    """A run whose files are all compared with their checksums and read."""
    return open_run(folder).checked()


def one_line(capsys) -> str:
    """The one line of an error on standard error."""
    error = capsys.readouterr().err
    assert error.count("\n") == 1
    return error


def one_error(capsys, *arguments, command=main) -> str:
    assert command([str(a) for a in arguments]) == 2
    error = one_line(capsys)
    assert error.startswith(("slipfront.figures: error: ", "draw.py: error: "))
    return error


def error_of_paper(capsys, *arguments) -> str:
    """Of the command that draws the paper's figures."""
    return one_error(capsys, *arguments, command=draw.main)


def gids(drawn, panel: int = 0) -> set[str]:
    """Names of all that is drawn in a panel, or in one of a figure's."""
    ax = drawn.axes[panel] if isinstance(drawn, Figure) else drawn
    return {a.get_gid() for a in ax.findobj() if a.get_gid()}


def artist(drawn, gid: str, panel: int = 0):
    """The one of a name."""
    ax = drawn.axes[panel] if isinstance(drawn, Figure) else drawn
    found = ax.findobj(lambda a: a.get_gid() == gid)
    assert len(found) == 1, f"{len(found)} artists named {gid}"
    return found[0]
