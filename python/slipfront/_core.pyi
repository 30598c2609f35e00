"""
The compiled part of slipfront; use the package slipfront, which explains it.
"""

from collections.abc import Callable, Sequence
import enum
import os
import pathlib
from typing import Annotated

import numpy
from numpy.typing import NDArray


def version() -> str:
    """Version and commit that the module was built from."""

class InterfaceState:
    """
    The interface at the beginning of a step. Arrays [nodes] are views that cannot be written to; they may be kept.
    """

    @property
    def step(self) -> int:
        """steps done"""

    @property
    def time_s(self) -> float:
        """since the start of the event"""

    @property
    def x_m(self) -> Annotated[NDArray[numpy.float64], dict(shape=(None,), writable=False)]:
        """position along the interface from the left edge"""

    @property
    def slip_m(self) -> Annotated[NDArray[numpy.float64], dict(shape=(None,), writable=False)]:
        """
        displacement of the plate along x relative to its base, since the start
        """

    @property
    def slip_rate_m_per_s(self) -> Annotated[NDArray[numpy.float64], dict(shape=(None,), writable=False)]:
        """velocity of the plate along x relative to its base"""

    @property
    def t_Pa(self) -> Annotated[NDArray[numpy.float64], dict(shape=(None,), writable=False)]:
        """tangential traction, positive against sliding to +x"""

    @property
    def p_Pa(self) -> Annotated[NDArray[numpy.float64], dict(shape=(None,), writable=False)]:
        """contact pressure, positive in compression"""

    @property
    def law_states(self) -> list[Annotated[NDArray[numpy.float64], dict(shape=(None,), writable=False)]]:
        """of the state variables of the friction law, in its order"""

class WaveSpeeds:
    """Wave speeds of a material."""

    @property
    def c_L_m_per_s(self) -> float:
        """longitudinal, in the plane chosen"""

    @property
    def c_S_m_per_s(self) -> float:
        """shear"""

    @property
    def c_R_m_per_s(self) -> float:
        """Rayleigh, on a free surface"""

class WellPosedness:
    """Growth of small waves on uniform sliding: docs/stability.md."""

    @property
    def statement(self) -> str:
        """the verdict, one plain line"""

    @property
    def unbounded(self) -> bool:
        """growth has no bound as the wavelength goes to zero: ill-posed"""

    @property
    def grid_wavelength_m(self) -> float:
        """2 h, the shortest that the mesh carries"""

    @property
    def growth_at_grid_per_s(self) -> float:
        """of the fastest mode there, 0 where none grows"""

    @property
    def weakening_over_radiation(self) -> float:
        """
        -mu'(0) p over the radiation damping; above 1 strength drops at once on slip
        """

    @property
    def fastest_growth_per_s(self) -> float:
        """
        infinite where unbounded, 0 where none grows, not a number where nothing tells
        """

    @property
    def fastest_wavelength_m(self) -> float:
        """0 where growth rises at ever shorter waves"""

    @property
    def longest_wavelength_m(self) -> float:
        """of the search"""

    @property
    def growth_in_crossing(self) -> float:
        """fastest growth times h/c_L; above 1 no step follows it"""

    @property
    def damping_length_m(self) -> float:
        """beta_R c_L: much shorter waves are overdamped"""

    @property
    def damping_length_over_h(self) -> float: ...

class NodeSpread:
    """Over the nodes; NaN where there are none."""

    @property
    def min(self) -> float: ...

    @property
    def median(self) -> float: ...

    @property
    def max(self) -> float: ...

class Rupture:
    """What is to be expected of a case's rupture: docs/stability.md."""

    @property
    def nominal(self) -> bool:
        """
        whether tractions are not known yet: one node at t = mu_s p under the nominal pressure
        """

    @property
    def nodes_inside(self) -> int: ...

    @property
    def nodes_that_weaken(self) -> int: ...

    @property
    def nodes_above_residual_strength(self) -> int: ...

    @property
    def nodes_of_S_above_10(self) -> int: ...

    @property
    def strength_excess_S(self) -> NodeSpread:
        """(mu_s p - t)/(t - mu_k p)"""

    @property
    def seismic_ratio(self) -> NodeSpread:
        """1/(1 + S)"""

    @property
    def nucleation_length_m(self) -> float | None:
        """Uenishi, Rice 2003; None where friction does not weaken over a slip"""

    @property
    def griffith_half_length_m(self) -> float | None:
        """half the critical crack length, Andrews 1976"""

    @property
    def supershear_half_length_m(self) -> float | None:
        """half the crack from which on fronts above c_S can form, Andrews 1985"""

    @property
    def process_zone_m(self) -> float | None:
        """at rest, Palmer, Rice 1973"""

    @property
    def process_zone_elements(self) -> float | None: ...

    @property
    def unstable_wavelength_m(self) -> float | None:
        """of a law with a state: longer waves of uniform sliding grow"""

    @property
    def tip_slip_rate_m_per_s(self) -> float | None:
        """of a law with a state: beyond it a node counts as slipping"""

    @property
    def trigger_length_m(self) -> float | None:
        """of the zone at an edge, or of the patch"""

    @property
    def regime(self) -> str: ...

    @property
    def doubts(self) -> list[str]:
        """why nothing may rupture, a line each"""

