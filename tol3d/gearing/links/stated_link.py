"""A link of two shafts that is no gear mesh, with its own rate and play; trains add up or compare the play.

Another kind of link is a subclass of it, with a kind of move whose `link` makes it; see LinkSpec.
"""

from abc import ABC, abstractmethod
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from typing import Any, ClassVar, Final, Literal

import numpy as np
from numpy.typing import NDArray

from tol3d.numerics.arrays import Array
from tol3d.numerics.kept import KnownRows, kept
from tol3d.study.system.contributor import Contributor
from tol3d.study.system.copula import Copula
from tol3d.study.system.system import KeyPath


@dataclass(frozen=True)
class LinkTrials:
    """Deviations of a link and the positions of its driver, trial on axis 0.

    Args:
        contributors: those whose deviations are the link's, in the scene's order.
        deviations: of each by name, (trials, components) [mm, rad, K].
        angles: of the driver's shaft against the link's carrier [rad], (trials, positions); 0 of a link whose play does
            not depend on them.
    """

    contributors: Sequence[Contributor]
    deviations: Mapping[str, Array]
    angles: Array

    def __len__(self) -> int:
        """Number of trials."""
        return len(self.angles)

    def part(self, first: int, last: int) -> "LinkTrials":
        """Trials from one to before another."""
        deviations = {name: own[first:last] for name, own in self.deviations.items()}
        return LinkTrials(self.contributors, deviations, self.angles[first:last])

    def rows(self, places: NDArray[np.intp]) -> "LinkTrials":
        """Some trials."""
        deviations = {name: own[places] for name, own in self.deviations.items()}
        return LinkTrials(self.contributors, deviations, self.angles[places])

    def of(self, kind: str) -> Array:
        """Components (trials, components) of the contributors of a kind, added up; 0 where there is none."""
        own = [self.deviations[contributor.name] for contributor in self.contributors if contributor.kind == kind]
        return np.asarray(sum(own, np.zeros((len(self), 1))))


STEP: Final = 1e-5  # mm, rad, K; differences over it lose 1e-11 of a play of 1 mrad to rounding
MOST_KEPT: Final = 200_000
"""Trials of a link whose contributions are kept."""
SAME_AXIS: Final = 1e-6  # mm, and rad


def pin_name(k: int) -> str:
    """A pin of a carrier, counted from 0, among the parts that bores move; scenes cannot name a part so."""
    return f".pin {k + 1}"


@dataclass(frozen=True)
class FreeTurn:
    """Free turn of a driven shaft while its driver, and its carrier if there is one, are held.

    Args:
        play: from end to end [rad], (trials, positions) or (trials, 1); below 0 the link binds; NaN where no stop is
            found.
        middle: of that turn about the shaft's z [rad], against its nominal angle, the same shape; None for 0. It
            matters only where load paths are parallel.
        jams: where the link cannot be assembled, the same shape; the play there is the missing amount, below 0, or NaN
            if unknown. None for a link that always can be.
    """

    play: Array
    middle: Array | None = None
    jams: NDArray[np.bool_] | None = None


@dataclass(frozen=True)
class LinkSum:
    """The theory of a play that is a sum: it is the same at every position.

    Args:
        nominal: without deviations [rad].
        rates: by contributor, of each of its components [rad per mm, rad or K].
    """

    nominal: float
    rates: Mapping[str, tuple[float, ...]]


@dataclass(frozen=True)
class Moved:
    """A part of a link moved by the bores of its shaft, or a pin of its carrier.

    Args:
        contributor: displacement x, y of a point of that shaft, or of the pin [mm].
        part: in the link; of a pin its `pin_name`.
        matrix: motion of the centre by x and by y: rows x and y across the driver's axis, in its frame at rest; of a
            pin outwards and counter-clockwise, in the frame of the carrier.
    """

    contributor: str
    part: str
    matrix: tuple[tuple[float, float], tuple[float, float]]


