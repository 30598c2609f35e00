# SPDX-License-Identifier: BSD-3-Clause
"""What a machine does to a run: two processes in one folder, foreign files, signals, closed streams."""

import os
import re
import shutil
import signal
import subprocess
import time

from .cases import COARSE, EARLIER, long
from .trials import HANG_S, LOCK, TRIES, Trial, Wrong, alone, freeze, one_line, remove, require, require_same

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
    both = [setting.bench.start(*command) for _ in range(2)]
    for process in both:
        _, process.stderr_text = process.communicate(timeout=HANG_S)
    require(0 in [p.returncode for p in both], f"neither is done: {[p.stderr_text for p in both]}")
    for process in both:
        if process.returncode == 0:
            continue
        require(process.returncode == 2, f"exit {process.returncode}: {process.stderr_text}")
        line = one_line(process)
        require("is in use by" in line or "is not empty" in line or "unfinished" in line, line)
    require_same(alone(folder), setting.expected, "other results")
    remove(folder.parent)


def frozen_in_event(bench, case):
    """The process and folder of a run that stands still in its event; again where it was over before."""
    for _ in range(TRIES):
        folder = bench.folder()
        history = folder / "unfinished/state/history.raw"
        process = bench.start("run", case, "-o", folder, "-q")
        while process.poll() is None and not history.exists():
            time.sleep(0.005)
        if freeze(process) and history.exists():
            return process, folder
        process.send_signal(signal.SIGCONT)
        process.communicate()
        remove(folder.parent)
    raise Wrong("over too soon, each time")


def while_one_runs(setting):
    """Every command that would write there is refused while a run goes on."""
    bench = setting.bench
    case = bench.case(long("triggered"))
    process, folder = frozen_in_event(bench, case)
    try:
        for command in (
            ("run", case, "-o", folder, "--overwrite"),
            ("run", "--restart", folder),
            ("reproduce", "--quick", "--overwrite", "-o", folder),
            ("verify", "--quick", "symmetry", "-o", folder),
            ("study", "convergence", case, "--overwrite", "-o", folder),
            ("study", "interface-step", case, "--overwrite", "-o", folder),
        ):
            other = bench.run(*command)
            require(other.returncode == 2, f"{command[0]}: exit {other.returncode}: {other.stderr_text}")
            line = one_line(other)
            require(f"in use by process {process.pid}" in line, line)
        process.send_signal(signal.SIGCONT)
        _, errors = process.communicate()
        require(process.returncode == 0, f"exit {process.returncode}: {errors}")
    finally:
        process.kill()
    alone(folder)
    remove(folder.parent)


# --- Foreign contents


def _folder(path, elsewhere):
    path.mkdir()
    (path / "precious.txt").write_text("precious")


def _state_folder(path, elsewhere):
    (path / "state").mkdir(parents=True)
    (path / "state/precious.txt").write_text("precious")


def _listed_folder(path, elsewhere):
    path.mkdir()
    (path / "precious.txt").write_text("precious")
    (path / "checksums.sha256").write_text(f"{'0' * 64}  precious.txt\n")


def _link_to_folder(path, elsewhere):
    path.symlink_to(elsewhere)


def _link_to_file(path, elsewhere):
    path.symlink_to(elsewhere / "precious.txt")


def _link_to_nothing(path, elsewhere):
    path.symlink_to(elsewhere / "nothing")


def _file(path, elsewhere):
    path.write_text("precious\n")


def _pipe(path, elsewhere):
    os.mkfifo(path)


FOREIGN = (
    _folder,
    _state_folder,
    _listed_folder,
    _link_to_folder,
    _link_to_file,
    _link_to_nothing,
    _file,
    _pipe,
)


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
    elsewhere.mkdir(parents=True)
    _folder(elsewhere / "unfinished", None)
    (elsewhere / "precious.txt").write_text("precious")
    if over_results:
        shutil.copytree(setting.old_folder, folder)
    else:
        folder.mkdir()
    make(folder / name, elsewhere)
    before = entries(folder.parent)
    command = (
        ("run", "--restart", folder)
        if "--restart" in options
        else ("run", setting.case, "-o", folder, *options)
    )
    process = setting.bench.run(*command, "-q")
    require(process.returncode == 2, f"exit {process.returncode}: {process.stderr_text}")
    line = one_line(process)
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
        while process.poll() is None and not (catches_signals(process.pid) and (folder / until).exists()):
            time.sleep(0.005)
        time.sleep(0.1)  # some way into it, or to its end
        return process, folder


def catches_signals(pid):
    with open(f"/proc/{pid}/status") as status:
        caught = int(re.search(r"^SigCgt:\s*([0-9a-f]+)", status.read(), re.MULTILINE)[1], 16)
    return bool(caught >> (signal.SIGINT - 1) & 1)


def stopped(run, until, name):
    """Ends with 128 + n, says how to go on, and goes on to the same results."""
    number = getattr(signal, f"SIG{name}")
    process, folder = run.start(until)
    process.send_signal(number)
    _, process.stderr_text = process.communicate(timeout=HANG_S)
    if process.returncode != 0:  # else it was done before
        require(process.returncode == 128 + number, f"exit {process.returncode}: {process.stderr_text}")
        require("interrupted" in one_line(process), process.stderr_text)
        again = run.bench.run("run", "--restart", folder, "-q")
        require(again.returncode == 0, f"--restart: exit {again.returncode}: {again.stderr_text}")
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
        _, errors = process.communicate()
        require(process.returncode == 0, f"exit {process.returncode}: {errors}")
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
    process = subprocess.run(
        [setting.bench.program, *map(str, commands(setting, folder)[name])],
        cwd=setting.bench.scratch,
        preexec_fn=lambda: [os.close(stream) for stream in streams],
        capture_output=True,
        timeout=HANG_S,
    )
    require(process.returncode in (0, 1), f"exit {process.returncode}: {process.stderr}")
    require(name != "run" or process.returncode == 0, f"exit {process.returncode}: {process.stderr}")
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
    require(process.returncode in (0, 1, -signal.SIGPIPE), f"exit {process.returncode}: {errors}")
    if name == "run":
        require(process.returncode == 0, f"exit {process.returncode}: {errors}")
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
    k = 0
    for name in RESERVED:
        for make in FOREIGN:
            for options in ((), ("--overwrite",), ("--restart",)):
                for over_results in (False, True):
                    if k % every == 0:
                        yield Trial(
                            f"{name}: {make.__name__[1:]}, {options}, {over_results}",
                            lambda a=name, b=make, c=options, d=over_results: foreign(setting, a, b, c, d),
                        )
                    k += 1


def signal_trials(bench, names=STOPPING, kinds=("ramp", "triggered")):
    parts = {"ramp": "unfinished/run.json", "triggered": "unfinished/state/history.raw"}
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