class MeshChoice:
    """A mesh for a case's process zone."""

    @property
    def element_size_m(self) -> float: ...

    @property
    def coarsenings(self) -> int:
        """of the plate, and of a base"""

    @property
    def process_zone_elements(self) -> float: ...

    @property
    def n_nodes(self) -> int: ...

class Loads:
    """
    Forces of the interface per metre of thickness, and the displacements that give them.
    """

    @property
    def normal_force_N_per_m(self) -> float:
        """before any shear"""

    @property
    def mean_pressure_Pa(self) -> float:
        """the same over plate.width_m"""

    @property
    def tilt_left_m(self) -> float:
        """downward displacement of the top edge at its left end"""

    @property
    def tilt_right_m(self) -> float:
        """the same at its right end"""

    @property
    def shear_force_N_per_m(self) -> float:
        """before triggered events"""

    @property
    def shear_m(self) -> float:
        """displacement of the top edge to +x that gives it"""

    @property
    def critical_shear_force_N_per_m(self) -> float:
        """at which t/p first reaches mu_s inside"""

    @property
    def critical_shear_m(self) -> float: ...

class Info:
    """What a case needs and what is to be expected of it, before it runs."""

    @property
    def speeds(self) -> WaveSpeeds:
        """of the plate"""

    @property
    def base_speeds(self) -> WaveSpeeds | None:
        """of the body below; None on the rigid plane"""

    @property
    def generalised_rayleigh_speed_m_per_s(self) -> float | None:
        """of the two bodies, where it exists"""

    @property
    def n_nodes(self) -> int: ...

    @property
    def n_cells(self) -> int: ...

    @property
    def n_interface(self) -> int: ...

    @property
    def stable_step_s(self) -> float: ...

    @property
    def step_s(self) -> float: ...

    @property
    def substep_s(self) -> float: ...

    @property
    def n_steps(self) -> int:
        """of the event, to time.end_s"""

    @property
    def node_updates(self) -> float:
        """of the event and of the ramp"""

    @property
    def memory_bytes(self) -> float:
        """the larger of statics and event"""

    @property
    def disk_bytes(self) -> float: ...

    @property
    def expected_s(self) -> float:
        """wall time, at the rate measured on the spot"""

    @property
    def node_updates_per_s(self) -> float:
        """measured on the spot"""

    @property
    def rupture(self) -> Rupture:
        """what is to be expected of it"""

    @property
    def cheapest_mesh(self) -> MeshChoice | None:
        """for arrivals to about 1 %, docs/mesh.md; None without a process zone"""

    @property
    def well_posedness(self) -> WellPosedness:
        """of slow uniform sliding at the plate's nominal pressure"""

    @property
    def loads(self) -> Loads | None:
        """of a case that gives forces, by its statics; else None"""

    @property
    def notes(self) -> list:
        """
        what is hardly meant, decides physics unasked, or keeps it from a rupture
        """

