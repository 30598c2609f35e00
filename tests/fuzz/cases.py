# SPDX-License-Identifier: BSD-3-Clause
"""Random cases of all keys, for `validate`, `info`, `fracture` and `run`: `make fuzz-cases`.

Keys, types and words are those that `slipfront keys` prints. A case is small, most of its numbers suit its
plate, some are anything within the range of their unit. Keys of which `validate` says that they do not apply
are left out until it takes the case, or nothing is left to be left out. Of each command it is asked that it

- ends with 0, or with 2 (the case) or 3 (the motion blows up) and one line, `run` within the time predicted;
- leaves no number that is not finite where it ends with 0.

Case k of `--seed s` is the first of `--seed s+k`."""

import argparse
import csv
import json
import math
import random
import re
import shutil
import subprocess
import sys
import tempfile
import time
from collections import Counter
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import h5py
import numpy as np

ROOT = Path(__file__).resolve().parents[2]
#: `run` is not tried where more is predicted, and a forecast is not asked to be better than so many times.
MOST_S, MOST_BYTES, TIMES_FORETOLD, START_S = 1.0, 3e7, 20, 10
HANG_S = 60
SIZES = ("plate.width_m", "plate.height_m", "plate.element_size_m")
#: Lengths that are slips, not sizes of the plate.
SLIPS = re.compile(r"d_c_m|table_slip_m|tilt_|shears_m|relaxation_length_m")
NO_NUMBER = re.compile(r"(?<![\w.-])-?(nan|inf)(?![\w])", re.IGNORECASE)


class Found(AssertionError):
    """What must not happen."""


def require(condition, what):
    if not condition:
        raise Found(what)


def call(program, *arguments, seconds=HANG_S, cwd=None):
    try:
        return subprocess.run(
            [program, *map(str, arguments)], capture_output=True, text=True, timeout=seconds, cwd=cwd
        )
    except subprocess.TimeoutExpired:
        raise Found(f"{' '.join(map(str, arguments))}: not over within {seconds:.3g} s") from None


def grammar(program):
    """Of each key its type, unit, default, and words; of a law's parameters their laws, too."""
    keys, table, law = {}, "", None
    for line in call(program, "keys").stdout.splitlines():
        if head := re.match(r"## \[(\w+)\]", line):
            table, law = head[1] + ".", None
        elif head := re.match(r'With `law = "(\w+)"`', line):
            law = head[1]
        elif row := re.match(
            r"\| `(\w+)` \| ([a-z ]+) \| ([^|]*) \| ((?:\\\||[^|])*) \| ((?:\\\||[^|])*) \|", line
        ):
            name, kind, unit, default, allowed = (cell.strip() for cell in row.groups())
            key = keys.setdefault(table + name, {"kind": kind, "unit": unit, "default": default, "laws": []})
            key["words"] = re.findall(r'"(\w+)"', allowed)
            key["whole"] = [int(n) for n in re.findall(r"at (?:least|most) (\d+)", allowed)]
            if law:
                key["laws"].append(law)
    return keys


def ranges(program):
    """Magnitudes that numbers of each unit may have."""
    rows = re.findall(r"^\| ([\w/]+) \| (\S+) \| (\S+) \|$", call(program, "keys").stdout, re.MULTILINE)
    return {unit: (float(low), float(high)) for unit, low, high in rows}


