# SPDX-License-Identifier: BSD-3-Clause
"""What a machine does to a run: two processes in one folder, foreign files, signals, closed streams."""

import itertools
import os
import shutil
import signal
import time

from common import HANG_S, call, catches_interrupts, finished, one_line, require_done, wait_until_or_over

from .cases import COARSE, EARLIER, long
from .trials import LOCK, TRIES, Trial, Wrong, alone, remove, require, require_same, stopped_under_way

RESERVED = ("unfinished", "publishing", LOCK)


class Setting:
    def __init__(self, bench):
        self.bench = bench
        self.case = bench.case(COARSE)
        self.expected = alone(bench.result(self.case))
        self.old_folder = bench.result(bench.case(EARLIER))
        self.old = alone(self.old_folder)


# --- Two processes


def two_at_once(setting, overwrites):
    """Of two that start together none spoils the other's results."""
    folder = setting.bench.folder()
    folder.parent.mkdir(parents=True)
    if overwrites:
        shutil.copytree(setting.old_folder, folder)
    command = ("run", setting.case, "-o", folder, "-q", *(["--overwrite"] if overwrites else []))
    both = [finished(process) for process in [setting.bench.start(*command) for _ in range(2)]]
    require(0 in [p.returncode for p in both], f"neither is done: {both}")
    for process in both:
        if process.returncode != 0:
            line = one_line(process, 2)
            require("is in use by" in line or "is not empty" in line or "unfinished" in line, line)
    require_same(alone(folder), setting.expected, "other results")
    remove(folder.parent)


def while_one_runs(setting):
    """Every command that would write there is refused while a run goes on."""
    bench = setting.bench
    case = bench.case(long("triggered"))
    process, folder = stopped_under_way(bench, case, lambda out: (out / "unfinished/interface.h5").exists())
    try:
        for command in (("run", case, "-o", folder, "--overwrite"), ("run", "--restart", folder)):
            line = one_line(bench.run(*command), 2)
            require(f"in use by process {process.pid}" in line, line)
        process.send_signal(signal.SIGCONT)
        require_done(finished(process))
    finally:
        process.kill()
    alone(folder)
    remove(folder.parent)


# --- Foreign contents


PRECIOUS = "precious.txt"


def _file(path):
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text("precious")


def _listed_folder(path):
    _file(path / PRECIOUS)
    (path / "checksums.sha256").write_text(f"{'0' * 64}  {PRECIOUS}\n")


#: What is made at a path, which may lead to another folder.
FOREIGN = {
    "folder": lambda path, elsewhere: _file(path / PRECIOUS),
    "state folder": lambda path, elsewhere: _file(path / "state" / PRECIOUS),
    "listed folder": lambda path, elsewhere: _listed_folder(path),
    "link to a folder": lambda path, elsewhere: path.symlink_to(elsewhere),
    "link to a file": lambda path, elsewhere: path.symlink_to(elsewhere / PRECIOUS),
    "link to nothing": lambda path, elsewhere: path.symlink_to(elsewhere / "nothing"),
    "file": lambda path, elsewhere: _file(path),
    "pipe": lambda path, elsewhere: os.mkfifo(path),
}


def entries(folder):
    """Everything below a folder, links as links."""
    found = {}
    for path in sorted(folder.rglob("*")):
        name = str(path.relative_to(folder))
        if path.is_symlink():
            found[name] = ("link", os.readlink(path))
        elif path.is_dir():
            found[name] = "folder"
        elif path.is_file():
            found[name] = path.read_bytes()
        else:
            found[name] = "other"
    return found


def foreign(setting, name, make, options, over_results):
    folder = setting.bench.folder()
    elsewhere = folder.parent / "elsewhere"
    _file(elsewhere / "unfinished" / PRECIOUS)
    _file(elsewhere / PRECIOUS)
    if over_results:
        shutil.copytree(setting.old_folder, folder)
    else:
        folder.mkdir()
    make(folder / name, elsewhere)
    before = entries(folder.parent)
    given = ("--restart", folder) if "--restart" in options else (setting.case, "-o", folder, *options)
    command = ("run", *given)
    line = one_line(setting.bench.run(*command, "-q"), 2)
    require("move it away" in line or "is not empty" in line, line)
    after = entries(folder.parent)
    require(after == before, f"changed: {sorted(k for k in before | after if before.get(k) != after.get(k))}")
    remove(folder.parent)


# --- Signals

STOPPING = ("HUP", "INT", "QUIT", "TERM", "XCPU", "PIPE", "XFSZ")


