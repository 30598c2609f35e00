# SPDX-License-Identifier: BSD-3-Clause
"""Slip fronts at frictional interfaces: cases run or composed, results opened, a user's own data measured.
docs/python.md

Nothing is imported before it is used: figures and readers do not need the compiled module."""

from difflib import get_close_matches
from importlib import import_module
from importlib.util import find_spec
from typing import TYPE_CHECKING, Any

from slipfront.errors import NEEDS_MODULE

if TYPE_CHECKING:
    from slipfront._core import BatchEvent as BatchEvent
    from slipfront._core import Body as Body
    from slipfront._core import ExponentialFit as ExponentialFit
    from slipfront._core import Info as Info
    from slipfront._core import Interface as Interface
    from slipfront._core import InterfaceState as InterfaceState
    from slipfront._core import Mesh as Mesh
    from slipfront._core import Rupture as Rupture
    from slipfront._core import Stepper as Stepper
    from slipfront._core import WaveSpeeds as WaveSpeeds
    from slipfront._core import WellPosedness as WellPosedness
    from slipfront.batch import Batch as Batch
    from slipfront.batch import event_of_history as event_of_history
    from slipfront.compare.cycles import compare_cycles as compare_cycles
    from slipfront.compare.cycles import events_of_force as events_of_force
    from slipfront.compare.onsets import compare_onsets as compare_onsets
    from slipfront.compare.speeds import compare_speeds as compare_speeds
    from slipfront.compare.traces import compare_traces as compare_traces
    from slipfront.contour import ContourIntegral as ContourIntegral
    from slipfront.contour import contour_integral as contour_integral
    from slipfront.cutting import read_recorders as read_recorders
    from slipfront.cutting import write_records as write_records
    from slipfront.errors import BlowUpError as BlowUpError
    from slipfront.errors import CaseError as CaseError
    from slipfront.errors import Error as Error
    from slipfront.errors import WriteError as WriteError
    from slipfront.files import DataError as DataError
    from slipfront.fracture import fracture_of_history as fracture_of_history
    from slipfront.fracture import predict_fronts as predict_fronts
    from slipfront.gauges import Gauge as Gauge
    from slipfront.gauges import gauges_of as gauges_of
    from slipfront.gauges import read_gauges as read_gauges
    from slipfront.measures import FrontSettings as FrontSettings
    from slipfront.measures import criteria as criteria
    from slipfront.measures import falls_while_rises as falls_while_rises
    from slipfront.measures import find_fronts as find_fronts
    from slipfront.measures import find_fronts_in_history as find_fronts_in_history
    from slipfront.measures import fit_exponential as fit_exponential
    from slipfront.measures import rank_correlation as rank_correlation
    from slipfront.measures import ratio_at_equal_x as ratio_at_equal_x
    from slipfront.measures import spread_at_equal_x as spread_at_equal_x
    from slipfront.near_tip import tip_field as tip_field
    from slipfront.onsets import read_onsets as read_onsets
    from slipfront.opened import OpenRun as OpenRun
    from slipfront.opened_sequence import OpenSequence as OpenSequence
    from slipfront.opened_sequence import open as open
    from slipfront.other_codes import read_seissol_fault_receivers as read_seissol_fault_receivers
    from slipfront.other_codes import read_sem2dpack as read_sem2dpack
    from slipfront.other_codes import read_uguca as read_uguca
    from slipfront.picks import pick_events as pick_events
    from slipfront.records import Channel as Channel
    from slipfront.records import Event as Event
    from slipfront.records import read_records as read_records
    from slipfront.running import case as case
    from slipfront.running import info as info
    from slipfront.running import resume as resume
    from slipfront.running import run as run
    from slipfront.running import run_with_law as run_with_law
    from slipfront.running import stable_step_s as stable_step_s
    from slipfront.running import version as version
    from slipfront.running import wave_speeds as wave_speeds
    from slipfront.running import well_posedness as well_posedness
    from slipfront.stretches import speed_stretches as speed_stretches
    from slipfront.tip_fit import TipFit as TipFit
    from slipfront.tip_fit import fit_front as fit_front
    from slipfront.tip_fit import fit_tip as fit_tip
    from slipfront.tip_fit import fit_tips as fit_tips

# The names of each module.
_NAMES = {
    "_core": (
        "BatchEvent Body ExponentialFit Info Interface InterfaceState Mesh Rupture Stepper WaveSpeeds "
        "WellPosedness"
    ),
    "batch": "Batch event_of_history",
    "compare.cycles": "compare_cycles events_of_force",
    "compare.onsets": "compare_onsets",
    "compare.speeds": "compare_speeds",
    "compare.traces": "compare_traces",
    "contour": "ContourIntegral contour_integral",
    "cutting": "read_recorders write_records",
    "errors": "BlowUpError CaseError Error WriteError",
    "files": "DataError",
    "fracture": "fracture_of_history predict_fronts",
    "gauges": "Gauge gauges_of read_gauges",
    "measures": (
        "FrontSettings criteria falls_while_rises find_fronts find_fronts_in_history fit_exponential "
        "rank_correlation ratio_at_equal_x spread_at_equal_x"
    ),
    "near_tip": "tip_field",
    "onsets": "read_onsets",
    "opened": "OpenRun",
    "opened_sequence": "OpenSequence open",
    "other_codes": "read_seissol_fault_receivers read_sem2dpack read_uguca",
    "picks": "pick_events",
    "records": "Channel Event read_records",
    "running": "case info resume run run_with_law stable_step_s version wave_speeds well_posedness",
    "stretches": "speed_stretches",
    "tip_fit": "TipFit fit_front fit_tip fit_tips",
}
_PLACES = {name: module for module, names in _NAMES.items() for name in names.split()}

__all__ = tuple(_PLACES)


def __getattr__(name: str) -> Any:
    if name not in _PLACES:
        near = get_close_matches(name, _PLACES, n=1)
        hint = f"; did you mean {near[0]}?" if near else ""
        raise AttributeError(f"module 'slipfront' has no attribute '{name}'{hint}")
    try:
        return getattr(import_module(f"slipfront.{_PLACES[name]}"), name)
    except ImportError as error:
        if find_spec("slipfront._core"):
            raise
        raise ImportError(f"slipfront.{name} needs {NEEDS_MODULE}") from error


def __dir__() -> list[str]:
    return sorted(__all__)
