# SPDX-License-Identifier: BSD-3-Clause
"""What several processes find is what one finds: the files of a run byte by byte, energies to rounding."""

import signal

import pytest
from common import finished, require_done, require_same_bytes, rows_of, run_json, wait_until_or_over
from conftest import send

# Elements of 2 mm: a run takes a tenth of a second.
PLATE = """\
title = "shared"
[plate]
width_m = 0.2
element_size_m = 2e-3
height_m = 0.04
{plate}
[base]
{base}
[loading]
{loading}
[time]
end_s = 60e-6
{time}
[friction]
{law}
{friction}
[output]
snapshot_times_s = [0, 30e-6, 45e-6]
moment_rate = true
[probes]
x_m = [0.0731, 0.1]
y_m = [0.0049, 0.0101]
{rest}
"""

LAW = 'law = "velocity_weakening"\nmu_s = 1.3\nmu_k = 0.6'
RELIEF = {"plate": 'corner = "relief"'}
RIGID = 'kind = "rigid"'
TILT = "tilt_left_m = 0.37e-3\ntilt_right_m = 0.037e-3"
BASE = """
kind = "body"
youngs_modulus_Pa = 1.4e9
poissons_ratio = 0.3
density_kg_per_m3 = 1100
stiffness_damping_s = 1e-7
height_m = 0.04
"""
GRADED = "coarsenings = 1\nfine_height_m = 12e-3\n"
FEW_SUB_STEPS = "interface_substeps = 2\ninterface_rows = 2"  # as parts of 33 columns allow
DAMPED = "[material]\nstiffness_damping_s = 1e-7\n"  # so that larger elements take larger steps
TABLE = "x_m,mu_s\n0,1.3\n0.09,1.3\n0.11,1.35\n0.2,1.3\n"
PRESTRESS = 'method = "prestress"'
NUCLEATION = """
[prestress]
t_Pa = 4.6e6
p_Pa = 4e6
[event]
kind = "nucleation"
[nucleation]
form = "{form}"
x_m = {x_m}
half_length_m = 8e-3
"""

