"""Drives of a gearbox: which shaft drives which, and where the teeth meet about each driver."""

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Final

import numpy as np

from tol3d.apps.drafting.rexs.document import RexsError
from tol3d.apps.drafting.rexs.gearbox import Gear, Gearbox, PlanetarySet, Stage

CARRIER: Final = 0
"""Stands for the carrier among the ids of a set's central gears."""
PARALLEL: Final = 1e-5  # rad; files print unit vectors with 6 digits and more
SAME_DISTANCE: Final = 1e-3  # mm; of shafts, as files print them


@dataclass(frozen=True)
class Link:
    """A mesh or a planetary stage, from the part that drives to the one that is driven.

    Args:
        cause: what it is.
        driver, driven: gears of a mesh; members of a set: a central gear's id, or CARRIER.
        start, end: parts that turn: a shaft by the id of its first component, or a gear that is its own.
    """

    cause: Stage | PlanetarySet
    driver: int
    driven: int
    start: int
    end: int

    @property
    def turned(self) -> "Link":
        """The same link with its ends exchanged."""
        return Link(self.cause, self.driven, self.driver, self.end, self.start)


@dataclass(frozen=True)
class Drive:
    """Parts that are linked.

    Args:
        links: each behind the one that turns its driver.
        root: the part that is driven from outside.
        outputs: parts that drive none.
    """

    links: Sequence[Link]
    root: int
    outputs: Sequence[int]


def turning(gearbox: Gearbox, gear: Gear) -> int:
    """The part that a gear turns with."""
    shaft = gearbox.shaft_of(gear)
    return gear.id if shaft is None else shaft.ids[0]


def drives(gearbox: Gearbox) -> Iterator[Drive]:
    """Drives of a gearbox, in the order of the file."""
    left = [_mesh(own, gearbox) for own in gearbox.stages] + [_set(own, gearbox) for own in gearbox.sets]
    while left:
        parts, size = {left[0].start, left[0].end}, 0
        while size < len(parts):
            size = len(parts)
            parts |= {end for own in left if {own.start, own.end} & parts for end in (own.start, own.end)}
        yield _drive([own for own in left if own.start in parts])
        left = [own for own in left if own.start not in parts]


def _mesh(stage: Stage, gearbox: Gearbox) -> Link:
    """A mesh; the gear that the file says drives it, else the one of fewer teeth.

    Raises:
        RexsError: both gears turn as one.
    """
    first, second = stage.gears
    drives_second = stage.driven_by == second.id or (stage.driven_by is None and second.teeth < first.teeth)
    link = Link(stage, first.id, second.id, turning(gearbox, first), turning(gearbox, second))
    if link.start == link.end:
        raise RexsError(f"cylindrical_stage {stage.id}: expected gears on two shafts, got shafts that turn as one")
    return link.turned if drives_second else link


def _set(own: PlanetarySet, gearbox: Gearbox) -> Link:
    """A set from its sun, or where that is held from another central gear, to what is left to drive."""
    centrals = {central.id: turning(gearbox, central) for central, _ in own.meshes}
    parts = centrals | {CARRIER: own.carrier.ids[0]}
    suns = [central.id for central, _ in own.meshes if not central.internal]
    free = [member for member in (*suns, *centrals, CARRIER) if member != own.held]
    rest = [member for member in dict.fromkeys(free) if member != free[0]]
    loaded = {shaft.ids[0] for shaft in gearbox.shafts if shaft.loaded}
    busy = loaded | {turning(gearbox, gear) for stage in gearbox.stages for gear in stage.gears}
    output = next((member for member in rest if parts[member] in busy), rest[-1])
    return Link(own, free[0], output, parts[free[0]], parts[output])


def _drive(links: Sequence[Link]) -> Drive:
    """Links in order from a root: a part of one link that drives it as it stands, else the first driver."""
    ends = [end for own in links for end in (own.start, own.end)]
    root = next((own.start for own in links if ends.count(own.start) == 1), links[0].start)
    reached, ordered, left = [root], list[Link](), list(links)
    while left:
        part = next(own for own in reached if any(own in (link.start, link.end) for link in left))
        link = next(link for link in left if part in (link.start, link.end))
        left.remove(link)
        link = link if link.start == part else link.turned
        ordered.append(link)
        reached += [link.end] if link.end not in reached else []
    driving = {own.start for own in ordered}
    return Drive(ordered, root, [part for part in reached if part not in driving])


@dataclass(frozen=True)
class Mounting:
    """Places of a drive's parts, in the frame of its root: z along u, x along w.

    Args:
        azimuths: of each mesh about its driver, from the driver's x [rad].
        senses: 1 for a part whose u points as the root's, -1 for the other way.
        remarks: lines on what the file says twice, and differently.
    """

    azimuths: Mapping[int, float]
    senses: Mapping[int, int]
    remarks: Sequence[str]


def mounting(drive: Drive, gearbox: Gearbox) -> Mounting:
    """Places of a drive's parts by the positions of their shafts, else by the angles that stages state.

    A driven part's x points from its driver's axis to where their teeth meet, as in scenes.

    Raises:
        RexsError: shafts of a mesh are not parallel.
    """
    poses = {own.ids[0]: own.pose for own in gearbox.shafts if own.pose is not None}
    azimuths, ahead = dict[int, float](), {drive.root: 0.0}
    remarks = list[str]()
    for link in drive.links:
        stage = link.cause
        if isinstance(stage, PlanetarySet):
            ahead.setdefault(link.end, ahead[link.start])
            continue
        driver, driven = (next(own for own in stage.gears if own.id == each) for each in (link.driver, link.driven))
        start, end, root = (poses.get(part) for part in (link.start, link.end, drive.root))
        if start is None or end is None or root is None:
            towards = (stage.direction or 0.0) + (0.0 if driver.id == stage.first.id else math.pi)
        else:
            if np.linalg.norm(np.cross(start[:3, 0], end[:3, 0])) > PARALLEL:
                raise RexsError(f"cylindrical_stage {stage.id}: expected shafts with parallel u axes, got others")
            apart = np.linalg.inv(root)[:3, :3] @ (end[:3, 3] - start[:3, 3])
            towards = math.atan2(-apart[1], apart[2])
            distance = math.hypot(apart[1], apart[2])
            if abs(distance - stage.centre_distance) > SAME_DISTANCE:
                remarks.append(
                    f"cylindrical_stage {stage.id}: its shafts lie {distance:.6g} mm apart; center_distance "
                    f"{stage.centre_distance:.6g} mm is drafted"
                )
        meet = towards + (math.pi if driven.internal else 0.0)
        azimuths[stage.id] = math.remainder(meet - ahead[link.start], math.tau)
        ahead.setdefault(link.end, meet)
    root = poses.get(drive.root)
    along = {part: 1.0 if root is None else float(pose[:3, 0] @ root[:3, 0]) for part, pose in poses.items()}
    return Mounting(azimuths, {part: 1 if own > 0.0 else -1 for part, own in along.items()}, remarks)