class Maker:
    """Makes one case."""

    def __init__(self, seed, keys, magnitudes):
        self.r = random.Random(seed)
        self.keys, self.magnitudes = keys, magnitudes

    def power(self, low, high):
        return math.exp(self.r.uniform(math.log(low), math.log(high)))

    def number(self, name, key):
        """Mostly of the order of the plate's size, times and tractions; else anything."""
        r = self.r
        if r.random() < self.wild:
            return r.choice([0.0, -1.0, 1.0]) * self.power(*self.magnitudes.get(key["unit"], (1e-18, 1e9)))
        if r.random() < 0.04 and "inf" in key["default"]:
            return math.inf
        sign = -1 if r.random() < 0.08 else 1
        if key["unit"] == "m" and SLIPS.search(name):
            return sign * self.width_m * self.power(1e-8, 1e-3)
        spread = {
            "m": (0.3 * self.h_m, self.width_m),
            "s": (1e-2 * self.crossing_s, 4 * self.crossing_s),
            "Pa": (1e-5 * self.E_Pa, 1e-2 * self.E_Pa),
            "Pa/s": (1e-5 * self.E_Pa / self.crossing_s, 1e-3 * self.E_Pa / self.crossing_s),
            "N/m": (1e-6 * self.E_Pa * self.width_m, 1e-3 * self.E_Pa * self.width_m),
            "m/s": (1e-12, 2 * self.c_m_per_s),
        }.get(key["unit"])
        if spread:
            return sign * self.power(*spread)
        try:
            return sign * float(key["default"].strip("`")) * self.power(0.3, 2)
        except ValueError:
            return sign * self.power(1e-3, 2)

    def value(self, name, key):
        r, kind = self.r, key["kind"]
        if kind == "word":
            return r.choice(key["words"])
        if kind == "true or false":
            return r.random() < 0.5
        if kind == "integer":
            least = key["whole"][0] if key["whole"] else 0
            return least + r.choice([0, 1, 2, 3, 5, 17])
        if kind == "list of numbers":
            values = [
                abs(self.number(name, key)) for _ in range(self.lists.setdefault(name[:12], r.randint(1, 4)))
            ]
            values = sorted(values) if not name.endswith(("mu", "y_m")) else values
            return [0.0, *values[1:]] if name.startswith("friction.table") and "mu" not in name else values
        if kind in ("string", "list of strings"):
            return None
        return self.number(name, key)

    def case(self):
        r = self.r
        self.wild = r.choice([0.02, 0.02, 0.2])
        columns, self.width_m = r.randint(8, 40), self.power(1e-4, 1e4) if r.random() < 0.5 else 0.2
        self.h_m, rows = self.width_m / columns, r.randint(3, 24)
        self.E_Pa, rho = (self.power(1e8, 3e11), self.power(1e3, 8e3)) if r.random() < 0.9 else (2.6e9, 1.2e3)
        self.c_m_per_s = math.sqrt(self.E_Pa / 2.6 / rho)
        self.crossing_s = self.width_m / self.c_m_per_s
        self.lists = {}
        law = r.choice(self.keys["friction.law"]["words"])
        case = {
            "plate.width_m": self.width_m,
            "plate.element_size_m": self.h_m,
            "plate.height_m": self.h_m * rows,
            "material.youngs_modulus_Pa": self.E_Pa,
            "material.density_kg_per_m3": rho,
            "friction.law": law,
            "event.kind": r.choice(self.keys["event.kind"]["words"]),
            "loading.method": r.choice(["direct", "direct", "prestress", "prestress", "ramp"]),
            "plate.corner": r.choice(["none", "none", *self.keys["plate.corner"]["words"]]),
            "time.end_s": self.crossing_s * self.power(0.2, 6),
        }
        p_Pa = self.E_Pa * self.power(1e-5, 1e-2)
        if case["loading.method"] == "prestress":
            case |= {"prestress.p_Pa": p_Pa, "prestress.t_Pa": p_Pa * r.uniform(-0.8, 0.8)}
        elif r.random() < 0.9:
            case["loading.mean_pressure_Pa"] = p_Pa
        if r.random() < 0.3 and case["loading.method"] == "direct":
            case |= {"sequence.max_events": r.choice([2, 3]), "event.kind": "spontaneous"}
        if r.random() < 0.4:
            like = r.random() < 0.5
            case |= {"base.kind": "body", "base.height_m": self.h_m * r.randint(3, 24)}
            case["base.youngs_modulus_Pa"] = self.E_Pa * (1 if like else self.power(1e-3, 1e3))
            case["base.density_kg_per_m3"] = rho * (1 if like else self.power(0.3, 3))
            case["base.poissons_ratio"] = 0.37 if like else r.uniform(-0.9, 0.49)
        else:
            case["base.kind"] = "rigid"
        density = r.choice([0.05, 0.15, 0.4])
        for name, key in self.keys.items():
            if name in case or name.endswith("file") or (key["laws"] and law not in key["laws"]):
                continue
            needed = name in ("nucleation.front_speed_m_per_s", "nucleation.weakening_time_s")
            own = 0.5 if key["laws"] else density
            if (r.random() < own or needed) and (value := self.value(name, key)) is not None:
                case[name] = value
        return case


def toml(value):
    if isinstance(value, float) and math.isinf(value):
        return "inf"
    return json.dumps(value)


def write(case, file):
    file.write_text("".join(f"{key} = {toml(value)}\n" for key, value in case.items()))


def ended(result, *codes):
    """Checks how a command ended. @return its exit code"""
    what = f"{' '.join(map(str, result.args[1:]))}: exit code {result.returncode}\n{result.stderr[-2000:]}"
    require(result.returncode in codes, what)
    lines = result.stderr.splitlines()
    if result.returncode:
        require(
            len(lines) == 1 and (result.returncode != 2 or not result.stdout), what + result.stdout[-500:]
        )
    else:
        require(not lines, what)
        for line in result.stdout.splitlines():
            require(not NO_NUMBER.search(line), f"{result.args[1]}: {line}")
    return result.returncode


#: What is tried where keys that are refused have their defaults.
OTHERWISE = {
    "plate.corner": "none",
    "time.interface_rows": 1,
    "nucleation.form": "overstress",
    "event.trigger_form": "weakened",
}


