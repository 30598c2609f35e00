# SPDX-License-Identifier: BSD-3-Clause
"""How far a sweep is, and how long it will still take: one line that is renewed in a terminal or a notebook,
a line every tenth elsewhere."""

from __future__ import annotations

import sys
import time
from contextlib import suppress

from slipfront.sweep.needs import duration_words

RENEW_EVERY_S = 0.5
PARTS = 10


def is_in_notebook() -> bool:
    return "ipykernel" in sys.modules


class Progress:
    """Counts of `total`; `quiet` shows nothing."""

    def __init__(self, what: str, total: int, quiet: bool = False) -> None:
        self.what, self.total, self.quiet = what, total, quiet
        self.start = time.monotonic()
        self.shown_at = 0.0
        self.shown_part = 0
        self.is_renewed = is_in_notebook() or sys.stderr is not None and sys.stderr.isatty()
        self.longest = 0

    def words(self, done: int, failed: int) -> str:
        text = f"{self.what}: {done} of {self.total}"
        if failed:
            text += f", {failed} failed"
        elapsed = time.monotonic() - self.start
        if 0 < done < self.total:
            text += f", {duration_words(elapsed * (self.total - done) / done)} to go"
        elif done:
            text += f", {duration_words(elapsed)}"
        return text

    def is_due(self, done: int) -> bool:
        if done >= self.total:
            return True
        if self.is_renewed:
            return time.monotonic() - self.shown_at >= RENEW_EVERY_S
        return PARTS * done // self.total > self.shown_part

    def update(self, done: int, failed: int = 0) -> None:
        if self.quiet or not self.total or not self.is_due(done):
            return
        self.shown_at = time.monotonic()
        self.shown_part = PARTS * done // self.total
        text = self.words(done, failed)
        self.longest = max(self.longest, len(text))
        if self.is_renewed:
            self.write("\r" + text.ljust(self.longest) + ("\n" if done >= self.total else ""))
        else:
            self.write(text + "\n")

    def close(self) -> None:
        """Ends the line that was renewed."""
        if self.is_renewed and self.shown_part < PARTS and self.shown_at:
            self.write("\n")

    @staticmethod
    def write(text: str) -> None:
        with suppress(OSError, ValueError, AttributeError):  # a closed terminal ends no sweep
            sys.stderr.write(text)
            sys.stderr.flush()
