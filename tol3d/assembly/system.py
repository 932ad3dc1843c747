"""System of an assembly for studies: two methods, contributors of a measure, closed forms."""

import math
from collections.abc import Callable, Hashable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import Any, ClassVar, Final, TypeVar

import numpy as np
from numpy.typing import NDArray
from typing_extensions import override

from tol3d.assembly.at_rest import at_rest
from tol3d.assembly.clearances.prepared import clearances_of, reader_of, solid_pairs, with_facing, witness_of
from tol3d.assembly.from_scene import Meant, Understood, meant, understood
from tol3d.assembly.from_scene.datums import place_of
from tol3d.assembly.from_scene.features import poses_of
from tol3d.assembly.from_scene.idle import idle_forms
from tol3d.assembly.grammar.checks import pose_names
from tol3d.assembly.grammar.drawing import Drawing
from tol3d.assembly.grammar.measures.pose_errors import DirectionErrorSpec, PoseErrorSpec
from tol3d.assembly.methods import PlacingMethod, TorsorMethod
from tol3d.assembly.model import Assembly
from tol3d.assembly.model.statuses import OK, STATUSES, WITH_CLEARANCES
from tol3d.assembly.moments import moments_of, widely
from tol3d.assembly.placing import method as placing
from tol3d.assembly.placing.plan import planned
from tol3d.assembly.placing.poses import Codes
from tol3d.assembly.torsors import method as torsors
from tol3d.assembly.torsors.first_order import Slopes
from tol3d.assembly.witnessed import reads
from tol3d.assembly.zones import EnvelopedForm, ZoneDraw, laws_told
from tol3d.errors import InputError
from tol3d.numerics.arrays import Array
from tol3d.numerics.kept import kept
from tol3d.scene import Scene
from tol3d.scene.schema import SECTIONS
from tol3d.study.system.closed_form import ClosedForm, Share
from tol3d.study.system.contributor import Contributor
from tol3d.study.system.measure import Measure
from tol3d.study.system.method import ANALYTIC_METHOD, Method, MethodKind
from tol3d.study.system.outcome import Statuses
from tol3d.study.system.plain import PlainSystem
from tol3d.study.system.regressors import is_group
from tol3d.study.system.stated import component_slices
from tol3d.study.system.system import Columns, KeyPath

T = TypeVar("T")
Words = NDArray[np.str_]

SETTLINGS: Final = 6
"""Times at most that parts are placed without deviations; each leaves a turn's share of the change."""
SETTLED: Final = 1e-12
"""Change of a pose [mm, rad] after which it stays."""
SAME: Final = 1e-6
"""mm or rad; largest nominal difference of the methods; it is larger if moves do not place parts as drawn."""

WITNESS: Final = "fcl"
MESHED_WITNESS: Final = MethodKind("solids and their meshes", threads=False, witness=True, contacts_per_minute=60_000)
FINER: Final = 0.25
"""Fraction of the stated chord error: that of meshes of half the step."""

FRAME: Final = "datum frame "
"""Beginning of the methods' messages on a datum frame; others begin with a place in the scene."""

FLAT: Final = 1e-6
"""Slope of a measure that counts as none: both sides of the mean raise it alike."""


