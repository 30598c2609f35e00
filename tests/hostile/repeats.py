# SPDX-License-Identifier: BSD-3-Clause
"""Verifications that are cut off, and given again until they are done."""

import random
import signal
import time

from common import finished, require_done

from .trials import Trial, alone, remove, require, require_same

SIGNALS = (signal.SIGINT, signal.SIGTERM, signal.SIGKILL)
COMMAND = ("--quick", "rayleigh_wave", "symmetry", "growing_modes", "column", "impact")


class Setting:
    def __init__(self, bench):
        self.bench = bench = bench.of_verifications()
        folder = bench.folder()
        start = time.monotonic()
        process = bench.run(*COMMAND, "-o", folder)
        self.duration_s = time.monotonic() - start
        require_done(process)
        self.expected = alone(folder)

    def interrupted(self, folder, dice):
        """@return whether it is done"""
        process = self.bench.start(*COMMAND, "-o", folder)
        time.sleep(dice.uniform(0, self.duration_s))
        sent = dice.choice(SIGNALS)
        process.send_signal(sent)
        process = finished(process)
        # By the signal itself before the program has taken it into its own hands.
        if process.returncode in (128 + sent, -sent):
            return False
        self.require_done(process)
        return True

    def require_done(self, process):
        """Now, or by one that was killed when its results were complete: these are refused to be replaced."""
        refused = process.returncode == 2 and "is not empty" in process.stderr
        require(process.returncode == 0 or refused, process)

    def trial(self, seed):
        dice = random.Random(seed)
        folder = self.bench.folder()
        done = False
        for _ in range(dice.randint(1, 4)):
            done = done or self.interrupted(folder, dice)
        if not done:
            self.require_done(self.bench.run(*COMMAND, "-o", folder))
        require_same(alone(folder), self.expected, "other results")
        remove(folder.parent)


def trials(bench, n, seed=1):
    """As many."""
    setting = Setting(bench)
    for k in range(seed, seed + n):
        yield Trial(f"verify, seed {k}", lambda k=k: setting.trial(k))