@dataclass(frozen=True, kw_only=True)
class StatedLink(ABC):
    """A link of shafts that a move of a scene stands for. Frozen; it pickles.

    Args:
        name: the move's.
        driver, driven: shafts.
        rate: turns of the driven per turn of the driver, signed; both against the carrier where there is one.
        carrier: the shaft that carries the link round, as the arm of an epicyclic gear does; None if it rests in the
            world.
        offset: of the driven shaft's origin along the driver's axis [mm].
        moved: effect of bores on its parts.
        assumed: assumption for parts without named bores, in words.
    """

    kind: ClassVar[str]
    """Kind in one word, for summaries and tables."""

    adds_up: ClassVar[bool] = False
    """True if its theory is a linear sum of its deviations, the same at every position: then it has a closed form."""

    has_middle: ClassVar[bool] = False
    """True if its free turns have a middle of their own."""

    unfollowed: ClassVar[str] = "whose error from position to position is not known"
    """Reason why trains have no transmission error with it, in words."""

    compares: ClassVar[bool] = False
    """True if load paths within it are compared, so that its play is no sum of effects; see `parts`."""

    housed: ClassVar[bool] = True
    """True if pictures show a housing in its place; else a presenter shows its inside."""

    presenter: ClassVar[str] = ""
    """Import path of the module whose PRESENTER shows what is in it; see gearing/presenting/shown_train.py."""

    name: str
    driver: str
    driven: str
    rate: Fraction
    carrier: str | None = None
    offset: float = 0.0
    moved: tuple[Moved, ...] = ()
    assumed: str = ""

    @property
    def turns(self) -> Fraction | None:
        """Turns of the driver against the carrier after which its play repeats; None: it depends on no position."""
        return None

    @property
    def remark(self) -> str:
        """Remark on its play for the check of a scene, if any."""
        return self.assumed

    @property
    def driver_from_driven(self) -> Array:
        """Pose of the driven shaft in the frame of its driver, both at 0, (4, 4) [mm]: along its axis if not said."""
        pose = np.eye(4)
        pose[2, 3] = self.offset
        return pose

    @property
    def coaxial(self) -> bool:
        """True if both shafts lie on one axis."""
        pose = self.driver_from_driven
        return bool(np.abs(pose[:2, 3]).max() < SAME_AXIS and np.abs(pose[:2, 2]).max() < SAME_AXIS)

    @property
    def twists(self) -> Mapping[str, float]:
        """By shaft, its turn as it slides in the teeth of what rests [rad/mm]; none of straight teeth."""
        return {}

    @abstractmethod
    def exact(self, seen: LinkTrials) -> FreeTurn:
        """The free turn of the 3D simulation, trial by trial."""

    def analytic(self, seen: LinkTrials) -> FreeTurn:
        """The free turn by theory; that of the 3D simulation where nothing better is known."""
        return self.exact(seen)

    def neglected(self, seen: LinkTrials) -> Mapping[str, Array]:
        """Largest first-order change of the play that its theory leaves out on purpose [rad], in words; see System.

        (trials, positions), or (trials, 1), by what is left out.
        """
        return {}

    @kept
    def known_parts(self, about: bytes) -> KnownRows[Array]:
        """Known `parts` about some means, by the deviations of a trial, (contributors,)."""
        return KnownRows(MOST_KEPT)

    @property
    def contacts(self) -> int:
        """Contacts that are found for one of its free turns; none of a formula."""
        return 0

    def is_compiled(self) -> bool:
        """True if the kernels of both laws are already compiled on this machine; also if the link has none."""
        return True

    def parts(self, seen: LinkTrials, means: Mapping[str, Array]) -> Mapping[str, Array]:
        """Contribution of each contributor to the play at the first position, from its mean [rad], (trials,) by name.

        Used for links that compare load paths; other contributors are regressed as they are.

        Args:
            seen: the trials.
            means: of each contributor (components,).
        """
        return {}

    def problems(self, mean: LinkTrials) -> Iterator[tuple[KeyPath, str]]:
        """Why it cannot be built with every contributor at its mean, with the place in the scene; see System."""
        return iter(())

    def offset_by(self, contributor: str, part: str) -> "StatedLink | None":
        """The same link, with a contributor that also moves a part off its axis of rotation by (x, y) [mm].

        The offset turns with the part, as by the run-out of its shaft; None if the link cannot model it.
        """
        return None

    # bores of its parts -----------------------------------------------------------------------------

    @property
    def levels(self) -> Mapping[str, float]:
        """Parts that turn about its axis, or rest on it, and whose bores may move them.

        Each with its height along the driver's z, where it counts how far its axis lies aside [mm].
        """
        return {}

    @property
    def pins(self) -> Sequence[tuple[float, float]]:
        """Pins of its carrier that may be drawn as features of a part: radius [mm] and azimuth [rad] of each."""
        return ()

    @property
    def held(self) -> str:
        """The part of it that is fixed in the world; "" if it is not needed."""
        return ""

    def asides(self, seen: LinkTrials) -> Mapping[str, Array]:
        """Offsets of parts moved by bores (trials, 2) [mm], in the directions of `Moved`."""
        found: dict[str, Array] = {}
        for own in self.moved:
            by = seen.deviations[own.contributor] @ np.array(own.matrix).T
            found[own.part] = found[own.part] + by if own.part in found else by
        return found

    def aside_slopes(self, seen: LinkTrials) -> Mapping[str, Array]:
        """Change of the play at the first position by each of `asides` (trials, 2) [rad/mm].

        To first order, with the contacts of each trial; used for links that compare load paths.
        """
        return {}

    def slopes_by_bores(self, seen: LinkTrials) -> Mapping[str, Array]:
        """The same by each displacement of the bores, by contributor (trials, 2)."""
        slopes, found = self.aside_slopes(seen) if self.moved else {}, dict[str, Array]()
        for own in self.moved:
            by = slopes[own.part] @ np.array(own.matrix)
            found[own.contributor] = found[own.contributor] + by if own.contributor in found else by
        return found

    def sections(self, contributors: Sequence[Contributor]) -> Mapping[str, Any]:
        """Its entries in summary.json, by section; see System.sections."""
        return {}

    def backlash_limits(self, contributors: Sequence[Contributor], copula: Copula) -> Sequence[Any]:
        """Limits of the backlash of its meshes, see summary/backlash_stages.py; most links have none."""
        return ()

    def ends(self, contributors: Sequence[Contributor]) -> tuple[float, float] | None:
        """Ends of the play by the laws of its contributors [rad]; None if unknown."""
        return None

    def sum_of(self, contributors: Sequence[Contributor]) -> LinkSum | None:
        """The theory as a sum; None where it is none."""
        if not self.adds_up:
            return None
        widths = [len(contributor.draw.components) for contributor in contributors]
        rows = np.concatenate([np.zeros((1, sum(widths))), np.eye(sum(widths))])
        plays = self.analytic(_seen(contributors, rows, np.zeros((len(rows), 1)))).play[:, 0]
        rates = np.split(plays[1:] - plays[0], np.cumsum(widths)[:-1])
        named = zip(contributors, rates, strict=True) if contributors else ()
        return LinkSum(float(plays[0]), {each.name: tuple(own.tolist()) for each, own in named})

    def rates(self, seen: LinkTrials, what: Literal["play", "rest"]) -> Mapping[str, Array]:
        """Derivatives of the play, or of its middle, on the 3D method.

        By contributor, (trials, positions, components) [rad per mm, rad or K].
        """
        one_law = type(self).analytic is StatedLink.analytic
        if what == "play" and one_law and (whole := self.sum_of(seen.contributors)):
            shape = seen.angles.shape
            return {name: np.broadcast_to(np.array(own), (*shape, len(own))) for name, own in whole.rates.items()}
        return {contributor.name: self._differences(seen, contributor.name, what) for contributor in seen.contributors}

    def _differences(self, seen: LinkTrials, name: str, what: str) -> Array:
        own = seen.deviations[name]
        rates = np.empty((*seen.angles.shape, own.shape[1]))
        for k, step in enumerate(STEP * np.eye(own.shape[1])):
            both = [self.exact(_moved(seen, name, sign * step)) for sign in (1.0, -1.0)]
            above, below = (turn.play if what == "play" else middle_of(turn) for turn in both)
            rates[..., k] = (above - below) / (2 * STEP)
        return rates


def middle_of(turn: FreeTurn) -> Array:
    """The middle of a free turn [rad], in the shape of its play."""
    return np.zeros_like(turn.play) if turn.middle is None else turn.middle


def _moved(seen: LinkTrials, name: str, step: Array) -> LinkTrials:
    return LinkTrials(seen.contributors, {**seen.deviations, name: seen.deviations[name] + step}, seen.angles)


def _seen(contributors: Sequence[Contributor], rows: Array, angles: Array) -> LinkTrials:
    """Deviations (trials, components of all) at angles."""
    found, start = {}, 0
    for contributor in contributors:
        width = len(contributor.draw.components)
        found[contributor.name] = rows[:, start : start + width]
        start += width
    return LinkTrials(contributors, found, angles)