@dataclass(frozen=True)
class AssemblySystem(PlainSystem):
    """Implements System.

    Args:
        assembly: nominally, and by its drawings.
        named: by measure, its features, or two measures.
        idle: sentences on tolerances that act on nothing.
        components: by measure of an error of place or turn, the component read.
        second_order: nominal difference of the methods that pushed parts explain [mm].
    """

    assembly: Assembly
    named: Mapping[str, tuple[str, ...]]
    idle: tuple[str, ...] = ()
    components: Mapping[str, str] = field(default_factory=dict)
    second_order: float = 0.0

    statuses: ClassVar[Statuses] = STATUSES

    def method(self, name: str, materials: Any) -> Method:
        return TorsorMethod(self.assembly) if name == ANALYTIC_METHOD else PlacingMethod(self.assembly)

    @property
    @override
    def warnings(self) -> Sequence[str]:  # type: ignore[override]
        """See System."""
        return self.idle

    @property
    def _exact_at_rest(self) -> Mapping[str, tuple[Array, Codes]]:
        """Values and codes (1,) of all measures without deviations, by the exact method."""
        return at_rest(self.assembly).exact

    def describe(self, measure: Measure) -> Mapping[str, Any]:
        """Its kind, its features, and the laws of deviations in the zones that act on it."""
        laws = laws_told(own for own in self.acting(measure) if isinstance(own.draw, ZoneDraw))
        of, component = self.named[measure.name], self.components.get(measure.name)
        return {**super().describe(measure), "of": list(of), **({"component": component} if component else {}), **laws}

    def problems(self) -> Iterator[tuple[KeyPath, str]]:
        """Measures of the nominal assembly that the methods read differently, or not at all."""
        exact, linear = self._exact_at_rest, at_rest(self.assembly).linear
        for measure in self.measures:
            (value,), (code,) = exact[measure.name]
            if code != OK:
                text = self.statuses.texts[code]
                yield ("measures", measure.name), f"cannot be read even without deviations: {text}"
            elif self.assembly.measures[measure.name].over_play is not None or measure.kind == "slack":
                continue  # it depends on the whole clearance, not on `placed`: a second-order difference
            elif abs(value - linear[measure.name][0]) > (
                SAME + self.second_order + self.assembly.measures[measure.name].chord_error
            ):
                off = abs(value - linear[measure.name][0]) * measure.per_internal
                words = (
                    f"moves place parts elsewhere than `placed` states, by {off:.3g} {measure.unit} in this measure; "
                    "state the final places of parts and fixtures"
                )
                yield ("measures", measure.name), words

    def acting(self, measure: Measure) -> Sequence[Contributor]:
        """Contributors with a slope, or read by a nonlinear term."""
        return self._acting_on(measure.name)

    @kept
    def _acting_on(self, name: str) -> Sequence[Contributor]:
        slopes = self.slopes_of(name)
        acts = slopes.coefficients != 0.0
        acts[list(slopes.bent)] = True
        slices = component_slices(self).values()
        touched = np.add.reduceat(acts, [own.start for own in slices]) if len(acts) else ()
        return [own for own, any_of in zip(self.contributors, touched, strict=True) if any_of]

    def regressor_key(self, measure: Measure) -> Hashable:
        """As of any system; also which components are squared."""
        return super().regressor_key(measure), self.squared(self.slopes_of(measure.name))

    @staticmethod
    def squared(slopes: Slopes) -> tuple[int, ...]:
        """Columns that raise a measure to both sides of their mean."""
        return tuple(place for place in slopes.bent if abs(slopes.coefficients[place]) < FLAT)

    def regress(
        self, measure: Measure, contributors: Sequence[Contributor], columns: Columns, rows: Mapping[str, Array]
    ) -> None:
        """Each component of a zone over its own sigma, squared where the measure takes its size; others as ever."""
        others, squared, slices = [], self.squared(self.slopes_of(measure.name)), component_slices(self)
        for contributor in contributors:
            draw = contributor.draw
            if not isinstance(draw, ZoneDraw) or len(draw.components) == 1 or is_group(contributor):
                others.append(contributor)
                continue
            places = range(*slices[contributor.name].indices(self.assembly.width))
            for row, name, mean, sigma, place in zip(
                rows[contributor.name], contributor.columns, draw.mean_vector, draw.sigmas, places, strict=True
            ):
                np.multiply(np.asarray(columns[name], dtype=np.float64), contributor.per_unit / (sigma or 1.0), out=row)
                if place in squared:
                    np.subtract(row, mean / (sigma or 1.0), out=row)
                    np.square(row, out=row)
        super().regress(measure, others, columns, rows)

    def closed_form(self, measure: Measure) -> ClosedForm | None:
        """Closed form by torsors; None if the measure is not linear in them."""
        return self._form_of(measure.name) if self.is_linear(measure) else None

    @kept
    def _form_of(self, name: str) -> ClosedForm:
        slopes = self.slopes_of(name)
        slices = component_slices(self)
        shares: list[Share] = []
        for own in self._acting_on(name):
            coefficients = slopes.coefficients[slices[own.name]]
            mean, covariance = moments_of(own)
            size = float(coefficients[0]) if len(coefficients) == 1 else float(np.sqrt(coefficients @ coefficients))
            variance = float(coefficients @ covariance @ coefficients)
            shares.append(Share(own.name, size, float(coefficients @ mean), variance))
        middle = slopes.nominal + sum(share.mean for share in shares)
        sigma = math.sqrt(sum(share.variance for share in shares))
        return ClosedForm(slopes.nominal, middle, sigma, tuple(shares))

    def is_linear(self, measure: Measure) -> bool:
        """True if a measure is linear in all deviations by the analytic method, which then has a closed form.

        A form within the envelope of a size goes with the size, so that their variances do not add up.
        """
        if torsors.is_bent(self.assembly, measure.name):
            return False
        if not any(isinstance(contributor.draw, EnvelopedForm) for contributor in self.contributors):
            return True
        return not any(isinstance(own.draw, EnvelopedForm) for own in self.acting(measure))

    @kept
    def slopes_of(self, name: str) -> Slopes:
        """Slopes of a measure of the assembly for each deviation, at the means."""
        return torsors.slopes(self.assembly, name, *self._moments)

    @cached_property
    def _moments(self) -> tuple[Array, Array]:
        """Means and sigmas of all components (columns,) [mm, K]."""
        moments = [moments_of(contributor) for contributor in self.contributors]
        means = np.concatenate([mean for mean, _ in moments] or [np.zeros(0)])
        return means, np.concatenate([np.sqrt(np.diagonal(covariance)) for _, covariance in moments] or [np.zeros(0)])


