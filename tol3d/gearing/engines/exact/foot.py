"""Functions that kernels need of a kind of gear: foot of a point of one flank on the other, and growth of gears.

The bodies here are never run: as a kernel is compiled for a kind of teeth, each call becomes that kind's variant.
"""

import math
from typing import Any

import numpy as np
from numpy.typing import NDArray

from tol3d.gearing.engines.exact.numbers import Facing, Foot, Nearest, Start
from tol3d.numerics.arrays import Array
from tol3d.numerics.compiled import variant

Integers = NDArray[np.int64]

TURN = 2.0 * math.pi
PER_TURN = 1.0 / TURN


def foot(own: Any, mate: Any, pose: Any, facing: Facing, profile: float, face: float) -> Foot:
    """The foot on the mate's endless flank of a point of own flank; one variant per kind of gears.

    Args:
        own, mate: the gears' teeth.
        pose: mate from own.
        facing: which flanks.
        profile, face: the point's parameters.
    """
    raise NotImplementedError


def grown(tooth: Any, scale: float) -> Any:
    """The teeth of a gear that has grown about its origin; one variant per kind."""
    raise NotImplementedError


def section(tooth: Any, share: float) -> Any:
    """The teeth reduced to one section, at a fraction of the face; one variant per kind."""
    raise NotImplementedError


def turn_to(mate: Any, gap: float, offset: float, at: Foot) -> float:
    """Turn of the mate [rad] until its flank passes through a point; one variant per kind.

    Args:
        mate: its teeth.
        gap: [mm] of the point whose Foot is `at`, or a little less.
        offset: that it holds [mm].
    """
    raise NotImplementedError


def line_of_action(own: Any, mate: Any, pose: Any, facing: Facing, face: float) -> Nearest:
    """The nearest points of two flanks where they are known in closed form; NOWHERE in general. One variant a kind."""
    raise NotImplementedError


def flank_of(tooth: Any, flanks: Any, gear: int, place: float, sigma: float) -> Any:
    """The teeth of a gear as one flank of them is; one variant a kind.

    Args:
        tooth: the gear's teeth.
        flanks: offsets of single flanks of both gears, or 0 where all are alike.
        gear: 0 the driver, 1 the driven.
        place: which tooth, as the mesh counts.
        sigma: side of the driver's flank.
    """
    raise NotImplementedError


def flanks_in(tooth: Any, offsets: Array, builds: Integers, places: Integers, row: int) -> Any:
    """Offsets of single flanks of both gears in a row, 0 where all are alike; one variant a kind.

    Args:
        tooth: the driver's teeth.
        offsets, builds: of FlankDeviations, its values and rows; empty where all are alike.
        places: of driver and driven, see deviated.FlankOffsets; empty likewise.
        row: of the build.
    """
    raise NotImplementedError


def quick_turn(driver: Any, build: Any, at: Any, look: Any) -> tuple[bool, float]:
    """The smallest turn of the driven gear [rad] that closes a pair of a side; True if it is certain.

    One variant a kind; for most kinds it never is.

    Args:
        driver: the driver's teeth.
        build: a MeshBuild.
        at: where its gears stand.
        look: side and place.
    """
    raise NotImplementedError


def sense_of(tooth: Any) -> float:
    """Sense in which a gear's involutes unwind: 1 of an external gear, -1 of a ring's space; by its kind."""
    raise NotImplementedError


def opening(driven: Any) -> float:
    """Sense in which the driven gear turns to leave the driver's right flanks: 1 of two external gears; by its kind."""
    raise NotImplementedError


def handed(driver: Any, sigma: float) -> float:
    """Side on which the flanks that meet unwind from their base circles, by the driver's flank; one variant a kind."""
    raise NotImplementedError


def widest(driver: Any, driven: Any, tangent: float) -> float:
    """Largest relative radius of curvature [mm] of flanks that touch; one variant a kind.

    Args:
        driver, driven: the gears' teeth.
        tangent: length of the tangent of both base circles [mm].
    """
    raise NotImplementedError


def leaning(tooth: Any, sigma: float) -> float:
    """Fall of the profile parameter along a generator of a flank per step along the face; one variant a kind.

    [rad/mm] for the kinds whose generators are no lines of a constant parameter: helical gears; 0 of all others.
    """
    raise NotImplementedError


def first_face(own: Any, mate: Any, pose: Any, sigma: float, face: float) -> float:
    """Height on own face at which to start a search [mm]; one variant a kind.

    Args:
        own, mate: the gears' teeth.
        pose: mate from own.
        sigma: side of the flanks.
        face: the middle of the common face.
    """
    raise NotImplementedError


