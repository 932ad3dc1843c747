"""Measures: quantity, positions, and value taken over them."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import ClassVar, Literal

from tol3d.study.system import measure as system_measure
from tol3d.study.system.measure import Worse
from tol3d.study.system.pooled_statistic import PooledStatistic
from tol3d.study.system.positions import Positions, Take
from tol3d.study.system.spectrum import Spectrum
from tol3d.units import ARCMIN

BacklashQuantity = Literal["normal_backlash", "circumferential_backlash", "angular_backlash", "rest_angle"]
TrainQuantity = Literal["lost_motion", "tip_displacement", "tip_error"]


@dataclass(frozen=True)
class Reading:
    """Place on the face, and teeth, at which a mesh is brought to contact and its gap is read.

    Args:
        contact: the working flanks touch over the whole face, or in the section in its middle.
        gap: the other flanks' distance is the least over the whole face, or that in the section.
        teeth: "all" candidate pairs, or one tooth in its space, the driver's or the driven's next to the
            line of centres.
        flank: the driver's flanks that touch: "drive", its working ones, or "back", the others.
        reversing: True if the turn to the other flanks ends where the load on those pushes the shafts.
    """

    contact: Literal["face", "section"] = "face"
    gap: Literal["face", "section"] = "face"
    teeth: Literal["all", "driver", "driven"] = "all"
    flank: Literal["drive", "back"] = "drive"
    reversing: bool = False


@dataclass(frozen=True)
class Slide:
    """A shaft that slides by its axial play where the load changes sides, as its helical gears make it do.

    Args:
        shaft: its name.
        factor: turn of the gear, or of the shaft that a stage drives, per axial play [rad/mm].
    """

    shaft: str
    factor: float


@dataclass(frozen=True)
class Backlash:
    """A backlash of a mesh: normal and circumferential [mm], or angular [rad] of one gear, the other held.

    Its rest angle [rad] is where the driven gear rests on the flank of its reading, against the middle of a nominal
    space. An angular backlash that is measured for itself contains the slides of its shafts; one of a stage does not.
    """

    quantity: BacklashQuantity
    mesh: str
    gear: str
    reading: Reading = Reading()
    slides: tuple[Slide, ...] = ()

    @property
    def is_angle(self) -> bool:
        """True if the value is an angle [rad] rather than a length [mm]."""
        return self.quantity in ("angular_backlash", "rest_angle")

    @property
    def adds_up(self) -> bool:
        """True: it is its own backlash."""
        return True

    @property
    def backlashes(self) -> tuple[tuple[float, "Backlash"], ...]:
        """The backlashes that it adds up, with their factors: itself."""
        return ((1.0, self),)

    @property
    def links(self) -> tuple[tuple[float, str], ...]:
        """The links that are no meshes whose play it adds up, with their factors: none."""
        return ()

    @property
    def sliding(self) -> frozenset[str]:
        """The shafts whose axial play acts."""
        return frozenset(slide.shaft for slide in self.slides)


@dataclass(frozen=True)
class Stage:
    """A link between the held shaft and the one that is read.

    Args:
        link: a mesh, or another link.
        factor: turn of the shaft that is read per turn of the link's driven shaft.
        backlash: angular backlash of the mesh's driven gear; None for a link that is no mesh.
        sense: of the turn of the shaft that is read for a turn of the driven gear about its own z, 1 or -1; without a
            gear, of the driven shaft.
        has_middle: True if a link that is no mesh defines the middle of its free turn.
        compares: whether a link that is no mesh compares load paths within it, so that its play is no sum.
        slides: of the shaft that a mesh drives, or of its driver's; each shaft of a train slides in one stage.
    """

    link: str
    factor: float
    backlash: Backlash | None
    sense: int = 1
    has_middle: bool = False
    compares: bool = False
    slides: tuple[Slide, ...] = ()


@dataclass(frozen=True)
class Mix:
    """A bound of the turn at which load paths join, some of their shafts sliding: a vertex of the dual programme.

    Args:
        weights: of the paths; of one below 0 its other end counts.
        slides: of the shafts, at the one where the paths join: half of it on each side.
    """

    weights: tuple[float, ...]
    slides: tuple[Slide, ...]


@dataclass(frozen=True)
class ParallelStage:
    """Load paths in parallel between two shafts: the play where they join is the intersection of their plays.

    Args:
        link: its links' names.
        factor: turn of the shaft that is read per turn of the shaft where they meet.
        first, last: the shafts where they part and meet.
        paths: the stages of each load path; their factors and senses are those of the shaft where the paths join.
        sense: of the turn of the shaft that is read for a turn of the shaft where they meet, 1 or -1.
        loops: stages from a shaft back to itself, likewise, of load paths that share links; none where they do not.
        mixes: bounds by several paths at once where shafts slide, whose weights add up to 1; else none.
        gaps: of those that add up to 0: what lets the paths be closed.
    """

    link: str
    factor: float
    first: str
    last: str
    paths: tuple[tuple["Stage | ParallelStage", ...], ...]
    sense: int = 1
    backlash: None = None
    loops: tuple[tuple[Stage, ...], ...] = ()
    mixes: tuple[Mix, ...] = ()
    gaps: tuple[Mix, ...] = ()
    slides: ClassVar[tuple[Slide, ...]] = ()

    @property
    def singles(self) -> tuple[Stage, ...]:
        """All stages in it, each link once, with their factors at the shaft that is read."""
        found: dict[str, Stage] = {}
        for stage in (stage for path in self.paths for stage in path):
            inner = stage.singles if isinstance(stage, ParallelStage) else (stage,)
            for single in inner:
                found.setdefault(single.link, replace(single, factor=self.factor * single.factor))
        return tuple(found.values())


AnyStage = Stage | ParallelStage


@dataclass(frozen=True)
class Tip:
    """A point of an arm, and its distance from the axis of the arm's shaft [mm]."""

    arm: str
    point: str
    lever: float


