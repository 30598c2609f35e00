# SPDX-License-Identifier: BSD-3-Clause
"""Prints what pyproject.toml requires: the package's dependencies and those of the extras named; "build"
stands for what building it takes.

usage: python-requirements.py [EXTRA]..."""

import pathlib
import sys
import tomllib

file = tomllib.loads((pathlib.Path(__file__).parent.parent / "pyproject.toml").read_text())
extras = {**file["project"]["optional-dependencies"], "build": file["build-system"]["requires"]}
requirements = file["project"]["dependencies"]
for extra in sys.argv[1:]:
    requirements += extras[extra]
print("\n".join(requirements))
