# SPDX-License-Identifier: BSD-3-Clause
"""docs/commands.md names every command and option; commands of other pages run."""

import re

import pytest
from common import ROOT, require_done

PAGE = (ROOT / "docs/commands.md").read_text(encoding="utf-8")


def subcommands(text: str) -> list[str]:
    return re.findall(r"^  ([a-z][\w-]*) {2,}", text, re.MULTILINE)


def helps(program, words=()) -> dict[str, str]:
    printed = require_done(program(*words, "--help")).stdout
    found = {" ".join(words): printed}
    for name in subcommands(printed):
        found |= helps(program, (*words, name))
    return found


def test_every_command_and_option_is_named(program):
    every = helps(program)
    assert len(every) > 10
    for name, text in every.items():
        if name and not subcommands(text):
            assert f"| `{name}" in PAGE, name
        options = re.findall(r"^ +(?:-\w,)?(--[\w-]+)", text, re.MULTILINE)
        assert [o for o in options if o not in ("--help", "--version") and f"`{o}" not in PAGE] == [], name


@pytest.fixture
def run_commands(program, write_case):
    """Runs the lines of a page's shell blocks, continued ones joined, on the tutorial's case."""

    def run(page: str, most=None) -> None:
        tutorial = (ROOT / "docs/tutorial.md").read_text(encoding="utf-8")
        write_case(re.search(r"^```toml\n(.*?)^```$", tutorial, re.MULTILINE | re.DOTALL)[1], "my.toml")
        text = (ROOT / page).read_text(encoding="utf-8")
        blocks = re.findall(r"^```sh\n(.*?)^```$", text, re.MULTILINE | re.DOTALL)
        lines = [line for block in blocks for line in block.replace("\\\n", " ").splitlines()]
        assert lines
        for line in lines[:most]:
            name, *words = line.replace("'", "").replace(", ", ",").split()
            assert name == "slipfront"
            require_done(program(*words))

    return run


@pytest.mark.parametrize("page", ["docs/prestress.md", "docs/paraview.md"])
def test_commands_on_the_tutorials_case_run(run_commands, page):
    run_commands(page)


def test_vtk_opens_the_fields(run_commands, tmp_path):
    """VTK's reader of these files is ParaView's."""
    vtk = pytest.importorskip("vtk")
    from vtk.util.numpy_support import vtk_to_numpy

    run_commands("docs/paraview.md", most=1)
    reader = vtk.vtkHDFReader()
    reader.SetFileName(str(tmp_path / "movie/fields.vtkhdf"))
    reader.UpdateInformation()
    times = reader.GetOutputInformation(0).Get(vtk.vtkStreamingDemandDrivenPipeline.TIME_STEPS())
    assert times == pytest.approx([20e-6, 40e-6, 60e-6], abs=4e-7)
    speeds = []
    for step in range(3):
        reader.SetStep(step)
        reader.Update()
        grid = reader.GetOutputDataObject(0)
        assert (grid.GetNumberOfPoints(), grid.GetNumberOfCells()) == (12261, 12000)
        speeds.append(abs(vtk_to_numpy(grid.GetPointData().GetArray("velocity_m_per_s"))).max())
        assert grid.GetPointData().GetArray("displacement_m").GetNumberOfComponents() == 3
    assert all(0.05 < speed < 5 for speed in speeds)
