# SPDX-License-Identifier: BSD-3-Clause
"""Prints what pyproject.toml requires: the package's dependencies and those of the extras named.

usage: python-requirements.py [EXTRA]..."""

import pathlib
import sys
import tomllib

project = tomllib.loads((pathlib.Path(__file__).parent.parent / "pyproject.toml").read_text())["project"]
requirements = project["dependencies"]
for extra in sys.argv[1:]:
    requirements += project["optional-dependencies"][extra]
print("\n".join(requirements))
