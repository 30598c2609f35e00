# SPDX-License-Identifier: BSD-3-Clause
"""The claims of Kammer et al. 2012 tested on events from anywhere: papers/kammer2012/scorecard.md."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import Any

from numpy.typing import ArrayLike
from slipfront import _core
from slipfront.given import column, flag, in_order, instance, number, refusing, text
from slipfront.measures import Arrays, history_arrays, tractions_at
from slipfront.running import CaseLike, make_case


def outcome(
    case: CaseLike,
    history: Arrays,
    tractions: Arrays,
    *,
    name: str = "",
    threshold_m_per_s: float = 1e-3,
    critical_shear_m: float = float("nan"),
    **tables: Any,
) -> _core.Outcome:
    """An event as the claims look at it.

    case: material, friction, event.kind with its trigger zone, and how fronts are measured; as for `run`.
    history: time_s [times], x_m [nodes], slip_rate_m_per_s, t_Pa and p_Pa [times, nodes]. tractions: t_s_Pa
    and p_s_Pa [nodes] before the event. Contact is where p_s is above 0, its inside loading.edge_margin_m
    from the ends. Raises CaseError where arrays do not fit each other or the case cannot be used."""
    threshold = number(threshold_m_per_s, "threshold_m_per_s", above=0)
    shear_m = number(critical_shear_m, "critical_shear_m")
    given = text(name, "name"), make_case(case, None, tables), *history_arrays(history)
    t_s, p_s = tractions_at(given[3], tractions)
    with refusing():
        return _core.outcome(*given, t_s, p_s, threshold, shear_m)


def collapse(outcomes: Iterable[_core.Outcome], *, without_tails: bool = False) -> _core.Collapse:
    """How well each criterion orders the speeds of a set of events: spreads at equal criterion, the fit of
    V_tip/c_L over the energy rise, and the share of points in the paper's band.

    without_tails: without the last 20 mm of fronts that arrest or run out of contact."""
    events = in_order(outcomes, "outcomes", "a list of slipfront.Outcome")
    for event in events:
        instance(event, _core.Outcome, "one of outcomes")
    return _core.collapse(events, flag(without_tails, "without_tails"))


def scorecard(
    *,
    spontaneous: _core.Outcome,
    left: _core.Outcome,
    right: _core.Outcome,
    spontaneous_mu_k_1: _core.Outcome,
    experiment: Mapping[str, ArrayLike] | None = None,
) -> list[_core.Claim]:
    """Every claim against four events, the last of them with mu_k = 1.0; each row says how it is tested.

    experiment: measured static_ratio and v_over_c_L [points]. Claims about studies over friction are not
    tested: their `holds` is None."""
    points = None
    if experiment is not None:
        ratio, speed = (column(experiment, "experiment", key) for key in ("static_ratio", "v_over_c_L"))
        points = ratio.tolist(), speed.tolist()
    events = {"spontaneous": spontaneous, "left": left, "right": right}
    events["spontaneous_mu_k_1"] = spontaneous_mu_k_1
    for name, event in events.items():
        instance(event, _core.Outcome, name)
    with refusing():
        return _core.scorecard(**events, experiment=points)
