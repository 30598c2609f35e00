# SPDX-License-Identifier: BSD-3-Clause
"""What is run for the paper: cases and studies, bases, open choices, and commands that write results."""

import json
import math
import sys
import tomllib
from argparse import Namespace

import bases
import numpy as np
import open_choices
import pytest
import reproduce

pytest.importorskip("slipfront._core")
pytest.importorskip("scipy")

import slipfront
from circle import Circle
from events import CRITERIA
from open_choices import Choices, Judged, Sample, region_of
from slipfront.files import DataError
from slipfront.read import main as verify

from cases import ALL, C_L_M_PER_S, HERE, paper_cases, sequences, studies, variations

CHOICES = Choices(open_choices.open_choices(False))


def tables(run):
    return tomllib.loads(run.case().toml)


def value_of(case, key):
    table, _, name = key.partition(".")
    return case[table][name]


def without(case, *keys):
    kept = {name: dict(table) for name, table in case.items() if name not in ("title", "output")}
    for key in keys:
        table, _, name = key.partition(".")
        kept[table].pop(name, None)
    return kept


def test_the_papers_cases_are_the_files_and_have_its_table_1():
    assert {file.stem for file in HERE.glob("*.toml")} == {run.name for run in paper_cases(False)}
    for run, quick in zip(paper_cases(False), paper_cases(True), strict=True):
        case = tables(run)
        mu_k = 1.0 if run.name == "spontaneous_mu_k_1.0" else 0.6
        expected = {
            "plate": {"width_m": 0.2, "height_m": 0.1},
            "material": {
                "youngs_modulus_Pa": 2.6e9,
                "poissons_ratio": 0.37,
                "density_kg_per_m3": 1200,
                "plane": "stress",
                "stiffness_damping_s": 0.1e-6,
            },
            "loading": {
                "tilt_left_m": 0.37e-3,
                "tilt_right_m": 0.037e-3,
                "shear_speed_m_per_s": 1e-6 * C_L_M_PER_S,
            },
            "friction": {"mu_s": 1.3, "mu_k": mu_k, "alpha_m2_per_s2": 0.1},
            "fronts": {"l_star_m": 0.67e-3},
        }
        for table, values in expected.items():
            assert case[table] | values == case[table]
        assert case["plate"]["element_size_m"] == pytest.approx(0.67e-3, abs=0.005e-3)
        size = "plate.element_size_m"
        assert value_of(tables(quick), size) == 2e-3
        assert without(tables(quick), size) == without(case, size)


def test_studies_have_the_scorecards_values():
    values = {study.name: [point.number for point in study.points] for study in studies(False)}
    assert values["mu_k"] == [0.4, 0.6, 0.8, 1.0, 1.1, 1.2]
    assert values["alpha"] == [0.01, 0.03, 0.1, 0.3, 1]
    assert all([r.name for r in p.runs] == list(ALL) for s in studies(False)[:2] for p in s.points)


@pytest.mark.parametrize("quick", [False, True])
def test_studies_change_one_parameter_of_the_papers_runs(quick):
    paper = {run.name: tables(run) for run in paper_cases(quick)}
    for study in studies(quick):
        assert len({point.value for point in study.points}) == len(study.points)
        if study.name == "corner":  # its values name two keys
            continue
        keys = (study.key, "plate.element_size_m") if study.own_reference else (study.key,)
        for point in study.points:
            for run in point.runs:
                case = tables(run)
                value = value_of(case, study.key)
                assert value == (point.value if math.isnan(point.number) else point.number)
                if study.key == "loading.method":  # keys of one method alone
                    continue
                assert without(case, *keys) == without(paper[run.name], *keys)


@pytest.mark.parametrize("quick", [False, True])
def test_variations_differ_from_the_runs_of_the_scorecard_in_one_parameter(quick):
    own = [tables(run) for run in paper_cases(quick)]
    own += [tables(run) for study in studies(quick)[:2] for p in study.points for run in p.runs]
    found = variations(quick)
    assert [(v.name, v.key, v.value) for v in found] == [
        ("mesh", "plate.element_size_m", 4e-3 if quick else 1e-3),
        ("step", "time.interface_substeps", 9),
    ]
    for variation in found:
        runs = [
            *variation.events,
            *(run for study in variation.studies for p in study.points for run in p.runs),
        ]
        for run, case in zip(runs, own, strict=True):
            varied = tables(run)
            assert value_of(varied, variation.key) == variation.value != value_of(case, variation.key)
            assert without(varied, variation.key) == without(case, variation.key)
            snapshots = varied["output"]["snapshot_times_s"]
            assert bool(snapshots) == (run in variation.events and run.event == "left")


