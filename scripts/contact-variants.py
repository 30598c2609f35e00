# SPDX-License-Identifier: BSD-3-Clause
"""A row of masses falls onto a plane with several ways to resolve the landing. Prints the numbers of
papers/kammer2012/contact-algorithms.md.

The row is a column of square elements with lumped masses, of height, density and wave speed 1, falling with
speed 1: verification/impact.md. Half a mass at either end.

direct       closes the gap at the step's end by a pressure
reflection   a node that would pass the plane gets the opposite of its last velocity
massless     the lowest node has no mass, the next one has it too; it stands where the forces on it balance
penalty      a spring of ten elements' stiffness under the plane instead of the constraint
"""

from __future__ import annotations

import math
from dataclasses import dataclass


@dataclass
class Row:
    variant: str
    n: int  # elements
    r: float  # step over the time a wave takes through an element
    pull: float = 0.0  # traction that draws the lower face down

    def __post_init__(self) -> None:
        self.h = 1 / self.n
        self.k = 1 / self.h
        self.mass = [self.h] * (self.n + 1)
        self.mass[0] = self.mass[-1] = 0.5 * self.h
        if self.variant == "massless":
            self.mass[1] += self.mass[0]
            self.mass[0] = 0.0
        self.k_plane = 10 * self.k
        # The penalty's spring raises the highest frequency, by less than this.
        self.dt = self.r * self.h / (math.sqrt(6) if self.variant == "penalty" else 1)
        self.u = [3.5 * self.dt] * (self.n + 1)  # heights over the places at rest on the plane
        self.v = [-1.0] * (self.n + 1)
        self.p = 0.0
        self.touches = False
        self.changes = 0
        self.time = 0.0
        self.place_lowest()

    def place_lowest(self) -> None:
        if self.variant == "massless":
            self.u[0] = max(0.0, self.u[1] - self.pull / self.k)
            self.p = max(0.0, self.pull - self.k * (self.u[1] - self.u[0]))

    def step(self) -> None:
        u, v, k, dt = self.u, self.v, self.k, self.dt
        stretch = [k * (b - a) for a, b in zip(u, u[1:], strict=False)]
        before = v[0]
        if self.mass[0] > 0:
            v[0] += dt * (stretch[0] - self.pull) / self.mass[0]
        for i in range(1, self.n):
            v[i] += dt * (stretch[i] - stretch[i - 1]) / self.mass[i]
        v[-1] -= dt * stretch[-1] / self.mass[-1]
        if self.mass[0] > 0:
            self.touch(before)
            u[0] += dt * v[0]
        for i in range(1, self.n + 1):
            u[i] += dt * v[i]
        self.place_lowest()
        self.changes += (self.p > 0) != self.touches
        self.touches = self.p > 0
        self.time += dt

    def touch(self, before: float) -> None:
        per_step = self.mass[0] / self.dt
        trial = self.v[0]
        passes = self.u[0] + self.dt * trial < 0
        if self.variant == "direct":
            self.p = max(0.0, -(trial + self.u[0] / self.dt) * per_step)
        elif self.variant == "reflection":
            self.p = (-before - trial) * per_step if passes and before < -trial else 0.0
            if passes and self.p == 0:  # it rests or rises: only a pressure closes the gap
                self.p = -(trial + self.u[0] / self.dt) * per_step
        else:
            self.p = max(0.0, -self.k_plane * self.u[0])
        self.v[0] += self.p / per_step

    def mean_v(self) -> float:
        return sum(m * v for m, v in zip(self.mass, self.v, strict=True))

    def energy(self) -> float:
        """Kinetic and strain energy about the last half step, and the pull's potential."""
        u, dt = self.u, self.dt
        w = [a - dt * v for a, v in zip(u, self.v, strict=True)]  # places before the step
        if self.mass[0] == 0:
            w[0] = w[1] - (u[1] - u[0])  # in the air the lowest spring keeps its length
        e = sum(0.5 * m * v * v for m, v in zip(self.mass, self.v, strict=True))
        e += sum(0.5 * self.k * (u[i + 1] - u[i]) * (w[i + 1] - w[i]) for i in range(self.n))
        return e + self.pull * 0.5 * (u[0] + w[0])


VARIANTS = ("direct", "reflection", "massless", "penalty")


def single(n: int) -> None:
    print(
        f"\n| one impact, {n} elements | step | bounce | contact / (2 H/c) | energy lost | "
        "changes of contact | highest p |"
    )
    print("|---|---|---|---|---|---|---|")
    for variant in VARIANTS:
        for r in (0.9, 0.05):
            row = Row(variant, n, r)
            start = row.energy()
            first = last = math.nan
            highest = 0.0
            while row.time < 3:
                row.step()
                highest = max(highest, row.p)
                if row.touches:
                    first = row.time if math.isnan(first) else first
                    last = row.time
            print(
                f"| {variant} | {r} | {row.mean_v():.3f} | {(last - first) / 2:.3f} | "
                f"{100 * (1 - row.energy() / start):.3f} % | {row.changes} | {highest:.1f} |"
            )


def many(n: int, pull: float = 0.1, flights: int = 20) -> None:
    print(
        f"\n| {flights} flights, {n} elements | step | energy lost | landings | pull larger by 1e-12: lost | "
        "landings |\n|---|---|---|---|---|---|"
    )
    flight = 2 / pull
    for variant in VARIANTS:
        for r in (0.9, 0.3):
            cells = []
            for change in (0.0, 1e-12):  # tells what is determined from what rounding decides
                row = Row(variant, n, r, pull * (1 + change))
                start = row.energy()
                while row.time < flights * flight or row.touches:
                    row.step()
                cells += [f"{100 * (1 - row.energy() / start):.1f} %", str((row.changes + 1) // 2)]
            print(f"| {variant} | {r} | {' | '.join(cells)} |")


if __name__ == "__main__":
    single(50)
    many(50)