CASES = {
    "relieved corners": RELIEF,
    "rounded corners": {"plate": 'corner = "fillet"\nfillet_radius_m = 6e-3'},
    "spontaneous": {"rest": '[event]\nkind = "spontaneous"'},
    "ramp": {
        "loading": TILT + '\nmethod = "ramp"\nshear_speed_m_per_s = 1.6',
        "rest": '[event]\nkind = "spontaneous"',
    },
    "no sub-steps": {"time": "interface_substeps = 1"},
    "single precision": RELIEF | {"time": 'precision = "single"'},
    "predictor-corrector": {"rest": '[contact]\nalgorithm = "predictor_corrector"'},
    "strength relaxed": {"friction": 'regularisation = "strength"\nrelaxation_time_s = 1e-6'},
    "pressure relaxed": {"friction": 'regularisation = "pressure"\nrelaxation_time_s = 1e-6'},
    "rate and state": {
        "plate": 'corner = "none"\nsides = "absorbing"\ntop = "absorbing"',
        "law": 'law = "rate_and_state_aging"\nf0 = 1.1',
        "loading": PRESTRESS,
        "rest": NUCLEATION.format(form="overstress", x_m=0.1),
    },
    # The slip rate at a tip follows from the table, which rank 0 alone has.
    "rate and state, table of tractions": {
        "plate": 'corner = "none"\nsides = "absorbing"\ntop = "absorbing"',
        "law": 'law = "rate_and_state_aging"\nf0 = 1.1',
        "loading": PRESTRESS,
        "rest": NUCLEATION.format(form="overstress", x_m=0.1).replace(
            "t_Pa = 4.6e6\np_Pa = 4e6", 'file = "tractions.csv"'
        ),
        "files": {"tractions.csv": "x_m,t_Pa,p_Pa\n0,4.6e6,4e6\n0.2,4.6e6,4e6\n"},
    },
    "forced nucleation, growing tractions": {
        "plate": 'corner = "none"',
        "loading": PRESTRESS,
        "rest": NUCLEATION.format(form="forced", x_m=0.1).replace(
            "[event]", "t_rate_Pa_per_s = 5e9\np_rate_Pa_per_s = -2e9\n[event]"
        )
        + "front_speed_m_per_s = 500\nweakening_time_s = 2e-6\n",
    },
    "friction along x": {"friction": 'file = "mu.csv"', "files": {"mu.csv": TABLE}},
    "two bodies": {"base": BASE},
    "absorbing edges": {
        "plate": 'corner = "none"\nsides = "absorbing"\ntop = "absorbing"',
        "loading": PRESTRESS,
        "rest": NUCLEATION.format(form="overstress", x_m=0.1),
    },
    # The rupture passes the sides.
    "periodic": {
        "plate": 'corner = "none"\nsides = "periodic"\ntop = "absorbing"',
        "loading": PRESTRESS,
        "rest": NUCLEATION.format(form="overstress", x_m=0.19),
    },
    # The patch lies where the parts of two processes, and of three, meet.
    "weakened between two": {
        "plate": 'corner = "none"',
        "loading": PRESTRESS,
        "rest": NUCLEATION.format(form="weakened", x_m=0.1),
    },
    "weakened between three": {
        "plate": 'corner = "none"',
        "loading": PRESTRESS,
        "rest": NUCLEATION.format(form="weakened", x_m=0.0667),
    },
    "graded, relieved corners": {
        "plate": GRADED + 'corner = "relief"',
        "time": FEW_SUB_STEPS,
        "rest": DAMPED,
    },
    "graded, one step": {
        "plate": GRADED + 'corner = "none"',
        "time": "local_steps = false\ninterface_substeps = 1",
    },
    "graded, two bodies": {
        "plate": GRADED + 'corner = "none"',
        "time": FEW_SUB_STEPS,
        "base": BASE + "coarsenings = 2\nfine_height_m = 8e-3\n",
        "rest": DAMPED,
    },
    "graded, absorbing edges": {
        "plate": GRADED + 'corner = "none"\nsides = "absorbing"\ntop = "absorbing"',
        "time": FEW_SUB_STEPS,
        "loading": PRESTRESS,
        "rest": NUCLEATION.format(form="overstress", x_m=0.1) + DAMPED,
    },
    "graded, periodic": {
        "plate": GRADED + 'corner = "none"\nsides = "periodic"\ntop = "absorbing"',
        "time": FEW_SUB_STEPS,
        "loading": PRESTRESS,
        "rest": NUCLEATION.format(form="overstress", x_m=0.19) + DAMPED,
    },
    "quiet end": {
        "friction": "alpha_m2_per_s2 = 1",
        "time": "quiet_s = 2e-6",
        "rest": '[event]\nkind = "right"',
    },
}  # fmt: skip
# Of three processes the middle one has two neighbours; of two with periodic sides each has the other twice.
PROCESSES = dict.fromkeys(CASES, (3,)) | {
    "relieved corners": (2, 3),
    "periodic": (2, 3),
    "two bodies": (2, 3),
    "weakened between two": (2,),
}


def write_case(folder, name):
    parts = CASES[name]
    for file, text in parts.get("files", {}).items():
        (folder / file).write_text(text, encoding="utf-8")
    slots = (
        {"law": LAW, "base": RIGID, "loading": TILT}
        | dict.fromkeys(("plate", "time", "friction", "rest"), "")
        | parts
    )
    (folder / "case.toml").write_text(PLATE.format(**slots), encoding="utf-8")
    return folder / "case.toml"


def energies(folder):
    return [[float(value) for value in row.values()] for row in rows_of(folder / "energy.csv")]


def require_same(one, several, rounding=1e-13):
    """All files but run.json's times, and energies to a part of the largest."""
    names = {path.name for path in one.iterdir()}
    assert {path.name for path in several.iterdir()} == names
    require_same_bytes(one, several, *(names - {"run.json", "energy.csv", "checksums.sha256"}))
    first, second = energies(one), energies(several)
    assert len(first) == len(second)
    largest = max(abs(value) for row in first for value in row)
    for row, other in zip(first, second, strict=True):
        assert row == pytest.approx(other, rel=0, abs=rounding * largest)
    of_one, of_several = run_json(one), run_json(several)
    for key in ("status", "fronts", "steps", "end", "notes"):
        assert of_one.get(key) == of_several.get(key), key