class Case:
    """A case with its changes, checked."""

    def __init__(self, file: str | os.PathLike, changes: Sequence[tuple[str, str]]) -> None:
        """Of a case file; changes are pairs of dotted key and TOML text."""

    @staticmethod
    def from_text(text: str, name: str, folder: str | os.PathLike, changes: Sequence[tuple[str, str]]) -> Case:
        """
        Of a text, which `name` stands for in messages; paths of its tables count from `folder`.
        """

    @property
    def toml(self) -> str:
        """every key with its value, as case.resolved.toml has it"""

    @property
    def wave_speeds(self) -> WaveSpeeds:
        """of the plate"""

    @property
    def limiting_speed_m_per_s(self) -> float:
        """
        at which a front that releases energy ends to be possible below the shear speeds
        """

    @property
    def static_coefficient(self) -> float: ...

    def info(self) -> Info:
        """
        What follows from the case; only loads that are forces take its statics.
        """

    def stable_step_s(self, element_size_m: float) -> float:
        """Largest stable step of the case's material in square elements, s."""

    def well_posedness(self, pressure_Pa: float, element_size_m: float, longest_wavelength_m: float) -> WellPosedness:
        """Of slow uniform sliding of the case's materials under its friction."""

    def run(self, dir: str | os.PathLike, overwrite: bool, threads: int | None, checkpoint_every_s: float, progress: object | None, observers: Sequence[tuple[float, object]], within: ResultFolder | None = None) -> None:
        """
        Runs the case into a folder; progress(part, step, total) is called at times, each of the observers with an InterfaceState at its interval, s. within: the ResultFolder of whose work the folder is a part.
        """

    def check(self) -> None:
        """
        What can be checked without solving anything: memory, geometry; raises CaseError.
        """

def run_by_law(case: Case, dir: str | os.PathLike, mu_of: Callable, evolve: Callable | None, initial: Callable | None, states: Sequence[tuple[str, str]], progress: object | None) -> None:
    """
    Runs a case whose coefficient is mu_of(slip_rate_m_per_s, slip_m), arrays [nodes]; or, under a law with states, mu_of(slip_rate_m_per_s, *states), and evolve(dt_s, slip_rate_m_per_s, *states) the list of states after a time. states: names and units of states of its own, of which initial(t_Pa, p_Pa) gives the list.
    """

def resume(dir: str | os.PathLike, case: Case | None, threads: int | None, checkpoint_every_s: float, progress: object | None, observers: Sequence[tuple[float, object]]) -> None:
    """
    Goes on with the unfinished run or sequence of a folder, or with a sequence that is complete and that the case continues; does nothing where it is complete.
    """

class Mesh:
    """
    Nodes and four-node cells of a plate, its lower edge the interface.

    plate: keys of [plate] of a case file, such as width_m=0.1, height_m=0.05, element_size_m=1e-3, corner="none", sides="absorbing", top="free". Raises CaseError. Arrays are views that cannot be written to.
    """

    def __init__(self, **plate: object) -> None: ...

    def __repr__(self) -> str: ...

    @property
    def x_m(self) -> Annotated[NDArray[numpy.float64], dict(shape=(None,), writable=False)]:
        """[nodes] along the interface, from the left edge"""

    @property
    def y_m(self) -> Annotated[NDArray[numpy.float64], dict(shape=(None,), writable=False)]:
        """[nodes] away from the interface; of a body below downwards"""

    @property
    def cells(self) -> Annotated[NDArray[numpy.int32], dict(shape=(None, 4), writable=False)]:
        """[cells, 4] numbers of their nodes, counterclockwise"""

    @property
    def interface_nodes(self) -> Annotated[NDArray[numpy.int32], dict(shape=(None,), writable=False)]:
        """[interface nodes] their numbers, x ascending"""

class Body:
    """
    An elastic body with stiffness damping.

    material: keys of [material], such as youngs_modulus_Pa=2.6e9, poissons_ratio=0.37, density_kg_per_m3=1200, plane="strain". Raises CaseError.
    """

    def __init__(self, mesh: Mesh, **material: object) -> None: ...

    def __repr__(self) -> str: ...

class Interface:
    """
    Contact and friction of an interface.

    friction: keys of [friction], such as law="slip_weakening" and its parameters. law may be a function mu(slip_rate_m_per_s, slip_m), as that of run_with_law: its mu(0, 0) is mu_s, and mu_k that of nodes weakened by strength_fraction, by default mu_s. contact: contact.algorithm, "direct" or "predictor_corrector". Raises CaseError.
    """

    def __init__(self, *, contact: object = 'direct', **friction: object) -> None: ...

    def __repr__(self) -> str: ...

