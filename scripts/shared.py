# SPDX-License-Identifier: BSD-3-Clause
"""What the scripts beside this file share: the package beside them, pictures, cases that are run."""

from __future__ import annotations

import subprocess
import sys
from collections.abc import Callable
from pathlib import Path

__all__ = ["DataError", "checked", "write_figure"]  # handed on

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "python"))

from slipfront import command
from slipfront.figures.drawing import checked, write_figure
from slipfront.files import DataError
from slipfront.folder import result_file
from slipfront.pages import Tables, command_to_renew

DOCS = Path(__file__).resolve().parents[1] / "docs"


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


def run(script: str, work: Callable[[], None]) -> int:
    """Exit code of a script; its error is one line."""

    def work_silently() -> list[str]:
        work()
        return []

    return command.run(Path(script).name, work_silently)


def renew_from_runs(
    script: str, purpose: str | None, page: str, write: Callable[[Path, Path], Tables]
) -> int:
    """Exit code of a script that runs cases and renews a page of docs/ and its picture."""
    return command_to_renew(script, purpose, DOCS / page, write)
