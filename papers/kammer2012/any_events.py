# SPDX-License-Identifier: BSD-3-Clause
"""The claims of Kammer et al. 2012 tested on events from anywhere: papers/kammer2012/scorecard.md."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any

import events
import slipfront
from events import Collapse, Event, event_of
from scorecard import Claim, Reproduction
from scorecard import scorecard as claims_of
from slipfront.given import flag, in_order, instance, refusing, text
from slipfront.measures import Arrays
from slipfront.running import CaseLike


def outcome(
    case: CaseLike,
    history: Arrays,
    tractions: Arrays,
    *,
    name: str = "",
    threshold_m_per_s: float = 1e-3,
    critical_shear_m: float = float("nan"),
    **tables: Any,
) -> Event:
    """An event as the claims look at it.

    case: material, friction, event.kind with its trigger zone, and how fronts are measured; as for `run`.
    history: time_s [times], x_m [nodes], slip_rate_m_per_s, t_Pa and p_Pa [times, nodes]. tractions: t_s_Pa
    and p_s_Pa [nodes] before the event. Contact is where p_s is above 0, its inside loading.edge_margin_m
    from the ends. Raises CaseError where arrays do not fit each other or the case cannot be used."""
    called, prepared = text(name, "name"), slipfront.case(case, **tables)
    found = slipfront.event_of_history(
        prepared, history, tractions, threshold_m_per_s=threshold_m_per_s, critical_shear_m=critical_shear_m
    )
    with refusing():
        return event_of(called, prepared, found)


def collapse(outcomes: Iterable[Event], *, without_tails: bool = False) -> Collapse:
    """How well each criterion orders the speeds of a set of events: spreads at equal criterion, the fit of
    V_tip/c_L over the energy rise, and the share of points in the paper's band.

    without_tails: without the last 20 mm of fronts that arrest or run out of contact."""
    given = in_order(outcomes, "outcomes", "a list of events")
    for event in given:
        instance(event, Event, "one of outcomes")
    return events.collapse(given, flag(without_tails, "without_tails"))


def scorecard(
    *,
    spontaneous: Event,
    left: Event,
    right: Event,
    spontaneous_mu_k_1: Event,
) -> list[Claim]:
    """Every claim against four events, the last of them with mu_k = 1.0; each row says how it is tested.

    Claims about studies over friction, and about an experiment, are not tested: their `holds` is None."""
    four = (spontaneous, left, right, spontaneous_mu_k_1)
    for name, event in zip(("spontaneous", "left", "right", "spontaneous_mu_k_1"), four, strict=True):
        instance(event, Event, name)
    return claims_of(Reproduction(*four))
