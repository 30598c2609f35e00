# SPDX-License-Identifier: BSD-3-Clause
"""Files that cannot be read or written as usual: one line, exit code 2 or, of a full disk, 1; no half-written
picture."""

from __future__ import annotations

import errno
import os
import resource
import shutil
import subprocess
import sys

import numpy as np
import pytest
import slipfront.command
from common import WITH_PACKAGE, call, call_script, refusal
from common import one_line as line_of
from refusals import one_error, one_line
from slipfront.figures import interface_step
from slipfront.figures.__main__ import main
from slipfront.files import DataError, read_json, read_table, read_toml
from slipfront.opened import open_run
from slipfront.read import read_fronts
from synthetic import ENERGY_HEADER, energy_rows, write_checksums, write_csv, write_run
from synthetic_study import write_interface_step, write_study, write_verification

NOBODY = 65534


@pytest.fixture
def run(tmp_path):
    write_run(tmp_path / "run", "left", 0.6, 10, 5, 6, 2)
    return tmp_path / "run"


def command(*arguments, module="slipfront.figures", **options) -> subprocess.CompletedProcess:
    return call(
        sys.executable, "-m", module, *arguments, env=WITH_PACKAGE | {"MPLCONFIGDIR": "/tmp"}, **options
    )


def not_written(done: subprocess.CompletedProcess, *says: str) -> None:
    line = line_of(done, 1)
    for part in ("slipfront.figures: error: ", *says):
        assert part in line


# Where there is no file


def make_folder(file):
    file.unlink()
    file.mkdir()


def make_pipe(file):
    file.unlink()
    os.mkfifo(file)


def make_loop(file):
    file.unlink()
    file.symlink_to(file)


@pytest.mark.parametrize("name", ["run.json", "energy.csv"])
@pytest.mark.parametrize(
    "make, says",
    [(make_folder, "Is a directory"), (make_pipe, "not a regular file"), (make_loop, "Too many levels")],
)
def test_what_is_no_file_is_refused_at_once(run, capsys, name, make, says):
    make(run / name)
    assert f"{run / name}: {says}" in one_error(capsys, run)


@pytest.mark.parametrize("make", [make_folder, make_pipe])
def test_what_is_no_hdf5_file_is_refused_at_once(run, make):
    make(run / "interface.h5")
    with pytest.raises(DataError, match="interface.h5"):
        _ = open_run(run).history


@pytest.mark.parametrize("closed", ["", "energy.csv"])
def test_what_may_not_be_read_is_refused(run, capsys, closed):
    """As another user where the tests run as root, whom no mode keeps out."""
    assert main([str(run)]) == 0  # all is imported: the other user may not read the interpreter's files
    root = os.geteuid() == 0
    parents = [p for p in run.parents if not p.stat().st_mode & 0o010] if root else []
    for parent in parents:
        parent.chmod(parent.stat().st_mode | 0o011)
    (run / closed).chmod(0)
    try:
        if root:
            os.seteuid(NOBODY)
        assert main([str(run)]) == 2
    finally:
        if root:
            os.seteuid(0)
        (run / closed).chmod(0o755)
        for parent in parents:
            parent.chmod(parent.stat().st_mode & ~0o011)
    error = one_line(capsys)
    assert str(run / closed) in error and "Permission denied" in error


# Text


def test_comments_bom_and_spaces_are_read(tmp_path):
    file = tmp_path / "measured.csv"
    file.write_bytes(
        b"\xef\xbb\xbf# measured by hand\r\nstatic_ratio, v_over_c_L\r\n# first\r\n0.7, 0.5\r\n\r\n0.8,"
    )
    table = read_table(file, by_hand=True)
    np.testing.assert_array_equal(table.numbers("static_ratio"), [0.7, 0.8])
    np.testing.assert_array_equal(table.numbers("v_over_c_L"), [0.5, np.nan])


