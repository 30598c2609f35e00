# SPDX-License-Identifier: BSD-3-Clause
"""Sweeps whose processes are killed, stopped or asked to end, on disks that fill: each goes on to the results
of one that was left alone, and says in one line what happened."""

import os
import random
import signal
import socket
import subprocess
import sys
import time
from contextlib import suppress
from pathlib import Path

from common import WITH_PACKAGE, finished, one_line, require_done, start, wait_until, wait_until_or_over

from . import disk
from .cases import COARSE, long
from .trials import Trial, comparable, remove, require, require_same

VARY = ("--vary", "friction.mu_k=0.5,0.6,0.7,0.8")
FAILED, INTERRUPTED = 1, 130


def results(folder):
    """Of all points and the table."""
    files = [folder / "sweep.csv", *(path for path in folder.glob("points/*/*") if path.is_file())]
    skipped = ("checksums.sha256", "report.html")
    return {str(path.relative_to(folder)): comparable(path) for path in files if path.name not in skipped}


def runs_in(folder):
    """Processes of the runs in a sweep's folder, and those that have begun them."""
    found = {}
    for place in Path("/proc").glob("[0-9]*"):
        with suppress(OSError):
            words = (place / "cmdline").read_bytes().decode(errors="replace").split("\0")
            if any(word.startswith(f"{folder}/points/") for word in words):
                found[int(place.name)] = int((place / "stat").read_text().rsplit(")", 1)[1].split()[1])
    return found


class Setting:
    def __init__(self, bench):
        self.bench = bench
        self.case = bench.case(long("triggered"))
        begun = time.monotonic()
        folder = bench.folder()
        require_done(finished(self.start(folder)))
        self.duration_s = time.monotonic() - begun
        self.expected = results(folder)
        require(len(self.expected) > 4 * 4, self.expected)

    def start(self, folder, *options, workers=2, **how):
        given = options or (self.case, *VARY, "-o", folder)
        command = (self.bench.program, "sweep", *given, "-q", "--workers", workers)
        return start(*command, env=WITH_PACKAGE, cwd=self.bench.scratch, start_new_session=True, **how)

    def go_on(self, folder):
        again = ("--restart", folder) if (folder / "sweep.json").exists() else ()
        require_done(finished(self.start(folder, *again)))
        require_same(results(folder), self.expected, "other results")
        remove(folder.parent)

    def whole_sweep(self, seed):
        """Killed, up to three times."""
        dice = random.Random(seed)
        folder = self.bench.folder()
        for _ in range(dice.randint(1, 3)):
            process = self.start(folder, *(("--restart", folder) if (folder / "sweep.json").exists() else ()))
            time.sleep(dice.uniform(0, self.duration_s))
            process.kill()
            require(finished(process).returncode in (0, -signal.SIGKILL), "ended otherwise")
            wait_until(lambda: not runs_in(folder))
        self.go_on(folder)

    def part(self, seed, signal_sent, runs):
        """Of its processes one is killed, or stands still for a while."""
        dice = random.Random(seed)
        folder = self.bench.folder()
        process = self.start(folder)
        wait_until_or_over(lambda: runs_in(folder), process)
        time.sleep(dice.uniform(0, 0.5))
        found = runs_in(folder)
        own = sorted(found if runs else {*found.values()} - {process.pid, 1})
        for pid in dice.sample(own, min(1, len(own))):
            with suppress(ProcessLookupError):
                os.kill(pid, signal_sent)
                if signal_sent == signal.SIGSTOP:
                    time.sleep(dice.uniform(0, 2))
                    os.kill(pid, signal.SIGCONT)
        ended = finished(process)
        may_be = (0,) if signal_sent == signal.SIGSTOP else (0, FAILED)
        require(ended.returncode in may_be and "Traceback" not in ended.stderr, ended)
        self.go_on(folder)

    def asked_to_end(self, seed, name):
        dice = random.Random(seed)
        folder = self.bench.folder()
        process = self.start(folder)
        wait_until_or_over(lambda: runs_in(folder), process)
        time.sleep(dice.uniform(0, 1))
        process.send_signal(getattr(signal, f"SIG{name}"))
        ended = finished(process)
        if ended.returncode != 0:
            require("interrupted" in one_line(ended, INTERRUPTED), ended)
        self.go_on(folder)

    def small_disk(self, n_bytes):
        """It fills; there is more room afterwards."""
        place = self.bench.folder()
        reason = disk.mount(place, n_bytes)
        require(not reason, reason)
        folder = place / "out"
        try:
            ended = finished(self.start(folder))
            require(ended.returncode in (0, 1, 2) and "Traceback" not in ended.stderr, ended)
            require(len(ended.stderr.splitlines()) <= 1, ended)
            subprocess.run(["mount", "-o", f"remount,size={256 * disk.MIB}", place], check=True)
            self.go_on(folder)
        finally:
            disk.unmount(place)
            remove(place.parent)

    def without_its_scheduler(self):
        """Dask's scheduler elsewhere is killed while the points are run."""
        with socket.socket() as free:
            free.bind(("127.0.0.1", 0))
            address = f"tcp://127.0.0.1:{free.getsockname()[1]}"
        port = address.rsplit(":", 1)[1]

        def dask(name, *options):
            command = [sys.executable, "-m", f"distributed.cli.dask_{name}", "--no-dashboard", *options]
            nowhere = subprocess.DEVNULL
            return subprocess.Popen(command, env=WITH_PACKAGE, stdout=nowhere, stderr=nowhere)

        scheduler = dask("scheduler", "--host", "127.0.0.1", "--port", port)
        helper = dask("worker", address, "--nthreads", "1", "--death-timeout", "60")
        folder = self.bench.folder()
        try:
            process = self.start(folder, self.case, *VARY, "-o", folder, "--scheduler", address)
            wait_until_or_over(lambda: runs_in(folder), process)
            scheduler.kill()
            ended = finished(process)
            require(ended.returncode in (0, FAILED) and not ended.stderr, ended)
        finally:
            for each in (scheduler, helper):
                each.kill()
                each.wait()
        wait_until(lambda: not runs_in(folder))
        self.go_on(folder)