# Open choices.


def test_ranges_hold_the_standard_and_go_back_and_forth():
    for choice in CHOICES.all:
        assert choice.at(0) == choice.levels[0]
        if choice.continuous:
            assert list(choice.levels) == sorted(choice.levels)
            assert choice.levels[0] <= choice.standard <= choice.levels[-1]
            for share in (0, 0.3, 1):
                assert choice.share_of(choice.at(share)) == pytest.approx(share)
        else:
            assert choice.standard in choice.levels


def test_choices_set_the_keys_that_they_name():
    for choice in CHOICES.all:
        base = dict(CHOICES.standard)
        if choice.decided_by:
            base[choice.decided_by] = choice.counts_with[0]
        if choice.name.endswith("duration_s"):
            base[f"{choice.event}_ramp_s"] = 0.1e-6
        event = choice.event or "spontaneous"
        cases = {
            level: CHOICES.case(event, base | {choice.name: level}).toml
            for level in {*choice.levels, choice.standard}
        }
        assert len(set(cases.values())) == len(cases), choice.name
        assert f"\n{choice.key.partition('.')[2]} = " in cases[choice.standard]


@pytest.mark.parametrize("event", ["left", "right"])
def test_triggers_vary_at_one_edge_and_ramps_end_within_their_duration(event):
    samples = CHOICES.triggers(event, 0, 512, CHOICES.standard)
    assert len({tuple(s.values.values()) for s in samples}) == len(samples)
    for sample in samples:
        values = sample.values
        for choice in CHOICES.all:
            value = values[choice.name]
            if choice.event != event:
                assert value == choice.standard
            elif choice.continuous:
                assert choice.levels[0] <= value <= choice.levels[-1]
                assert f"{value:.2g}" == f"{value:.6g}"
        if values[f"{event}_end"] == "taken away" and values[f"{event}_form"] != "weakened":
            assert values[f"{event}_ramp_s"] <= values[f"{event}_duration_s"]
    assert sum(s.values[f"{event}_end"] == "held" for s in samples) == 256
    behind = CHOICES.triggers(event, 500, 12, CHOICES.standard)
    assert [s.values for s in behind] == [s.values for s in samples[500:]]


def test_space_filling_reaches_every_tenth_of_every_range():
    samples = CHOICES.space_filling(CHOICES.all, "all", 0, 256, CHOICES.standard)
    for choice in CHOICES.all:
        if choice.continuous and not choice.at_most:
            shares = [choice.share_of(s.values[choice.name]) for s in samples]
            n = np.histogram(shares, 10, (0, 1))[0]
            assert n.min() >= 23
            assert n.max() <= 28


def test_a_choice_counts_where_all_that_decide_it_do():
    def used(**values):
        all_values = CHOICES.standard | {f"left_{name}": value for name, value in values.items()}
        return {c.name for c in CHOICES.of("left") if CHOICES.in_use(c.name, all_values)}

    held = {"left_form", "left_zone_m", "left_added", "left_end", "left_ramp_s"}
    assert used() == held
    assert used(end="taken away") == held | {"left_duration_s"}
    assert used(end="taken away", form="weakened") == {"left_form", "left_zone_m"}


def test_samples_about_another_change_one_choice_or_one_with_the_word_that_lets_it_count():
    standard = CHOICES.standard  # held: durations come with an end
    changed = []
    for sample in CHOICES.about(standard):
        names = [name for name, value in sample.values.items() if value != standard[name]]
        assert 1 <= len(names) <= 2
        assert len(names) == 1 or names[0].endswith(("_form", "_end"))
        changed.append(names[-1])
    assert set(changed) == set(standard)
    brief = standard | {"left_end": "taken away", "left_duration_s": 2e-6, "left_ramp_s": 1e-6}
    for sample in CHOICES.about(brief):
        values = sample.values
        if values["left_end"] == "taken away" and values["left_form"] != "weakened":
            assert values["left_ramp_s"] <= values["left_duration_s"]


