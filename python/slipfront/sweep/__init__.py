# SPDX-License-Identifier: BSD-3-Clause
"""Sweeps: a case run over values of its keys, side by side, and what came out of each run in one table.

`slipfront sweep --help` and docs/sweeps.md say how; `run` and `open_sweep` do the same in a notebook."""

from slipfront.sweep.notebook import open_sweep, run

__all__ = ["open_sweep", "run"]
