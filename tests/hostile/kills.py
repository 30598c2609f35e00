# SPDX-License-Identifier: BSD-3-Clause
"""Runs that are killed at random moments, gone on with, killed again, until they are done."""

import random
import signal
import time

from common import finished, require_done

from .cases import KINDS, long
from .trials import Trial, alone, remove, require, require_same

OFTEN = ("--checkpoint-every", "0.05")


class Setting:
    def __init__(self, bench, kind):
        self.bench = bench
        self.case = bench.case(long(kind))
        start = time.monotonic()
        folder = bench.result(self.case)
        self.duration_s = time.monotonic() - start
        self.expected = alone(folder)
        remove(folder.parent)

    def trial(self, seed):
        """Killed up to four times, with another number of threads each time."""
        dice = random.Random(seed)
        folder = self.bench.folder()
        folder.parent.mkdir(parents=True)
        begin = ("run", self.case, "-o", folder, "-q")
        command = begin
        for _ in range(dice.randint(1, 4)):
            process = self.bench.start(*command, *OFTEN, "--threads", dice.randint(1, 3))
            time.sleep(dice.uniform(0, 1.1 * self.duration_s))
            process.send_signal(signal.SIGKILL)
            killed = finished(process)
            if killed.returncode == 2 and command != begin:
                require("holds no unfinished run" in killed.stderr, killed)
                command = begin
            else:
                require(killed.returncode in (-signal.SIGKILL, 0), killed)
                if folder.exists():
                    command = ("run", "--restart", folder, "-q")
        process = self.bench.run(*command, "--threads", dice.randint(1, 3))
        if process.returncode == 2 and "holds no unfinished run" in process.stderr:
            process = self.bench.run(*begin)
        require_done(process)
        require_same(alone(folder), self.expected, "other results")
        remove(folder.parent)


def trials(bench, n, seed=1, kinds=tuple(KINDS)):
    """As many trials in all, over all kinds of cases."""
    settings = {kind: Setting(bench, kind) for kind in kinds}
    for k in range(n):
        kind = kinds[k % len(kinds)]
        setting = settings[kind]
        yield Trial(f"{kind}, seed {seed + k}", lambda setting=setting, s=seed + k: setting.trial(s))
