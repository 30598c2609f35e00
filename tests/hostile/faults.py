# SPDX-License-Identifier: BSD-3-Clause
"""Runs of which one call to the system fails, or that are killed at one: each that changes files, in turn."""

import errno
import shutil

from cases import COARSE, EARLIER
from trials import LOCK, Trial, alone, difference, one_line, remove, require, require_same, visible

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
DEATHS = [("kill", 0), ("tear", 0)]


class Setting:
    """A run into a folder that is empty or holds earlier results, and what comes of it undisturbed."""

    def __init__(self, bench, overwrites):
        self.bench = bench
        self.overwrites = overwrites
        self.case = bench.case(COARSE)
        self.new = alone(bench.result(self.case))
        self.old_folder = bench.result(bench.case(EARLIER)) if overwrites else None
        self.old = alone(self.old_folder) if overwrites else None

    def prepared_folder(self):
        folder = self.bench.folder()
        folder.parent.mkdir(parents=True)
        if self.overwrites:
            shutil.copytree(self.old_folder, folder)
        return folder

    def command(self, folder):
        return ("run", self.case, "-o", folder, "-q", *CHECKPOINTS, *(["--overwrite"] if self.overwrites else []))

    def disturbed(self, folder, n, mode, error):
        """@return the process, and how many calls it made"""
        count = folder.parent / "count"
        count.write_bytes(bytes(8))
        process = self.bench.run(
            *self.command(folder),
            disturbance={
                "FAULT_BELOW": str(folder),
                "FAULT_COUNT": str(count),
                "FAULT_AT": str(n),
                "FAULT_MODE": mode,
                "FAULT_ERROR": str(error),
            },
        )
        return process, int.from_bytes(count.read_bytes(), "little")

    def calls(self):
        """How many calls an undisturbed run makes."""
        folder = self.prepared_folder()
        process, n = self.disturbed(folder, 0, "none", 0)
        require(process.returncode == 0, process.stderr_text)
        require(n > 50, f"only {n} calls were seen: is the library loaded?")
        return n

    def trial(self, n, mode, error):
        folder = self.prepared_folder()
        process, _ = self.disturbed(folder, n, mode, error)
        if process.returncode == 0:
            (folder / LOCK).unlink(missing_ok=True)  # its removal may be what failed
            require_same(alone(folder), self.new, "done, and other results")
        elif mode not in ("kill", "tear"):
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
        line = one_line(process)
        require(process.returncode in (1, 2), f"exit {process.returncode}: {line}")
        require(str(folder) in line, f"names no file: {line}")
        if process.returncode == 2:
            require("cannot be" in line, line)

    def finish(self, folder):
        """As a user would: with --restart, or anew where there is nothing to go on with."""
        process = self.bench.run("run", "--restart", folder, "-q")
        if process.returncode == 2:
            line = one_line(process)
            require("holds no unfinished run" in line, line)
        else:
            require(process.returncode == 0, f"--restart: exit {process.returncode}: {process.stderr_text}")
        if process.returncode == 2 or (self.overwrites and not difference(visible(folder), self.old)):
            process = self.bench.run(*self.command(folder))
            require(process.returncode == 0, f"run again: exit {process.returncode}: {process.stderr_text}")
        require_same(alone(folder), self.new, "other results after all")


def trials(bench, overwrites, kinds, every=1):
    """For each kind every so many of the calls, a different one for each kind."""
    setting = Setting(bench, overwrites)
    calls = setting.calls()
    for k, (mode, error) in enumerate(kinds):
        for n in range(1 + k % every, calls + 1, every):
            yield Trial(
                f"{'over results' if overwrites else 'empty folder'}, call {n} of {calls}, {mode} "
                f"{errno.errorcode.get(error, '')}",
                lambda n=n, mode=mode, error=error: setting.trial(n, mode, error),
            )