def taken(program, case, file):
    """Leaves out what the program refuses. @return whether it takes the case in the end"""
    otherwise = dict(OTHERWISE)
    for _ in range(60):
        write(case, file)
        result = call(program, "validate", file)
        if ended(result, 0, 2) == 0:
            return True
        named = re.findall(r"[a-z]+\.\w+", result.stderr.split(".toml", 1)[-1])
        drop = [key for key in named if key in case and key not in SIZES]
        instead = [key for key in otherwise for name in named if key.split(".")[0] == name.split(".")[0]]
        if drop:
            del case[drop[0]]
        elif instead:
            case[instead[0]] = otherwise.pop(instead[0])
        else:
            return False
    return False


def check_results(folder):
    """Numbers in results that are not finite; of histories those at nodes that slip."""
    for file in folder.rglob("*"):
        if file.suffix == ".json":
            json.loads(
                file.read_text(), parse_constant=lambda word, f=file: require(False, f"{f.name}: {word}")
            )
        elif file.suffix == ".csv":
            for row in csv.reader(file.read_text().splitlines()):
                require(not any(NO_NUMBER.fullmatch(cell) for cell in row), f"{file.name}: {row}")
        elif file.suffix in (".h5", ".vtkhdf"):
            with h5py.File(file) as h5:
                h5.visititems(lambda name, data, f=file: check_array(f.name, name, data))


def check_array(file, name, data):
    if isinstance(data, h5py.Dataset) and data.dtype.kind == "f":
        require(np.isfinite(data[()]).all(), f"{file}: {name} has numbers that are not finite")


def predicted(printed):
    """Time and disk of a run, and whether these leave something out."""
    seconds = float(re.search(r"^expected time +(\S+) s", printed, re.MULTILINE)[1])
    disk = 1e9 * float(re.search(r"^disk +(\S+) GB", printed, re.MULTILINE)[1])
    events = re.search(r"^sequence +at most (\d+) events", printed, re.MULTILINE)
    return seconds * (int(events[1]) if events else 1), disk


def trial(program, seed, keys, magnitudes, folder):
    """One case. @return how far it came"""
    file, out = folder / f"{seed}.toml", folder / f"{seed}"
    case = Maker(seed, keys, magnitudes).case()
    if not taken(program, case, file):
        return "refused by validate"
    ended(call(program, "fracture", file), 0, 2)
    info = call(program, "info", file)
    if ended(info, 0, 2):
        return "refused by info"
    seconds, disk = predicted(info.stdout)
    if seconds > MOST_S or disk > MOST_BYTES:
        return "too long to run"
    limit_s = START_S + TIMES_FORETOLD * seconds
    run = call(program, "run", file, "-o", out, "-q", "--threads", 1, seconds=limit_s)
    code = ended(run, 0, 2, 3)
    if code == 0:
        check_results(out)
    elif code == 3 and case.get("time.allow_unstable"):
        return "blew up, with unstable steps"
    elif code == 3:
        print(f"seed {seed}: {run.stderr.strip()[:300]}", flush=True)
    return {0: "ran", 2: "refused by run", 3: "blew up"}[code]


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("program", type=Path)
    parser.add_argument("--seed", type=int, default=None)
    parser.add_argument("--cases", type=int, default=1000)
    parser.add_argument("--jobs", type=int, default=2)
    parser.add_argument(
        "--keep", type=Path, default=Path("fuzz-cases"), help="where cases that found something go"
    )
    options = parser.parse_args()
    program = options.program.resolve()
    seed = random.SystemRandom().randrange(10**9) if options.seed is None else options.seed
    print(f"seed {seed}, {options.cases} cases", flush=True)
    keys, magnitudes, start = grammar(program), ranges(program), time.monotonic()
    outcomes = Counter()
    with tempfile.TemporaryDirectory(prefix="slipfront-fuzz-") as scratch:

        def one(k):
            folder = Path(scratch) / str(k)
            folder.mkdir()
            try:
                outcomes[trial(program, seed + k, keys, magnitudes, folder)] += 1
            except Found as found:
                outcomes["FOUND"] += 1
                options.keep.mkdir(parents=True, exist_ok=True)
                shutil.copy(folder / f"{seed + k}.toml", options.keep)
                print(f"seed {seed + k}: {found}", flush=True)
            shutil.rmtree(folder)

        with ThreadPoolExecutor(options.jobs) as pool:
            list(pool.map(one, range(options.cases)))
    for outcome, count in outcomes.most_common():
        print(f"{count:6d} {outcome}")
    print(f"{time.monotonic() - start:.0f} s")
    sys.exit("cases that found something: " + str(options.keep) if outcomes["FOUND"] else 0)


if __name__ == "__main__":
    main()
