"""Effect of each tolerance on an RV reducer, and the draw of its components."""

import math
from itertools import product
from typing import Any

from tol3d.gearing.cycloid.grammar.tolerances import (
    BearingPlaySpec,
    CarrierBearingSpec,
    CarrierHoleSpec,
    CrankEccentricitySpec,
    CrankPhaseSpec,
    DiscEccentricitySpec,
    DiscHoleSpec,
    DiscTiltSpec,
    LobePitchSpec,
    LobeProfileSpec,
    PinCircleSpec,
    PinPositionSpec,
    PinRadiusSpec,
    PinRingOffsetSpec,
)
from tol3d.gearing.cycloid.reducer.deviated import EFFECTS
from tol3d.gearing.cycloid.reducer.rv_set import RVSet
from tol3d.gearing.grammar.tolerances.composite import ToothRunOutSpec
from tol3d.gearing.grammar.tolerances.gears import EccentricitySpec, TeethOffAxisSpec, ToothThicknessSpec
from tol3d.gearing.reducers.deviations import Acts
from tol3d.gearing.reducers.from_scene import drawn, law_of, numbered
from tol3d.scene import Scene
from tol3d.scene.direction import At
from tol3d.scene.entry import kind_of
from tol3d.study.system.draw import Draw

OF_THE_STAGE: dict[type, str] = {
    PinCircleSpec: "pin circle",
    PinRingOffsetSpec: "pin ring",
    PinRadiusSpec: "pin radius",
    LobePitchSpec: "lobe pitch",
    LobeProfileSpec: "lobe profile",
    DiscEccentricitySpec: "disc offset",
    DiscHoleSpec: "disc hole",
    DiscTiltSpec: "disc tilt",
    CrankPhaseSpec: "crank phase",
    CarrierBearingSpec: "carrier offset",
}
OF_GEARS = (ToothThicknessSpec, EccentricitySpec, ToothRunOutSpec)
OF_A_CHOICE = (PinPositionSpec, CrankEccentricitySpec, CarrierHoleSpec, BearingPlaySpec)


def acts_of(scene: Scene, rv_set: RVSet, name: str, spec: Any) -> Acts:
    """Effect of a tolerance on the reducer.

    Raises:
        SceneError: it acts on nothing of an RV reducer, or on something not stated.
    """
    if isinstance(spec, DiscTiltSpec) and rv_set.width is None:
        words = f"expected the width of the disc, over which it tilts by {name!r}, such as 'width: 20 mm'; got none"
        raise scene.refuse(("parts", rv_set.disc), words)
    if type(spec) in OF_THE_STAGE:
        return Acts(OF_THE_STAGE[type(spec)])
    if isinstance(spec, PinPositionSpec):
        directions = {"radial": "pin outwards", "tangential": "pin round", "random": "pin place"}
        return Acts(directions[spec.direction])
    if isinstance(spec, CrankEccentricitySpec):
        return Acts("crank throw" if spec.each == "crank" else "crank throw of a disc")
    if isinstance(spec, CarrierHoleSpec):
        return Acts("carrier hole" if spec.each == "hole" else "carrier circle")
    if isinstance(spec, BearingPlaySpec):
        return Acts("disc play" if spec.of == rv_set.disc else "carrier play", least=0.0)
    if isinstance(spec, OF_GEARS):
        return _of_a_gear(scene, rv_set, name, spec)
    words = ", ".join(str(kind_of(kind)) for kind in (*OF_THE_STAGE, *OF_A_CHOICE, *OF_GEARS))
    sentence = f"expected of an RV reducer one of {words}, got {kind_of(type(spec))}"
    raise scene.refuse(("tolerances", name, "kind"), sentence)


def _of_a_gear(scene: Scene, rv_set: RVSet, name: str, spec: ToothThicknessSpec | TeethOffAxisSpec) -> Acts:
    first = rv_set.first
    assert first is not None  # other gears take part in no move
    of_sun = spec.of == first.sun
    if isinstance(spec, TeethOffAxisSpec):
        if isinstance(spec.direction, At):
            words = "expected random: how a gear's teeth are turned on its shaft is not stated, got {at: ...}"
            raise scene.refuse(("tolerances", name, "direction"), words)
        return Acts("sun offset" if of_sun else "planet offset", spec.of)
    counted = 1 / math.cos(first.pair.pinion.pressure_angle) if spec.is_normal else 1.0
    return Acts("sun thickness" if of_sun else "planet thickness", spec.of, counted, spec.over)


def draw_of(scene: Scene, rv_set: RVSet, acts: Acts, spec: Any) -> Draw:
    """Draw of the components of a tolerance."""
    reach, profile = EFFECTS[acts.effect], rv_set.profile
    counts = {"pin": profile.pins, "lobe": profile.lobes, "disc": rv_set.discs}
    each = [numbered(word, counts.get(word, rv_set.cranks)) for word in reach.each if word]
    return drawn(law_of(scene, spec), tuple(map(" ".join, product(*each))) if each else (), planar=reach.planar)
