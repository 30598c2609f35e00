# SPDX-License-Identifier: BSD-3-Clause
"""Results that are changed, and what `python -m slipfront.figures` says of them."""

from __future__ import annotations

from slipfront.figures.__main__ import main


def replace(file, old, new) -> None:
    """The first of its kind."""
    text = file.read_text()
    assert old in text
    file.write_text(text.replace(old, new, 1))


def one_error(capsys, *arguments) -> str:
    assert main([str(a) for a in arguments]) == 2
    error = capsys.readouterr().err
    assert error.count("\n") == 1 and error.startswith("slipfront.figures: error: ")
    return error