@pytest.mark.parametrize(
    "data, says",
    [
        (b"a,b\n1,\xe9\n", ":2: byte 0xe9 is not UTF-8"),
        (b"a,b\n1,\0\n", "holds a byte 0"),
        (b"a,b\n1,2", "the last line is cut off"),
        (b'a,b\n1,"2\n3,4"\n', ":2: not a line of CSV"),
        (b"a,a\n1,2\n", "two columns 'a'"),
        (b"", "empty"),
        (b"# nothing\n", "empty"),
    ],
)
def test_a_table_that_is_none_is_refused(tmp_path, data, says):
    file = tmp_path / "table.csv"
    file.write_bytes(data)
    with pytest.raises(DataError) as refused:
        read_table(file)
    assert str(refused.value).startswith(str(file)) and says in str(refused.value)


@pytest.mark.parametrize("cell", ["nan", "inf", "-inf", "1_0", "１", "0x1", "1e", "1,5"])
def test_a_cell_that_is_no_number_is_refused(tmp_path, cell):
    file = tmp_path / "table.csv"
    file.write_text(f'a\n"{cell}"\n')
    with pytest.raises(DataError, match=":2: .* in column 'a' is not a number"):
        read_table(file).numbers("a")


@pytest.mark.parametrize(
    "read, name, texts",
    [
        (read_json, "JSON", ["[" * 100_000, '{"a": NaN}', '{"a": Infinity}', "1" * 10_000, "{", ""]),
        (read_toml, "TOML", ["a = " + "[" * 100_000, "a = 2020-13-45", "a = 1\na = 2", "a"]),
    ],
    ids=["json", "toml"],
)
def test_what_is_no_json_or_toml_is_refused(tmp_path, read, name, texts):
    file = tmp_path / "file"
    for text in texts:
        file.write_text(text)
        with pytest.raises(DataError, match=rf"file(:\d+)?: not {name}"):
            read(file)


def test_a_front_that_turns_back_is_refused(run):
    file = run / "fronts.csv"
    lines = file.read_text().splitlines()
    lines[2], lines[3] = lines[3], lines[2]
    file.write_text("\n".join(lines) + "\n")
    with pytest.raises(DataError, match="does not go on in its direction"):
        read_fronts(file)


@pytest.mark.parametrize("title", [r"costs $5 $\frac$", "two\nlines 日本 \u202e"])
def test_any_title_is_drawn(tmp_path, title):
    step = write_interface_step(tmp_path / "step", title)
    assert interface_step.main([str(tmp_path / "made/picture.png"), str(step)]) == 0
    study = write_study(tmp_path / "study")
    file = study / "convergence.json"
    file.write_text(file.read_text().replace("made up", title.encode("unicode_escape").decode()))
    assert main([str(study)]) == 0


def test_a_folder_of_any_name_is_drawn(run):
    odd = os.fsdecode(os.fsencode(run.parent) + b"/a $\\frac b\n\xff")
    run.rename(odd)
    done = command(odd, encoding="utf-8", errors="replace")
    assert (done.returncode, done.stderr) == (0, "")
    assert done.stdout.count("\n") == 1


# Output


def test_pictures_of_verify_are_written_or_refused(tmp_path):
    def draw(results, figures):
        return call_script("verification/figures.py", results, figures)

    refusal(draw(tmp_path, tmp_path / "figures"))
    assert not (tmp_path / "figures").exists()
    assert draw(write_verification(tmp_path / "verify"), tmp_path / "a/b").returncode == 0
    assert [f.name for f in (tmp_path / "a/b").iterdir()] == ["column.png"]


@pytest.fixture
def study(tmp_path):
    return write_interface_step(tmp_path / "study")


def draws(picture, folder) -> int:
    """The exit code of a module that draws a study into a picture."""
    return interface_step.main([str(picture), str(folder)])


def test_a_study_is_drawn_into_its_folder(study, capsys):
    write_checksums(study)
    assert main([str(study)]) == 0
    names = ["interface_step.pdf", "interface_step.png"]
    assert sorted(f.name for f in (study / "figures").iterdir()) == names
    assert f"figure: {study / 'figures/interface_step'}.png" in capsys.readouterr().out
    shutil.rmtree(study / "figures")
    (study / "interface_step.csv").write_text("changed")
    assert "interface_step.csv: does not match checksums.sha256" in one_error(capsys, study)
    assert not (study / "figures").exists()


