# SPDX-License-Identifier: BSD-3-Clause
"""Cases run from Python."""

from __future__ import annotations

import json
import math
import os
import re
import shutil
import sys
from collections.abc import Callable, Iterable, Iterator, Mapping
from pathlib import Path
from tempfile import mkdtemp
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

import slipfront.printed  # noqa: F401
from slipfront import _core
from slipfront.errors import BlowUpError, CaseError, WriteError
from slipfront.given import array, flag, in_order, kept_path, number, path, shown, table, text, whole
from slipfront.opened import Kept, OpenRun
from slipfront.opened_sequence import OpenSequence, opened
from slipfront.read import HISTORY_FIELDS

# A path, the text of a case file, or its tables as dictionaries.
CaseLike = str | os.PathLike[str] | Mapping[str, Any]
# Called at times with the part ("ramp", "event"; "event 1", ... of a sequence), steps done and their total.
Progress = Callable[[str, int, int], None]
# An interval of simulated time, s, and a function that is shown the interface at it.
Observer = tuple[float, Callable[[_core.InterfaceState], str | None]]

DEFAULT_MATERIAL = {"plane": "stress"}  # a case sets at least one key
LARGEST_INTEGER = 2**63  # of TOML
MOST_THREADS = 1024
CHECKPOINT_EVERY_S = 300.0


def toml_text(value: Any, key: str = "value") -> str:
    """A value as TOML."""
    if hasattr(value, "__array__"):  # NumPy's numbers and arrays, and what becomes one
        value = np.asarray(value).tolist()
    if isinstance(value, bool):
        return str(value).lower()
    if isinstance(value, float) or isinstance(value, int) and abs(value) < LARGEST_INTEGER:
        return repr(value)
    if isinstance(value, str | os.PathLike):
        return json.dumps(text(os.fsdecode(value), key), ensure_ascii=False).replace("\x7f", "\\u007f")
    if isinstance(value, list | tuple):
        return "[" + ", ".join(toml_text(each, key) for each in value) + "]"
    what = "no value of a case file: give a number, text, True, False or a list"
    raise CaseError(f"{key} is {shown(value)}: {what}")


def flattened(given: Mapping[str, Any], before: str = "") -> Iterator[tuple[str, str]]:
    """Pairs of dotted key and TOML text."""
    for name, value in given.items():
        key = before + text(name, "a key")
        if isinstance(value, Mapping) and value:
            yield from flattened(value, f"{key}.")
        else:
            yield key, "{}" if isinstance(value, Mapping) else toml_text(value, key)


def without_conflicts(pairs: Iterable[tuple[str, str]]) -> list[tuple[str, str]]:
    """Refuses two values of one key."""
    keys: dict[str, str] = {}
    for key, value in pairs:
        if keys.setdefault(key, value) != value:
            raise CaseError(f"{key} is given as {shown(keys[key])} and as {shown(value)}; keep one")
    return list(keys.items())


def working_folder() -> Path:
    """Paths in a case that is no file count from it."""
    try:
        return Path.cwd()
    except OSError as error:
        raise CaseError(f"case: the working folder is gone ({error.strerror})") from None


def temporary_folder() -> Path:
    try:
        return Path(mkdtemp(prefix="slipfront-"))
    except OSError as error:
        raise WriteError(f"temporary folder: {error.strerror}; name a folder by `output`") from None


def make_case(case: CaseLike, changes: Mapping[str, Any] | None, tables: Mapping[str, Any]) -> _core.Case:
    """The case with its changes, checked."""
    try:
        given = {} if changes is None else table(changes, "changes")
        pairs = without_conflicts([*flattened(given), *flattened(tables)])
        keys = [*without_conflicts(flattened(case)), *pairs] if isinstance(case, Mapping) else []
    except RecursionError:
        raise CaseError("case: nested too deeply") from None
    if isinstance(case, Mapping):
        return _core.Case.from_text("", "case", working_folder(), keys)
    if isinstance(case, str) and "\n" in case:
        return _core.Case.from_text(text(case, "case"), "case", working_folder(), pairs)
    if not isinstance(case, str | os.PathLike):
        what = "a path, the text of a case file or a dictionary of its tables"
        raise CaseError(f"case is {shown(case)}; it must be {what}")
    return _core.Case(path(case, "case"), pairs)


