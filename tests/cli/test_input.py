# SPDX-License-Identifier: BSD-3-Clause
"""Case files and tables of every kind, numbers of every size, little memory, outputs that take no more."""

import os
import re

import pytest
from common import COARSE, finished, one_line, refusal, require_done, require_same_bytes, run_json, sets

PRESTRESSED = """\
plate = {width_m = 0.2, height_m = 0.1, element_size_m = 5e-3}
loading.method = "prestress"
prestress.file = "table.csv"
event.kind = "nucleation"
nucleation.x_m = 0.1
time.end_s = 2e-5
"""
TABLE = "x_m,t_Pa,p_Pa\n0,2.1e6,5e6\n0.2,2.3e6,5e6\n"


def test_case_and_table_from_pipes(program, pipe, write_case, tmp_path):
    case, table = pipe("case.toml", PRESTRESSED), pipe("piped.csv", TABLE)
    require_done(program("run", case, "-o", "out", "-q", "--set", f"prestress.file={table}"))
    write_case(TABLE, "table.csv")
    require_done(program("run", write_case(PRESTRESSED, "file.toml"), "-o", "again", "-q"))
    require_same_bytes(tmp_path / "out", tmp_path / "again", "interface.h5", "fronts.csv", "static.csv")


def test_late_error_of_a_case_from_a_pipe_has_its_line(program, pipe):
    case = pipe("case.toml", COARSE.replace("mu_s = 1.3", "mu_s = 100"))
    assert refusal(program("run", case, "-o", "out")).startswith(f"{case}:18: ")


@pytest.mark.parametrize("name", ["loop", "n" * 300, "d/" * 3000 + "x", "file/x", "folder", "none"])
@pytest.mark.parametrize("table", [False, True])
def test_names_that_cannot_be_read(program, tmp_path, name, table):
    (tmp_path / "loop").symlink_to("loop")
    (tmp_path / "file").write_text("")
    (tmp_path / "folder").mkdir()
    (tmp_path / "c.toml").write_text(PRESTRESSED)
    case = ["c.toml", "--set", f"prestress.file={name}"] if table else [name]
    line = refusal(program("run", *case, "-o", "out"))
    assert name[:20] in line
    assert "check the path" in line or "name the" in line
    assert not (tmp_path / "out").exists()
    for command in ("validate", "info"):
        assert refusal(program(command, *case)) == line


def test_case_without_a_name(program):
    assert refusal(program("validate", "")).startswith("CASE: cannot be read")


def test_special_files_as_a_case(program):
    assert "sets no key" in refusal(program("validate", "/dev/null"))
    assert "is larger than" in refusal(program("validate", "/dev/zero"))
    assert "cannot be read" in refusal(program("validate", "/proc/self/mem"))


def test_title_that_is_no_utf8(program, coarse):
    printed = refusal(program("run", coarse, "-o", "out", "--set", os.fsdecode(b"title=\xff")))
    assert printed.startswith("--set title=?: holds bytes that are no utf-8")


# --- Numbers

WELL_BEYOND = ["1e150", "5e-324"]
INTEGERS = ["1000000", "9223372036854775807", "-9223372036854775808"]


def numeric_keys(program):
    """Keys of the reference with the law that they belong to."""
    table, law = "", ""
    for line in program("keys").stdout.splitlines():
        if found := re.match(r"## \[(\w+)\]", line):
            table, law = found[1] + ".", ""
        if found := re.match(r'With `law = "(\w+)"`', line):
            law = found[1]
        if found := re.match(r"\| `(\w+)` \| (number|integer|list of numbers) \|", line):
            yield table + found[1], found[2], law


@pytest.mark.parametrize(
    "base", [*(pytest.param(b, marks=pytest.mark.slow) for b in ("tilted", "prestressed")), "graded"]
)
def test_numbers_of_every_size(program, write_case, tmp_path, base):
    (tmp_path / "table.csv").write_text(TABLE)
    coarse = "[plate]\nelement_size_m = 5e-3\n"
    graded = coarse + "coarsenings = 1\nfine_height_m = 0.02\n"
    case = write_case({"tilted": coarse, "prestressed": PRESTRESSED, "graded": graded}[base])
    for key, kind, law in numeric_keys(program):
        for value in INTEGERS if kind == "integer" else WELL_BEYOND:
            value = f"[{value}]" if kind == "list of numbers" else value
            overrides = sets(f"{key}={value}", *([f"friction.law={law}"] if law else []))
            result = program("info", case, *overrides, memory_bytes=4 << 30)
            if kind != "integer" or result.returncode != 0:
                refusal(result)
            assert not re.search(r"\b(nan|inf)\b", result.stdout), result


