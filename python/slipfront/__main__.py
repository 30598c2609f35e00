# SPDX-License-Identifier: BSD-3-Clause
"""`python -m slipfront COMMAND ARGS`, which `slipfront COMMAND ARGS` runs for the commands in Python."""

from __future__ import annotations

import importlib
import os
import sys

from slipfront.command import INTERRUPTED, REFUSED, report_error, run
from slipfront.errors import NEEDS_MODULE, Error
from slipfront.program import program

#: By their words, the module whose `main(arguments)` returns the exit code. It is imported when it is wanted.
COMMANDS = {
    "compare": "slipfront.compare.command",
    "fit": "slipfront.fit.command",
    "fronts": "slipfront.fronts_command",
    "gauges": "slipfront.gauges_command",
    "picks": "slipfront.picks_command",
    "records": "slipfront.records_command",
    "report": "slipfront.report.command",
    "study convergence": "slipfront.study.convergence",
    "study interface-step": "slipfront.study.interface_step",
    "sweep": "slipfront.sweep.command",
}
USAGE = f"usage: python -m slipfront {{{','.join(COMMANDS)}}} ARGS; COMMAND --help prints them"


def missing(name: str, package: str) -> str:
    """What to install for a command that needs a package; of our own, only the version can be wrong."""
    if package == "slipfront":
        return (
            f"{name}: is not part of this version of the Python package slipfront: install the program's own"
        )
    how = f"{sys.executable} -m pip install {package}"
    return f"{name}: needs the Python package {package}: install it with '{how}'"


def command_in(arguments: list[str]) -> str:
    """The command that the first arguments name; empty where they name none."""
    return next((name for n in (1, 2) if (name := " ".join(arguments[:n])) in COMMANDS), "")


def main(arguments: list[str]) -> int:
    """Exit code of the command that the first arguments name."""
    if arguments[:1] in (["--help"], ["-h"]):
        return run("slipfront", lambda: [USAGE])
    name = command_in(arguments)
    if not name:
        report_error("slipfront", f"no Python command '{arguments[0]}'; {USAGE}" if arguments else USAGE)
        return REFUSED
    try:
        module = importlib.import_module(COMMANDS[name])
    except ModuleNotFoundError as error:
        report_error("slipfront", missing(name, (error.name or "").split(".")[0]))
        return REFUSED
    except KeyboardInterrupt:
        report_error("slipfront", f"{name}: interrupted")
        return INTERRUPTED
    except ImportError as error:
        if not (error.msg or "").startswith("cannot import name '_core'"):
            raise
        report_error("slipfront", f"{name}: needs {NEEDS_MODULE}")
        return REFUSED
    code: int = module.main(arguments[len(name.split()) :])
    return code


def console() -> int:
    """The console script. Commands in Python are called, all others go to the compiled program.

    It takes the place of this process, so that signals and streams are its own.
    """
    arguments = sys.argv[1:]
    if command_in(arguments):
        return main(arguments)
    try:
        file = program()
        os.execv(file, [str(file), *arguments])
    except (Error, OSError) as error:
        report_error("slipfront", str(error))
        return REFUSED


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
