# SPDX-License-Identifier: BSD-3-Clause
"""Histories written as other codes write them come back as this program's own, or are refused by one line."""

from __future__ import annotations

import re
from functools import partial

import numpy as np
import pytest
import slipfront
from common import ROOT
from package_cases import refused

V_M_PER_S = 500.0  # onsets are a millionth of a second apart, or several
TIME_S = 1e-6 * np.arange(61)
X_M = -0.02 + 1e-3 * np.cumsum([1.0, 0.5, 1.5, 1.0] * 10)  # uneven, as nodes of spectral elements
SLIPS = np.maximum(TIME_S[:, None] - 10e-6 - np.abs(X_M - 0.005) / V_M_PER_S, 0)  # how long; runs both ways
T_0, T_1, P_0 = 2e6, -0.4e6, 5e6


def own(sign=1.0, by_slip=False):
    """A front from 5 mm to both sides; t before it grows along x. by_slip: the rate is by central differences
    of slip, (s(t+dt) - s(t-dt))/(2 dt)."""
    slipping = SLIPS > 0.5e-6
    rate = np.gradient(2.0 * SLIPS, TIME_S, axis=0) if by_slip else 2.0 * slipping
    return {
        "slip_m": sign * 2.0 * SLIPS,
        "slip_rate_m_per_s": sign * rate,
        "t_Pa": sign * (T_0 * (1 + X_M) + T_1 * slipping),
        "p_Pa": P_0 * (1 - X_M) - 1e5 * slipping,
    }


def assert_is_own(read, tolerance=1e-6, sign=1.0, shift_m=0.0, by_slip=False):
    """The same fields, and the same fronts from them."""
    assert np.allclose(read.time_s, TIME_S, rtol=1e-9, atol=1e-15)
    assert np.allclose(read.x_m, X_M + shift_m, rtol=0, atol=1e-12)
    for name, values in own(sign, by_slip).items():
        assert np.allclose(read[name], values, rtol=tolerance, atol=tolerance * np.abs(values).max()), name
        assert read[name].dims == ("time_s", "x_m") and read[name].attrs["units"]
    found = slipfront.find_fronts_in_history(read, settings=slipfront.FrontSettings(l_star_m=5e-3))
    assert sorted(found.direction.values) == [-1, 1]
    speeds = found.v_tip_m_per_s.values[np.isfinite(found.v_tip_m_per_s)]
    assert len(speeds) > 20 and np.allclose(speeds, V_M_PER_S, rtol=1e-6)
    assert np.allclose(found.t_s_Pa, sign * T_0 * (1 + found.x_m - shift_m), rtol=1e-6)


refusal = partial(refused, kind=slipfront.DataError)


# ---- SEM2DPACK


def write_sem2dpack(
    folder, order="<", marker="i4", adaptive=False, extra=0, descending=False, angle=0.0, lines_of_init=1
):
    """A fault as bc_dynflt.f90 writes it; extra fields are those of osides or of rate and state."""
    fields = own()
    at = slice(None, None, -1 if descending else 1)
    t_0, s_0 = T_0 * (1 + X_M), -P_0 * (1 - X_M)
    records = [fields["slip_m"], fields["slip_rate_m_per_s"], fields["t_Pa"] - t_0, -fields["p_Pa"] - s_0]
    records += [np.full_like(SLIPS, 0.6 + k) for k in range(1 + extra)]
    size = np.array([4 * len(X_M)], order + marker).tobytes()
    rows = (record[step, at] for step in range(len(TIME_S)) for record in records)
    written = b"".join(size + row.astype(order + "f4").tobytes() + size for row in rows)
    (folder / "Flt01_sem2d.dat").write_bytes(written)
    sizes = f" {len(X_M)} {len(records)}"
    head = [" NPTS NDAT", sizes] if adaptive else [" NPTS NDAT NSAMP DELT", f"{sizes} {len(TIME_S)} 1.0D-006"]
    head += [" Slip:Slip_Rate:Shear_Stress:Normal_Stress:Friction", " XPTS ZPTS"]
    head += [f"   {x * np.cos(angle):.16E}   {x * np.sin(angle):.16E}" for x in X_M[at]]
    (folder / "Flt01_sem2d.hdr").write_text("\n".join([*head, ""]))
    break_line = "\n" if lines_of_init == 2 else " "
    rows = [f"  {t:.15E}  {s:.15E}{break_line}  0.6" for t, s in zip(t_0[at], s_0[at], strict=True)]
    (folder / "Flt01_init_sem2d.tab").write_text("\n".join([*rows, ""]))
    if adaptive:
        rows = [f" {k} 1e-6 {t:.15E} 0 T F" for k, t in enumerate(TIME_S)]
        (folder / "Flt01_time_sem2d.tab").write_text("\n".join([*rows, ""]))
    return folder / "Flt01_sem2d.hdr"


