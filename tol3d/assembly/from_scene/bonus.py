"""The size that widens a zone or counts against a measure, by a material modifier."""

from tol3d.assembly.grammar.drawing import Drawing
from tol3d.assembly.grammar.tolerances import SizeSpec
from tol3d.assembly.model import Axis, Slot
from tol3d.assembly.model.bonus import Modifier
from tol3d.assembly.zones import Bonus, SizedBy
from tol3d.scene import Scene


def sized_by(scene: Scene, drawing: Drawing, feature: str, modifier: Modifier) -> SizedBy:
    """The size of a feature that has a tolerance of it, and its bonus.

    Raises:
        SceneError: its distribution has no limits and none are stated, so that there is no material condition.
    """
    (own,) = drawing.of(feature, SizeSpec)
    spec, shape = own.spec, drawing.kind(feature).shape
    assert isinstance(spec, SizeSpec)
    assert isinstance(shape, Axis | Slot)
    law = spec.distribution.resolve(scene.files)
    limits = law.limits if spec.limits is None else tuple(own.internal for own in spec.limits)
    if limits is None:
        words = "expected the drawing's limits of size, such as [0 um, 15 um], from which the bonus counts; got none"
        raise scene.refuse(("tolerances", own.entry), f"{words}, and its distribution has none")
    low, high = limits
    return SizedBy(own.name, law, Bonus.at(modifier, low, high, inner=shape.inner))