def many(bench, n):
    """As many points, of runs that take a moment."""
    folder = bench.folder()
    values = f"friction.mu_k=0.4:0.9:{n}"
    command = (bench.program, "sweep", bench.case(COARSE), "--vary", values, "-o", folder, "--keep", "tables")
    ended = require_done(finished(start(*command, "-q", env=WITH_PACKAGE, cwd=bench.scratch)))
    require(not ended.stderr, ended)
    rows = (folder / "sweep.csv").read_text().splitlines()
    require(len(rows) == n + 1 and all(",done," in row for row in rows[1:]), rows[:3])
    remove(folder.parent)


def trials(bench, n, n_points=1000):
    setting = Setting(bench)
    for seed in range(n):
        yield Trial(f"killed, seed {seed}", lambda s=seed: setting.whole_sweep(s))
        for runs in (True, False):
            for sent in (signal.SIGKILL, signal.SIGSTOP):
                name = f"{sent.name} to a {'run' if runs else 'worker'}, seed {seed}"
                yield Trial(name, lambda s=seed, sent=sent, runs=runs: setting.part(s, sent, runs))
        name = ("TERM", "INT")[seed % 2]
        yield Trial(f"{name}, seed {seed}", lambda s=seed, name=name: setting.asked_to_end(s, name))
    if not disk.is_allowed(bench):
        for k in range(n):
            n_bytes = disk.MIB * (1 + 16 * k // n)
            yield Trial(f"{n_bytes} bytes", lambda n_bytes=n_bytes: setting.small_disk(n_bytes))
    yield Trial("without its scheduler", setting.without_its_scheduler)
    yield Trial(f"{n_points} points", lambda: many(bench, n_points))