def judged(kind="left trigger", n_apart=8, holds=True, spread=0.05, **values):
    """A sample whose constraints but C25 hold or do not."""
    claims = dict.fromkeys(open_choices.CONSTRAINTS, holds) | {"C14": spread < 0.1, "C21": None}
    spreads = dict.fromkeys(CRITERIA, Namespace(median_relative=spread))
    wave = Circle(10, n_apart, 2, 0.2, 1) if n_apart is not None else None
    defaults = CHOICES.standard | {"left_end": "taken away", "right_end": "taken away"}
    maxima = {"left": 1.0, "spontaneous": 2.0, "right": 3.0}
    distance = 1 if spread < 0.05 else 1.5
    return Judged(Sample(kind, defaults | values), claims, maxima, 1.0, wave, None, 0.8, spreads, distance)


def test_a_region_has_the_triggers_for_which_all_constraints_hold():
    others = [judged(n_apart=7), judged(n_apart=None), judged(holds=False), judged("right trigger")]
    assert region_of(CHOICES, others, "left").chosen is None
    good = judged()
    region = region_of(CHOICES, [*others, good], "left")
    assert region.all == [good]
    assert region.chosen is good


def test_a_region_is_chosen_in_the_middle_of_its_most_frequent_form_and_end():
    def left(zone_m, duration_s=5e-6, **more):
        return judged(left_zone_m=zone_m, left_duration_s=duration_s, **more)

    added = [left(zone_m) for zone_m in (4e-3, 2e-3, 16e-3, 2e-3, 20e-3)]
    others = [left(2e-3, left_form="raised"), *(left(4e-3, s, left_end="held") for s in (5e-6, 15e-6))]
    region = region_of(CHOICES, [others[0], *added, *others[1:]], "left")
    assert len(region.all) == 8
    assert region.alike == added
    assert region.chosen is added[0]  # 4 mm is the median
    # Durations count by their logarithms: 0.5, 1, 1, 4 and 15 us, median 1. 2 mm and 1 us: log 2 / log 10
    # off; 4 mm and 15 us: log 15 / log 30.
    for o, duration_s in zip(added, (15e-6, 1e-6, 4e-6, 0.5e-6, 1e-6), strict=True):
        o.sample.values["left_duration_s"] = duration_s
    assert region_of(CHOICES, added, "left").chosen is added[1]


def test_a_right_trigger_is_chosen_among_those_like_the_left_one():
    ends = [("added", "taken away")] * 2 + [
        ("raised", "held"),
        ("weakened", "taken away"),
        ("raised", "taken away"),
    ]
    rights = [
        judged("right trigger", left_form="raised", right_form=form, right_end=end) for form, end in ends
    ]
    region = region_of(CHOICES, rights, "right")
    assert len(region.all) == 5
    assert region.alike == [rights[4]]
    assert region.chosen is rights[4]


def test_evidence_is_of_the_region_and_of_held_triggers_without_the_circle():
    study = object.__new__(open_choices.Study)
    study.choices, study.claims = CHOICES, ["C14", "C21"]
    region = [judged(spread=0.04), judged(spread=0.06), judged(spread=0.12, left_form="raised")]
    held = [judged(n_apart=0, spread=0.2, left_end="held", left_form=form) for form in ("added", "weakened")]
    brief = judged(n_apart=0, spread=0.9)
    found = [o for o in [*region, *held, brief] if study.is_held(o)]
    assert found == held[:1]  # a weakened zone has no end
    assert [o for o in [*region, *held, brief] if study.is_of_region(o)] == region
    told = open_choices.evidence_json(study, "the region", region)
    assert told["n_paper_fit_in_intervals"] == 1
    assert told["spread_at_energy_rise"] == [0.04, 0.06, 0.12]
    assert told["difference_of_kinds_over_c_L"] == [None] * 3
    assert told["claims"] == {"C14": {"n": 3, "n_holding": 2}}  # C21 was not tested


# The commands.


def run(command, *arguments):
    """Exit code of a command."""
    before, sys.argv = sys.argv, [command.__name__, *map(str, arguments)]
    try:
        return command.main()
    finally:
        sys.argv = before


@pytest.fixture(scope="module")
def choices_folder(tmp_path_factory):
    folder = tmp_path_factory.mktemp("choices") / "results"
    assert run(open_choices, "--quick", "-o", folder) == 0
    return folder


