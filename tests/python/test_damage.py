# SPDX-License-Identifier: BSD-3-Clause
"""Whatever the files of a result folder hold, they are read or refused in one line, without waiting.

Bytes are changed at random, SLIPFRONT_FUZZ_N times a test, from a seed, SLIPFRONT_FUZZ_SEED.
"""

from __future__ import annotations

import io
import os
import random
import shutil
import signal
from contextlib import contextmanager, redirect_stderr, redirect_stdout
from pathlib import Path

import pytest
from common import HANG_S, loaded_script
from draw import main as draw_paper
from drawing import open_choices
from drawing.results import read_results
from report import KINDS as OF_PAPER
from slipfront import command
from slipfront.figures import interface_step
from slipfront.figures.__main__ import main
from slipfront.figures.drawing import write_results
from slipfront.files import DataError
from slipfront.report.command import KINDS
from slipfront.report.command import main as report
from synthetic import interrupt, seal, write_output
from synthetic_study import write_interface_step, write_open_choices, write_study, write_verification

FUZZ_N = int(os.environ.get("SLIPFRONT_FUZZ_N", "16"))
SEED = int(os.environ.get("SLIPFRONT_FUZZ_SEED", "20120401"))
TEXTS = b'\xff \0 nan inf -1 0 1e308 1e999 null [] {} " # \n'.split(b" ")


@contextmanager
def time_limit(what: str):
    def expire(*_):
        raise TimeoutError(f"{what}: no end after {HANG_S} s")

    before = signal.signal(signal.SIGALRM, expire)
    signal.alarm(HANG_S)
    try:
        yield
    finally:
        signal.alarm(0)
        signal.signal(signal.SIGALRM, before)


def mutated(data: bytes, rng: random.Random) -> bytes:
    """Cut off, some bytes changed, a piece replaced by another text, or a piece repeated."""
    kind = rng.randrange(5)
    at = rng.randrange(max(1, min(len(data), rng.choice((len(data), 4096)))))
    if kind == 0:
        return data[:at]
    if kind == 1:
        return data[:at] + rng.choice(TEXTS) + data[at + rng.randrange(8) :]
    if kind == 2:
        return data[:at] + data[at // 2 : at // 2 + 64] + data[at:]
    changed = bytearray(data)
    for _ in range(rng.choice((1, 1, 4, 16))):
        at = rng.randrange(max(1, min(len(data), rng.choice((len(data), 4096)))))
        changed[at : at + 1] = bytes(
            [rng.choice((0, 255, rng.randrange(256), changed[at] ^ 1 << rng.randrange(8)))]
        )
    return bytes(changed)


def fuzz(folder: Path, attempt) -> None:
    """Attempts, each with one file of the folder changed, of the files in turn; it is restored afterwards."""
    rng = random.Random(SEED)
    files = sorted(f for f in folder.rglob("*") if f.is_file() and "figures" not in f.parts)
    for n in range(FUZZ_N):
        file = files[n % len(files)]
        data = file.read_bytes()
        changed = mutated(data, rng)
        file.write_bytes(changed)
        try:
            with time_limit(str(file)):
                attempt()
        except BaseException:
            kept = Path("/tmp") / f"slipfront-fuzz-{file.name}"
            kept.write_bytes(changed)
            print(f"attempt {n} of seed {SEED} on {file}; the changed file is {kept}")
            raise
        finally:
            file.write_bytes(data)


def read_or_refused(read):
    def attempt():
        try:
            read()
        except DataError as error:
            assert "\n" not in str(error) and "/" in str(error)

    return attempt


def done_or_refused(command):
    def attempt():
        out, err = io.StringIO(), io.StringIO()
        with redirect_stdout(out), redirect_stderr(err):
            code = command()
        assert code in (0, 2)
        assert err.getvalue().count("\n") == (0 if code == 0 else 1), err.getvalue()

    return attempt


@pytest.fixture(scope="module")
def small(tmp_path_factory):
    """A reproduction of few numbers: most bytes matter."""
    return write_output(tmp_path_factory.mktemp("small") / "out", columns=10, rows=5, n_times=6, snapshots=3)


@pytest.fixture
def output(small, tmp_path):
    return shutil.copytree(small, tmp_path / "out")


@pytest.mark.slow
def test_a_damaged_reproduction_is_drawn_or_refused(output):
    fuzz(output, done_or_refused(lambda: draw_paper([str(output)])))


@pytest.mark.slow
@pytest.mark.parametrize("status", ["running", "interrupted", "blew_up"])
def test_a_damaged_unfinished_run_is_drawn_or_refused(output, status):
    run = output / "left"
    interrupt(run, status)
    fuzz(run, read_or_refused(lambda: read_results(output)))
    fuzz(run, done_or_refused(lambda: main([str(run)])))


verification = loaded_script("verification/figures.py")
STUDIES = {
    "study": (write_study, lambda folder, picture: main([str(folder)])),
    "verify": (write_verification, lambda folder, picture: verification.main(folder, picture.parent)),
    "step": (write_interface_step, lambda folder, picture: interface_step.main([str(picture), str(folder)])),
    "choices": (
        write_open_choices,
        lambda folder, picture: command.run("x", lambda: write_results(picture, folder, open_choices.draw)),
    ),
}


@pytest.mark.slow
@pytest.mark.parametrize("kind", STUDIES)
def test_a_damaged_study_is_drawn_or_refused(tmp_path, kind):
    write, draw = STUDIES[kind]
    folder, picture = write(tmp_path / kind), tmp_path / "picture.png"
    assert draw(folder, picture) == 0
    fuzz(folder, done_or_refused(lambda: draw(folder, picture)))


PAGES = {
    "reproduction": write_output,
    "run": lambda folder: write_output(folder, columns=10, rows=5, n_times=6, snapshots=3) / "left",
    "study": write_study,
    "step": write_interface_step,
}


@pytest.mark.slow
@pytest.mark.parametrize("kind", PAGES)
def test_a_damaged_folder_is_reported_or_refused(tmp_path, kind):
    folder, page = PAGES[kind](tmp_path / kind), tmp_path / "page.html"
    fuzz(folder, done_or_refused(lambda: report([str(folder), "-o", str(page)], (*OF_PAPER, *KINDS))))


def test_no_change_to_a_file_with_a_checksum_is_accepted(output):
    seal(output)
    read_results(output)
    rng = random.Random(SEED)
    for file in sorted(output.rglob("checksums.sha256")):
        data = file.read_bytes()
        for _ in range(10):
            file.write_bytes(mutated(data, rng))
            read_or_refused(lambda: read_results(output))()
        file.write_bytes(data)
    for file in sorted(f for f in output.rglob("*") if f.is_file() and f.name != "checksums.sha256"):
        data = file.read_bytes()
        for _ in range(2):
            changed = mutated(data, rng)
            if changed == data:
                continue
            file.write_bytes(changed)
            with pytest.raises(DataError, match="does not match checksums.sha256") as refused:
                read_results(output)
            assert str(file) in str(refused.value)
        file.write_bytes(data)
    read_results(output)
