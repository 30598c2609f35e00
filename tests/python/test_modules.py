# SPDX-License-Identifier: BSD-3-Clause
"""Each module of the program includes what the build names for it, and the page on the structure
shows it; libraries that are missing are named."""

from __future__ import annotations

import re
import subprocess
import sys
from pathlib import Path

import pytest
from common import ROOT


def built() -> dict[str, set[str]]:
    """What src/CMakeLists.txt lets each module see, in its order."""
    text = (ROOT / "src/CMakeLists.txt").read_text(encoding="utf-8")
    calls = re.findall(r"^slipfront_module\((\w+)([^)]*)\)", text, re.MULTILINE)
    return {name: set(rest.partition("SEES")[2].partition("USES")[0].split()) for name, rest in calls}


def folder(module: str) -> Path:
    return ROOT / "src" / module


def described() -> list[str]:
    """The modules in the table of docs/architecture.md."""
    text = (ROOT / "docs/architecture.md").read_text(encoding="utf-8")
    return re.findall(r"^\| `(\w+)` \| ", text, re.MULTILINE)


def included(module: str) -> set[str]:
    """Modules of which a module includes headers."""
    seen = set()
    for file in folder(module).rglob("*.[ch]pp"):
        seen |= set(re.findall(r'^#include "(\w+)/', file.read_text(encoding="utf-8"), re.MULTILINE))
    return seen - {module}


def test_the_page_shows_what_is_built(tmp_path):
    assert described() == list(built())
    drawn = tmp_path / "modules.svg"
    subprocess.run([sys.executable, ROOT / "scripts/module-diagram.py", drawn], check=True)
    assert drawn.read_bytes() == (ROOT / "docs/figures/modules.svg").read_bytes()


def test_modules_include_what_they_are_named_and_nothing_else():
    modules = {path.name for path in (ROOT / "src").iterdir() if path.is_dir()}
    assert modules == set(built())
    # base brings errors and assertions: every module may use it.
    assert {module: included(module) | {"base"} for module in modules} == {
        module: sees | {"base"} for module, sees in built().items()
    }


def test_a_case_is_read_where_problems_are_made_and_by_commands_alone():
    readers = {"input", "problem", "cli", "bench", "python"}
    found = {
        file for file in (ROOT / "src").rglob("*.[ch]pp") if "input::" in file.read_text(encoding="utf-8")
    }
    assert {file.relative_to(ROOT / "src").parts[0] for file in found} <= readers


def test_the_way_is_one_way():
    above: set[str] = set()
    for module, sees in built().items():
        assert sees <= above, module
        above.add(module)


# For use from outside, by docs/installing.md, and what their headers need where they are installed.
OUTSIDE = [
    "base",
    "mesh",
    "solid/material.hpp",
    "interface/friction",
    "interface/friction.hpp",
    "statics/prestress.hpp",
    "motion/observer.hpp",
    "motion/observers",
    "motion/stepper.hpp",
    "fronts",
    "record",
    "input",
    "setup/initial_state.hpp",
    "run/run.hpp",
]
INSTALLED_WITH = {"fmt", "unistd.h", "immintrin.h"}


def reached(files: list[Path]) -> tuple[set[Path], dict[str, Path]]:
    """All files that these include, and the libraries that they name, each with one that does."""
    headers, libraries = list(files), dict[str, Path]()
    seen: set[Path] = set()
    while headers:
        header = headers.pop()
        if header in seen:
            continue
        seen.add(header)
        text = header.read_text(encoding="utf-8")
        names = re.findall(r'^#include "([^"]+)"', text, re.MULTILINE)
        headers += [ROOT / name if name.startswith("papers/") else ROOT / "src" / name for name in names]
        for name in re.findall(r"^#include <([^>]+)>", text, re.MULTILINE):
            if "." in name or "/" in name:
                libraries[name.split("/")[0]] = header
    return seen, libraries


def test_headers_for_programs_outside_need_no_library_but_fmt():
    src = ROOT / "src"
    named = [src / name for name in OUTSIDE]
    seen, libraries = reached(
        [h for place in named for h in ([place] if place.is_file() else place.rglob("*.hpp"))]
    )
    assert src / "motion/event.hpp" in seen
    assert set(libraries) <= INSTALLED_WITH, libraries
    installed = re.search(
        r"^foreach\(module ([^)]*)\)", (ROOT / "cmake/install.cmake").read_text(), re.MULTILINE
    )
    assert {header.relative_to(src).parts[0] for header in seen} <= set(installed[1].split())


def test_the_python_module_of_a_wheel_needs_no_library_but_fmt_and_nanobind():
    _, libraries = reached(list((ROOT / "src/python").glob("*.?pp")))
    assert set(libraries) <= INSTALLED_WITH | {"nanobind"}, libraries


@pytest.mark.slow
def test_all_missing_libraries_are_named(tmp_path):
    without = [f"-DCMAKE_DISABLE_FIND_PACKAGE_{name}=ON" for name in ("fmt", "HDF5", "GTest")]
    command = ["cmake", "-S", str(ROOT), "-B", str(tmp_path), "-G", "Ninja", *without]
    result = subprocess.run(command, capture_output=True, text=True, check=False)
    assert result.returncode != 0
    missing = re.findall(r"^    (\w+) [\d.]*: lib", result.stderr, re.MULTILINE)
    assert missing == ["fmt", "HDF5", "GTest"], result.stderr
