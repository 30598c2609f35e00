# SPDX-License-Identifier: BSD-3-Clause
"""Trials: runs of the program that something happens to, and what must hold of their results."""

import hashlib
import itertools
import json
import os
import shutil
import signal
import tempfile
from concurrent.futures import ThreadPoolExecutor
from contextlib import suppress
from dataclasses import dataclass, field, replace
from functools import partial
from pathlib import Path

from common import finished, freeze, require_done, start, wait_until_or_over

CHECKSUMS = "checksums.sha256"
LOCK = ".slipfront.lock"
#: Of a run that is to be met under way: it may be over before.
TRIES = 1000
#: What run.json, and the files of studies and verifications, say of the computation but not of its results.
MEASURED = {"wall_s", "node_updates_per_s", "process", "processes", "host", "sessions"}


class Wrong(AssertionError):
    """What must not happen."""


def require(condition, what):
    if not condition:
        raise Wrong(what)


@dataclass
class Bench:
    """The program, the library that disturbs it, and a place for folders."""

    program: Path
    shim: Path
    scratch: Path
    _numbers: itertools.count = field(default_factory=itertools.count)

    def of_verifications(self):
        """The same with the program that solves problems with known answers."""
        return replace(self, program=self.program.with_name("slipfront-verify"))

    def folder(self):
        """A path of its own at which nothing is."""
        return self.scratch / f"t{next(self._numbers)}" / "out"

    def case(self, settings):
        """A case file."""
        path = self.scratch / f"case{next(self._numbers)}.toml"
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text("".join(f"{key} = {toml(value)}\n" for key, value in settings.items()))
        return path

    def start(self, *arguments, disturbance=None, **options):
        environment = dict(os.environ)
        if disturbance:
            environment |= disturbance | {"LD_PRELOAD": str(self.shim)}
        return start(self.program, *arguments, env=environment, cwd=self.scratch, **options)

    def run(self, *arguments, disturbance=None):
        with self.start(*arguments, disturbance=disturbance) as process:
            return finished(process)

    def result(self, case, *arguments):
        """The folder of an undisturbed run."""
        folder = self.folder()
        require_done(self.run("run", case, "-o", folder, "-q", *arguments))
        return folder


def toml(value):
    if isinstance(value, bool):
        return str(value).lower()
    if isinstance(value, list):
        return "[" + ", ".join(map(toml, value)) + "]"
    return json.dumps(value) if isinstance(value, str) else repr(value)


# --- Sets of results


def unmeasured(value):
    """JSON without what is measured."""
    if isinstance(value, dict):
        return {key: unmeasured(v) for key, v in value.items() if key not in MEASURED}
    return [unmeasured(v) for v in value] if isinstance(value, list) else value


def comparable(path):
    """A file's contents; equal where the results are."""
    if path.name == "timings.json":
        return None  # nothing but what is measured
    data = path.read_bytes()
    return unmeasured(json.loads(data)) if path.suffix == ".json" else data


def listed(folder, find, prefix=""):
    """Contents by name of what a folder's list of checksums names, each file being what it says."""
    contents = {}
    for line in find(prefix + CHECKSUMS).read_text().splitlines():
        checksum, name = line.split("  ", 1)
        path = find(prefix + name)
        require(path.is_file() and not path.is_symlink(), f"{prefix + name} is in the list, and missing")
        data = path.read_bytes()
        sum_of_data = hashlib.sha256(data).hexdigest()
        require(sum_of_data == checksum, f"{prefix + name} is not what its checksum says")
        if path.name == CHECKSUMS:
            contents |= listed(folder, find, prefix + name.removesuffix(CHECKSUMS))
        else:
            contents[prefix + name] = comparable(path)
    return contents


def visible(folder):
    """The set of results in a folder as its readers see it; None where there is none."""

    def find(name):
        on_its_way = folder / "publishing" / name
        return on_its_way if on_its_way.exists() else folder / name

    return listed(folder, find) if find(CHECKSUMS).is_file() else None


def alone(folder):
    """The set of results in a folder that holds nothing else."""
    contents = listed(folder, lambda name: folder / name)
    names = {str(p.relative_to(folder)) for p in folder.rglob("*") if not p.is_dir() and p.name != CHECKSUMS}
    require(names == set(contents), f"left over, or not in the list: {names ^ set(contents)}")
    return contents


def difference(contents, expected):
    """Empty where two sets are the same; else in which files they differ."""
    if contents is None or expected is None:
        return "" if contents == expected else "there is no set of results"
    return ", ".join(sorted(name for name in contents | expected if contents.get(name) != expected.get(name)))


def require_same(contents, expected, what):
    differing = difference(contents, expected)
    require(not differing, f"{what}: {differing}")


# --- Many of them


@dataclass
class Trial:
    name: str
    run: object  # called without arguments; raises where something is wrong


@dataclass
class Outcome:
    passed: int
    failures: list


def hold(title, trials):
    """Runs trials side by side and tells how many held."""

    def attempt(trial):
        try:
            trial.run()
        except Exception as error:  # whatever it is, it is told
            return f"{trial.name}: {type(error).__name__}: {error}"
        return None

    trials = list(trials)
    with ThreadPoolExecutor(2 * os.cpu_count()) as pool:  # they wait for the disk, too
        failures = [failure for failure in pool.map(attempt, trials) if failure]
    print(f"{title}: {len(trials)} trials, {len(failures)} failed", flush=True)
    for failure in failures[:20]:
        print(f"  {failure}", flush=True)
    return Outcome(len(trials) - len(failures), failures)


def scratch_folder():
    """Of real path, for a library that compares paths."""
    return Path(tempfile.mkdtemp(prefix="slipfront-hostile-")).resolve()


def stopped_under_way(bench, case, is_under_way):
    """The process of a run that stands still, and its folder; again where it was over too soon."""
    for _ in range(TRIES):
        folder = bench.folder()
        process = bench.start("run", case, "-o", folder, "-q")
        with suppress(FileNotFoundError):  # published between two looks
            wait_until_or_over(partial(is_under_way, folder), process)
            if freeze(process) and is_under_way(folder):
                return process, folder
        process.send_signal(signal.SIGCONT)
        finished(process)
        remove(folder.parent)
    raise Wrong("over too soon, each time")


def remove(folder):
    shutil.rmtree(folder, ignore_errors=True)
