# SPDX-License-Identifier: BSD-3-Clause
"""Whatever a notebook hands in wrongly is refused by an exception of slipfront's own, in one line; results
are printed with names, values and units."""

from __future__ import annotations

import re

import any_events
import numpy as np
import pytest
import slipfront
import slipfront.sweep
from package_cases import CASE, refused
from slipfront import _core

X_M = np.linspace(0, 0.2, 101)
ONSET_S = np.abs(X_M - 0.12) / 900
LONE = "\ud800"  # half a surrogate pair, as os.listdir or a JSON file may give
POINT_NAMES = ("t_s_Pa", "p_s_Pa", "t_d_Pa", "p_d_Pa", "U_s_J_per_m3", "U_r_J_per_m3")
HISTORY = {
    "time_s": np.arange(4.0),
    "x_m": np.arange(3.0),
    "slip_rate_m_per_s": np.ones((4, 3)),
    "t_Pa": np.ones((4, 3)),
    "p_Pa": np.ones((4, 3)),
}
TRACTIONS = {"t_s_Pa": np.ones(3), "p_s_Pa": np.ones(3)}
ITSELF: list = []
ITSELF.append(ITSELF)


@pytest.mark.parametrize("name", [LONE, "a\0b", "x" * 300, 5, None, 1.5, b"out", [], object()])
def test_what_is_no_path_is_refused(name):
    assert "folder is " in refused(lambda: slipfront.open(name))
    assert "output is " in refused(lambda: slipfront.resume(name))
    assert "case is " in refused(lambda: slipfront.run(name))
    assert "case is " in refused(lambda: slipfront.info(name))
    if name is not None:
        assert "output is " in refused(lambda: slipfront.run(CASE, output=name))
    assert "folder is " in refused(lambda: slipfront.sweep.open_sweep(name))
    assert "case is " in refused(lambda: slipfront.sweep.run(name, {"friction.mu_k": [1]}, "out"))
    assert "output is " in refused(lambda: slipfront.sweep.run("case.toml", {"friction.mu_k": [1]}, name))


@pytest.mark.parametrize(
    ("case", "said"),
    [
        ({"plate": None}, "plate is None: no value of a case file"),
        ({"plate": {"width_m": None}}, "plate.width_m is None: no value"),
        ({"plate": {"width_m": 1 + 2j}}, "plate.width_m is (1+2j): no value"),
        ({"plate": {"width_m": {1}}}, "plate.width_m is {1}: no value"),
        ({"plate": {"width_m": 10**5000}}, "no value"),
        ({"plate": {"width_m": np.nan}}, "plate.width_m is nan m"),
        ({"title": LONE}, "title is "),
        ({"title": {}}, "title must be a string, is a table"),
        ({"plate": {"width_m": {}}}, "plate.width_m must be a number, is a table"),
        ({"frction": {}}, "unknown table [frction]; did you mean [friction]?"),
        ({"friction": {"mu_k": 0.7}, "friction.mu_k": 0.8}, "friction.mu_k is given as '0.7' and as '0.8'"),
        ({LONE: 1}, "a key is "),
        ({5: 1}, "a key is 5; it must be a text"),
        ({"plate": {None: 1}}, "a key is None; it must be a text"),
        (f"[plate]\ntitle = '{LONE}'", "case is "),
        ({"a": ITSELF}, "nested too deeply"),
    ],
)
def test_what_no_case_may_hold_is_refused(case, said):
    assert said in refused(lambda: slipfront.info(case))
    if isinstance(case, dict):
        assert said in refused(lambda: slipfront.run(CASE, case))


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        ({"threads": 0}, "threads is 0; it must be at least 1"),
        ({"threads": 1.5}, "threads is 1.5; it must be a whole number"),
        ({"threads": "2"}, "threads is '2'; it must be a whole number"),
        ({"threads": 10**30}, "it must be at most 1024"),
        ({"checkpoint_every_s": "often"}, "checkpoint_every_s is 'often'; it must be a number"),
        ({"checkpoint_every_s": np.nan}, "checkpoint_every_s is nan"),
        ({"overwrite": "no"}, "overwrite is 'no'; it must be True or False"),
        ({"progress": 5}, "progress is 5; it must be True or False"),
        ({"friction": 5}, "friction is a table"),
        ({"output": 5}, "output is 5"),
        (
            {"observers": None},
            "observers is None; it must be a list of pairs of an interval, s, and a function",
        ),
    ],
)
def test_options_of_a_run(arguments, said):
    assert said in refused(lambda: slipfront.run(CASE, **arguments))