class Stepper:
    """
    Explicit steps of a body on the rigid plane, or of two bodies on each other.

    below: another body instead of the plane, described upside down: y, u_y and v_y point away from the interface. Its interface nodes face those above. time: keys of [time] that say how steps are taken, such as interface_substeps=1. Results do not depend on threads. Arrays are views of the state between two steps: they change with it and cannot be written to; copy what is to be kept. Raises CaseError, also before the start, after a failure, and where another thread is advancing it.
    """

    def __init__(self, above: Body, interface: Interface, below: Body | None = None, *, threads: int = 1, **time: object) -> None: ...

    def __repr__(self) -> str: ...

    def start(self, t_Pa: object, p_Pa: object, *, strength_fraction: object = 1.0, shear_speed_m_per_s: float = 0.0) -> None:
        """
        Starts at rest, undeformed, under tractions on the interface: each a number or [interface nodes]. t_Pa drives the body above to +x, p_Pa > 0 presses it down, the opposite acts on a body below. strength_fraction: 1, or less down to 0 for nodes weakened for good, mu = mu_k + strength_fraction (mu - mu_k). shear_speed_m_per_s: of a loaded upper edge. Raises CaseError.
        """

    def start_from_statics(self, share: float | None = None, **loading: object) -> None:
        """
        Starts from the equilibrium under tilt and shear of the upper edge. share: largest t/(mu_s p) inside, above 1 for an event that begins by itself; by default what `loading` says, keys of [loading], as before a triggered event. Raises CaseError, KeyboardInterrupt.
        """

    def set_tractions(self, t_Pa: object, p_Pa: object) -> None:
        """
        Tractions on the interface from the next step on, instead of those before, as for start.
        """

    def advance(self, n_steps: int) -> int:
        """
        Takes steps; other Python threads go on meanwhile. Returns their number. Raises BlowUpError, after which the stepper cannot be used, and KeyboardInterrupt, after which it goes on.
        """

    def run_until(self, time_s: float) -> int:
        """The same up to the first step at or after a time, s since the start."""

    def energies(self) -> dict[str, float]:
        """
        Terms of the energy balance up to the last half (sub-)step, J per metre of thickness, named as in energy.csv: what is stored, works since the start, and what they leave open.
        """

    @property
    def step(self) -> int:
        """steps taken"""

    @property
    def time_s(self) -> float:
        """since the start"""

    @property
    def step_s(self) -> float: ...

    @property
    def stable_step_s(self) -> float:
        """the largest stable step of the smallest cells"""

    @property
    def x_m(self) -> Annotated[NDArray[numpy.float64], dict(shape=(None,), writable=False)]:
        """[interface nodes] position along the interface from the left edge"""

    @property
    def slip_m(self) -> Annotated[NDArray[numpy.float64], dict(shape=(None,), writable=False)]:
        """
        [interface nodes] displacement along x of the body above relative to what it lies on, since the start
        """

    @property
    def slip_rate_m_per_s(self) -> Annotated[NDArray[numpy.float64], dict(shape=(None,), writable=False)]:
        """[interface nodes] its velocity in the last (sub-)step"""

    @property
    def t_Pa(self) -> Annotated[NDArray[numpy.float64], dict(shape=(None,), writable=False)]:
        """
        [interface nodes] tangential traction in the last (sub-)step, positive against sliding to +x
        """

    @property
    def p_Pa(self) -> Annotated[NDArray[numpy.float64], dict(shape=(None,), writable=False)]:
        """[interface nodes] contact pressure, positive in compression"""

    @property
    def law_states(self) -> list[Annotated[NDArray[numpy.float64], dict(shape=(None,), writable=False)]]:
        """
        of the state variables of the friction law, in its order, [interface nodes] each, at time_s
        """

    def displacement_m(self, body: int = 0) -> tuple[Annotated[NDArray[numpy.float64], dict(shape=(None,), writable=False)], Annotated[NDArray[numpy.float64], dict(shape=(None,), writable=False)]]:
        """Of all nodes of a body, 0 above or 1 below: arrays u_x and u_y."""

    def velocity_m_per_s(self, body: int = 0) -> tuple[Annotated[NDArray[numpy.float64], dict(shape=(None,), writable=False)], Annotated[NDArray[numpy.float64], dict(shape=(None,), writable=False)]]:
        """
        The same of the velocity half a step before, half a sub-step next to the interface.
        """