def test_a_study_of_open_choices_begins_with_the_standard(choices_folder):
    found = json.loads((choices_folder / "open_choices.json").read_text())
    # The default, four triggers at each edge, four of all choices; more where triggers were chosen.
    assert found["n_samples"] + found["n_impossible"] >= 13
    assert found["n_triggers"] == 4
    assert found["standard"]["set"] == "standard"
    rows = (choices_folder / "open_choices.csv").read_text().splitlines()
    assert len(rows) == 1 + found["n_samples"]
    assert rows[1].startswith("standard,added,0.01,5,2,held,5e-06,5e-06,added,")
    assert len(found["choices"]) == len(CHOICES.all)
    assert verify([str(choices_folder)]) == 0


def test_triggers_are_read_from_the_folder_of_a_study(choices_folder, tmp_path):
    assert open_choices.read_trigger_sample(choices_folder, True).n_triggers == 4
    with pytest.raises(DataError, match="is a quick study"):
        open_choices.read_trigger_sample(choices_folder, False)
    with pytest.raises(DataError, match="holds no open_choices.json"):
        open_choices.read_trigger_sample(tmp_path, True)
    copy = tmp_path / "copy"
    copy.mkdir()
    for file in choices_folder.iterdir():
        (copy / file.name).write_bytes(file.read_bytes())
    (copy / "open_choices.json").write_text("{}")
    with pytest.raises(DataError, match="changed or damaged"):
        open_choices.read_trigger_sample(copy, True)


def interrupt(monkeypatch, command, n_runs, *arguments):
    """Ends a command as by Ctrl-C when so many runs are done."""
    step = command.Progress.step

    def stop(progress):
        step(progress)
        if progress.done == n_runs:
            raise KeyboardInterrupt

    monkeypatch.setattr(command.Progress, "step", stop)
    assert run(command, *arguments) == 130
    monkeypatch.undo()


def test_a_study_goes_on_behind_what_was_done(tmp_path, choices_folder, monkeypatch):
    folder = tmp_path / "results"
    interrupt(monkeypatch, open_choices, 3, "--quick", "--threads", 1, "-o", folder)
    kept = len(list((folder / "unfinished/state/runs").iterdir()))
    assert kept >= 2
    assert run(open_choices, "--quick", "-o", folder) == 0
    for file in ("open_choices.csv", "open_choices.json"):
        assert (folder / file).read_text() == (choices_folder / file).read_text()


def test_bases_have_the_papers_nominal_pressure_and_equal_bodies_change_none(tmp_path):
    for base, material in bases.BASES.items():
        case = tables(bases.runs_on(base, True)[0])
        E_Pa = case["material"]["youngs_modulus_Pa"]
        compliance = case["plate"]["height_m"] / E_Pa
        if material is not None:
            compliance += case["base"]["height_m"] / case["base"]["youngs_modulus_Pa"]
        pressure = (case["loading"]["tilt_left_m"] + case["loading"]["tilt_right_m"]) / 2 / compliance
        assert pressure == pytest.approx((0.37e-3 + 0.037e-3) / 2 / (0.1 / 2.6e9))
        assert (case["base"]["kind"] == "body") == (material is not None)
    folder = tmp_path / "results"
    assert run(bases, "--quick", "-o", folder) == 0
    found = json.loads((folder / "bases.json").read_text())
    own, *_, rigid = found["bases"]
    assert [own["pressure_change"][d] for d in ("along", "against")] == pytest.approx([0, 0], abs=1e-3)
    assert rigid["pressure_change"]["against"] < -0.05
    assert rigid["pressure_change"]["along"] > 0.2
    assert own["speed_ratio"]["median"] < 1 < rigid["speed_ratio"]["median"]
    assert len(own["events"]) == 4
    rows = (folder / "bases_points.csv").read_text().splitlines()
    assert len(rows) > sum(base["n_points"] for base in found["bases"])


@pytest.fixture(scope="module")
def quick(tmp_path_factory):
    folder = tmp_path_factory.mktemp("reproduce") / "results"
    assert run(reproduce, "--quick", "-o", folder) == 0
    return folder


# At elements of 2 mm: the verdicts, and figures of some of them.
DO_NOT_HOLD = {
    "C3",
    "C4",
    "C11",
    "C12",
    "C17",
    "C18",
    "C18+",
    "C18b",
    "C19",
    "C19b",
    "C21+",
    "C22b",
    "C22b2+",
}
FIGURES = {
    "C2": [("maximum", 56.0), ("minimum", 37.36)],
    "C5": [("ratio", 0.8176)],
    "C10": [("left peak", 1.133), ("right peak", 2.694)],
    "C18b": [("rms", 0.1060), ("a", 0.7653), ("b", 1.622), ("c", 3.367), ("within the band", 60.80)],
    "C19b": [("points outside", 114), ("near an end", 36), ("where V_tip falls", 31)],
    "C20b": [("0.4", 90.0), ("rank correlation", -1)],
    "C24": [("mu_k = 0.6", 0.7750), ("mu_k = 1", 0.9095)],
    "C25": [("share", 70), ("peak", 4.303)],
}