@dataclass(frozen=True)
class LostMotion:
    """Play of a shaft from all links between it and the held shaft [rad], or the resulting motion of a tip [mm].

    Args:
        quantity: the turn, the tip's displacement by it, or its error over a swing.
        train: the train's name.
        shaft, held: the shaft read and the one held.
        stages: the links between them, from the held shaft on.
        tip: the point that is displaced.
        turned: for a swing, at which of its positions the other flanks work than at its start.
        changes: for a swing, angles of the output at which the load changes sides [rad].
    """

    quantity: TrainQuantity
    train: str
    shaft: str
    held: str
    stages: tuple[AnyStage, ...]
    tip: Tip | None = None
    turned: tuple[bool, ...] = ()
    changes: tuple[float, ...] = ()

    @property
    def is_angle(self) -> bool:
        """True if the value is an angle [rad] rather than a length [mm]."""
        return self.tip is None

    @property
    def singles(self) -> tuple[Stage, ...]:
        """All meshes and other links on the load path, those in parallel too."""
        each = (stage.singles if isinstance(stage, ParallelStage) else (stage,) for stage in self.stages)
        return tuple(single for singles in each for single in singles)

    @property
    def adds_up(self) -> bool:
        """True if it is the sum of its backlashes: no load paths are in parallel, nor within a link."""
        return not self.joins and not any(stage.compares for stage in self.singles)

    @property
    def joins(self) -> bool:
        """True if load paths are in parallel."""
        return any(isinstance(stage, ParallelStage) for stage in self.stages)

    @property
    def backlashes(self) -> tuple[tuple[float, Backlash], ...]:
        """The backlashes of meshes that it adds up or compares, with their factors."""
        return tuple((stage.factor, stage.backlash) for stage in self.singles if stage.backlash)

    @property
    def links(self) -> tuple[tuple[float, str], ...]:
        """The links that are no meshes whose play it adds up or compares, with their factors."""
        return tuple((stage.factor, stage.link) for stage in self.singles if stage.backlash is None)

    @property
    def sliding(self) -> frozenset[str]:
        """The shafts whose axial play acts."""
        mixes = (mix for stage in self.stages if isinstance(stage, ParallelStage) for mix in stage.mixes)
        return frozenset(slide.shaft for sliding in (*self.stages, *mixes) for slide in sliding.slides)