@pytest.mark.parametrize(
    ("given", "said"),
    [
        ({"x_m": None}, "x_m is None; it must be an array of numbers"),
        ({"x_m": ["a", "b"]}, "x_m is not an array of numbers: could not convert"),
        ({"x_m": X_M[None]}, "x_m has 2 dimensions; it must have 1"),
        ({"x_m": [], "onset_s": []}, "x_m has fewer than two values"),
        ({"x_m": X_M[::-1]}, "x_m must ascend strictly"),
        ({"x_m": np.where(X_M > 0.1, np.nan, X_M)}, "x_m holds a value that is not finite"),
        ({"x_m": {}}, "x_m is not an array of numbers"),
        ({"x_m": [[1], [1, 2]]}, "x_m is not an array of numbers"),
        ({"onset_s": ONSET_S[1:]}, "onset_s has 100 values, not 101"),
        ({"onset_s": ONSET_S + 0j}, "onset_s holds complex numbers"),
        ({"onset_s": np.arange(101).astype("timedelta64[us]")}, "onset_s is "),
        ({"settings": {"l_star_m": 1}}, "it must be a slipfront.FrontSettings"),
        ({"resolution_s": "fast"}, "resolution_s is 'fast'; it must be a number"),
        ({"resolution_s": np.nan}, "resolution_s is nan"),
        ({"end_time_s": -1}, "end_time_s is -1; it must be at least 0.000133333"),
        ({"t_s_Pa": 5}, "t_s_Pa has 1 values, not 101"),
        ({"settings": slipfront.FrontSettings(l_star_m="a")}, "l_star_m is 'a'; it must be a number"),
        ({"never_slipped": "maybe"}, "never_slipped is 'maybe'; it must be a number"),
        ({"settings": slipfront.FrontSettings(l_star_m=np.nan)}, "l_star_m is nan"),
        ({"settings": slipfront.FrontSettings(mu_s="a")}, "mu_s is 'a'"),
        (
            {"settings": slipfront.FrontSettings(youngs_modulus_Pa=-1)},
            "youngs_modulus_Pa is -1.0; it must be",
        ),
        (
            {"settings": slipfront.FrontSettings(poissons_ratio=5)},
            "it must be above -1 and below 0.5, or NaN",
        ),
        ({"settings": slipfront.FrontSettings(l_star_m=0)}, "l_star_m is 0; it must be above 0"),
        ({"settings": slipfront.FrontSettings(speed_interval="left")}, "speed_interval is 'left'"),
        ({"settings": slipfront.FrontSettings(crack_share=0.1)}, "pulse_share 0.2 is above crack_share 0.1"),
    ],
)
def test_arrays_and_options_of_fronts(given, said):
    assert said in refused(lambda: slipfront.find_fronts(**{"x_m": X_M, "onset_s": ONSET_S} | given))


@pytest.mark.parametrize(
    ("history", "said"),
    [
        (5, "history has no 'time_s'"),
        ({}, "history has no 'time_s'"),
        (HISTORY | {"time_s": HISTORY["time_s"][::-1]}, "time_s must ascend strictly"),
        (HISTORY | {"time_s": []}, "time_s has fewer than two values"),
        (HISTORY | {"p_Pa": None}, "history['p_Pa'] is None"),
        (HISTORY | {"p_Pa": np.ones(4)}, "history['p_Pa'] has 1 dimensions; it must have 2"),
        (HISTORY | {"p_Pa": np.empty((0, 3))}, "p_Pa must be an array [times, nodes]"),
        (HISTORY | {"t_Pa": np.ones((3, 4))}, "t_Pa must be an array [times, nodes]"),
        (HISTORY | {"slip_rate_m_per_s": np.full((4, 3), np.nan)}, "holds a value that is not finite"),
    ],
)
def test_histories(history, said):
    assert said in refused(lambda: slipfront.find_fronts_in_history(history, TRACTIONS))
    assert said in refused(lambda: any_events.outcome(CASE, history, TRACTIONS))
    assert refused(lambda: slipfront.find_fronts_in_history(history))


@pytest.mark.parametrize("given", [5, "x", {}, {"t_s_Pa": np.ones(3)}, [], "friction.mu_k=1", [1]])
def test_tractions_and_changes_are_dictionaries(given):
    assert "tractions" in refused(lambda: slipfront.find_fronts_in_history(HISTORY, given))
    assert "tractions" in refused(lambda: any_events.outcome(CASE, HISTORY, given))
    if not isinstance(given, dict):
        assert "it must be a dictionary" in refused(lambda: slipfront.run(CASE, given))


@pytest.mark.parametrize("places", [HISTORY["x_m"][::-1], HISTORY["x_m"] + 1])
def test_tractions_have_the_places_of_the_history(places):
    given = TRACTIONS | {"x_m": places}
    assert "tractions['x_m'] differs" in refused(lambda: slipfront.find_fronts_in_history(HISTORY, given))
    assert "tractions['x_m'] differs" in refused(lambda: any_events.outcome(CASE, HISTORY, given))


def test_criteria_need_their_columns():
    fronts = slipfront.find_fronts(X_M, ONSET_S)
    assert "fronts has no 'p_d_Pa'" in refused(lambda: slipfront.criteria(fronts.drop_vars("p_d_Pa")))
    for given in (5, None, {}, "x"):
        assert "fronts has no 't_s_Pa'" in refused(lambda given=given: slipfront.criteria(given))
    columns = {name: [1.0, 2.0] for name in POINT_NAMES} | {"p_s_Pa": [1.0]}
    assert "differ in length: t_s_Pa 2, p_s_Pa 1" in refused(lambda: slipfront.criteria(columns))