def version() -> str:
    """Version and commit that the compiled module was built from."""
    return _core.version()


def case(case: CaseLike, changes: Mapping[str, Any] | None = None, /, **tables: Any) -> _core.Case:
    """A case with its changes, given as for `run`, checked as far as its keys tell; `toml` has every key."""
    return make_case(case, changes, tables)


class Bar:
    """Progress on a terminal or in a notebook; nothing elsewhere, or where tqdm is not installed."""

    def __init__(self) -> None:
        self.bar: Any = None
        self.part = ""

    def __call__(self, part: str, step: int, total: int) -> None:
        if part != self.part:
            self.close()
            self.part = part
            self.bar = self.make(part, total)
        if self.bar is not None:
            self.bar.update(step - self.bar.n)

    @staticmethod
    def make(part: str, total: int) -> Any:
        if "ipykernel" not in sys.modules and not (sys.stderr and sys.stderr.isatty()):
            return None
        try:
            from tqdm.auto import tqdm
        except ImportError:
            return None
        return tqdm(total=total, desc=part, unit="step", leave=False)

    def close(self) -> None:
        if self.bar is not None:
            self.bar.close()
            self.bar = None


def compute(work: Callable[[Progress | None], None], progress: bool | Progress) -> None:
    """Does work that tells its progress."""
    if callable(progress):
        work(progress)
        return
    if not flag(progress, "progress"):
        work(None)
        return
    bar = Bar()
    try:
        work(bar)
    finally:
        bar.close()


def threads_of(threads: int | None) -> int | None:
    return None if threads is None else whole(threads, "threads", least=1, most=MOST_THREADS)


def observers_of(observers: Iterable[Observer]) -> list[Observer]:
    """Checked."""
    pairs: list[Observer] = []
    for each in in_order(observers, "observers", "a list of pairs of an interval, s, and a function"):
        if not isinstance(each, tuple | list) or len(each) != 2 or not callable(each[1]):
            raise CaseError(f"observers has {shown(each)}; give pairs of an interval, s, and a function")
        pairs.append((number(each[0], "the interval of an observer", least=0), each[1]))
    return pairs