class Front:
    """A path of onsets, continuous in x, in one direction. Arrays: [points]"""

    @property
    def id(self) -> int: ...

    @property
    def direction(self) -> int:
        """+1 or -1 along x"""

    @property
    def end(self) -> str:
        """why it ends"""

    @property
    def mode(self) -> str:
        """crack, pulse or mixed"""

    @property
    def length_m(self) -> float: ...

    @property
    def node(self) -> Annotated[NDArray[numpy.int32], dict(shape=(None,), writable=False)]:
        """indices along the interface"""

    @property
    def x_m(self) -> Annotated[NDArray[numpy.float64], dict(shape=(None,), writable=False)]: ...

    @property
    def onset_s(self) -> Annotated[NDArray[numpy.float64], dict(shape=(None,), writable=False)]: ...

    @property
    def v_tip_m_per_s(self) -> Annotated[NDArray[numpy.float64], dict(shape=(None,), writable=False)]: ...

    @property
    def t_s_Pa(self) -> Annotated[NDArray[numpy.float64], dict(shape=(None,), writable=False)]: ...

    @property
    def p_s_Pa(self) -> Annotated[NDArray[numpy.float64], dict(shape=(None,), writable=False)]: ...

    @property
    def t_d_Pa(self) -> Annotated[NDArray[numpy.float64], dict(shape=(None,), writable=False)]: ...

    @property
    def p_d_Pa(self) -> Annotated[NDArray[numpy.float64], dict(shape=(None,), writable=False)]: ...

    @property
    def t_r_Pa(self) -> Annotated[NDArray[numpy.float64], dict(shape=(None,), writable=False)]: ...

    @property
    def p_r_Pa(self) -> Annotated[NDArray[numpy.float64], dict(shape=(None,), writable=False)]: ...

    @property
    def U_s_J_per_m3(self) -> Annotated[NDArray[numpy.float64], dict(shape=(None,), writable=False)]: ...

    @property
    def U_r_J_per_m3(self) -> Annotated[NDArray[numpy.float64], dict(shape=(None,), writable=False)]: ...

    @property
    def slipping_share(self) -> Annotated[NDArray[numpy.float64], dict(shape=(None,), writable=False)]: ...

    @property
    def accelerating(self) -> Annotated[NDArray[numpy.bool_], dict(shape=(None,), writable=False)]: ...

class SpeedInterval(enum.Enum):
    """Where l* lies against the node at x."""

    centred = 0

    approach = 1

class FrontOptions:
    """How fronts are found and measured; lengths in m, times in s."""

    def __init__(self) -> None: ...

    @property
    def l_star_m(self) -> float: ...

    @l_star_m.setter
    def l_star_m(self, arg: float, /) -> None: ...

    @property
    def speed_interval(self) -> SpeedInterval: ...

    @speed_interval.setter
    def speed_interval(self, arg: SpeedInterval, /) -> None: ...

    @property
    def arrest_time_s(self) -> float: ...

    @arrest_time_s.setter
    def arrest_time_s(self, arg: float, /) -> None: ...

    @property
    def arrest_time_by_event(self) -> bool: ...

    @arrest_time_by_event.setter
    def arrest_time_by_event(self, arg: bool, /) -> None: ...

    @property
    def whole_interface(self) -> bool: ...

    @whole_interface.setter
    def whole_interface(self, arg: bool, /) -> None: ...

    @property
    def min_length_m(self) -> float: ...

    @min_length_m.setter
    def min_length_m(self, arg: float, /) -> None: ...

    @property
    def crack_share(self) -> float: ...

    @crack_share.setter
    def crack_share(self, arg: float, /) -> None: ...

    @property
    def pulse_share(self) -> float: ...

    @pulse_share.setter
    def pulse_share(self, arg: float, /) -> None: ...

    @property
    def mode_fraction(self) -> float: ...

    @mode_fraction.setter
    def mode_fraction(self, arg: float, /) -> None: ...

    @property
    def mu_s(self) -> float: ...

    @mu_s.setter
    def mu_s(self, arg: float, /) -> None: ...

    @property
    def youngs_modulus_Pa(self) -> float: ...

    @youngs_modulus_Pa.setter
    def youngs_modulus_Pa(self, arg: float, /) -> None: ...

    @property
    def poissons_ratio(self) -> float: ...

    @poissons_ratio.setter
    def poissons_ratio(self, arg: float, /) -> None: ...

    @property
    def plane_strain(self) -> bool: ...

    @plane_strain.setter
    def plane_strain(self, arg: bool, /) -> None: ...

def find_fronts(x_m: Annotated[NDArray[numpy.float64], dict(shape=(None,), order='C', device='cpu', writable=False)], onset_s: Annotated[NDArray[numpy.float64], dict(shape=(None,), order='C', device='cpu', writable=False)], t_s_Pa: Annotated[NDArray[numpy.float64], dict(shape=(None,), order='C', device='cpu', writable=False)], p_s_Pa: Annotated[NDArray[numpy.float64], dict(shape=(None,), order='C', device='cpu', writable=False)], end_time_s: float, resolution_s: float, options: FrontOptions) -> list[Front]:
    """Fronts in first onsets at x_m [nodes], infinite where none is."""