def stop_after_checkpoint(mpirun, n, folder, *arguments):
    """Begins or goes on, and ends it once there is a checkpoint more.
    @return whether it was stopped; else it was done before"""
    state = folder / "unfinished/state"
    before = set(state.glob("*checkpoint*"))
    with mpirun.start(n, *arguments, "-q") as process:
        wait_until_or_over(lambda: set(state.glob("*checkpoint*")) - before, process)
        # The leader and not mpirun, which takes a second to end its processes.
        send(mpirun.processes().get(0), signal.SIGTERM)
        result = finished(process)
        assert result.returncode in (0, 128 + signal.SIGTERM), result.stderr
        return result.returncode != 0


@pytest.mark.parametrize("name", CASES)
def test_processes_change_nothing(name, tmp_path, mpirun):
    case = write_case(tmp_path, name)
    one = tmp_path / "one"
    require_done(mpirun.alone("run", case, "-o", one, "-q"))
    assert (one / "fronts.csv").read_text().count("\n") > 10
    # Where a step is single precision's, so are its sums.
    rounding = 1e-7 if "single" in name else 1e-13
    for n in PROCESSES[name]:
        several = tmp_path / f"by-{n}"
        require_done(mpirun(n, "run", case, "-o", several, "-q"))
        require_same(one, several, rounding)


def test_any_number_of_processes_goes_on(tmp_path, mpirun):
    """A run that is stopped once there is a checkpoint, and gone on with by other numbers of processes."""
    case = write_case(tmp_path, "graded, two bodies")
    # Long enough to be stopped again and again.
    text = case.read_text().replace("end_s = 60e-6", "end_s = 1.5e-3\nquiet_s = inf")
    case.write_text(text.replace("element_size_m = 2e-3", "element_size_m = 1e-3"))
    one, several = tmp_path / "one", tmp_path / "several"
    require_done(mpirun.alone("run", case, "-o", one, "-q"))
    often = ("--checkpoint-every-simulated", "50e-6")
    stops = stop_after_checkpoint(mpirun, 2, several, "run", case, "-o", several, *often)
    for n in (3, 1):
        stops += stop_after_checkpoint(mpirun, n, several, "run", "--restart", several, *often)
    require_done(mpirun(2, "run", "--restart", several, *often))
    require_same(one, several)
    assert run_json(several)["sessions"] == 1 + stops


SEQUENCE = """
[plate]
width_m = 0.2
height_m = 0.1
element_size_m = 4e-3
[base]
kind = "rigid"
[event]
kind = "spontaneous"
[sequence]
max_events = 2
[time]
interface_rows = 2
"""


PUSHER = "[loading]\npusher_from_m = 8e-3\npusher_to_m = 20e-3\n"  # of rank 0's columns alone
MACHINE = PUSHER + "shear_stiffness_Pa_per_m = 8.3e10\nnormal_stiffness_Pa_per_m = 0.0\n"
# Event 1 of a law with a state, which slow slip leads to.
SLOW = """
[material]
stiffness_damping_s = 2e-6
[loading]
mean_pressure_Pa = 5e6
[friction]
law = "rate_and_state_aging"
a = 0.01
b = 0.02
d_c_m = 1e-6
V_i_m_per_s = 1e-6
"""


@pytest.mark.parametrize("loading", ["", PUSHER, MACHINE, SLOW])
def test_a_sequence_of_several_processes(tmp_path, mpirun, loading):
    """The first event is the same; energies to rounding, from which the next one grows apart."""
    (tmp_path / "case.toml").write_text(SEQUENCE + loading)
    require_done(mpirun(2, "run", "case.toml", "-q", "-o", "shared"))
    require_done(mpirun.alone("run", "case.toml", "-q", "-o", "alone"))
    first = {}
    for name in ("shared", "alone"):
        rows = rows_of(tmp_path / name / "events.csv")
        assert len(rows) == 2
        first[name] = {key: float(value) for key, value in rows[0].items() if value}
    assert first["shared"] == pytest.approx(first["alone"], rel=1e-9)
    events = [tmp_path / name / "events" / "0001" for name in ("shared", "alone")]
    require_same_bytes(*events, "interface.h5", "fronts.csv", "static.csv")