@pytest.mark.parametrize(
    "form",
    [
        {},
        {"order": ">"},
        {"marker": "i8"},
        {"order": ">", "marker": "i8"},
        {"adaptive": True},
        {"extra": 9},
        {"descending": True},
        {"angle": 0.7},
        {"lines_of_init": 2},
    ],
    ids=str,
)
def test_sem2dpack(tmp_path, form):
    assert_is_own(slipfront.read_sem2dpack(write_sem2dpack(tmp_path, **form)))


def test_sem2dpack_times(tmp_path):
    """The first is not in the files; NSAMP may be one too many."""
    header = write_sem2dpack(tmp_path)
    data = tmp_path / "Flt01_sem2d.dat"
    data.write_bytes(data.read_bytes()[: -5 * (4 * len(X_M) + 8)])
    read = slipfront.read_sem2dpack(header, first_time_s=3e-6)
    assert np.allclose(read.time_s, 3e-6 + TIME_S[:-1], rtol=1e-12)


def test_sem2dpack_refuses_what_is_damaged(tmp_path):
    header = write_sem2dpack(tmp_path)
    data, table = tmp_path / "Flt01_sem2d.dat", tmp_path / "Flt01_init_sem2d.tab"
    whole, head, init = data.read_bytes(), header.read_text(), table.read_text()
    record = 4 * len(X_M) + 8

    def told_of(file, content, names=None):
        before = file.read_bytes()
        file.write_bytes(content if isinstance(content, bytes) else content.encode())
        told = refusal(lambda: slipfront.read_sem2dpack(header))
        file.write_bytes(before)
        assert told.startswith(str(names or file))
        return told

    assert "ends within a record" in told_of(data, whole[:-5])
    assert "ends within a time of 5 records" in told_of(data, whole[:-record])
    assert "59 times, NSAMP of its header is 61" in told_of(data, whole[: -10 * record])
    assert "shorter than a record" in told_of(data, whole[:9])
    assert "shorter than a record" in told_of(data, b"")
    assert "not of 40 numbers" in told_of(data, b"\7" + whole[1:])
    assert "a record is damaged" in told_of(data, whole[:record] + b"\7" + whole[record + 1 :])
    nan = np.array([np.nan], "<f4").tobytes()
    assert "slip_m is missing or not finite" in told_of(data, whole[:4] + nan + whole[8:])
    assert "NPTS = 41, but places of 40 nodes" in told_of(header, head.replace(" 40 5 ", " 41 5 "))
    assert "NDAT = 4: not a fault with friction" in told_of(header, head.replace(" 40 5 ", " 40 4 "))
    assert "negative or not finite" in told_of(header, head.replace(" 40 5 ", " 40 nan "))
    assert "neither NPTS NDAT NSAMP DELT nor" in told_of(header, head.replace(" 40 5 ", " 40 5 5 "))
    assert "could not convert string to float" in told_of(header, head.replace(" 40 5 ", " 40 five "))
    assert "time does not ascend" in told_of(header, head.replace("1.0D-006", "0.0"), names=data)
    assert "a number of line 2 is not whole" in told_of(header, head.replace(" 40 5 ", " 40.5 5 "))
    assert "a number of line 2 is not whole" in told_of(header, head.replace(" 40 5 61", " 40 5 60.5"))
    assert "NPTS is below 2" in told_of(header, head.replace(" 40 5 ", " 0 5 "))
    assert "empty" in told_of(header, "\n") and "empty" in told_of(table, " \n")
    assert "fewer than the four lines" in told_of(header, " NPTS NDAT\n")
    assert "the last line is cut off" in told_of(header, head[:-1])
    assert ":7: 1 numbers in place of 2" in told_of(header, head.replace(head.splitlines()[6], "0.0"))
    assert "beside the straight line" in told_of(header, head[: head.rindex("   ")] + " 0.01\n")
    assert "numbers of 40 nodes" in told_of(table, init + "1.0\n")
    assert "a value is not finite" in told_of(table, init.replace("0.6", "inf", 1))
    header.with_name("Flt01_init_sem2d.tab").unlink()
    assert "No such file" in refusal(lambda: slipfront.read_sem2dpack(header))
    assert "not the name of a header" in refusal(lambda: slipfront.read_sem2dpack(data))


