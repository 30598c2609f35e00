# SPDX-License-Identifier: BSD-3-Clause
"""Notes on a case or its run."""

from __future__ import annotations

from typing import Any, NamedTuple


class Note(NamedTuple):
    """What to know of a case or its run that is not refused for it."""

    kind: str  # units, resolution, physics or output; empty in folders of version 0.2
    text: str  # one line

    def __str__(self) -> str:
        return self.text


def notes_of(info: dict[str, Any]) -> list[Note]:
    """Those of run.json or sequence.json; version 0.2 has their texts alone."""
    told = info.get("notes", info.get("warnings", []))
    notes = []
    for note in told if isinstance(told, list) else []:
        table = note if isinstance(note, dict) else {"text": note}
        notes.append(Note(str(table.get("kind", "")), str(table.get("text", ""))))
    return notes
