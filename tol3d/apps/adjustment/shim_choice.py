"""Measure and shims of a choice: those of a scene, and the scene with another thickness."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from itertools import chain, count
from math import sin
from typing import Final, Literal, get_args

from tol3d.apps.adjustment.stock import NO_SHIM, tidy
from tol3d.errors import InputError
from tol3d.gearing import BevelMeshSpec, Mesh, NormalBacklashSpec, ShimSpec
from tol3d.scene import MeasureEntry, Scene, hint, with_tolerances
from tol3d.statistics.distributions import (
    LOW_PROBABILITY,
    ConstantSpec,
    DistributionSpec,
    NormalSpec,
    TriangularSpec,
    TruncatedNormalSpec,
    UniformSpec,
)
from tol3d.study.runs import MeasureSummary, Sample
from tol3d.units import FACTORS, Quantity

MOVED_FIELDS: Final[Mapping[type[DistributionSpec], tuple[str, ...]]] = {
    ConstantSpec: ("value",),
    NormalSpec: ("lower", "upper", "mean"),
    UniformSpec: ("lower", "upper"),
    TriangularSpec: ("lower", "mode", "upper"),
    TruncatedNormalSpec: ("mean", "lower", "upper"),
}
"""The quantities of a law that move with its mean; the others say its spread."""

SPUR_PAIRS = "a shim moves a gear along its axis, which changes nothing of a spur pair"


@dataclass(frozen=True)
class Shim:
    """One shim of a scene, or one that is to be put there.

    Args:
        name: of its tolerance.
        spec: the tolerance; of a new shim one of no thickness.
        mean: its mean thickness in the scene [mm].
        closing: normal backlash that a thickness takes [mm/mm], to first order; negative in front of a gear.
        is_new: whether the scene has it not yet.
    """

    name: str
    spec: ShimSpec
    mean: float
    closing: float
    is_new: bool

    def of_thickness(self, thickness: float) -> ShimSpec:
        """Its tolerance with another mean thickness [mm], the spread as it was."""
        law = self.spec.distribution
        moved = {
            field: _longer(quantity, thickness - self.mean)
            for field, quantity in law.quantities().items()
            if field in MOVED_FIELDS[type(law)]
        }
        return self.spec.model_copy(update={"distribution": law.model_copy(update=moved)})


def _longer(quantity: Quantity, length: float) -> Quantity:
    """A length plus an increment [mm], in its own unit."""
    return Quantity(round(tidy(quantity.internal + length) / FACTORS["length"][quantity.unit], 9), quantity.unit)


def measure_of(scene: Scene, name: str | None) -> str:
    """The measure that is meant: the one of that name, or the only normal backlash of a bevel mesh.

    Raises:
        InputError: none, several, or one that shims do not change.
    """
    fitting = [own for own, spec in scene.measures.items() if not _unfit(scene, spec)]
    if name is None:
        if len(fitting) == 1:
            return fitting[0]
        listed = ", ".join(map(repr, fitting))
        got = f"several: say which by --measure: {listed}" if fitting else f"none; {SPUR_PAIRS}"
        raise InputError(f"{scene.scene}: expected one measure of the kind normal_backlash of a bevel mesh, got {got}")
    if name not in scene.measures:
        raise InputError(f"--measure: expected the name of a measure, got {name!r}{hint(name, fitting)}")
    if problem := _unfit(scene, scene.measures[name]):
        raise InputError(f"--measure: expected a normal_backlash of a bevel mesh, got {name!r}, {problem}")
    return name


def _unfit(scene: Scene, spec: MeasureEntry) -> str:
    """Reason why shims cannot be chosen for a measure, or nothing."""
    if not isinstance(spec, NormalBacklashSpec):
        return f"of the kind {spec.kind}"
    if not isinstance(scene.moves.get(spec.of), BevelMeshSpec):
        return f"of {spec.of!r}; {SPUR_PAIRS}"
    return f"which takes the {spec.take}" if spec.take in ("curve", "range") else ""


def mesh_of(scene: Scene, measure: str) -> str:
    """The mesh whose normal backlash a measure is."""
    spec = scene.measures[measure]
    if not isinstance(spec, NormalBacklashSpec):
        raise TypeError(f"{measure} is no normal backlash")
    return spec.of


def shims_of(scene: Scene, mesh: Mesh, names: Sequence[str]) -> tuple[Shim, ...]:
    """The shims whose thickness is looked for.

    Args:
        scene, mesh: where they are.
        names: shims of the scene, or gears behind which a new one is put; none: all shims that the scene has under
            the mesh's gears, or else one behind each gear.

    Raises:
        InputError: a name that is neither.
    """
    gears = (mesh.driver, mesh.driven)
    own = {name: spec for name, spec in scene.tolerances.items() if isinstance(spec, ShimSpec) and spec.of in gears}
    for name in names:
        if name not in own and name not in gears:
            known = (*own, *gears)
            words = "the names of shims of that mesh, or of its gears for a new shim behind each"
            raise InputError(f"--shims: expected {words}, got {name!r}{hint(name, known)}")
    chosen = dict.fromkeys(names or own or gears)
    return tuple(_shim(scene, mesh, name, own.get(name)) for name in chosen)


def _shim(scene: Scene, mesh: Mesh, name: str, spec: ShimSpec | None) -> Shim:
    """A shim of the scene, or where there is none a new one behind the gear of that name."""
    if spec is None:
        law = ConstantSpec(kind="constant", value=Quantity(NO_SHIM, "mm"))
        new = ShimSpec(kind="shim", of=name, side="behind", distribution=law)
        return Shim(_free_name(scene, f"{name} shim"), new, NO_SHIM, _closing(mesh, new), is_new=True)
    if type(spec.distribution) not in MOVED_FIELDS:
        known = [get_args(law.model_fields["kind"].annotation)[0] for law in MOVED_FIELDS]
        raise scene.refuse(
            ("tolerances", name, "distribution", "kind"),
            f"a thickness is looked for by moving its mean: expected one of {', '.join(known)}, "
            f"got {spec.distribution.kind}",
        )
    return Shim(name, spec, spec.distribution.resolve(scene.files).mean, _closing(mesh, spec), is_new=False)


def _free_name(scene: Scene, name: str) -> str:
    taken = {*scene.parts, *scene.tolerances, *scene.moves, *scene.measures}
    names = chain((name,), (f"{name} {number}" for number in count(2)))
    return next(own for own in names if own not in taken)


def _closing(mesh: Mesh, spec: ShimSpec) -> float:
    """2 sin(alpha_w) sin(delta) of the gear that it moves along its axis, towards the apex if behind.

    Of two shims behind equal gears at 90 deg that is 2 sqrt(2) sin(alpha) together.
    Source: Jiang et al., J. Zhejiang Univ. (Eng. Sci.) 58(8), 2024, 1533-1542, section 4; here for any cones.
    """
    towards_apex = 1 if spec.side == "behind" else -1
    return towards_apex * 2 * sin(mesh.pair.working_pressure_angle) * sin(mesh.gear(spec.of).pitch_angle)


def with_shims(scene: Scene, shims: Sequence[Shim], thickness: float) -> Scene:
    """The scene with these shims, all of the same mean thickness [mm]."""
    return with_tolerances(scene, {shim.name: shim.of_thickness(thickness) for shim in shims})


Minimum = Literal["low_3sigma", "p0.135", "sample_min"]

MINIMUM_WORDS: Final[Mapping[Minimum, str]] = {
    "low_3sigma": "mean − 3 sigma",
    "p0.135": "0.135 % quantile",
    "sample_min": "smallest of the trials",
}
UNMEASURED: Final[Mapping[Minimum, float]] = {"low_3sigma": 1.0, "p0.135": LOW_PROBABILITY, "sample_min": 0.0}
"""The share of builds that interfere, and have no backlash to measure, with which a minimum is still above nothing."""

BELOW_NOTHING: Final = -1e-3  # mm; for a minimum that is less than nothing by an unknown length: a search goes back
UM: Final = 1000.0  # um in a mm
MINIMUM_XTOL: Final = 5e-6  # mm of backlash; half of the 0.01 um that is promised, and what FCL rounds


@dataclass(frozen=True)
class Shimmed:
    """Results of a study with some shims.

    Args:
        thickness: of each shim [mm]; None for the scene as it stands.
        called: statistic that is called the minimum.
        measure: as summary.json shows it [um, arcmin].
        found: its results by 3D simulation.
        trials: number of builds.
    """

    thickness: float | None
    called: Minimum
    measure: MeasureSummary
    found: Sample
    trials: int

    @property
    def minimum(self) -> float:
        """The number that is called so [mm]; the smallest of the trials is the deepest jam where any is jammed."""
        minimum = (self.found.value(self.called) or 0.0) / UM
        if self.failed <= UNMEASURED[self.called] * self.trials:
            return minimum
        deepest = self.found.deepest_overlap
        return min(minimum, deepest / UM if self.called == "sample_min" and deepest is not None else BELOW_NOTHING)

    @property
    def failed(self) -> int:
        """Trials without a backlash to measure; its statistics are those of the others."""
        return self.trials - self.found.count

    @property
    def resolution(self) -> float:
        """Accuracy to which the minimum can be met [mm]: a quantile is resolved to a bin of the study's histogram."""
        bin_width = self.found.quantile_error / UM if self.called == "p0.135" else 0.0
        return max(MINIMUM_XTOL, bin_width)

    @property
    def sampling_error(self) -> float | None:
        """Standard error of mean - 3 sigma [mm], as of independent mean and sigma; None for another minimum."""
        mean, sigma = self.found.mean_se, self.found.sigma_se
        if self.called != "low_3sigma" or mean is None or sigma is None:
            return None
        return math.hypot(mean, 3 * sigma) / UM
