"""Tolerances of planetary sets: their kinds, effects and draws."""

import math
from dataclasses import dataclass, replace
from typing import Any, ClassVar, Final, Self

import numpy as np
from numpy.typing import NDArray

from tol3d.assembly.from_scene.zones import drawn_by
from tol3d.assembly.zones import Process
from tol3d.assembly.zones.catalogue import axis_section
from tol3d.assembly.zones.zone_draw import ZoneDraw
from tol3d.gearing.grammar.parts import GearSpec, InternalGearSpec
from tol3d.gearing.grammar.tolerances.axial_play import AxialPlaySpec
from tol3d.gearing.grammar.tolerances.composite import ToothRunOutSpec
from tol3d.gearing.grammar.tolerances.gears import ClockingSpec, EccentricitySpec, ToothThicknessSpec
from tol3d.gearing.planetary.grammar.parts import PlanetSpec
from tol3d.gearing.planetary.grammar.tolerances import BorePositionSpec, PlanetPinSpec
from tol3d.gearing.planetary.model.planetary_set import PlanetarySet
from tol3d.gearing.reducers.deviations import Acts
from tol3d.gearing.reducers.from_scene import drawn, law_of, numbered
from tol3d.numerics.arrays import Array
from tol3d.scene import Scene
from tol3d.scene.direction import At
from tol3d.scene.entry import kind_of
from tol3d.statistics.distributions import DeviationLaw, Distribution
from tol3d.study.system.draw import Draw
from tol3d.study.system.each_planar import EachOwn, parts_of
from tol3d.study.system.steepest import Values, steepest_ends


@dataclass(frozen=True)
class EachZone(EachOwn):
    """Displacements of all planets [mm], each in a zone of its own: radial and tangential, planet by planet.

    Args:
        each: draw of one planet, of two components.
        names: of the planets.
    """

    axes: ClassVar[tuple[str, str]] = ("radial", "tangential")

    each: ZoneDraw
    names: tuple[str, ...]

    @property
    def distribution(self) -> DeviationLaw:
        """Distribution of one component."""
        return self.each.distribution

    @property
    def words(self) -> str:
        """See JointDraw."""
        return f"{self.each.words}, each of {len(self.names)}"

    @property
    def covariance(self) -> Array:
        """See JointDraw: planets are independent."""
        return np.asarray(np.kron(np.eye(len(self.names)), self.each.covariance), dtype=np.float64)

    @property
    def width(self) -> float:
        """See Zoned."""
        return self.each.width

    def sized(self, width: float) -> Self:
        """See Zoned: all of them."""
        return replace(self, each=self.each.sized(width))

    def scaled(self, factor: float) -> Self:
        """See Scalable: all of them."""
        return replace(self, each=self.each.scaled(factor))

    def ends(self, values: Values, *, turning: bool) -> Array:
        """See Draw: all planets along the steepest direction, as far as one alone reaches along it.

        All bores at their worst ends together would be far rarer than one at its end.
        """
        steps, mean = np.sqrt(np.diagonal(self.covariance)), np.array(self.mean(turning=False))
        return steepest_ends(values, mean, steps, self._reach)

    def _reach(self, slopes: Array) -> Array:
        """Components at the end along slopes: each planet at |its slopes| / |all slopes| of its own reach."""
        middle = np.array(self.each.mean(turning=False))
        size = float(np.sqrt((slopes * slopes).sum())) or 1.0
        ends = [
            middle + float(np.sqrt((planet * planet).sum())) / size * (self.each.furthest(planet) - middle)
            for planet in slopes.reshape(len(self.names), -1)
        ]
        return np.concatenate(ends)


@dataclass(frozen=True)
class EachJudgedZone(EachZone):
    """Displacements of all planets by a process; zones only judge them."""

    each: Process

    def with_law(self, law: Distribution) -> Self:
        """See Lawful: all of them."""
        return replace(self, each=self.each.with_law(law))

    def beyond(self, *components: Array) -> NDArray[np.bool_]:
        """See JudgedDraw: True where any bore lies outside its zone."""
        outside = [~self.each.zone.inside(np.stack(bore, axis=-1)) for bore in parts_of(components, 2)]
        return np.asarray(np.any(outside, axis=0))


