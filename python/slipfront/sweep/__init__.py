# SPDX-License-Identifier: BSD-3-Clause
"""Sweeps: a case run over values of its keys, side by side, and what came out of each run in one table.

`slipfront sweep --help` and docs/sweeps.md say how; `run` and `open_sweep` do the same in a notebook."""

from __future__ import annotations

from slipfront.sweep.notebook import open_sweep, run

__all__ = ["main", "open_sweep", "run"]


def main(arguments: list[str]) -> int:
    """Exit code of `slipfront sweep`: 0 done, 1 some points failed, 2 refused, 130 interrupted."""
    from slipfront.sweep.command import main as command

    return command(arguments)