def run(
    case: CaseLike,
    changes: Mapping[str, Any] | None = None,
    /,
    *,
    output: str | os.PathLike[str] | None = None,
    overwrite: bool = False,
    threads: int | None = None,
    checkpoint_every_s: float = CHECKPOINT_EVERY_S,
    progress: bool | Progress = True,
    observers: Iterable[Observer] = (),
    **tables: Any,
) -> OpenRun | OpenSequence:
    """Runs a case: statics, event, fronts; or a sequence of events. The results are those of `slipfront run`,
    bit for bit.

    case: path of a case file, text of one (of more than one line), or a dictionary of its tables.
    changes, tables: keys to set as with --set, {"friction.mu_k": 0.8} or friction={"mu_k": 0.8}; SI units.
    Keys of the table [output] are given dotted.
    output: folder for the results. Without one they are kept until the returned object and all that was
    read from it are gone; an interrupted or blown-up run stays where its message says.
    overwrite: replace results that the folder already holds.
    threads: of this run; the results do not depend on them.
    checkpoint_every_s: wall time between checkpoints, s.
    progress: a bar on terminals and in notebooks, or a function that is called with part ("ramp", "event", of
    a sequence "event 1", ...), steps done and their total; what it raises ends the run.
    observers: pairs of an interval of simulated time, s, and a function. It is called between steps of the
    event, or of each, with an `InterfaceState`: of time 0, and of the first step at or after each multiple of
    the interval. A text that it returns ends the event, as the reason. What it raises ends the run; a
    checkpoint is kept, and `resume` goes on behind the state that was shown last.

    Other Python threads go on meanwhile. Ctrl-C ends the run within a few steps with a KeyboardInterrupt; its
    checkpoint is kept, and `resume` goes on from there.

    Raises CaseError (a ValueError), BlowUpError, WriteError, MemoryError."""
    if isinstance(output, Mapping):
        raise CaseError(
            'output is the folder; give keys of [output] dotted, as {"output.snapshot_times_s": [...]}'
        )
    prepared = make_case(case, changes, tables)
    replace, n_threads = flag(overwrite, "overwrite"), threads_of(threads)
    every_s = number(checkpoint_every_s, "checkpoint_every_s", least=0)
    called = observers_of(observers)

    def work(folder: Path) -> None:
        compute(lambda show: prepared.run(folder, replace, n_threads, every_s, show, called), progress)

    if output is not None:
        folder = kept_path(output, "output")
        work(folder)
        return opened(folder)
    folder = temporary_folder()
    try:
        work(folder)
        return opened(folder, Kept(folder))
    except (KeyboardInterrupt, BlowUpError):
        raise  # the message names the folder
    except BaseException:
        shutil.rmtree(folder, ignore_errors=True)
        raise


def resume(
    output: str | os.PathLike[str],
    case: CaseLike | None = None,
    *,
    threads: int | None = None,
    checkpoint_every_s: float = CHECKPOINT_EVERY_S,
    progress: bool | Progress = True,
    observers: Iterable[Observer] = (),
) -> OpenRun | OpenSequence:
    """Goes on with a run or a sequence that was left unfinished in a folder, as if it had never stopped: bit
    for bit.

    case: that of the run, to be compared with it; or a sequence that is complete goes on where its last event
    has left it, by the same case with more sequence.max_events, a later sequence.end_s, or longer
    sequence.times_s and shears_m. Its results stay in the folder until it is complete again.
    observers: those of `run`, or others.

    A run that is complete is opened. Raises as `run` does."""
    folder, n_threads = kept_path(output, "output"), threads_of(threads)
    every_s = number(checkpoint_every_s, "checkpoint_every_s", least=0)
    called = observers_of(observers)
    given = None if case is None else make_case(case, None, {})
    compute(lambda show: _core.resume(folder, given, n_threads, every_s, show, called), progress)
    return opened(folder)


Law = Callable[..., ArrayLike]


def checked_at_nodes(given: ArrayLike, name: str, least: float, like: np.ndarray) -> np.ndarray:
    """What a function of a law gives, a value for each node."""
    values = array(given, name)
    if len(values) not in (1, len(like)):
        raise CaseError(f"{name} has {len(values)} values, not {len(like)}")
    if not (np.isfinite(values) & (values >= least)).all():
        raise CaseError(f"{name} gives a value that is {'below 0 or ' if least == 0 else ''}not finite")
    return np.ascontiguousarray(np.broadcast_to(values, like.shape))


def checked_mu(mu: Law) -> Callable[..., np.ndarray]:
    """The function, with what it gives checked."""
    if not callable(mu):
        raise CaseError(f"mu is {shown(mu)}; it must be a function of slip rates and slip paths")

    def of_arrays(speed_m_per_s: np.ndarray, *slip_or_states: np.ndarray) -> np.ndarray:
        return checked_at_nodes(mu(speed_m_per_s, *slip_or_states), "mu", 0, speed_m_per_s)

    return of_arrays


def coefficient_at_rest(mu: Law) -> float:
    return float(np.ravel(mu(np.zeros(1), np.zeros(1)))[0])