@dataclass(frozen=True)
class TransmissionError:
    """Lead of a driven gear, or a train's output, over its nominal position with one flank side in contact [rad].

    Counted in the sense in which the driver's working flank pushes it, relative to its lead at the first position.

    Args:
        of: the mesh or the train.
        gear: the driven gear, or the train's output shaft.
        flank: the driver's flanks that touch, the working ones or the others.
        backlashes: rest angles of the driven gears with their factors: turns of the output, in its sense, for a turn
            of the driven gear about its own z.
        train: True for a train, whose positions are those of its first shaft.
    """

    of: str
    gear: str
    flank: Literal["drive", "back"]
    backlashes: tuple[tuple[float, Backlash], ...]
    train: bool = False

    quantity: ClassVar[Literal["transmission_error"]] = "transmission_error"
    is_angle: ClassVar[bool] = True
    adds_up: ClassVar[bool] = True
    links: ClassVar[tuple[tuple[float, str], ...]] = ()
    sliding: ClassVar[frozenset[str]] = frozenset()  # one flank side stays loaded

    @property
    def meshes(self) -> tuple[str, ...]:
        """Names of its meshes, from the input on."""
        return tuple(backlash.mesh for _, backlash in self.backlashes)


Kind = Backlash | LostMotion | TransmissionError


def at_one_position(kind: Kind) -> Kind:
    """Kind read at one position where a swing's flanks have changed; any other kind unchanged."""
    if isinstance(kind, LostMotion) and kind.turned:
        return replace(kind, quantity="tip_displacement", turned=(), changes=())
    return kind


@dataclass(frozen=True)
class Measure:
    """A measure with its limits [mm or rad]."""

    name: str
    kind: Kind
    positions: Positions
    take: Take
    lower_limit: float | None = None
    upper_limit: float | None = None

    @property
    def unit(self) -> str:
        """Unit of its columns and of summary.json: "um", "mm" for a tip, or "arcmin"."""
        if self.kind.is_angle:
            return "arcmin"
        return "mm" if isinstance(self.kind, LostMotion) else "um"

    @property
    def per_internal(self) -> float:
        """Factor from mm or rad to its unit."""
        return {"arcmin": ARCMIN, "mm": 1.0, "um": 1000.0}[self.unit]

    @property
    def worse(self) -> Worse:
        """The smaller backlash, the larger lost motion or error of a tip."""
        return "low" if isinstance(self.kind, Backlash) else "high"

    @property
    def adds_up(self) -> bool:
        """True if it is the sum of its backlashes: no load paths are in parallel."""
        return self.kind.adds_up

    @property
    def pooled_statistics(self) -> tuple[PooledStatistic, ...]:
        """None: every sample has those of backlashes."""
        return ()

    @property
    def spectrum(self) -> Spectrum | None:
        """None: scenes of gears ask for no harmonics."""
        return None

    @property
    def keeps_overlap(self) -> bool:
        """True if it is a backlash, which is below 0 where teeth overlap, and smooth through 0."""
        return isinstance(self.kind, Backlash)


def gear_measure(measure: system_measure.Measure) -> Measure:
    """A measure that a study hands back: one of this model's."""
    if not isinstance(measure, Measure):
        raise TypeError(f"{measure.name} is no measure of gears")
    return measure


def gear_measures(measures: Sequence[system_measure.Measure]) -> tuple[Measure, ...]:
    """The same of several."""
    return tuple(map(gear_measure, measures))