# ---- uguca


def write_uguca(folder, form="ascii", below="bimaterial", names=("coord",), pressure=True):
    """A dump as uca_dumper.cc writes it; versions differ in the name of the file of coordinates."""
    fields = own()
    top, bottom = {"bimaterial": (0.7, -0.3), "mirrored": (0.5, None), "rigid": (1.0, None)}[below]
    dumped = {"cohesion_0": fields["t_Pa"]}
    if pressure:
        dumped["cohesion_1"] = -fields["p_Pa"]
    for name, field in (("disp_0", "slip_m"), ("velo_0", "slip_rate_m_per_s")):
        dumped[f"top_{name}"] = top * fields[field]
        if bottom is not None:
            dumped[f"bot_{name}"] = bottom * fields[field]
    sign, end = ("," if form == "csv" else " "), (".csv" if form == "csv" else ".out")
    data = folder / "run-DataFiles"
    data.mkdir()
    for name, values in dumped.items():
        if form == "binary":
            values.astype("<f4").tofile(data / f"{name}{end}")
        else:
            rows = (sign.join(f"{value:.10e}" for value in row) + "\n" for row in values)
            (data / f"{name}{end}").write_text("".join(rows))
    (folder / "run.fields").write_text("".join(f"{name} {name}{end}\n" for name in dumped))
    (folder / "run.time").write_text("".join(f"{k}{sign}{t:.10e}\n" for k, t in enumerate(TIME_S)))
    (folder / "run.coords").write_text("".join(f"{x:.10e}{sign}{0:.10e}\n" for x in X_M))
    info = folder / "run.info"
    info.write_text(
        "field_description run.fields\ntime_description run.time\ncoord_description run.coords\n"
        f"folder_name run-DataFiles\noutput_format {form}\n"
    )
    return info


@pytest.mark.parametrize("form", ["ascii", "csv", "binary"])
@pytest.mark.parametrize("below", ["bimaterial", "mirrored", "rigid"])
def test_uguca(tmp_path, form, below):
    info = write_uguca(tmp_path, form, below)
    assert_is_own(slipfront.read_uguca(info, below=None if below == "bimaterial" else below))


def test_uguca_of_a_uniform_pressure(tmp_path):
    info = write_uguca(tmp_path, pressure=False)
    assert (slipfront.read_uguca(info, p_Pa=5e6).p_Pa == 5e6).all()
    assert "'cohesion_1' was not dumped" in refusal(lambda: slipfront.read_uguca(info))