class WitnessedSystem(AssemblySystem):
    """An assembly with measures that FCL reads too."""

    methods: ClassVar[Mapping[str, MethodKind]] = {**PlainSystem.methods, WITNESS: MESHED_WITNESS}

    def materials(self, method: str) -> Any:
        """See System: of the witness pairs of solids by measure, and those of half the step."""
        return (solid_pairs(self.assembly), solid_pairs(self.assembly, FINER)) if method == WITNESS else None

    def method(self, name: str, materials: Any) -> Method:
        return witness_of(self.assembly, *materials) if name == WITNESS else super().method(name, materials)


class ClearanceSystem(WitnessedSystem):
    """An assembly with clearances of whole parts, whose solids are meshed once."""

    statuses: ClassVar[Statuses] = WITH_CLEARANCES
    methods: ClassVar[Mapping[str, MethodKind]] = {
        ANALYTIC_METHOD: MethodKind("model"),
        "exact": replace(MESHED_WITNESS, witness=False),
        WITNESS: MESHED_WITNESS,
    }

    def materials(self, method: str) -> Any:
        """See System: of the exact method pairs of solids, by measure."""
        return solid_pairs(self.assembly) if method == "exact" else super().materials(method)

    def method(self, name: str, materials: Any) -> Method:
        if name != "exact":
            return super().method(name, materials)
        error = max(pair.chord_error for pair in materials.values())
        return PlacingMethod(self.assembly, reader_of(materials), error)

    @property
    def _exact_at_rest(self) -> Mapping[str, tuple[Array, Codes]]:
        rest, names = np.zeros((1, self.assembly.width)), list(self.assembly.measures)
        return placing.values(self.assembly, rest, names, reader_of(solid_pairs(self.assembly)))

    def describe(self, measure: Measure) -> Mapping[str, Any]:
        """Also the chord error of a clearance that is stated, and that of its meshes."""
        found = super().describe(measure)
        pair = solid_pairs(self.assembly).get(measure.name)
        if pair is None:
            return found
        stated = self.assembly.measures[measure.name].chord_error
        return {**found, "chord_error_um": 1000 * stated, "mesh_error_um": 1000 * pair.chord_error}

    def chord_bound(self, measure: Measure, chord_error: float) -> float:
        """See System: what is stated, of a clearance."""
        return self.assembly.measures[measure.name].chord_error * measure.per_internal