# --- Notes


def test_table_in_another_unit(program, write_case, tmp_path):
    case = write_case(PRESTRESSED)
    rows = "".join(f"{x},2.1e6,5e6\n" for x in range(0, 201, 10))
    (tmp_path / "table.csv").write_text("x_m,t_Pa,p_Pa\n" + rows)
    note = (
        "the table of prestress.file reaches from x = 0 to 200 m, the plate from 0 to 0.2 m: 20 of its 21 "
        "rows lie beyond it; are its positions in m?"
    )
    for command in (["validate", case], ["info", case], ["run", case, "-o", "out"]):
        assert f"note: {note}\n" in program(*command).stdout
    assert {"kind": "units", "text": note} in run_json(tmp_path / "out")["notes"]
    for command in (["validate", case], ["info", case], ["run", case, "-o", "strict"]):
        line = refusal(program(*command, "--strict"))
        assert note in line and "--strict refuses notes of units and resolution" in line
    assert not (tmp_path / "strict").exists()
    (tmp_path / "table.csv").write_text(TABLE)
    assert "prestress.file" not in program("validate", case).stdout


# --- Output

TELLING = [["keys"], ["--version"], ["--help"], ["run", "--help"]]
TELLING += [["info", "coarse.toml"], ["validate", "coarse.toml"]]


@pytest.mark.parametrize("arguments", TELLING, ids=lambda arguments: arguments[0])
class TestStandardOutput:
    def test_that_is_full(self, program, coarse, arguments):
        with open("/dev/full", "w") as full:
            printed = one_line(finished(program.start(*arguments, stdout=full)), 1)
        assert printed == "slipfront: standard output cannot be written (No space left on device)"

    @pytest.mark.parametrize("ignored", [False, True])
    def test_whose_reader_has_gone(self, program, coarse, arguments, ignored):
        reading, writing = os.pipe()
        os.close(reading)
        result = program.start(*arguments, restore_signals=not ignored, stdout=writing)
        os.close(writing)
        assert finished(result).stderr == ""


# --- Memory


@pytest.mark.parametrize("megabytes", [60, 100, 200])
def test_little_memory(program, write_case, megabytes):
    """Each ends by its work or with one line; with too little no library is loaded."""
    case = write_case('[plate]\ncorner = "none"\n[time]\nend_s = 2e-6\n')
    for command in (["info", case], ["run", case, "-o", f"out{megabytes}", "-q"]):
        result = program(*command, memory_bytes=megabytes * 10**6)
        loaded = "while loading shared libraries" not in result.stderr
        assert loaded or megabytes < 200
        assert result.returncode in ((0, 1, 2) if loaded else (127,)), result
        assert len(result.stderr.splitlines()) == (0 if result.returncode == 0 else 1)


def test_a_byte_0_in_a_text_is_refused(program, write_case):
    case = write_case('title = "a\\u0000b"\n')
    assert refusal(program("validate", case)).startswith(f"{case}:1: title holds the character U+0000")
    case = write_case('[probes]\nx_m = [0.1]\ny_m = [0.01]\nnames = ["a\\u0000b"]\n')
    assert refusal(program("validate", case)).startswith(f"{case}:4: probes.names holds the character")


# --- Slender plates


def test_long_interface_is_solved_iteratively(program, write_case, tmp_path):
    plate = '[plate]\nwidth_m = 1\nheight_m = 2.5e-3\nelement_size_m = 5e-4\ncorner = "none"\n'
    loading = "[loading]\ntilt_left_m = 1e-6\ntilt_right_m = 1e-6\n[friction]\nmu_s = 0.6\nmu_k = 0.3\n"
    rest = "[time]\nend_s = 1e-7\n[fronts]\nl_star_m = 1e-3\n"
    case = write_case(plate + loading + rest)
    require_done(program("run", case, "-o", "out", "-q"))
    assert run_json(tmp_path / "out")["statics"]["solver"] == "iterative"