def test_uguca_refuses_what_is_damaged(tmp_path):
    info = write_uguca(tmp_path, below="rigid")

    def told_of(name, change, below="rigid"):
        file = tmp_path / name
        before = file.read_text()
        file.write_text(change(before))
        told = refusal(lambda: slipfront.read_uguca(info, below=below))
        file.write_text(before)
        return told

    velo = "run-DataFiles/top_velo_0.out"
    first, *rest = (tmp_path / velo).read_text().splitlines(keepends=True)
    assert "'bot_disp_0' was not dumped: dump it, or set below" in told_of("run.info", str, below=None)
    assert "60 rows, there are 61 times" in told_of(velo, lambda text: "".join(rest))
    assert f"{velo}:1: 39 numbers in place of 40" in told_of(velo, lambda text: first[17:] + "".join(rest))
    assert "the last line is cut off" in told_of(velo, lambda text: text[:-3])
    assert "could not convert" in told_of(velo, lambda text: "x" + text)
    nan = "nan " + first.partition(" ")[2] + "".join(rest)
    assert f"{velo}: a value is missing or not finite" in told_of(velo, lambda text: nan)
    assert "empty" in told_of(velo, lambda text: "")
    for name in ("run.info", "run.time", "run.coords", "run.fields", velo):
        for nothing in ("", "\n"):
            assert f"{name}: empty" in told_of(name, lambda text, nothing=nothing: nothing)
    assert "time does not ascend" in told_of("run.time", lambda text: text.replace("1.0000000000e-06", "9"))
    aside = told_of("run.coords", lambda text: text.replace(" 0.0000000000e+00", " 1", 1))
    assert "beside the straight line" in aside
    assert "no entry 'folder_name'" in told_of("run.info", lambda text: text.replace("folder_name", "x"))
    assert "not a name and its value" in told_of("run.info", lambda text: text + "output_format\n")
    assert "not ascii, csv or binary" in told_of("run.info", lambda text: text.replace("ascii", "hdf5"))
    assert "of several ranks" in told_of("run.info", lambda text: text + "rank_description run.procs\n")
    as_binary = told_of("run.info", lambda text: text.replace("ascii", "binary"))
    assert "61 times of 40 nodes take 9760" in as_binary
    with pytest.raises(slipfront.CaseError, match="below is 'stiff'"):
        slipfront.read_uguca(info, below="stiff")


# ---- SeisSol


def write_receivers(folder, old=False, totals=True, changes=True, slips=True, line=(1, 0, 0), dip=False):
    """Files of receivers as OutputManager.cpp writes them, or its predecessor in Fortran."""
    fields = own()
    files = []
    for k, x in enumerate(X_M):
        t, p = fields["t_Pa"][:, k], fields["p_Pa"][:, k]
        t_0, p_0 = t[0], p[0]
        s, other = ("d", "s") if dip else ("s", "d")
        columns = {"Time": TIME_S, f"SR{s}": fields["slip_rate_m_per_s"][:, k], f"SR{other}": 7e3 * TIME_S}
        if changes:
            columns |= {f"T_{s}": t - t_0, f"T_{other}": 7e6 * TIME_S, "P_n": -(p - p_0)}
        columns["Vr"] = np.full(len(TIME_S), np.inf)  # not read
        if totals:
            columns |= {f"T{s}0": t, f"T{other}0": 7e6 * TIME_S, "Pn0": -p}
        if slips:
            columns |= {f"Sl{s}": fields["slip_m"][:, k], f"Sl{other}": 0.7 * TIME_S}
        head = {f"x{d + 1}": x * line[d] for d in range(3)}
        backgrounds = {"P_0": -p_0, f"T_{s}": t_0, f"T_{other}": 3.0}
        lines = ['TITLE = "Temporal Signal for fault receiver number 1"']
        lines.append("VARIABLES = " + " ,".join(f'"{name}"' for name in columns))
        if old:
            lines += [f"# {name}{value:25.12E}" for name, value in (head | backgrounds).items()]
            rows = ("".join(f"{v:25.15E}" for v in row) for row in zip(*columns.values(), strict=True))
        else:
            lines += ["# Receiver number 1", *(f"# {name}\t{value:.16e}" for name, value in head.items())]
            lines += ["# face-global-id\t15699"]
            lines += [f"# {name}1\t{value:.16e}" for name, value in backgrounds.items()]
            rows = ("".join(f"{v:.16e}\t" for v in row) for row in zip(*columns.values(), strict=True))
        files.append(folder / f"tpv-faultreceiver-{k + 1:05}.dat")
        files[-1].write_text("\n".join([*lines, *rows, ""]))
    return files


@pytest.mark.parametrize(
    "form",
    [
        {},
        {"old": True},
        {"totals": False},
        {"changes": False},
        {"line": (0, 1, 0)},
        {"line": (0.6, 0.8, 0)},
        {"line": (0, 0, 1), "dip": True},
    ],
    ids=str,
)
def test_seissol(tmp_path, form):
    files = write_receivers(tmp_path, **form)
    component = "dip" if form.get("dip") else "strike"
    read = slipfront.read_seissol_fault_receivers(reversed(files), component=component)
    assert_is_own(read, by_slip=True)
    assert read.notes == []