def find_fronts_in_history(time_s: Annotated[NDArray[numpy.float64], dict(shape=(None,), order='C', device='cpu', writable=False)], x_m: Annotated[NDArray[numpy.float64], dict(shape=(None,), order='C', device='cpu', writable=False)], slip_rate_m_per_s: Annotated[NDArray[numpy.float64], dict(shape=(None, None), order='C', device='cpu', writable=False)], t_Pa: Annotated[NDArray[numpy.float64], dict(shape=(None, None), order='C', device='cpu', writable=False)], p_Pa: Annotated[NDArray[numpy.float64], dict(shape=(None, None), order='C', device='cpu', writable=False)], t_s_Pa: Annotated[NDArray[numpy.float64], dict(shape=(None,), order='C', device='cpu', writable=False)], p_s_Pa: Annotated[NDArray[numpy.float64], dict(shape=(None,), order='C', device='cpu', writable=False)], threshold_m_per_s: float, tip_at_peak: bool, options: FrontOptions) -> list[Front]:
    """Fronts in a history of the interface, matrices [times, nodes]."""

def falls_while_rises(s_m: Annotated[NDArray[numpy.float64], dict(shape=(None,), order='C', device='cpu', writable=False)], falling: Annotated[NDArray[numpy.float64], dict(shape=(None,), order='C', device='cpu', writable=False)], rising: Annotated[NDArray[numpy.float64], dict(shape=(None,), order='C', device='cpu', writable=False)], min_length_m: float) -> Annotated[NDArray[numpy.float64], dict(shape=(None,), writable=False)]:
    """
    Lengths of stretches of a path over which one quantity falls while another rises.
    """

def energy_density_J_per_m3(t_Pa: Annotated[NDArray[numpy.float64], dict(shape=(None,), order='C', device='cpu', writable=False)], p_Pa: Annotated[NDArray[numpy.float64], dict(shape=(None,), order='C', device='cpu', writable=False)], youngs_modulus_Pa: float, poissons_ratio: float, plane_strain: bool) -> Annotated[NDArray[numpy.float64], dict(shape=(None,), writable=False)]:
    """Kammer et al. 2012, Eq. 2."""

def predict_fronts(case: Case, x_m: Annotated[NDArray[numpy.float64], dict(shape=(None,), order='C', device='cpu', writable=False)], fracture_energy_J_per_m2: Annotated[NDArray[numpy.float64], dict(shape=(None,), order='C', device='cpu', writable=False)], residual_coefficient: Annotated[NDArray[numpy.float64], dict(shape=(None,), order='C', device='cpu', writable=False)], at_x_m: float | None, before: tuple[Annotated[NDArray[numpy.float64], dict(shape=(None,), order='C', device='cpu', writable=False)], Annotated[NDArray[numpy.float64], dict(shape=(None,), order='C', device='cpu', writable=False)], Annotated[NDArray[numpy.float64], dict(shape=(None,), order='C', device='cpu', writable=False)]] | None) -> dict:
    """
    Fronts of a case by the equation of motion of cracks; empty arrays leave friction to the law. before: places, t and p before the event, instead of those of the case.
    """

def fracture_of_history(bodies: Case, time_s: Annotated[NDArray[numpy.float64], dict(shape=(None,), order='C', device='cpu', writable=False)], x_m: Annotated[NDArray[numpy.float64], dict(shape=(None,), order='C', device='cpu', writable=False)], slip_m: Annotated[NDArray[numpy.float64], dict(shape=(None, None), order='C', device='cpu', writable=False)], slip_rate_m_per_s: Annotated[NDArray[numpy.float64], dict(shape=(None, None), order='C', device='cpu', writable=False)], t_Pa: Annotated[NDArray[numpy.float64], dict(shape=(None, None), order='C', device='cpu', writable=False)], p_Pa: Annotated[NDArray[numpy.float64], dict(shape=(None, None), order='C', device='cpu', writable=False)], front_id: Annotated[NDArray[numpy.float64], dict(shape=(None,), order='C', device='cpu', writable=False)], direction: Annotated[NDArray[numpy.float64], dict(shape=(None,), order='C', device='cpu', writable=False)], node: Annotated[NDArray[numpy.float64], dict(shape=(None,), order='C', device='cpu', writable=False)], point_x_m: Annotated[NDArray[numpy.float64], dict(shape=(None,), order='C', device='cpu', writable=False)], onset_s: Annotated[NDArray[numpy.float64], dict(shape=(None,), order='C', device='cpu', writable=False)], v_tip_m_per_s: Annotated[NDArray[numpy.float64], dict(shape=(None,), order='C', device='cpu', writable=False)], t_s_Pa: Annotated[NDArray[numpy.float64], dict(shape=(None,), order='C', device='cpu', writable=False)], threshold_m_per_s: float, cohesion_Pa: float) -> dict:
    """
    Columns of fracture.csv at points of fronts in a history, matrices [times, nodes].
    """

