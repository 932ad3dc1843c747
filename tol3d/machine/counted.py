"""Deviations that a scene counts twice: those of axes that bores give, and tolerances that state them again."""

from collections.abc import Iterator

from tol3d.assembly.grammar.feature_name import part_of
from tol3d.assembly.grammar.parts import SolidSpec, likes
from tol3d.assembly.grammar.tolerances.feature_tolerance import FeatureTolerance
from tol3d.assembly.grammar.tolerances.plus_minus import SizeSpec
from tol3d.gearing.grammar.parts import BearingSpec
from tol3d.gearing.grammar.tolerances.bearing_clearance import BearingClearanceSpec
from tol3d.gearing.grammar.tolerances.gearing_tolerance import MeshToleranceSpec
from tol3d.machine.grammar.shaft_in_bores import ShaftInBoresSpec
from tol3d.machine.system import MachineSystem
from tol3d.scene import Scene


def refuse_counted_twice(scene: Scene, system: MachineSystem) -> None:
    """Refuse tolerances of axes that deviate as bores do already, and bore sizes beside bearing clearances.

    Raises:
        SceneError: at the tolerance of the gears, naming the other one.
    """
    for name, spec in scene.tolerances.items():
        if isinstance(spec, MeshToleranceSpec):
            for other in system.moving_apart(spec.of):
                words = f"expected no {spec.kind} of {spec.of!r}, for {other!r} moves the bores of its shafts"
                raise scene.refuse(("tolerances", name), f"{words} already, and both would count; take out one")
        elif isinstance(spec, BearingClearanceSpec):
            for other in _sizes(scene, spec):
                words = (
                    f"expected no clearance beside {other!r}, the size of a bore of the same shaft, for both say how "
                )
                raise scene.refuse(("tolerances", name), f"{words}loose it is; take out one")


def _sizes(scene: Scene, spec: BearingClearanceSpec) -> Iterator[str]:
    """Tolerances of the sizes of the bores of a shaft."""
    part = scene.parts[spec.of]
    gear = part.shaft if isinstance(part, BearingSpec) else spec.of
    carrying = (name for name, own in scene.parts.items() if gear in getattr(own, "carries", {}))
    shaft = next(carrying, gear)
    bores = {bore for move in scene.of(ShaftInBoresSpec).values() if move.shaft == shaft for bore in move.in_}
    modified = {own.of for own in scene.of(FeatureTolerance).values() if getattr(own, "modifier", None)}
    for name, size in scene.of(SizeSpec).items():
        if size.of in modified:
            continue  # it widens a zone
        if size.of in bores or any(_is_copy(scene, bore, size.of) for bore in bores):
            yield name


def _is_copy(scene: Scene, bore: str, original: str) -> bool:
    """True if a bore belongs to a part identical to the toleranced one."""
    solids, feature = scene.of(SolidSpec), bore.partition(".")[2]
    others = likes(part_of(bore), solids)[1:] if part_of(bore) in solids else ()
    return any(f"{own}.{feature}" == original for own in others)