def begun(own: Any, mate: Any, pose: Any, facing: Facing, profile: float, face: float) -> Start:
    """Place on own flank at which Newton's search for the lowest gap begins; one variant a kind.

    Args:
        own, mate, pose, facing: as of `foot`.
        profile, face: of the start.
    """
    raise NotImplementedError


def promise(own: Any, mate: Any, pose: Any, sigma: float, start: float, apart: float) -> tuple[float, float]:
    """Order in which the pairs of one base pitch touch as axes lean, and its leeway; one variant a kind.

    A pair that comes later than another by more than the leeway is not nearest. (0, 0) where nothing is known.

    Args:
        own, mate: the gears' teeth.
        pose: mate from own.
        sigma: side of the flanks.
        start: profile parameter of own flank of a pair, in the middle of the face.
        apart: size of the gap [mm], about.
    """
    raise NotImplementedError


def external(kind: type) -> None:
    """Register the gears of a kind as external; see foot.py."""
    variant(sense_of, kind)(external_sense)
    variant(opening, kind)(external_opening)
    variant(handed, kind)(external_side)
    variant(widest, kind)(external_radius)


def internal(kind: type) -> None:
    """Register the gears of a kind, which know their sense, as those of internal pairs; see internal.py."""
    variant(sense_of, kind)(own_sense)
    variant(opening, kind)(internal_opening)
    variant(handed, kind)(internal_side)
    variant(widest, kind)(internal_radius)


def alike(kind: type) -> None:
    """Register a kind of teeth all of whose flanks are alike."""
    variant(flank_of, kind)(tooth_itself)
    variant(flanks_in, kind)(no_offsets)
    variant(quick_turn, kind)(never_quickly)


def straight(kind: type) -> None:
    """Register a kind of teeth whose generators keep their profile parameter along the face."""
    variant(leaning, kind)(straight_leaning)
    variant(first_face, kind)(middle_face)
    variant(promise, kind)(no_promise)
    variant(begun, kind)(as_given)


def tooth_itself(tooth: Any, flanks: Any, gear: int, place: float, sigma: float) -> Any:
    """The gear's teeth."""
    return tooth


def no_offsets(tooth: Any, offsets: Array, builds: Integers, places: Integers, row: int) -> float:
    """None."""
    return 0.0


def never_quickly(driver: Any, build: Any, at: Any, look: Any) -> tuple[bool, float]:
    """Not known."""
    return False, 0.0


def middle_face(own: Any, mate: Any, pose: Any, sigma: float, face: float) -> float:
    """The middle."""
    return face


def as_given(own: Any, mate: Any, pose: Any, facing: Facing, profile: float, face: float) -> Start:
    """The start itself."""
    return Start(profile, face, 0.0, 0.0, False)


def no_promise(own: Any, mate: Any, pose: Any, sigma: float, start: float, apart: float) -> tuple[float, float]:
    """Any may touch."""
    return 0.0, 0.0


def straight_leaning(tooth: Any, sigma: float) -> float:
    """The parameter stays."""
    return 0.0


def external_sense(tooth: Any) -> float:
    """The string of both gears' involutes unwinds outwards."""
    return 1.0


def own_sense(tooth: Any) -> Any:
    """That of the gear, or of its mate, which is a ring."""
    return tooth.sense


def external_opening(driven: Any) -> float:
    """In the sense in which the driver leaves its mate."""
    return 1.0


def external_side(driver: Any, sigma: float) -> float:
    """Flanks of one side meet."""
    return sigma


def external_radius(driver: Any, driven: Any, tangent: float) -> float:
    """r_1 r_2/(r_1 + r_2), where r_1 + r_2 is the tangent, is at most a quarter of it."""
    return 0.25 * tangent


def internal_opening(driven: Any) -> float:
    """The driven gear's flank lies on the other side of its tooth than the driver's."""
    return -1.0


def internal_side(driver: Any, sigma: float) -> Any:
    """As the pinion's flank does."""
    return sigma * driver.sense


def internal_radius(driver: Any, driven: Any, tangent: float) -> Any:
    """r_1 r_2/(r_2 - r_1), where r_2 - r_1 is the tangent, grows up to the pinion's tip."""
    largest = driver.base * driver.end if driver.sense > 0.0 else driven.base * driven.end
    return largest * (largest + tangent) / tangent