class Estimate:
    """A value with a two-sided confidence interval."""

    @property
    def value(self) -> float: ...

    @property
    def low(self) -> float: ...

    @property
    def high(self) -> float: ...

class ExponentialFit:
    """y = a + b exp(-c sqrt(x)), Kammer et al. 2012, Eq. 3."""

    @property
    def a(self) -> Estimate: ...

    @property
    def b(self) -> Estimate: ...

    @property
    def c(self) -> Estimate: ...

    @property
    def rms(self) -> float:
        """of the residuals"""

    @property
    def n_points(self) -> int: ...

    def curve(self) -> tuple[Annotated[NDArray[numpy.float64], dict(shape=(None,), writable=False)], Annotated[NDArray[numpy.float64], dict(shape=(None,), writable=False)], Annotated[NDArray[numpy.float64], dict(shape=(None,), writable=False)], Annotated[NDArray[numpy.float64], dict(shape=(None,), writable=False)]]:
        """The fitted curve: x, y and its interval low and high, [points]."""

    def __call__(self, x: Annotated[NDArray[numpy.float64], dict(shape=(None,), order='C', device='cpu', writable=False)]) -> Annotated[NDArray[numpy.float64], dict(shape=(None,), writable=False)]:
        """y at x [points]"""

class Spread:
    """Spread of y over the series at equal x."""

    @property
    def median_relative(self) -> float:
        """median over the bins; NaN where no bin has two series"""

    @property
    def rms_relative(self) -> float:
        """of all points of a bin about their mean"""

    @property
    def n_bins(self) -> int:
        """bins with at least two series"""

class Ratio:
    """Ratio of the medians of y of two series at equal x."""

    @property
    def median(self) -> float:
        """over the bins; NaN where no bin has both series"""

    @property
    def low(self) -> float:
        """the smallest of a bin"""

    @property
    def high(self) -> float:
        """the largest"""

    @property
    def n_bins(self) -> int:
        """bins that both series reach"""

def fit_exponential(series: Sequence[tuple[Annotated[NDArray[numpy.float64], dict(shape=(None,), order='C', device='cpu', writable=False)], Annotated[NDArray[numpy.float64], dict(shape=(None,), order='C', device='cpu', writable=False)]]], resamples: int, block_points: int, confidence: float, seed: int) -> ExponentialFit:
    """Least squares over all points of all series (x, y)."""

def spread_at_equal_x(series: Sequence[tuple[Annotated[NDArray[numpy.float64], dict(shape=(None,), order='C', device='cpu', writable=False)], Annotated[NDArray[numpy.float64], dict(shape=(None,), order='C', device='cpu', writable=False)]]], bins: int) -> Spread: ...

def ratio_at_equal_x(series: Sequence[tuple[Annotated[NDArray[numpy.float64], dict(shape=(None,), order='C', device='cpu', writable=False)], Annotated[NDArray[numpy.float64], dict(shape=(None,), order='C', device='cpu', writable=False)]]], bins: int) -> Ratio: ...

def rank_correlation(x: Annotated[NDArray[numpy.float64], dict(shape=(None,), order='C', device='cpu', writable=False)], y: Annotated[NDArray[numpy.float64], dict(shape=(None,), order='C', device='cpu', writable=False)]) -> float:
    """Spearman's."""

class Velocities:
    """Of a plate's nodes at a time."""

    @property
    def time_s(self) -> float: ...

    @property
    def x_m_per_s(self) -> Annotated[NDArray[numpy.float64], dict(shape=(None,), writable=False)]: ...

    @property
    def y_m_per_s(self) -> Annotated[NDArray[numpy.float64], dict(shape=(None,), writable=False)]: ...