@pytest.mark.parametrize("kind", ["png", "pdf", "svg"])
def test_the_picture_is_written_where_it_is_wanted(study, tmp_path, capsys, kind):
    picture = tmp_path / f"a/picture.{kind}"
    assert draws(picture, study) == 0
    first = picture.read_bytes()
    # A regular file is replaced, by the same bytes.
    assert draws(picture, study) == 0
    assert picture.read_bytes() == first and len(first) > 1000
    shutil.rmtree(study)
    assert draws(picture, study) == 2
    assert "No such file" in one_line(capsys)


def test_a_path_that_names_no_picture_is_refused(study, tmp_path, capsys):
    for name in ("picture", "picture.txt", "picture.jpg", ".png"):
        (tmp_path / name).write_text("mine")
        assert draws(tmp_path / name, study) == 2
        error = capsys.readouterr().err
        assert f"{tmp_path / name}: the picture's name must end with .png, .pdf, .svg" in error
        assert (tmp_path / name).read_text() == "mine"


def link_to_a_file(path):
    path.with_name("mine").write_text("mine")
    path.symlink_to(path.with_name("mine"))


def link_to_a_device(path):
    path.symlink_to("/dev/full")


@pytest.mark.parametrize("make", [os.mkfifo, os.mkdir, link_to_a_file, link_to_a_device])
def test_what_is_no_regular_file_is_not_replaced(study, tmp_path, capsys, make):
    picture = tmp_path / "picture.png"
    make(picture)
    kind = os.lstat(picture).st_mode
    assert draws(picture, study) == 2
    assert f"{picture}: is there and not a regular file" in one_line(capsys)
    assert os.lstat(picture).st_mode == kind


def test_figures_that_is_a_file_is_refused(run, capsys):
    (run / "figures").write_text("mine")
    assert f"{run / 'figures'}: cannot be written: File exists" in one_error(capsys, run)
    assert (run / "figures").read_text() == "mine"


def limit_files():
    resource.setrlimit(resource.RLIMIT_FSIZE, (4096, 4096))


def test_a_full_disk_leaves_what_was_there(run):
    not_written(command(run, preexec_fn=limit_files), str(run / "figures"), "File too large")
    assert not (run / "figures").exists()
    assert main([str(run)]) == 0
    before = {f.name: f.read_bytes() for f in (run / "figures").iterdir()}
    write_csv(run / "energy.csv", ENERGY_HEADER, energy_rows(12))
    not_written(command(run, preexec_fn=limit_files), str(run / "figures"), "File too large")
    assert {f.name: f.read_bytes() for f in (run / "figures").iterdir()} == before


def test_a_standard_output_that_takes_nothing_is_told(run):
    with open("/dev/full", "w") as full:
        not_written(command(run, stdout=full), "standard output", "No space left")
    assert (run / "figures/energy_balance.png").is_file()
    read_end, write_end = os.pipe()
    os.close(read_end)
    not_written(command(run, stdout=write_end), "standard output", "Broken pipe")
    os.close(write_end)


def test_closed_streams_do_not_matter(run):
    def close():
        os.close(1)
        os.close(2)

    assert command(run, stdout=None, stderr=None, preexec_fn=close).returncode == 0


@pytest.mark.parametrize("module", ["slipfront.figures", "slipfront.figures.interface_step"])
def test_without_arguments_the_usage_is_told(module):
    done = command(module=module)
    assert done.returncode == 2 and "usage:" in done.stderr and "Traceback" not in done.stderr


def test_a_full_disk_is_no_mistake_of_the_users(tmp_path, capsys):
    def work():
        with slipfront.command.publishing_into(tmp_path / "out"):
            raise OSError(errno.ENOSPC, "No space left on device")

    assert slipfront.command.run("name", work) == 1
    assert "No space left on device" in capsys.readouterr().err
    assert not (tmp_path / "out").exists()
