# SPDX-License-Identifier: BSD-3-Clause
"""Prints what pyproject.toml requires to draw the figures and to test."""

import pathlib
import tomllib

project = tomllib.loads((pathlib.Path(__file__).parent.parent / "pyproject.toml").read_text())["project"]
print("\n".join(project["dependencies"] + project["optional-dependencies"]["test"]))