KINDS: Final = (
    ToothThicknessSpec, EccentricitySpec, ToothRunOutSpec, ClockingSpec, AxialPlaySpec, PlanetPinSpec, BorePositionSpec
)  # fmt: skip
"""Kinds of tolerances of planetary sets; those of gears are shared with trains."""


def acts_of(scene: Scene, planetary_set: PlanetarySet, name: str, spec: Any) -> Acts:
    """Effect of a tolerance on the set.

    Raises:
        SceneError: of a kind that does not act on planetary sets, or of a part that is not in this one.
    """
    if not isinstance(spec, KINDS):
        words = ", ".join(str(kind_of(kind)) for kind in KINDS)
        sentence = f"expected of planetary sets {words}, got {kind_of(type(spec))}"
        raise scene.refuse(("tolerances", name, "kind"), sentence)
    if isinstance(spec, PlanetPinSpec | BorePositionSpec):
        if spec.of != planetary_set.carrier:
            raise scene.refuse(("tolerances", name, "of"), f"expected {planetary_set.carrier!r}, got {spec.of!r}")
        effects = {"radial": "pin outwards", "tangential": "pin round"}
        return Acts("pin" if isinstance(spec, BorePositionSpec) else effects.get(spec.direction, "pin"))
    if isinstance(spec, AxialPlaySpec):
        return _slide(scene, planetary_set, name, spec)
    known = [mesh.central.name for mesh in planetary_set.meshes] + [gear.name for gear in planetary_set.gears]
    if spec.of not in known:
        raise scene.refuse(("tolerances", name, "of"), f"expected a gear of {planetary_set.name!r}, got {spec.of!r}")
    if isinstance(spec, ToothThicknessSpec):
        part = scene.parts[spec.of]
        assert isinstance(part, GearSpec)
        arc_per_stated = 1 / math.cos(part.pressure_angle.internal) if spec.is_normal else 1.0
        factor = spec.sign_in(ring=isinstance(part, InternalGearSpec)) * arc_per_stated
        return Acts("thickness", spec.of, factor, spec.over)
    return Acts("clocking" if isinstance(spec, ClockingSpec) else "offset", spec.of)


def _slide(scene: Scene, own: PlanetarySet, name: str, spec: AxialPlaySpec) -> Acts:
    """Effect of an axial play of a shaft, or of each planet."""
    if spec.of in own.shafts:
        return Acts("slide", spec.of, least=0.0)
    if isinstance(scene.parts[spec.of], PlanetSpec):
        if len(own.unlike_leads) > 1:
            unlike = ", ".join(own.meshes[m].name for m in own.unlike_leads)
            words = f"expected planets with one lead in all meshes but one, got {spec.of!r} with others in {unlike}"
            raise scene.refuse(("tolerances", name, "of"), f"{words}; hold the planets along their pins")
        return Acts("slide", least=0.0)
    words = f"expected the planet, {', '.join(own.shafts[:-1])} or {own.shafts[-1]}, got {spec.of!r}"
    raise scene.refuse(("tolerances", name, "of"), words)


def draw_of(scene: Scene, planetary_set: PlanetarySet, acts: Acts, spec: Any) -> Draw:
    """Draw of a tolerance's components: of planets, pins and bores an independent one each."""
    planets = numbered("planet", planetary_set.planets)
    if isinstance(spec, BorePositionSpec):  # its axis parallel to the set's
        draw = drawn_by(spec.law, axis_section(spec.zone.diameter.internal), scene.files)
        return EachJudgedZone(draw, planets) if isinstance(draw, Process) else EachZone(draw, planets)
    of_planets = not acts.gear or acts.gear in {gear.name for gear in planetary_set.gears}
    at = getattr(spec, "direction", None)
    direction = at.at.internal if isinstance(at, At) else None
    planar = acts.effect in ("offset", "pin")
    return drawn(law_of(scene, spec), planets if of_planets else (), planar=planar, direction=direction)
