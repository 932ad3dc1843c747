"""Teeth that are much thinner or thicker than they are drawn: warned of, and refused where nothing is left of a tip."""

from collections.abc import Iterator, Mapping
from typing import Final

from tol3d.gearing.grammar.tolerances import ToothThicknessSpec
from tol3d.gears import Gear
from tol3d.scene import Scene
from tol3d.scene.implausible import Implausible, farthest, warned
from tol3d.scene.place import KeyPath

THICKNESS: Final = Implausible(0.1, "write how much thicker than nominal the tooth is, and look at the unit")


def implausible_teeth(scene: Scene, gears: Mapping[str, Gear]) -> Iterator[str]:
    """Warnings of tooth thicknesses off by more than a tenth.

    Args:
        scene: with the tolerances.
        gears: by their names, nominal; tolerances of others are left out.

    Raises:
        SceneError: a tooth is thinned until its flanks meet at the tip, or beyond.
    """
    for name, spec in scene.of(ToothThicknessSpec).items():
        if (gear := gears.get(spec.of)) is None:
            continue
        law = spec.distribution.resolve(scene.files)
        arc = gear.thickness_radius / gear.section_arm if spec.measured == "normal" else 1.0
        path: KeyPath = ("tolerances", name, "distribution")
        thinnest, left = law.extremes[0] * arc, gear.section_thickness
        if -thinnest >= gear.section_tip:
            words = f"expected teeth of {spec.of!r} ({left:.4g} mm thick) that are thinner by less than "
            words += f"{gear.section_tip:.4g} mm, where their flanks meet at the tip, got {thinnest:.4g} mm"
            raise scene.refuse(path, f"{words}; {THICKNESS.advice}")
        if sentence := THICKNESS.sentence(f"the tooth thickness of {spec.of!r}", left, farthest(law) * arc):
            yield warned(path, sentence)