class BatchEvent:
    """What a case of a batch has come to."""

    @property
    def blew_up(self) -> bool:
        """see reason"""

    @property
    def reason(self) -> str: ...

    @property
    def speeds(self) -> WaveSpeeds:
        """of the plate"""

    @property
    def fronts(self) -> list[Front]: ...

    @property
    def x_m(self) -> Annotated[NDArray[numpy.float64], dict(shape=(None,), writable=False)]:
        """of the interface [nodes]"""

    @property
    def t_s_Pa(self) -> Annotated[NDArray[numpy.float64], dict(shape=(None,), writable=False)]:
        """before the event [nodes]"""

    @property
    def p_s_Pa(self) -> Annotated[NDArray[numpy.float64], dict(shape=(None,), writable=False)]:
        """before the event [nodes]"""

    @property
    def inside_from_m(self) -> float:
        """the part of the contact that counts as inside"""

    @property
    def inside_to_m(self) -> float: ...

    @property
    def peak_x_m(self) -> float:
        """of t_s/p_s inside"""

    @property
    def critical_shear_m(self) -> float:
        """shear at which slip begins inside"""

    @property
    def ramp_critical_shear_m(self) -> float:
        """the same by the ramp; NaN where there was none"""

    @property
    def ramp_onsets(self) -> int:
        """beginnings of slip at the edges during the ramp"""

    @property
    def onset_x_m(self) -> Annotated[NDArray[numpy.float64], dict(shape=(None,), writable=False)]:
        """where slip begins, in the order of time [onsets]"""

    @property
    def onset_s(self) -> Annotated[NDArray[numpy.float64], dict(shape=(None,), writable=False)]:
        """when it does [onsets]"""

    @property
    def trigger_work_J_per_m(self) -> float:
        """NaN where no energies were taken"""

    @property
    def node_x_m(self) -> Annotated[NDArray[numpy.float64], dict(shape=(None,), writable=False)]:
        """of the plate, of a case with snapshots [nodes]"""

    @property
    def node_y_m(self) -> Annotated[NDArray[numpy.float64], dict(shape=(None,), writable=False)]:
        """the same"""

    @property
    def snapshots(self) -> list[Velocities]:
        """those of the case; none of a run that was kept"""

class Batch:
    """Cases that run side by side and share their statics."""

    def __init__(self, threads: int, kept: str | os.PathLike | None) -> None:
        """kept: folder of the runs that are done."""

    def run(self, cases: Sequence[Case], folders: Sequence[str | os.PathLike | None], done: Callable) -> None:
        """
        Runs cases, but for those that were kept; writes each into its folder, if any; calls done(k, event) as case k is done.
        """

    @property
    def n_runs(self) -> int:
        """of all calls"""

    @property
    def n_quiet(self) -> int:
        """of them, those that ended before time.end_s since nothing moved"""

def event_of_history(case: Case, time_s: Annotated[NDArray[numpy.float64], dict(shape=(None,), order='C', device='cpu', writable=False)], x_m: Annotated[NDArray[numpy.float64], dict(shape=(None,), order='C', device='cpu', writable=False)], slip_rate_m_per_s: Annotated[NDArray[numpy.float64], dict(shape=(None, None), order='C', device='cpu', writable=False)], t_Pa: Annotated[NDArray[numpy.float64], dict(shape=(None, None), order='C', device='cpu', writable=False)], p_Pa: Annotated[NDArray[numpy.float64], dict(shape=(None, None), order='C', device='cpu', writable=False)], t_s_Pa: Annotated[NDArray[numpy.float64], dict(shape=(None,), order='C', device='cpu', writable=False)], p_s_Pa: Annotated[NDArray[numpy.float64], dict(shape=(None,), order='C', device='cpu', writable=False)], threshold_m_per_s: float, critical_shear_m: float) -> BatchEvent:
    """An event from a history of its interface and the tractions before it."""

class ResultFolder:
    """A folder of results, which come into it when they are complete."""

    def __init__(self, dir: str | os.PathLike, work: str) -> None:
        """work: only unfinished work of this kind is gone on with."""

    @property
    def unfinished(self) -> pathlib.Path:
        """where the work goes on"""

    @property
    def state(self) -> pathlib.Path:
        """what going on needs, no result"""

    def require_empty(self, overwrite: bool, resumes: bool) -> None: ...

    def begin_or_resume(self) -> None: ...

    def publish(self) -> None: ...

    def abandon(self) -> None: ...
