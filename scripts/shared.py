# SPDX-License-Identifier: BSD-3-Clause
"""What the scripts beside this file share: checked results, pages written whole, errors as one line."""

from __future__ import annotations

import argparse
import subprocess
import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

__all__ = ["DataError", "checked", "read_text", "write_figure"]  # handed on

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "python"))

import numpy as np
import slipfront
from slipfront import command
from slipfront.figures.picture import checked, write_figure
from slipfront.files import DataError, read_json, read_text
from slipfront.folder import result_file


def read_result(file: Path) -> Any:
    """A JSON file of a folder of results, refused where it is not as the folder's checksums say."""
    return read_json(result_file(file))


def run_case(program: str, case: Path, folder: Path, *settings: str) -> None:
    """Runs a case into a folder; whatever keeps it from that is one error."""
    overrides = [part for setting in settings for part in ("--set", setting)]
    command_line = [program, "run", str(case), "-o", str(folder), "--overwrite", "-q", *overrides]
    try:
        done = subprocess.run(command_line, stderr=subprocess.PIPE, text=True, check=False)
    except OSError as error:
        raise DataError(f"{program}: {error.strerror}") from None
    if done.returncode != 0:
        lines = done.stderr.strip().splitlines() or [f"exit code {done.returncode}"]
        raise DataError(f"{case.name}, {', '.join(settings)}: {lines[-1]}")
    if not result_file(folder / "run.json").is_file():
        raise DataError(f"{program}: left no results in {folder}")


@contextmanager
def expecting(what: str, file: Path) -> Iterator[None]:
    """Whatever values of a file are missing or of another kind is told as one error."""
    try:
        yield
    except (AttributeError, IndexError, KeyError, OverflowError, TypeError, ValueError) as error:
        raise DataError(f"{file}: not {what}: {type(error).__name__}: {error}") from None


def between_marks(page: Path, text: str, mark: str, content: str) -> str:
    """The page's text with the lines between <!-- mark --> and <!-- end of mark --> replaced."""
    start, end = f"<!-- {mark} -->\n", f"<!-- end of {mark} -->"
    before, found_start, rest = text.partition(start)
    _, found_end, after = rest.partition(end)
    if not found_start or not found_end:
        raise DataError(f"{page}: no lines {start.strip()} and {end}")
    return before + start + content + end + after


def after_mark(page: Path, text: str, mark: str, content: str) -> str:
    """The page's text with all that follows a line replaced."""
    before, found, _ = text.partition(mark)
    if not found:
        raise DataError(f"{page}: no line {mark}")
    return f"{before}{mark}\n\n{content}"


def write_pages(folder: Path, pages: dict[str, str]) -> None:
    """Writes pages of a folder, by their names; after an error each is as before."""
    for name in pages:
        command.replaceable(folder / name)
    with command.publishing_into(folder) as made:
        for name, text in pages.items():
            (made / name).write_bytes(text.encode())


def G_over_Gamma(
    run: slipfront.OpenRun, x_m: np.ndarray, direction: int, at_x_m: float | None = None
) -> np.ndarray:
    """Of a crack at rest that grows from `at_x_m`, along a front, by what friction took in its run. NaN
    beyond what is predicted."""
    predicted = slipfront.predict_fronts(run, at_x_m=at_x_m)
    same_way = predicted.isel(point=(predicted.direction == direction).to_numpy())
    if same_way.sizes["point"] == 0:
        return np.full(len(x_m), np.nan)
    ratio = same_way.G_static_J_per_m2 / same_way.fracture_energy_J_per_m2
    order = np.argsort(same_way.x_m.to_numpy())
    known = same_way.x_m.to_numpy()[order], ratio.to_numpy()[order]
    return np.interp(x_m, *known, left=np.nan, right=np.nan)


def correlation(a: np.ndarray, b: np.ndarray) -> str:
    """Of ranks, where both are known."""
    both = np.isfinite(a) & np.isfinite(b)
    return f"{slipfront.rank_correlation(a[both], b[both]):.2f}" if both.sum() > 2 else "-"


def renew(page: Path, change: Callable[[str], str]) -> None:
    """Writes a page with its text changed."""
    write_pages(page.parent, {page.name: change(read_text(command.replaceable(page)))})


def with_tables(page: Path, text: str, contents: dict[str, str]) -> str:
    """The page's text with its tables replaced, by their marks."""
    for mark, content in contents.items():
        text = between_marks(page, text, mark, content)
    return text


def renew_tables(file: Path, page: Path, what: str, tables: Callable[[Any], dict[str, str]]) -> None:
    """Writes a page with its tables, by their marks, made from a file of results."""
    results = read_result(file)
    with expecting(what, file):
        contents = tables(results)
    renew(page, lambda text: with_tables(page, text, contents))


def run(script: str, work: Callable[[], None]) -> int:
    """Exit code of a script; its error is one line."""

    def work_silently() -> list[str]:
        work()
        return []

    return command.run(Path(script).name, work_silently)


def renew_page(
    script: str, purpose: str | None, command_line: str, page: str, write: Callable[[Path, Path], None]
) -> int:
    """Exit code of a script that renews one page from the results of a command."""
    parser = argparse.ArgumentParser(description=purpose)
    parser.add_argument("results", type=Path, help=f"output folder of `{command_line}`")
    parser.add_argument("page", type=Path, help=page)
    options = parser.parse_args()
    return run(script, lambda: write(options.results, options.page))


def renew_from_runs(
    script: str, purpose: str | None, page: str, write: Callable[[Path, Path, Path], dict[str, str]]
) -> int:
    """Exit code of a script that runs cases and renews a page and its picture.

    write: draws the picture and returns the page's tables, of the page, the picture and the folder of the
    runs, which may be there."""
    parser = argparse.ArgumentParser(description=purpose)
    parser.add_argument("page", type=Path, help=page)
    parser.add_argument("picture", type=Path)
    parser.add_argument("--runs", type=Path, help="folder of the runs, or for them")
    options = parser.parse_args()

    def work() -> None:
        checked(options.picture)
        with TemporaryDirectory() as temporary:
            folder = options.runs or Path(temporary)
            folder.mkdir(parents=True, exist_ok=True)
            tables = write(options.page, options.picture, folder)
        renew(options.page, lambda text: with_tables(options.page, text, tables))

    return run(script, work)