def test_seissol_slip_from_its_rate(tmp_path):
    read = slipfront.read_seissol_fault_receivers(write_receivers(tmp_path, slips=False))
    # The rate jumps within a step of 1 us: the trapezium is up to half of that too long or short.
    assert np.abs(read.slip_m.values - own()["slip_m"]).max() <= 0.5 * 2.0 * 1e-6 * 1.001
    assert read.slip_m.values[-1].max() > 50e-6
    assert np.allclose(read.slip_rate_m_per_s, own()["slip_rate_m_per_s"])


def test_seissol_onsets_are_those_of_its_slip():
    """Two receivers of TPV104 (SeisSol/precomputed-seissol, tpv104/precomputed/double, the columns that are
    read, up to 0.4 s), where SRs passes 1 mm/s at 0.03 s, long before slip grows. RT of SeisSol is 0.309 and
    0.319 s; slip grows at 1 mm/s, by its central differences, from the following."""
    files = sorted((ROOT / "tests/python/seissol_tpv104").glob("*.dat"))
    history = slipfront.read_seissol_fault_receivers(files)
    settings = slipfront.FrontSettings(l_star_m=1000, min_length_m=1, arrest_time_s=2)
    found = slipfront.find_fronts_in_history(history, settings=settings)
    assert dict(zip(found.x_m.values, found.onset_s.values, strict=True)) == pytest.approx(
        {-500.0: 0.3145, 500.0: 0.3206}, abs=1e-4
    )


def test_seissol_components_confused(tmp_path):
    files = write_receivers(tmp_path)  # along dip slip grows to 42 um, along strike to 100
    assert slipfront.read_seissol_fault_receivers(files).notes == []
    for file in files:
        text = file.read_text().replace("Sls", "Sl?").replace("Sld", "Sls").replace("Sl?", "Sld")
        file.write_text(text)
    (note,) = slipfront.read_seissol_fault_receivers(files).notes
    assert note.startswith("slip is up to ") and "set component to 'dip'" in note


def test_seissol_with_local_time_steps(tmp_path):
    files = write_receivers(tmp_path, slips=False)
    head, rows = files[0].read_text().splitlines()[:10], files[0].read_text().splitlines()[10:]
    files[0].write_text("\n".join([*head, *rows[::2], ""]))  # twice the step of the others
    assert_is_own_but_for(slipfront.read_seissol_fault_receivers(files), column=0)
    files[0].write_text("\n".join([*head, *rows[:-3], ""]))
    told = refusal(lambda: slipfront.read_seissol_fault_receivers(files))
    assert told.startswith(str(files[0])) and "ends at 5.7e-05 s, another receiver at 6e-05 s" in told


def assert_is_own_but_for(read, column):
    rest = np.arange(len(X_M)) != column
    for name, values in own().items():
        if name == "slip_m":  # the integral of a rate that jumps, see above
            continue
        assert np.allclose(read[name].values[:, rest], values[:, rest])
        assert np.allclose(read[name].values[::2, column], values[::2, column])


