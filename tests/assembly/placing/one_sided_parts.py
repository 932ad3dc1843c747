"""Parts on one-sided contacts by numbers, and what they carry by scipy's HiGHS."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from assembly.placing.built_by_numbers import Columns, assembly, feature, frame, pair, part
from numpy.typing import NDArray
from scipy.optimize import linprog

from tol3d.assembly.grammar.measures.gap import GapSpec
from tol3d.assembly.model import Assembly, Fix, Measured, Point, Rest
from tol3d.assembly.model.measures import Rocking
from tol3d.assembly.model.moves import PointsOn

Array = NDArray[np.float64]

DOWN = np.array([0.0, 0.0, -1.0])


@dataclass(frozen=True)
class Contacts:
    """Points of a part on planes of a base, nominally touching."""

    points: Array
    normals: Array
    force: Array
    at: Array

    def rested(
        self,
        pose: Array | None = None,
        points_on: PointsOn = "part",
        seen: Sequence[tuple[Array, Array]] = (),
        rocking: Rocking | None = None,
    ) -> Assembly:
        """A part at rest; the deviations are the heights of locators, or of points that stand still, in order.

        Args:
            pose: of the part, nominally.
            points_on: which side they ride on.
            seen: points and directions, whose displacements are the measures "0", "1", ...
            rocking: of all measures.
        """
        columns, own = Columns(), np.eye(4) if pose is None else pose
        back = np.linalg.inv(own)
        base, moving, pairs = [], [], []
        for k, (at, normal) in enumerate(zip(self.points, self.normals, strict=True)):
            height = columns(normal[:, None])
            on_part = points_on == "part"
            base.append(feature(f"base.{k}", Point(), frame(at), () if on_part else [height]))
            moving.append(feature(f"part.{k}", Point(), frame(back[:3, :3] @ at + back[:3, 3])))
            direction = normal if on_part else back[:3, :3] @ normal
            locator = [replace(height, matrix=np.eye(1))] if on_part else []
            pairs.append(pair(f"part.{k}", f"base.{k}", direction, locator))
        measures = {}
        for k, (at, along) in enumerate(seen):
            base.append(feature(f"base.seen {k}", Point(), frame(at)))
            moving.append(feature(f"part.seen {k}", Point(), frame(back[:3, :3] @ at + back[:3, 3])))
            measures[str(k)] = Measured(GapSpec.reads, (f"base.seen {k}", f"part.seen {k}"), along, rocking=rocking)
        at = back[:3, :3] @ self.at + back[:3, 3]
        move = Rest("rest", "part", tuple(pairs), self.force, at, points_on)
        return assembly(
            columns, [part("base", base), part("part", moving, pose=own)], [Fix("put", "base"), move], measures
        )


def pads(places: Array, force: Array = DOWN, at: tuple[float, float] = (0.0, 0.0)) -> Contacts:
    """Pads at places (pads, 2), their normals up."""
    points = np.column_stack([places, np.zeros(len(places))])
    return Contacts(points, np.tile([0.0, 0.0, 1.0], (len(places), 1)), force, np.array([*at, 0.0]))


def random_pads(rng: np.random.Generator) -> Contacts:
    """Three to eight pads, the centre of gravity well within."""
    while True:
        places = rng.uniform(-100, 100, (rng.integers(3, 9), 2))
        shares = rng.dirichlet(np.ones(len(places)))
        if np.linalg.svd(places - places.mean(axis=0), compute_uv=False)[1] > 40:
            return pads(places, at=tuple(shares @ places))


def random_contacts(rng: np.random.Generator) -> Contacts:
    """Six to nine contacts on all sides, and a force that some of them balance, with some room to either side."""
    while True:
        counts = rng.integers(3, 6), rng.integers(2, 4), rng.integers(1, 3)
        normals = np.repeat(np.eye(3)[[2, 1, 0]], counts, axis=0) + rng.normal(0, 0.15, (sum(counts), 3))
        normals /= np.linalg.norm(normals, axis=1)[:, None]
        force = -np.array([rng.uniform(0.2, 1), rng.uniform(0.2, 1), rng.uniform(0.5, 1)])
        found = Contacts(rng.uniform(-80, 80, (len(normals), 3)), normals, force, rng.uniform(-30, 30, 3))
        held = programme(found, np.eye(3), found.points, np.zeros(len(normals)))
        if held is not None and np.sum(held > 0.02) == 6:
            return found


def programme(own: Contacts, turn: Array, points: Array, gaps: Array) -> Array | None:
    """Forces of contacts by HiGHS (contacts,); None where they do not hold the part."""
    rows = np.hstack([own.normals, np.cross(points, own.normals) / 50])
    pull = np.concatenate([own.force, np.cross(turn @ own.at, own.force) / 50])
    found = linprog(-pull, A_ub=-rows, b_ub=gaps, bounds=(None, None), method="highs")
    return -np.asarray(found.ineqlin.marginals) if found.status == 0 else None
