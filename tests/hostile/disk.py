# SPDX-License-Identifier: BSD-3-Clause
"""Runs on a real file system that is small, or full for a moment."""

import os
import random
import subprocess
import threading
import time

from common import one_line, require_done

from .cases import COARSE
from .trials import Trial, alone, difference, remove, require, require_same, visible

MIB = 1 << 20
OFTEN = ("--checkpoint-every-simulated", "1e-4")
# Half a second, 1000 rows of history.
CASE = COARSE | {"time.end_s": 4e-3, "time.quiet_s": float("inf"), "output.history_interval_s": 4e-6}


def mount(folder, n_bytes):
    """@return why there is no such file system; empty where there is one"""
    folder.mkdir(parents=True)
    command = ["mount", "-t", "tmpfs", "-o", f"size={n_bytes}", "slipfront-test", folder]
    try:
        result = subprocess.run(command, capture_output=True, text=True)
    except OSError as error:
        return str(error)
    return result.stderr.strip() if result.returncode else ""


def unmount(folder):
    subprocess.run(["umount", folder], check=True)


def is_allowed(bench):
    """@return why small file systems cannot be made here; empty where they can"""
    folder = bench.folder()
    reason = mount(folder, MIB)
    if not reason:
        unmount(folder)
    return reason


class Filler(threading.Thread):
    """Fills a file system and frees it, again and again, for 2 to 100 ms each."""

    def __init__(self, folder, dice):
        super().__init__(daemon=True)
        self.file, self.dice, self.ended = folder / "filler", dice, False

    def run(self):
        time.sleep(self.dice.uniform(0, 0.3))
        while not self.ended:
            self.fill()
            time.sleep(self.dice.uniform(2e-3, 0.1))
            self.file.unlink(missing_ok=True)
            time.sleep(self.dice.uniform(2e-3, 0.1))

    def fill(self):
        with open(self.file, "wb", buffering=0) as file:
            try:
                while not self.ended:
                    file.write(bytes(64 * 1024))
            except OSError:
                pass

    def end(self):
        self.ended = True
        self.join()
        self.file.unlink(missing_ok=True)


class Setting:
    def __init__(self, bench):
        self.bench = bench
        self.case = bench.case(CASE)
        folder = bench.result(self.case)
        self.expected = alone(folder)
        self.bytes = sum(path.stat().st_size for path in folder.iterdir())

    def on(self, n_bytes, work):
        place = self.bench.folder()
        reason = mount(place, n_bytes)
        require(not reason, reason)
        try:
            work(place)
        finally:
            unmount(place)
            remove(place.parent)

    def begin(self, folder):
        return self.bench.run("run", self.case, "-o", folder, "-q", *OFTEN)

    def check(self, process, folder):
        """Done with these results, or one line and no other results."""
        if process.returncode == 0:
            require_same(alone(folder), self.expected, "done, and other results")
            return
        require(str(folder) in one_line(process, 1, 2), process)
        seen = visible(folder) if folder.exists() else None
        require(not difference(seen, None) or not difference(seen, self.expected), "half a set of results")

    def go_on(self, process, folder):
        """Where it was refused, it comes to its end with more room."""
        if process.returncode != 0:
            process = self.bench.run("run", "--restart", folder, "-q")
            if "holds no unfinished run" in process.stderr:
                process = self.begin(folder)
            self.check(require_done(process), folder)

    def filled(self, seed):
        def work(place):
            folder = place / "out"
            filler = Filler(place, random.Random(seed))
            filler.start()
            try:
                process = self.begin(folder)
            finally:
                filler.end()
            self.check(process, folder)
            self.go_on(process, folder)

        self.on(4 * self.bytes, work)

    def small(self, n_bytes):
        """A disk with little left, from the beginning on; more of it afterwards."""

        def work(place):
            folder = place / "out"
            process = self.begin(folder)
            self.check(process, folder)
            subprocess.run(["mount", "-o", f"remount,size={16 * MIB}", place], check=True)
            self.go_on(process, folder)

        self.on(n_bytes, work)


def trials(bench, n_filled, n_small):
    setting = Setting(bench)
    for seed in range(n_filled):
        yield Trial(f"filled for a moment, seed {seed}", lambda seed=seed: setting.filled(seed))
    page = os.sysconf("SC_PAGE_SIZE")
    most = 4 * setting.bytes
    for k in range(n_small):
        n_bytes = page * (1 + k * most // n_small // page)
        yield Trial(f"{n_bytes} bytes", lambda n_bytes=n_bytes: setting.small(n_bytes))