def checked_law(mu: Law) -> tuple[Callable[..., np.ndarray], float]:
    """The function of an Interface, checked, and its coefficient at rest."""
    of_arrays = checked_mu(mu)
    return of_arrays, coefficient_at_rest(of_arrays)


def run_with_law(
    case: CaseLike,
    mu: Law,
    changes: Mapping[str, Any] | None = None,
    /,
    *,
    evolve: Callable[..., ArrayLike | tuple[ArrayLike, ...]] | None = None,
    initial: Callable[[np.ndarray, np.ndarray], ArrayLike | tuple[ArrayLike, ...]] | None = None,
    states: Mapping[str, str] | None = None,
    progress: bool | Progress = True,
    **tables: Any,
) -> OpenRun | OpenSequence:
    """Runs a case, or a sequence, with a friction law in Python, to try laws out: slow, and right.

    mu: called with slip rates |v|, m/s, and slip paths, m, both [nodes]; returns the friction coefficient
    [nodes]. Called up to five times for each (sub-)step, since the rate at its end depends on mu.

    evolve: of a law with states, which never sticks, in the place of a law of rate and state, which the case
    has. evolve(dt_s, slip_rate, *states) returns the states after a time at these slip rates, however short
    or long: an array, or a tuple of as many as there are states. mu(slip_rate, *states) rises with the slip
    rate and is odd in it, so that it is asked for above 0 alone. Each node is solved for its slip rate; mu is
    called some 10 times. States are those of the case's law, and begin as its.

    states, initial: states of its own instead, names as they are to have in results, with their units, and
    initial(t_Pa, p_Pa), which returns them at nodes before the event; where t_Pa or p_Pa is 0 those of steady
    sliding at the case's V_i_m_per_s.

    The case's own law still gives the coefficient before slip, which statics and fronts take: mu(0, 0) must
    be equal to it; that of weakened nodes; and, with states, thresholds and accuracies: let it have a like a
    and d_c. Case and changes as for `run`. The run takes one thread. Its files name the case's own law, so
    that they cannot be kept in a folder or gone on with: they go with the returned object. Raises what `mu`
    raises, CaseError where it gives no number or one below 0, and as `run` does."""
    for name in ("observers", "output"):
        if callable(tables.get(name)) or isinstance(tables.get(name), (list, tuple, str)):
            raise CaseError(f"run_with_law takes no {name}: results go with the returned object")
    prepared = make_case(case, changes, tables)
    if evolve is not None and not callable(evolve):
        raise CaseError(f"evolve is {shown(evolve)}; it must be a function of a time, slip rates and states")
    if (initial is None) != (states is None) or (initial is not None and evolve is None):
        raise CaseError("states of a law's own need evolve, states and initial; give all of them")
    if states is not None and not isinstance(states, Mapping):
        raise CaseError(f"states is {shown(states)}; it must be units by names, such as {{'psi_1': '1'}}")
    if initial is not None and not callable(initial):
        raise CaseError(f"initial is {shown(initial)}; it must be a function of t_Pa and p_Pa")
    for name in states or ():
        if not re.fullmatch("[A-Za-z][A-Za-z0-9_]*", name) or name in (*HISTORY_FIELDS, "time_s", "x_m"):
            raise CaseError(f"states: {shown(name)} cannot be a state's name in results; choose another one")
    of_arrays = checked_mu(mu)

    def states_of(given: Any, name: str, n_states: int, like: np.ndarray) -> list[np.ndarray]:
        values = given if isinstance(given, tuple) else (given,)
        if len(values) != n_states:
            found = f"{len(values)} states" if isinstance(given, tuple) else f"one {type(given).__name__}"
            raise CaseError(f"{name} returns {found}; it must be a tuple of {n_states} states")
        return [checked_at_nodes(value, name, -math.inf, like) for value in values]

    def after(dt_s: float, speed_m_per_s: np.ndarray, *now: np.ndarray) -> list[np.ndarray]:
        assert evolve is not None
        return states_of(evolve(dt_s, speed_m_per_s, *now), "evolve", len(now), speed_m_per_s)

    def first(t_Pa: np.ndarray, p_Pa: np.ndarray) -> list[np.ndarray]:
        assert initial is not None and states is not None
        return states_of(initial(t_Pa, p_Pa), "initial", len(states), t_Pa)

    if evolve is None:
        at_rest = coefficient_at_rest(of_arrays)
        expected = prepared.static_coefficient
        if not math.isclose(at_rest, expected, rel_tol=1e-12):
            raise CaseError(
                f"mu(0, 0) is {at_rest}, the case's coefficient at rest {expected}; make them equal"
            )
    folder = temporary_folder()
    try:
        compute(
            lambda show: _core.run_by_law(
                prepared,
                folder,
                of_arrays,
                None if evolve is None else after,
                None if initial is None else first,
                list((states or {}).items()),
                show,
            ),
            progress,
        )
        return opened(folder, Kept(folder))
    except BaseException:
        shutil.rmtree(folder, ignore_errors=True)
        raise