def test_a_quick_reproduction_has_the_known_scorecard(quick):
    rows = {row["id"]: row for row in json.loads((quick / "scorecard.json").read_text())}
    assert {id for id, row in rows.items() if row["holds"] is False} == DO_NOT_HOLD | {"C23", "C25"}
    assert {id for id, row in rows.items() if row["holds"] is None} == {"C11b", "E1"}
    for id, expected in FIGURES.items():
        values = {figure["name"]: figure["value"] for figure in rows[id]["figures"]}
        for name, value in expected:
            assert values[name] == pytest.approx(value, rel=2e-3), (id, name)
    assert {row["second_test_of"] for row in rows.values() if "why" in row} <= rows.keys()


def test_a_reproduction_writes_each_run_and_the_analysis(quick):
    folders = [run.name for run in paper_cases(True)]
    folders += [
        f"studies/{study.name}/{p.value}/{r.name}"
        for study in studies(True)
        for p in study.points
        for r in p.runs
    ]
    for name in folders:
        opened = slipfront.open(quick / name)
        assert opened.status == "complete"
        assert opened.fronts.sizes["point"] >= 0
    for one in sequences(True):
        assert slipfront.open(quick / one.name).events.sizes["event"] >= 1
    analysis = json.loads((quick / "analysis.json").read_text())
    assert analysis["paper_fit"] == {"a": 0.76, "a_band": 0.07, "b": 1.80, "c": 3.05}
    assert [study["name"] for study in analysis["studies"]] == [study.name for study in studies(True)]
    for told, study in zip(analysis["studies"], studies(True), strict=True):
        assert [point["value"] for point in told["points"]] == [point.value for point in study.points]
    assert len(json.loads((quick / "timings.json").read_text())) == 4
    assert verify([str(quick)]) == 0


def test_a_reproduction_refuses_a_folder_that_holds_anything(tmp_path, capsys):
    (tmp_path / "notes.txt").write_text("mine")
    assert run(reproduce, "--quick", "-o", tmp_path) == 2
    assert "is not empty" in capsys.readouterr().err
    assert [file.name for file in tmp_path.iterdir()] == ["notes.txt"]


def test_a_reproduction_goes_on_behind_what_was_done(tmp_path, quick, choices_folder, monkeypatch):
    folder = tmp_path / "results"
    interrupt(monkeypatch, reproduce, 9, "--quick", "-o", folder)
    assert not (folder / "scorecard.json").exists()
    damaged = folder / "unfinished/studies/mu_k/0.4/left/fronts.csv"
    damaged.write_text("damaged")  # it is computed again
    assert run(reproduce, "--quick", "-o", folder, "--open-choices", choices_folder) == 0
    rows, others = (json.loads((f / "scorecard.json").read_text()) for f in (folder, quick))
    assert [row for row in rows if row["id"] not in ("C11", "C11b")] == [
        row for row in others if row["id"] not in ("C11", "C11b")
    ]
    assert next(row["measured"] for row in rows if row["id"] == "C11b") == "0 of 4 triggers (0 %)"
    name = "studies/mu_k/0.4/left/fronts.csv"
    assert (folder / name).read_text() == (quick / name).read_text()


@pytest.mark.slow
def test_sensitivity_adds_variations_and_changes_nothing_else(tmp_path, quick):
    assert run(reproduce, "--quick", "--sensitivity", "-o", tmp_path / "results") == 0
    rows = json.loads((tmp_path / "results/scorecard.json").read_text())
    for row in rows:
        for variation in variations(True):
            entry = row.pop(f"{variation.name}_variation")
            assert (entry["parameter"], entry["value"]) == (variation.key, variation.value)
            assert len(entry["differences"]) == len(row["figures"])
    assert rows == json.loads((quick / "scorecard.json").read_text())
    # The coarse study of the mesh has the runs of the mesh variation.
    for event in ALL:
        a = tmp_path / "results/variations/mesh" / event / "fronts.csv"
        assert a.read_text() == (quick / "studies/element_size/0.004" / event / "fronts.csv").read_text()