def assembly_system(scene: Scene, pose: str = "", meaning: Understood | None = None) -> AssemblySystem:
    """System of a scene of an assembly.

    Args:
        scene: the scene.
        pose: pose for moves that have poses, with the measures read in it; "" for the first.
        meaning: its drawings and measures, if known already.

    Raises:
        SceneError: the scene is inconsistent, such as moves that leave a part free.
    """
    pose = pose or next(iter(pose_names(scene)), "")
    known = meaning or meaning_of(scene)
    placed = _asked(scene, lambda: _settled(scene, pose, known))
    for miss in at_rest(placed.assembly).misses:
        raise scene.refuse(("moves", miss.move, "relations", miss.number), miss.sentence)
    kind = _kind_of(placed.assembly)
    assembly = at_rest(_asked(scene, lambda: _faced(placed))).assembly
    idle = tuple(idle_forms(Drawing(scene)))
    made = kind(
        scene.scene, placed.contributors, placed.measures, assembly, placed.named, idle, _components(scene),
        placed.second_order,
    )  # fmt: skip
    _asked(scene, lambda: at_rest(assembly).linear)
    measures = _asked(
        scene, lambda: tuple(replace(measure, adds_up=made.is_linear(measure)) for measure in made.measures)
    )
    return replace(made, measures=measures)


def meaning_of(scene: Scene) -> Understood:
    """Drawings and measures of a scene of an assembly.

    Raises:
        SceneError: see `understood`.
    """
    return _asked(scene, lambda: understood(scene))


def _components(scene: Scene) -> Mapping[str, str]:
    return {
        name: spec.component
        for name, spec in scene.measures.items()
        if isinstance(spec, PoseErrorSpec | DirectionErrorSpec)
    }


def _kind_of(assembly: Assembly) -> type[AssemblySystem]:
    """By what FCL reads of it."""
    if clearances_of(assembly):
        return ClearanceSystem
    return WitnessedSystem if any(reads(assembly, name) for name in assembly.measures) else AssemblySystem


def _faced(placed: Meant) -> Assembly:
    """The assembly, with the nearest places of parts with a measured clearance."""
    bare = replace(placed.assembly, measures={})

    def motions(part: str, after: int) -> Array:
        return torsors.displacements(bare, part, after, widely(placed.contributors))

    return with_facing(placed.assembly, motions)


def _settled(scene: Scene, pose: str, meaning: Understood) -> Meant:
    """Model of a scene, with parts where its moves place them without deviations.

    A part that cannot be placed so, such as by pins beside their holes, stays as drawn. Of a part that is pushed, where
    it lies decides by second order how it lies: until that is met.
    """
    poses = poses_of(scene)
    made = drawn = meant(meaning, poses, pose)
    for n in range(SETTLINGS):
        settled = at_rest(made.assembly).poses
        off = max((float(np.abs(pose - poses[name]).max()) for name, pose in settled.items()), default=0.0)
        if off <= (SETTLED if n else 0.0):
            break  # the first with its cached properties
        poses = {**poses, **settled}
        made = meant(meaning, poses, pose)
        if not any(move.is_pushed for move in made.assembly.moves):
            break
        made = _pushed_alike(made, drawn)
    return made


def _pushed_alike(settled: Meant, drawn: Meant) -> Meant:
    """The settled model, its parts pushed in the directions of the drawn one: a push does not turn itself."""
    moves, second_order = list(settled.assembly.moves), 0.0
    for k, room in planned(drawn.assembly).rooms.items():
        if room.move.is_pushed:
            moves[k], gone = room.pushed_alike(moves[k], settled.assembly)
            second_order += gone
    return replace(settled, assembly=replace(settled.assembly, moves=tuple(moves)), second_order=second_order)


def _asked(scene: Scene, ask: Callable[[], T]) -> T:
    try:
        return ask()
    except InputError as error:
        place, _, sentence = str(error).partition(": ")
        section, _, name = place.partition(".")
        if place.startswith(FRAME):
            path = place_of(scene, place.removeprefix(FRAME))
        else:
            path = (section, name) if section in SECTIONS and name in scene.section(section) else ()
        if not path:
            raise
        raise scene.refuse(path, sentence) from None
