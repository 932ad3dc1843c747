"""Sizes of features without a tolerance of their own, which take the general one of their scene."""

from collections.abc import Iterator, Mapping
from typing import Any

from tol3d.assembly.grammar.drawing import Drawing
from tol3d.assembly.grammar.parts import SolidSpec
from tol3d.assembly.grammar.tolerances.location import ProfileSpec
from tol3d.assembly.grammar.tolerances.plus_minus import SizeSpec
from tol3d.scene import Scene


def general_sizes(scene: Scene) -> Iterator[tuple[str, Mapping[str, Any]]]:
    """A tolerance for each diameter or width stated in numbers, as general tolerance of its nominal size.

    Sizes with a tolerance or a profile of their own keep it; sizes read from a solid are left out.
    """
    drawing = Drawing(scene)
    for part, solid in scene.of(SolidSpec).items():
        for name, spec in solid.features.items():
            nominal = getattr(spec, "width" if spec.kind == "slot" else "diameter", None)
            if spec.kind not in SizeSpec.applies_to or nominal is None:
                continue
            own = [f"{part}.{member}" for member in spec.members(name)]
            if not any(drawing.of(feature, kind) for feature in own for kind in (SizeSpec, ProfileSpec)):
                law = {"general": scene.general_sizes, "of": str(nominal)}
                yield f"size of {part} {name}", {"kind": "size", "of": f"{part}.{name}", "distribution": law}
