# SPDX-License-Identifier: BSD-3-Clause
"""Many cases side by side, into one folder of results that goes on where it was interrupted."""

from __future__ import annotations

import math
import os
from collections.abc import Callable, Iterable, Sequence
from pathlib import Path

from slipfront import _core
from slipfront.errors import CaseError
from slipfront.given import flag, in_order, instance, kept_path, number, refusing, text
from slipfront.measures import Arrays, history_arrays, tractions_before
from slipfront.opened_sequence import OpenSequence, open_sequence
from slipfront.running import CHECKPOINT_EVERY_S, MOST_THREADS, CaseLike, make_case, threads_of


def event_of_history(
    case: CaseLike | _core.Case,
    history: Arrays,
    tractions: Arrays | None = None,
    *,
    threshold_m_per_s: float = 1e-3,
    critical_shear_m: float = math.nan,
) -> _core.BatchEvent:
    """Fronts and onsets of any history, as of a batch's event.

    case: material, friction, event.kind with its trigger zone, and how fronts are measured. history,
    tractions, threshold_m_per_s: as for find_fronts_in_history. Contact is where p_s is above 0, its inside
    loading.edge_margin_m from the ends. Raises CaseError."""
    threshold = number(threshold_m_per_s, "threshold_m_per_s", above=0)
    shear_m = number(critical_shear_m, "critical_shear_m")
    prepared = case if isinstance(case, _core.Case) else make_case(case, None, {})
    arrays = history_arrays(history)
    before = tractions_before(arrays, tractions)
    with refusing():
        return _core.event_of_history(prepared, *arrays, *before, threshold, shear_m)


class Batch:
    """Cases run side by side, in memory; those of one plate, material, loading and mu_s share their statics.

        with slipfront.Batch("results", "mu_k from 0.4 to 1.2") as batch:
            batch.run(cases, done)
            (batch.folder / "table.csv").write_text(...)

    output: folder for the results, which come into it at the end, with a list of checksums. What was done
    before an interruption is kept, and taken when the same work is begun again by the same program.
    work: its name. threads: runs at a time, by default as many as processors; results do not depend on them.
    overwrite: replace results that the folder already holds.

    Raises CaseError, WriteError; Ctrl-C ends the runs under way with a KeyboardInterrupt."""

    def __init__(
        self,
        output: str | os.PathLike[str],
        work: str,
        *,
        threads: int | None = None,
        overwrite: bool = False,
    ) -> None:
        self._threads = threads_of(threads) or min(os.cpu_count() or 1, MOST_THREADS)
        self._folder = _core.ResultFolder(kept_path(output, "output"), text(work, "work"))
        self._folder.require_empty(flag(overwrite, "overwrite"), True)
        self._folder.begin_or_resume()
        self._batch = _core.Batch(self._threads, self._folder.state / "runs")

    def __enter__(self) -> Batch:
        return self

    def __exit__(self, kind: type[BaseException] | None, *_: object) -> None:
        if kind is None:
            self._folder.publish()
        elif issubclass(kind, CaseError):
            self._folder.abandon()
        del self._folder  # its lock goes

    @property
    def folder(self) -> Path:
        """Where files of the results are to be written meanwhile."""
        return self._folder.unfinished

    @property
    def n_runs(self) -> int:
        """Runs that are done."""
        return self._batch.n_runs

    @property
    def n_quiet(self) -> int:
        """Of them, those that ended before time.end_s since nothing moved."""
        return self._batch.n_quiet

    def run(
        self,
        cases: Iterable[_core.Case],
        done: Callable[[int, _core.BatchEvent], object],
        *,
        names: Sequence[str] | None = None,
    ) -> None:
        """Runs cases, see slipfront.case.

        done: called with the index of each case as it is done, and what came out; what it raises ends the
        batch. A case with snapshots is run again after an interruption.
        names: of a folder in `folder` for the files of each run; without them there are none."""
        given = [
            instance(each, _core.Case, "one of cases")
            for each in in_order(cases, "cases", "a list of slipfront.case")
        ]
        folders = [None] * len(given) if names is None else [self.folder / name for name in names]
        if len(folders) != len(given):
            raise CaseError(f"names has {len(folders)} entries, cases {len(given)}")
        self._batch.run(given, folders, done)

    def run_sequence(self, case: _core.Case, name: str) -> OpenSequence:
        """Runs a sequence of events into a folder in `folder`. It has all threads."""
        to, every_s = self.folder / name, CHECKPOINT_EVERY_S
        case.run(to, True, self._threads, every_s, None, [], within=self._folder)
        return open_sequence(to)
