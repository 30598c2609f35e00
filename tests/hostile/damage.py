# SPDX-License-Identifier: BSD-3-Clause
"""Unfinished runs that somebody damages, and then goes on with: refused in one line, or the same results."""

import hashlib
import io
import math
import os
import random
import shutil
import signal
import struct

import h5py
from common import finished, one_line, require_done, wait_until_or_over

from .cases import long
from .energy import relative_imbalance
from .trials import TRIES, Trial, Wrong, alone, remove, require, require_same, stopped_under_way

SUM_DIGITS = 64  # at the end of a checkpoint
LEFT_BY_FORGERY = 2e-6  # of the largest term of the energies: the program refuses from 1e-6 on
FEW = ("--checkpoint-every", "1e9", "--checkpoint-every-simulated")


def sealed(contents):
    """A checkpoint of these bytes with a checksum that fits."""
    return contents + hashlib.sha256(contents).hexdigest().encode()


def change(path, edit):
    path.write_bytes(edit(path.read_bytes()))


def flip(dice):
    def edit(data):
        place = dice.randrange(len(data))
        return data[:place] + bytes([data[place] ^ 1 << dice.randrange(8)]) + data[place + 1 :]

    return edit


def cut(dice):
    return lambda data: data[: dice.randrange(len(data))]


def interrupted(bench, case):
    """The folder of a run that has two checkpoints; again where it was over before it could be stopped."""
    for _ in range(TRIES):
        folder = bench.folder()
        process = bench.start("run", case, "-o", folder, "-q", *FEW, "2e-5")
        wait_until_or_over((folder / "unfinished/state/checkpoint-000002.bin").exists, process)
        process.send_signal(signal.SIGTERM)
        ended = finished(process)
        if ended.returncode != 0:
            require(ended.returncode == 128 + signal.SIGTERM, ended)
            return folder
    raise Wrong("over too soon, each time")


class Setting:
    """A run that was interrupted with two checkpoints, and what it comes to undisturbed."""

    def __init__(self, bench, kind):
        self.bench = bench
        self.settings = long(kind)
        self.case = bench.case(self.settings)
        whole = bench.result(self.case)
        self.expected = alone(whole)
        remove(whole.parent)
        self.folder = interrupted(bench, self.case)
        self.other = interrupted(bench, bench.case(long(kind) | {"friction.mu_k": 0.55}))

    def trial(self, damage, may_be):
        """@param may_be  exit codes that are right"""
        folder = self.bench.folder()
        shutil.copytree(self.folder, folder)
        state = folder / "unfinished/state"
        damage(folder / "unfinished", state, sorted(state.glob("checkpoint-*.bin")))
        process = self.bench.run("run", "--restart", folder, "-q")
        lines = process.stderr.splitlines()
        errors = [line for line in lines if not line.startswith("note: ")]
        require(process.returncode in may_be, process)
        require(len(errors) == (1 if process.returncode else 0), process.stderr)
        if process.returncode == 0:
            require_same(alone(folder), self.expected, "done, and other results")
        else:
            require(str(folder) in errors[0], f"names no file: {errors[0]}")
            require(not (folder / "run.json").exists(), "results after a refusal")
        remove(folder.parent)