@pytest.mark.parametrize(
    "series", [5, None, "ab", {}, [5], [(X_M,)], [(X_M, X_M, X_M)], [("a", "b")], [([1, 2], [1])]]
)
def test_series(series):
    refused(lambda: slipfront.fit_exponential(series))
    refused(lambda: slipfront.spread_at_equal_x(series))


@pytest.mark.parametrize(
    "options", [{"resamples": 1.5}, {"resamples": 10**12}, {"seed": -1}, {"seed": None}, {"confidence": "a"}]
)
def test_options_of_the_fit(options):
    (name,) = options
    assert name in refused(lambda: slipfront.fit_exponential([(X_M, X_M)], **options))


def test_events_are_outcomes():
    for given in (5, None, "x", [5], [None]):
        assert "outcome" in refused(lambda given=given: any_events.collapse(given)).lower()
    four = dict.fromkeys(("spontaneous", "left", "right", "spontaneous_mu_k_1"), "left.toml")
    said = refused(lambda: any_events.scorecard(**four))
    assert said == "spontaneous is 'left.toml'; it must be a slipfront.Event"


@pytest.mark.parametrize(
    "size_m", ["a", None, np.nan, np.inf, 0, -1, [1], 10**400, True, np.array([1.0, 2.0])]
)
def test_sizes(size_m):
    assert "element_size_m is " in refused(lambda: slipfront.stable_step_s(size_m))
    assert "pressure_Pa is " in refused(
        lambda: slipfront.well_posedness(
            {"law": "coulomb"}, pressure_Pa=size_m, element_size_m=1e-3, longest_wavelength_m=0.2
        )
    )


def test_masked_values_are_not_taken_for_data():
    onset_s = np.ma.masked_array(ONSET_S, mask=X_M > 0.15)
    found = slipfront.find_fronts(X_M, onset_s)
    assert float(found.x_m.max()) <= 0.15


def test_fronts_without_a_column(tmp_path):
    run = slipfront.run(CASE, output=tmp_path / "out")
    (tmp_path / "out/checksums.sha256").unlink()
    file = tmp_path / "out/fronts.csv"
    whole = file.read_text()
    for column in ("front_id", "x_m", "onset_s", "direction", "v_tip_m_per_s"):
        file.write_text(re.sub(rf"\b{column}\b", "other", whole, count=1))
        assert f"no column '{column}'" in refused(lambda: slipfront.open(run.folder).fronts)


def test_bytes_of_a_name_that_are_no_text_are_told(tmp_path):
    """A name of a file system's own bytes may be used, and is told with signs that can be printed."""
    said = refused(lambda: slipfront.open(tmp_path / "a\udc80b"))
    assert said == f"{tmp_path}/a?b: no such folder; name the output folder of a run"
    run = slipfront.run(CASE, output=tmp_path / "c\udc80d")
    assert slipfront.open(run.folder).status == "complete"
    (run.folder / "energy.csv").unlink()
    assert "c?d/energy.csv: missing" in refused(lambda: slipfront.open(run.folder).energies)


def test_a_working_folder_that_is_gone(tmp_path, monkeypatch):
    (tmp_path / "gone").mkdir()
    monkeypatch.chdir(tmp_path / "gone")
    (tmp_path / "gone").rmdir()
    assert refused(lambda: slipfront.run(CASE)).startswith("case: the working folder is gone")


def test_no_room_for_a_temporary_folder(monkeypatch):
    monkeypatch.setattr("tempfile.tempdir", "/nonexistent")
    with pytest.raises(slipfront.WriteError, match="temporary folder: No such file or directory; name"):
        slipfront.run(CASE)


def test_a_fit_is_a_function_of_numbers_and_arrays():
    x = np.linspace(0.05, 3, 60)
    fit = slipfront.fit_exponential([(x, 0.7 + 1.9 * np.exp(-2.5 * np.sqrt(x)))], resamples=0)
    assert fit(1) == pytest.approx(0.7 + 1.9 * np.exp(-2.5), rel=1e-6)
    assert isinstance(fit(1), float)
    assert np.array_equal(fit([[1, 2], [1, 1]]), [[fit(1), fit(2)], [fit(1), fit(1)]])
    for given in ("a", None, 1j):
        assert "x " in refused(lambda given=given: fit(given))


# --- Printed


def test_speeds_are_printed_with_names_values_and_units():
    assert "\n  c_S_m_per_s  889.244 m/s  shear\n" in repr(slipfront.wave_speeds())


def test_no_result_is_printed_as_an_address():
    results = [found for found in vars(_core).values() if isinstance(found, type)]
    plain = [kind.__name__ for kind in results if kind.__repr__ is object.__repr__]
    assert plain == ["FrontOptions", "Batch", "ResultFolder"]  # of no function of the package
