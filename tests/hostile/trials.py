# SPDX-License-Identifier: BSD-3-Clause
"""Trials: runs of the program that something happens to, and what must hold of their results."""

import hashlib
import itertools
import json
import os
import shutil
import signal
import subprocess
import tempfile
import time
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, field
from pathlib import Path

CHECKSUMS = "checksums.sha256"
LOCK = ".slipfront.lock"
#: What takes longer hangs.
HANG_S = 900
#: Of a run that is to be met under way: it may be over before.
TRIES = 1000
#: What run.json, and the files of studies and verifications, say of the computation but not of its results.
MEASURED = {"wall_s", "node_updates_per_s", "process", "processes", "host", "sessions"}


class Wrong(AssertionError):
    """What must not happen."""


def require(condition, what):
    if not condition:
        raise Wrong(what)


def as_from_a_terminal():
    """In the background of a shell some signals are ignored, and the program leaves them so."""
    signal.signal(signal.SIGINT, signal.default_int_handler)
    for each in (signal.SIGQUIT, signal.SIGHUP, signal.SIGTERM):
        signal.signal(each, signal.SIG_DFL)


def wait_until(condition, process=None):
    """Without the process, if there is one, ending before."""
    end = time.monotonic() + HANG_S
    while not condition():
        assert process is None or process.poll() is None, "ended before"
        assert time.monotonic() < end, "waited in vain"
        time.sleep(0.002)


def freeze(process):
    """Lets a process stand still, with all its threads, until SIGCONT. @return False where it is over"""
    process.send_signal(signal.SIGSTOP)
    if process.returncode is not None:
        return False
    state = os.waitid(os.P_PID, process.pid, os.WSTOPPED | os.WEXITED | os.WNOWAIT)
    return state.si_code == os.CLD_STOPPED


@dataclass
class Bench:
    """The program, the library that disturbs it, and a place for folders."""

    program: Path
    shim: Path
    scratch: Path
    _numbers: itertools.count = field(default_factory=itertools.count)

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
        options = {
            "stdout": subprocess.PIPE,
            "stderr": subprocess.PIPE,
            "stdin": subprocess.DEVNULL,
        } | options
        return subprocess.Popen(
            [self.program, *map(str, arguments)], env=environment, cwd=self.scratch, text=True, **options
        )

    def run(self, *arguments, disturbance=None):
        with self.start(*arguments, disturbance=disturbance) as process:
            try:
                process.stdout_text, process.stderr_text = process.communicate(timeout=HANG_S)
            except subprocess.TimeoutExpired:
                process.kill()
                raise Wrong(f"does not end: {process.args}") from None
        return process

    def result(self, case, *arguments, folder=None):
        """The folder of an undisturbed run."""
        folder = folder or self.folder()
        process = self.run("run", case, "-o", folder, "-q", *arguments)
        require(process.returncode == 0, f"an undisturbed run fails: {process.stderr_text}")
        return folder


def toml(value):
    if isinstance(value, bool):
        return str(value).lower()
    if isinstance(value, list):
        return "[" + ", ".join(map(toml, value)) + "]"
    return json.dumps(value) if isinstance(value, str) else repr(value)


def one_line(process):
    """All that a process says on its standard error, which must be a single line."""
    lines = process.stderr_text.splitlines()
    require(
        len(lines) == 1, f"exit {process.returncode} with {len(lines)} lines: {process.stderr_text[-600:]}"
    )
    return lines[0]


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
        require(
            hashlib.sha256(data).hexdigest() == checksum, f"{prefix + name} is not what its checksum says"
        )
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
    bench: Bench | None = None


@dataclass
class Outcome:
    passed: int = 0
    skipped: str = ""
    failures: list = field(default_factory=list)


def hold(title, trials, jobs=None):
    """Runs trials side by side and tells how many held."""

    def attempt(trial):
        try:
            trial.run()
        except Exception as error:  # whatever it is, it is told
            return f"{trial.name}: {type(error).__name__}: {error}"
        return None

    trials = list(trials)
    with ThreadPoolExecutor(jobs or 2 * os.cpu_count()) as pool:  # they wait for the disk, too
        failures = [failure for failure in pool.map(attempt, trials) if failure]
    print(f"{title}: {len(trials)} trials, {len(failures)} failed", flush=True)
    for failure in failures[:20]:
        print(f"  {failure}", flush=True)
    return Outcome(len(trials) - len(failures), "", failures)


def scratch_folder():
    """Of real path, for a library that compares paths."""
    return Path(tempfile.mkdtemp(prefix="slipfront-hostile-")).resolve()


def remove(folder):
    shutil.rmtree(folder, ignore_errors=True)
