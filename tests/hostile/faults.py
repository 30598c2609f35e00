# SPDX-License-Identifier: BSD-3-Clause
"""Runs of which one call to the system fails, or that die at one, killed or with the power: each call that
changes files, in turn."""

import errno
import shutil
import signal
from dataclasses import dataclass, field
from pathlib import Path

from common import finished, one_line, require_done, wait_until_or_over

from .cases import COARSE, EARLIER, long
from .trials import LOCK, TRIES, Bench, Trial, alone, difference, remove, require, require_same, visible

CHECKPOINTS = ("--checkpoint-every-simulated", "1e-4")
#: Mode and errno: what the n-th call does.
FAILURES = [
    ("once", errno.EIO),
    ("once", errno.EINTR),
    ("once", errno.ENOSPC),
    ("on", errno.ENOSPC),
    ("on", errno.EIO),
    ("short", 0),
]
DEATHS = [("kill", 0), ("tear", 0), ("power", 0)]


@dataclass
class Setting:
    """A command whose work goes into a folder that is empty or holds earlier results."""

    bench: Bench
    name: str
    command: list  # but for the folder
    old_folder: Path | None = None
    restarts: bool = False  # with --restart; others go on when they are given again
    new: dict = field(init=False)
    old: dict | None = field(init=False)

    def __post_init__(self):
        folder = self.prepared_folder()
        require_done(self.bench.run(*self.command, "-o", folder))
        self.new = alone(folder)
        self.old = visible(self.old_folder) if self.old_folder else None

    def prepared_folder(self):
        folder = self.bench.folder()
        folder.parent.mkdir(parents=True)
        if self.old_folder:
            shutil.copytree(self.old_folder, folder)
        return folder

    def disturbed(self, folder, n, mode, error):
        """@return the process, and how many calls it made"""
        count = folder.parent / "count"
        count.write_bytes(bytes(8))
        fault = {"BELOW": folder, "COUNT": count, "AT": n, "MODE": mode, "ERROR": error}
        disturbance = {f"FAULT_{name}": str(value) for name, value in fault.items()}
        process = self.bench.run(*self.command, "-o", folder, disturbance=disturbance)
        return process, int.from_bytes(count.read_bytes(), "little")

    def calls(self):
        """How many calls an undisturbed run makes."""
        folder = self.prepared_folder()
        process, n = self.disturbed(folder, 0, "none", 0)
        require_done(process)
        require(n > 20, f"only {n} calls were seen: is the library loaded?")
        return n

    def trial(self, n, mode, error):
        folder = self.prepared_folder()
        process, _ = self.disturbed(folder, n, mode, error)
        if process.returncode == 0:
            (folder / LOCK).unlink(missing_ok=True)  # its removal may be what failed
            require_same(alone(folder), self.new, "done, and other results")
        elif mode in ("kill", "tear", "power"):
            require(process.returncode == -signal.SIGKILL, process)
        else:
            self.require_refusal(process, folder)
        if folder.exists():
            seen = visible(folder)
            require(
                not difference(seen, self.old) or not difference(seen, self.new),
                f"a mixture: not the earlier set: {difference(seen, self.old)}; "
                f"not the new one: {difference(seen, self.new)}",
            )
        if process.returncode != 0:
            self.finish(folder)
        remove(folder.parent)

    def require_refusal(self, process, folder):
        line = one_line(process, 1, 2)
        require(str(folder) in line, f"names no file: {line}")
        if process.returncode == 2:
            require("cannot be" in line, line)

    def finish(self, folder):
        """As a user would: with --restart, or anew where there is nothing to go on with."""
        done = False
        if self.restarts:
            process = self.bench.run("run", "--restart", folder, "-q")
            done = process.returncode == 0 and difference(visible(folder), self.old)
            if process.returncode != 0:
                require("holds no unfinished run" in one_line(process, 2), process)
        if not done:
            require_done(self.bench.run(*self.command, "-o", folder))
        require_same(alone(folder), self.new, "other results after all")


def run_setting(bench, overwrites):
    command = ["run", bench.case(COARSE), "-q", *CHECKPOINTS]
    if not overwrites:
        return Setting(bench, "run", command, restarts=True)
    old_folder = bench.result(bench.case(EARLIER))
    return Setting(bench, "run over results", [*command, "--overwrite"], old_folder, restarts=True)


def run_over_work_setting(bench):
    """Results, and an unfinished run, all to be replaced."""
    old_folder = bench.result(bench.case(EARLIER))
    case, state = bench.case(long("triggered")), old_folder / "unfinished/state"
    for _ in range(TRIES):
        process = bench.start("run", case, "-o", old_folder, "-q", "--overwrite")
        wait_until_or_over((old_folder / "unfinished/interface.h5").exists, process)
        process.terminate()
        finished(process)
        if (state / "checkpoint-000001.bin").exists():
            break
    require((state / "checkpoint-000001.bin").exists(), "over too soon, each time")
    command = ["run", bench.case(COARSE), "-q", "--overwrite"]
    return Setting(bench, "run over unfinished work", command, old_folder)


def verify_setting(bench):
    """Adds to a set."""
    bench = bench.of_verifications()
    old_folder = bench.folder()
    require_done(bench.run("--quick", "column", "-o", old_folder))
    return Setting(bench, "verify", ["--quick", "symmetry"], old_folder)


def trials(setting, kinds, every=1, among=slice(None)):
    """For each kind every so many of the calls, or of some of them; different ones for each kind."""
    calls = setting.calls()
    for k, (mode, error) in enumerate(kinds):
        for n in range(1, calls + 1)[among][k % every :: every]:
            yield Trial(
                f"{setting.name}, call {n} of {calls}, {mode} {errno.errorcode.get(error, '')}",
                lambda n=n, mode=mode, error=error: setting.trial(n, mode, error),
            )