def test_seissol_refuses_what_is_damaged(tmp_path):
    files = write_receivers(tmp_path, slips=False)

    def told_of(change):
        before = files[3].read_text()
        files[3].write_text(change(before))
        told = refusal(lambda: slipfront.read_seissol_fault_receivers(files))
        files[3].write_text(before)
        assert told.startswith(str(files[3]))
        return told

    row = files[3].read_text().splitlines()[-1]
    assert "the last line is cut off" in told_of(lambda text: text[:-9])
    assert "numbers in place of 10" in told_of(lambda text: text[: -len(row) // 2] + "\n")
    assert "ends at 4" in told_of(lambda text: "\n".join([*text.splitlines()[:-12], ""]))
    assert "Time does not ascend" in told_of(lambda text: f"{text}{row}\n")
    assert "a value of 'SRs' is not finite" in told_of(
        lambda text: text.replace(row, "\t".join([row.split()[0], "nan", *row.split()[2:]]))
    )
    assert "no column 'SRs'" in told_of(lambda text: text.replace('"SRs"', '"SRs-1"'))
    assert "no column 'Time'" in told_of(lambda text: text.replace("VARIABLES", "# VARIABLES"))
    assert "no lines '# x1'" in told_of(lambda text: text.replace("# x2", "# y2"))
    assert "of several receivers" in told_of(lambda text: text.replace("# x2", "# x1"))
    assert "beside the straight line" in told_of(lambda text: text.replace("# x3\t-0.000", "# x3\t-0.001"))
    twice = refusal(lambda: slipfront.read_seissol_fault_receivers([*files, files[0]]))
    assert "two places are one" in twice
    wrong = (("one.dat", "files is 'one.dat'"), ([], "files has 0 paths"), (files[:1], "has 1 paths"))
    for given, said in wrong:
        with pytest.raises(slipfront.CaseError, match=said):
            slipfront.read_seissol_fault_receivers(given)
    with pytest.raises(slipfront.CaseError, match="component is 'x'"):
        slipfront.read_seissol_fault_receivers(files, component="x")


@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_tractions_of_either_sign(tmp_path, sign):
    """Left-lateral slip is negative, and so is what drives it."""
    files = write_receivers(tmp_path)
    if sign < 0:
        for file in files:
            head, rows = file.read_text().splitlines()[:10], file.read_text().splitlines()[10:]
            names = head[1].count('"') // 2
            table = np.array([row.split() for row in rows], float)
            columns = [k for k in range(names) if head[1].split('"')[2 * k + 1] in ("SRs", "Ts0", "Sls")]
            table[:, columns] *= -1
            file.write_text("\n".join([*head, *("\t".join(map(repr, row)) for row in table.tolist()), ""]))
    assert_is_own(slipfront.read_seissol_fault_receivers(files), sign=sign, by_slip=True)


def test_the_page_runs(tmp_path, monkeypatch):
    """The code of docs/other-codes.md; whatever code the history is of, the fronts are those of all."""
    text = (ROOT / "docs/other-codes.md").read_text(encoding="utf-8")
    *readers, analysis, _ = re.findall(r"^```python\n(.*?)^```", text, re.MULTILINE | re.DOTALL)
    (tmp_path / "output").mkdir()
    write_sem2dpack(tmp_path)
    write_uguca(tmp_path, below="rigid")
    write_receivers(tmp_path / "output")
    monkeypatch.chdir(tmp_path)
    names: dict = {}
    sources = []
    for reader in readers:
        exec(reader + analysis, names)
        sources.append(names["history"].attrs["source"].partition(":")[0])
        assert list(names["fronts"].direction.values) == [-1, 1]
    assert sources == ["SEM2DPACK", "uguca", "SeisSol"]


def test_the_converted_case_is_that_of_sem2dpack():
    """cases/other-codes/testflt2d.toml against the numbers of EXAMPLES/TestFlt2D/Par.inp."""
    rho, c_P, c_S = 2670, 6000, 3464
    Tn, Tt, nucleating = -120e6, 70e6, 81.6e6
    mu_s, mu_d, Dc = 0.677, 0.525, 0.4
    case = ROOT / "cases/other-codes/testflt2d.toml"
    info = slipfront.info(case)
    assert info.speeds.c_L_m_per_s == pytest.approx(c_P, rel=1e-6)
    assert info.speeds.c_S_m_per_s == pytest.approx(c_S, rel=1e-6)
    S = (-mu_s * Tn - Tt) / (Tt + mu_d * Tn)
    assert info.rupture.strength_excess_S.median == pytest.approx(S, rel=1e-12)
    nu = (c_P**2 - 2 * c_S**2) / (2 * (c_P**2 - c_S**2))
    zone = 9 * np.pi / 32 * rho * c_S**2 / (1 - nu) * Dc / ((mu_s - mu_d) * -Tn)
    assert info.rupture.process_zone_m == pytest.approx(zone, rel=1e-5)
    assert f"overstress_Pa = {(nucleating - Tt) / 1e6:g}e6" in case.read_text(encoding="utf-8")