def damages(dice, other):
    """Name, what is done to (unfinished, state, checkpoints), and the exit codes that are right."""
    rows = ("interface.h5", "fields.vtkhdf")

    def both(edit):
        return lambda u, s, c: [change(path, edit) for path in c]

    def state_file(name, edit):
        return lambda u, s, c: change(s / name, edit)

    def result_file(name, edit):
        return lambda u, s, c: change(u / name, edit)

    def from_other(u, s, c):
        shutil.copy(max((other / "unfinished/state").glob("checkpoint-*.bin")), c[-1])

    def all_from_other(u, s, c):
        shutil.rmtree(s)
        shutil.copytree(other / "unfinished/state", s)

    def relabelled(old, new):
        return both(lambda data: sealed(data[:-SUM_DIGITS].replace(old, new, 1)))

    for k in range(12):
        yield f"byte of the last checkpoint {k}", lambda u, s, c: change(c[-1], flip(dice)), {0}
        yield f"cut last checkpoint {k}", lambda u, s, c: change(c[-1], cut(dice)), {0}
    for name in rows:
        # The head is written anew, and behind what a checkpoint counts on anything may be there; between them
        # all must be as it was.
        for k in range(6):
            yield f"byte of {name} {k}", result_file(name, flip(dice)), {0, 2}
            yield f"cut {name} {k}", result_file(name, cut(dice)), {0, 2}
        yield f"first byte of {name}", result_file(name, lambda data: b"x" + data[1:]), {0}
        yield f"first row of {name}", result_file(name, first_row_changed), {2}
        yield f"empty {name}", result_file(name, lambda data: b""), {2}
        yield f"no {name}", lambda u, s, c, name=name: (u / name).unlink(), {2}
        yield f"longer {name}", result_file(name, lambda data: data + b"more"), {0}
    yield "bytes of both checkpoints", both(flip(dice)), {0}
    yield "empty checkpoints", both(lambda data: b""), {0}
    yield "bytes behind a checkpoint", lambda u, s, c: change(c[-1], lambda data: data + b"x"), {0}
    yield "sealed bytes behind the checkpoints", both(lambda d: sealed(d[:-SUM_DIGITS] + b"x")), {2}
    yield "sealed halves of checkpoints", both(lambda d: sealed(d[: len(d) // 2])), {2}
    yield "another program's checkpoints", relabelled(b", build ", b", built "), {2}
    yield "another form of checkpoints", relabelled(b"slipfront checkpoint ", b"slipfront checkpoint 9"), {0}
    yield "no checkpoint", lambda u, s, c: [path.unlink() for path in c], {0}
    yield "a checkpoint of another case", from_other, {2}
    yield "the state of another case", all_from_other, {2}
    yield "a folder as checkpoint", lambda u, s, c: (s / "checkpoint-000009.bin").mkdir(), {0}
    case = "case.resolved.toml"
    yield "a case with another value", result_file(case, lambda d: d.replace(b"mu_k = ", b"mu_k = 0.1#")), {2}
    yield "a case with another comment", result_file(case, lambda d: b"# mine\n" + d), {0}
    yield "half a case", result_file(case, lambda d: d[: len(d) // 2]), {2}
    yield "no case", lambda u, s, c: (u / case).unlink(), {2}
    yield "no kind", lambda u, s, c: (s / "kind").unlink(), {2}
    yield "another kind", state_file("kind", lambda d: b"study\n"), {2}
    yield "no state", lambda u, s, c: shutil.rmtree(s), {2}
    yield "static.csv", result_file("static.csv", flip(dice)), {0}
    yield "no static.csv", lambda u, s, c: (u / "static.csv").unlink(), {0}
    yield "run.json", result_file("run.json", flip(dice)), {0}
    tables, begun = ("fronts.csv", "energy.csv"), ("run.json.new", "interface.h5.new")
    yield "fronts.csv and energy.csv", lambda u, s, c: [os.truncate(u / n, 9) for n in tables], {0}
    yield "files cut off", lambda u, s, c: [(u / n).write_text("x") for n in begun], {0}


#: Put in place of eight bytes of a checkpoint.
_ODD = [
    *(struct.pack("<d", value) for value in (math.nan, math.inf, -math.inf, 0, -1, 1e300, 5e-324)),
    *(struct.pack("<q", value) for value in (1, 2, -1, 2**31 - 1, 2**31, 2**63 - 1)),
]


def forged(setting, seed):
    """A checkpoint with other numbers and a checksum that fits is refused, or the run goes on with them to
    results whose energies balance, or is seen to blow up."""
    dice = random.Random(seed)
    folder = setting.bench.folder()
    shutil.copytree(setting.folder, folder)
    last = max((folder / "unfinished/state").glob("checkpoint-*.bin"))
    contents = bytearray(last.read_bytes()[:-SUM_DIGITS])
    for _ in range(dice.choice((1, 1, 4))):
        # Counts and single numbers are near the ends, in between is motion.
        n = dice.choice((len(contents), 1 << 13)) - 8
        place = dice.choice((dice.randrange(n), len(contents) - 8 - dice.randrange(n)))
        flipped = flip(dice)(contents[place : place + 8])
        contents[place : place + 8] = dice.choice((dice.choice(_ODD), flipped))
    last.write_bytes(sealed(bytes(contents)))
    process = setting.bench.run("run", "--restart", folder, "-q")
    require(process.returncode in (0, 2, 3), process)
    errors = [line for line in process.stderr.splitlines() if not line.startswith("note: ")]
    require(len(errors) == (process.returncode != 0), process.stderr)
    if process.returncode == 0:
        alone(folder)
        imbalance = relative_imbalance(folder, setting.settings)
        require(imbalance < LEFT_BY_FORGERY, f"imbalance {imbalance:.3g}")
    else:
        require(str(folder) in errors[0], f"names no file: {errors[0]}")
    remove(folder.parent)


def forged_trials(bench, n, kinds=("triggered", "prestressed_absorbing", "predictor_corrector", "graded")):
    for kind in kinds:
        setting = Setting(bench, kind)
        for seed in range(n):
            yield Trial(f"forged {kind} {seed}", lambda s=setting, seed=seed: forged(s, seed))


_UNIFORM = ("prestress.t_Pa", "prestress.p_Pa")


def changed_table(bench, name, text, changed):
    """A table that is changed between a run's beginning and its end: the run has its own."""
    table = bench.folder().with_suffix(".csv")
    table.parent.mkdir(parents=True)
    table.write_text(text)
    settings = long("prestressed_absorbing") | {f"{name}.file": str(table)}
    settings["time.end_s"] *= 8  # not to be over before it is stopped
    replaced = _UNIFORM if name == "prestress" else ()
    case = bench.case({key: value for key, value in settings.items() if key not in replaced})
    expected = alone(bench.result(case))
    folder = interrupted(bench, case)
    table.write_text(changed)
    own = folder / f"unfinished/{name}.csv"
    require(own.read_text() == text, "the table is not kept")
    own.write_text(changed)
    line = one_line(bench.run("run", "--restart", folder, "-q"), 2)
    require(str(own) in line, line)
    own.write_text(text)
    require_done(bench.run("run", "--restart", folder, "-q"))
    require_same(alone(folder), expected, "other results")


def first_row_at(file):
    """Of a file that is finished or not."""
    first = int.from_bytes(file.read(8), "little")
    if first % 4096:
        with h5py.File(file, "r") as hdf5:
            return hdf5["rows"].id.get_offset()
    return first


def has_row(path):
    with open(path, "rb") as file:
        return path.stat().st_size >= first_row_at(file) + 16


def first_row_changed(data):
    first = first_row_at(io.BytesIO(data))
    return data[:first] + b"12345678" + data[first + 8 :]


def meddlings():
    """Name, what is done to (unfinished, state) of a run that goes on, and the exit code: what is on its way
    to the results is compared, what is small is written anew."""
    for name in ("interface.h5", "fields.vtkhdf"):

        def change_first(u, s, name=name):
            with open(u / name, "r+b") as file:
                file.seek(first_row_at(file))
                file.write(b"12345678")

        yield f"changed {name}", change_first, 1
        yield f"cut {name}", lambda u, s, name=name: os.truncate(u / name, 4), 1
        yield f"removed {name}", lambda u, s, name=name: (u / name).unlink(), 1
    for name in ("case.resolved.toml", "static.csv", "energy.csv", "fronts.csv", "run.json"):
        yield f"changed {name}", lambda u, s, name=name: (u / name).write_text("mine\n"), 0
        yield f"removed {name}", lambda u, s, name=name: (u / name).unlink(), 0


def is_under_way(folder):
    """Rows of both records are there."""
    rows = [folder / "unfinished" / name for name in ("interface.h5", "fields.vtkhdf")]
    begun = (folder / "unfinished/fronts.csv").exists()
    return begun and all(path.exists() and has_row(path) for path in rows)


def meddle(setting, how, may_be):
    """The same while the run goes on."""
    process, folder = stopped_under_way(setting.bench, setting.case, is_under_way)
    state = folder / "unfinished/state"
    how(folder / "unfinished", state)
    process.send_signal(signal.SIGCONT)
    ended = finished(process)
    # Where it was done with the file before, the results are right all the same.
    require(ended.returncode in (0, may_be), ended)
    if ended.returncode == 0:
        require_same(alone(folder), setting.expected, "done, and other results")
    else:
        require(str(folder) in one_line(ended, may_be), ended)
        require(not (folder / "run.json").exists(), "results after a refusal")
    remove(folder.parent)


def trials(bench, seed=1, kind="triggered", every=1):
    setting = Setting(bench, kind)
    dice = random.Random(seed)
    for k, (name, damage, may_be) in enumerate(damages(dice, setting.other)):
        if k % every == 0 or k >= 40:
            yield Trial(name, lambda damage=damage, may_be=may_be: setting.trial(damage, may_be))
    for name, how, may_be in meddlings():
        yield Trial(f"while it goes: {name}", lambda how=how, may_be=may_be: meddle(setting, how, may_be))
    for name, text, old, new in (
        ("prestress", "x_m,t_Pa,p_Pa\n0,2.2e6,5e6\n0.1,2.2e6,5e6\n", "0,2.2e6", "0,2.1e6"),
        ("friction", "x_m,d_c_m\n0,4e-6\n0.1,5e-6\n", "5e-6", "6e-6"),
    ):
        table = (name, text, text.replace(old, new, 1))
        yield Trial(f"a changed table of {name}", lambda table=table: changed_table(bench, *table))