class Long:
    """A run that goes on for a second or two, in its ramp or its event."""

    def __init__(self, bench, kind):
        self.bench = bench
        self.case = bench.case(long(kind))
        folder = bench.result(self.case)
        self.expected = alone(folder)
        remove(folder.parent)

    def start(self, until):
        folder = self.bench.folder()
        process = self.bench.start("run", self.case, "-o", folder, "-q")
        wait_until_or_over(lambda: catches_interrupts(process.pid) and (folder / until).exists(), process)
        time.sleep(0.1)  # some way into it, or to its end
        return process, folder


def stopped(run, until, name):
    """Ends with 128 + n, says how to go on, and goes on to the same results."""
    number = getattr(signal, f"SIG{name}")
    process, folder = run.start(until)
    process.send_signal(number)
    ended = finished(process)
    if ended.returncode != 0:  # else it was done before
        require("interrupted" in one_line(ended, 128 + number), ended)
        require_done(run.bench.run("run", "--restart", folder, "-q"))
    require_same(alone(folder), run.expected, "other results")
    remove(folder.parent)


def asked_to_keep(run, until):
    """USR1 makes a checkpoint, and the run goes on; again where it was over before one was seen."""
    seen = False
    for _ in range(TRIES):
        process, folder = run.start(until)
        while process.poll() is None:
            if not seen:
                process.send_signal(signal.SIGUSR1)
            seen = seen or (folder / "unfinished/state/checkpoint-000001.bin").exists()
            time.sleep(0.005)
        require_done(finished(process))
        require_same(alone(folder), run.expected, "other results")
        remove(folder.parent)
        if seen:
            return
    raise Wrong("no checkpoint was seen")


# --- Streams


def commands(setting, folder):
    return {
        "run": ("run", setting.case, "-o", folder),
        "info": ("info", setting.case),
        "validate": ("validate", setting.case),
        "keys": ("keys",),
    }


def closed(setting, name, streams):
    """Nothing of what is printed gets into a file."""
    folder = setting.bench.folder()
    process = call(
        setting.bench.program,
        *commands(setting, folder)[name],
        cwd=setting.bench.scratch,
        preexec_fn=lambda: [os.close(stream) for stream in streams],
    )
    require(process.returncode in ((0,) if name == "run" else (0, 1)), process)
    if name == "run":
        require_same(alone(folder), setting.expected, "other results")
    remove(folder.parent)


def reader_goes(setting, name, lines):
    """The reader takes a line or none, and goes."""
    folder = setting.bench.folder()
    process = setting.bench.start(*commands(setting, folder)[name])
    for _ in range(lines):
        process.stdout.readline()
    process.stdout.close()
    errors = process.stderr.read()
    process.wait(timeout=HANG_S)
    process.stderr.close()
    expected = (0,) if name == "run" else (0, 1, -signal.SIGPIPE)
    require(process.returncode in expected, f"exit {process.returncode}: {errors}")
    if name == "run":
        require_same(alone(folder), setting.expected, "other results")
    remove(folder.parent)


# --- All


def process_trials(bench, n):
    setting = Setting(bench)
    for k in range(n):
        yield Trial(f"two at once {k}", lambda k=k: two_at_once(setting, k % 2 == 1))
    yield Trial("while one runs", lambda: while_one_runs(setting))


def foreign_trials(bench, every=1):
    setting = Setting(bench)
    kinds = itertools.product(RESERVED, FOREIGN, ((), ("--overwrite",), ("--restart",)), (False, True))
    for name, what, options, over_results in itertools.islice(kinds, 0, None, every):
        yield Trial(
            f"{name}: {what}, {options}, {over_results}",
            lambda a=name, b=FOREIGN[what], c=options, d=over_results: foreign(setting, a, b, c, d),
        )


def signal_trials(bench, names=STOPPING, kinds=("ramp", "triggered")):
    parts = {"ramp": "unfinished/run.json", "triggered": "unfinished/interface.h5"}
    for kind in kinds:
        run = Long(bench, kind)
        for name in names:
            yield Trial(f"{name} in {kind}", lambda run=run, u=parts[kind], n=name: stopped(run, u, n))
        yield Trial(f"USR1 in {kind}", lambda run=run, u=parts[kind]: asked_to_keep(run, u))


def stream_trials(bench):
    setting = Setting(bench)
    for name in ("run", "info", "validate", "keys"):
        for which in range(8):
            streams = [stream for stream in range(3) if which >> stream & 1]
            yield Trial(f"{name} without {streams}", lambda n=name, s=streams: closed(setting, n, s))
        for lines in (0, 1):
            yield Trial(f"{name} | head -{lines}", lambda n=name, k=lines: reader_goes(setting, n, k))
