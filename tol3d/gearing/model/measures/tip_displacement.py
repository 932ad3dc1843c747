"""What lost motion does to a point of an arm."""

from tol3d.gearing.grammar.measures import TipDisplacementSpec, TipMeasureSpec
from tol3d.gearing.model.measure import Measure, Tip
from tol3d.gearing.model.measures.lost_motion import lost_motion, one_position
from tol3d.gearing.model.measures.measured import measured
from tol3d.gearing.model.model import Model
from tol3d.gearing.model.readings import reader_of
from tol3d.gearing.model.shafts import Arm
from tol3d.gearing.model.trains import refuse_incomparable
from tol3d.scene import Scene


@measured.register
def _(spec: TipDisplacementSpec, scene: Scene, name: str, model: Model) -> Measure:
    arm = arm_of(scene, name, spec, model)
    tip, read = tip_of(arm, spec.point), reader_of(spec)
    kind = lost_motion(model, model.train(spec.of), arm.on, "tip_displacement", read, tip)
    return Measure(name, kind, one_position(spec.over), "value")


def arm_of(scene: Scene, name: str, spec: TipMeasureSpec, model: Model) -> Arm:
    """The arm that a measure is read on.

    Raises:
        SceneError: it does not move with the train.
    """
    arm = next(arm for arm in model.arms if arm.name == spec.arm)
    train = model.train(spec.of)
    if model.layout.root_of.get(arm.on) != train.driven or arm.on == train.held:
        raise scene.refuse(
            ("measures", name, "arm"),
            f"expected an arm on a shaft that moves where {train.held!r} is held, such as {train.output!r}, got "
            f"{spec.arm!r}, which hangs on {arm.on!r}",
        )
    refuse_incomparable(scene, ("measures", name, "arm"), model.layout, train.driven, arm.on)
    return arm


def tip_of(arm: Arm, point: str) -> Tip:
    """A point of an arm."""
    return Tip(arm.name, point, arm.lever(point))