def info(case: CaseLike, changes: Mapping[str, Any] | None = None, /, **tables: Any) -> _core.Info:
    """What follows from a case without running it: wave speeds, steps, size, memory, expected time,
    stability of uniform sliding; of loads given as forces the displacements, by statics. Case and changes as
    for `run`; raises CaseError."""
    return make_case(case, changes, tables).info()


# ---- What follows from materials and friction alone. Each table is given as in a case file, by keyword; what
# is not given has the case file's default.


def wave_speeds(**material: Any) -> _core.WaveSpeeds:
    """Speeds of longitudinal, shear and Rayleigh waves, m/s: c_L_m_per_s, c_S_m_per_s, c_R_m_per_s.

    material: keys of [material], such as youngs_modulus_Pa=2.6e9, poissons_ratio=0.37,
    density_kg_per_m3=1200, plane="strain"."""
    return make_case({"material": {**DEFAULT_MATERIAL, **material}}, None, {}).wave_speeds


def plate_of(element_size_m: float) -> dict[str, float]:
    """Table of a plate of squares, whose size the defaults of a case follow."""
    h = element_size_m
    return {"width_m": 100 * h, "height_m": 50 * h, "element_size_m": h}


def stable_step_s(element_size_m: float, **material: Any) -> float:
    """Largest stable time step of the explicit scheme in square elements, s; with the material's damping, by
    default that of a case with such elements.

    The step of a plate may be smaller by what its corners ask for: `info` tells it."""
    size_m = number(element_size_m, "element_size_m", above=0, finite=True)
    tables = {"plate": plate_of(size_m), "material": material}
    return make_case(tables, None, {}).stable_step_s(size_m)


def well_posedness(
    friction: Mapping[str, Any],
    *,
    pressure_Pa: float,
    element_size_m: float,
    longest_wavelength_m: float,
    material: Mapping[str, Any] | None = None,
    base: Mapping[str, Any] | None = None,
) -> _core.WellPosedness:
    """Whether slow uniform sliding under a friction law has a growth that a finer mesh would not change.

    friction, material, base: tables of a case file, base={"kind": "body", ...} for a second half-space;
    damping is by default that of a case with such elements.
    pressure_Pa: uniform, positive in compression. longest_wavelength_m: such as the length of the interface.
    Theory: docs/stability.md."""
    p_Pa = number(pressure_Pa, "pressure_Pa", above=0, finite=True)
    size_m = number(element_size_m, "element_size_m", above=0, finite=True)
    wavelength_m = number(longest_wavelength_m, "longest_wavelength_m", above=0, finite=True)
    given = {"friction": friction, "material": material, "base": base}
    tables = {name: table(value, name) for name, value in given.items() if value is not None}
    tables["plate"] = plate_of(size_m)
    return make_case(tables, None, {}).well_posedness(p_Pa, size_m, wavelength_m)
