"""Lost motion of a train at one of its shafts."""

from tol3d.gearing.grammar.measures import LostMotionSpec
from tol3d.gearing.model.links import Link, Parallel
from tol3d.gearing.model.measure import (
    AnyStage,
    Backlash,
    LostMotion,
    Measure,
    ParallelStage,
    Stage,
    Tip,
    TrainQuantity,
)
from tol3d.gearing.model.measures.measured import measured
from tol3d.gearing.model.model import Model
from tol3d.gearing.model.networks import Network, Walk
from tol3d.gearing.model.readings import Reader, reader_of
from tol3d.gearing.model.shafts import Train
from tol3d.gearing.model.trains import refuse_incomparable
from tol3d.scene import Scene
from tol3d.scene.direction import At, RandomOrFixed
from tol3d.system.positions import Positions


@measured.register
def _(spec: LostMotionSpec, scene: Scene, name: str, model: Model) -> Measure:
    train = model.train(spec.of)
    shaft = spec.shaft or train.output
    if model.layout.root_of.get(shaft) != train.driven:
        raise scene.refuse(("measures", name, "shaft"), f"expected a shaft that {train.driven!r} turns, got {shaft!r}")
    refuse_incomparable(scene, ("measures", name, "shaft"), model.layout, train.driven, shaft)
    if shaft == train.held:
        raise scene.refuse(("measures", name), f"expected another shaft than the one that is held, got {shaft!r}")
    kind = lost_motion(model, train, shaft, "lost_motion", reader_of(spec))
    return Measure(name, kind, one_position(spec.over), "value")


def lost_motion(
    model: Model,
    train: Train,
    shaft: str,
    quantity: TrainQuantity,
    read: Reader,
    tip: Tip | None = None,
) -> LostMotion:
    """What a train's links leave free at one of its shafts, its meshes read as `read` says."""
    path = model.layout.load_path(train.held, shaft)
    stages = tuple(_stage(model, element, (shaft, train.held), read) for element in path)
    return LostMotion(quantity, train.name, shaft, train.held, stages, tip)


def _stage(model: Model, element: Link | Parallel, ends: tuple[str, str], read: Reader) -> AnyStage:
    """A link or load paths in parallel, read at a shaft while another one is held."""
    if isinstance(element, Network):
        return network_stage(model, element, ends[0], read)
    layout = model.layout
    ratio = float(layout.freed_turn(element.driven, *ends))
    if isinstance(element, Parallel):
        within = (element.driven, element.driver)
        paths = tuple(tuple(_stage(model, inner, within, read) for inner in path) for path in element.paths)
        return ParallelStage(element.name, abs(ratio), element.driver, element.driven, paths, 1 if ratio > 0.0 else -1)
    return _single(model, element, ratio, read)


def _single(model: Model, link: Link, ratio: float, read: Reader) -> Stage:
    """A link that turns the shaft that is read by a ratio, signed, for a turn of its driven shaft."""
    mesh = next((mesh for mesh in model.meshes if mesh.name == link.name), None)
    if mesh is None:
        own = model.link(link.name)
        return Stage(link.name, abs(ratio), None, 1 if ratio > 0.0 else -1, own.has_middle, own.compares)
    _, carried = model.layout.carrying[mesh.driven]
    backlash = Backlash("angular_backlash", mesh.name, mesh.driven, read(mesh))
    return Stage(link.name, abs(ratio), backlash, carried.sense if ratio > 0.0 else -carried.sense)


def network_stage(model: Model, element: Network, shaft: str, read: Reader) -> ParallelStage:
    """Load paths that share links, read at a shaft beyond the last of theirs."""
    turns = model.layout.ratio

    def along(walk: Walk) -> tuple[Stage, ...]:
        return tuple(
            _single(model, link, sense * float(turns(element.driven, link.driven)), read) for link, sense in walk
        )

    ratio = float(turns(shaft, element.driven))
    paths, loops = (tuple(along(walk) for walk in walks) for walks in (element.walks, element.loops))
    sense = 1 if ratio > 0.0 else -1
    return ParallelStage(element.name, abs(ratio), element.driver, element.driven, paths, sense, loops=loops)


def one_position(over: RandomOrFixed) -> Positions:
    """The position of the train's driven shaft: random or at an angle."""
    if isinstance(over, At):
        return Positions("at", 1, 1, over.at.internal)
    return Positions("random", 1, 1)
