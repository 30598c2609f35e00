# SPDX-License-Identifier: BSD-3-Clause
"""Where in a text of TOML its keys are. `tomllib` tells the line of a mistake in the syntax alone."""

from __future__ import annotations

import tomllib
from collections.abc import Iterator
from typing import Any


def keys_of(table: Any, before: tuple[str, ...] = ()) -> Iterator[tuple[str, ...]]:
    """Of a table and of those in it, the outer ones first."""
    if before:
        yield before
    if isinstance(table, list) and len(table) == 1:  # of [[name]]
        table = table[0]
    if isinstance(table, dict):
        for name, value in table.items():
            yield from keys_of(value, (*before, name))


def statements(text: str) -> Iterator[tuple[int, str]]:
    """First line and text of each key with its value, and of each header. A value is over where the lines so
    far are TOML by themselves: an open bracket or quotation is not."""
    begun, lines = 1, []
    for number, line in enumerate(text.split("\n"), start=1):
        lines.append(line)
        try:
            is_empty = not tomllib.loads("\n".join(lines))
        except tomllib.TOMLDecodeError:
            continue
        if not is_empty:
            yield begun, "\n".join(lines)
        begun, lines = number + 1, []


def lines_of(text: str) -> dict[str, int]:
    """The line of each dotted key of a text that is TOML."""
    found: dict[str, int] = {}
    header: tuple[str, ...] = ()
    for line, statement in statements(text):
        keys = list(keys_of(tomllib.loads(statement)))
        is_header = statement.lstrip().startswith("[")
        for key in keys:
            found.setdefault(".".join(key if is_header else header + key), line)
        if is_header:
            header = keys[-1]
    return found
