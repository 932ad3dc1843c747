"""Random touches: a part whose round features lie against others nominally, and where it comes to lie by scipy.

Shares no code with what it checks: contacts are asked here as distances of centres, of points and lines, of lines.
"""

from dataclasses import dataclass

import numpy as np
from assembly.drafts import Draft, frame, turned
from numpy.typing import NDArray
from oracles.rigid_parts import RigidParts
from scipy.linalg import null_space
from scipy.optimize import least_squares
from scipy.spatial.transform import Rotation

from tol3d.assembly.grammar.measures.gap import ContactAngleSpec, GapSpec, SurfaceGapSpec
from tol3d.assembly.model import Assembly, Axis, Contact, Fix, Measured, Plane, Point, RoundPlane, Shape, Touch

Array = NDArray[np.float64]

RADIUS = 50.0  # mm: turns are unknown as lengths there
KINDS = (
    "ball on plane", "plane on ball", "cylinder on plane", "plane on cylinder", "ball on ball", "ball in socket",
    "socket on ball", "point on ball", "ball on cylinder", "ball in bore", "cylinder on ball", "bore on ball",
    "point on cylinder", "cylinder on point", "cylinder along cylinder", "cylinder in bore", "bore on cylinder",
    "cylinder across cylinder",
)  # fmt: skip
TWO = ("cylinder on plane", "plane on cylinder", "cylinder along cylinder", "cylinder in bore", "bore on cylinder")


@dataclass
class RandomTouch:
    """An assembly of a base and a part that touches it.

    Args:
        assembly: its part lies in contact nominally.
        kinds: of its contacts.
    """

    assembly: Assembly
    kinds: tuple[str, ...]

    @property
    def touch(self) -> Touch:
        """The move."""
        move = self.assembly.moves[1]
        assert isinstance(move, Touch)
        return move

    def errors(self, deviations: Array, pose: Array) -> Array:
        """Residual of each contact [mm] with the part at a pose (4, 4)."""
        rigid = RigidParts(self.assembly, deviations, {})
        base = self.assembly.part["base"].pose
        found: list[float] = []
        for kind, contact in zip(self.kinds, self.touch.contacts, strict=True):
            (p, a), (q, b) = (rigid.on_part(name) for name in (contact.moving, contact.target))
            p, a = pose[:3, :3] @ p + pose[:3, 3], pose[:3, :3] @ a
            q, b = base[:3, :3] @ q + base[:3, 3], base[:3, :3] @ b
            radii = [self.radius(name, deviations) for name in (contact.moving, contact.target)]
            found += errors_of(kind, (p, a), (q, b), radii)
        return np.array(found)

    def radius(self, name: str, deviations: Array) -> float:
        """Radius of a feature in the trial [mm]."""
        feature = self.assembly.features[name]
        nominal = getattr(feature.shape, "diameter", None) or 0.0
        return float(nominal + sum(float(deviations[own.columns].sum()) for own in feature.size_by)) / 2.0

    def pose(self, deviations: Array, steps: int = 1) -> Array | None:
        """Pose of the part (4, 4), near its nominal one; what no contact decides neither turns nor shifts their middle.

        Args:
            deviations: (columns,) [mm].
            steps: in which they grow from nothing; the pose is followed.

        Returns:
            None where contacts cannot be met.
        """
        start = self.assembly.part["part"].pose
        middle = np.mean([self.assembly.features[own.moving].frame[:3, 3] for own in self.touch.contacts], axis=0)

        def posed(unknowns: Array) -> Array:
            made = np.eye(4)
            made[:3, :3] = Rotation.from_rotvec(unknowns[3:] / RADIUS).as_matrix() @ start[:3, :3]
            made[:3, 3] = start[:3, :3] @ middle + start[:3, 3] + unknowns[:3] - made[:3, :3] @ middle
            return made

        step = 1e-4
        nominal = np.zeros(self.assembly.width)
        sides = [[self.errors(nominal, posed(s * h)) for h in step * np.eye(6)] for s in (1.0, -1.0)]
        free = null_space((np.array(sides[0]) - np.array(sides[1])).T / (2 * step), rcond=1e-6)  # (6, motions)
        left, sizes, right = np.linalg.svd(free[3:])
        turning = int((sizes > 1e-6).sum())
        pure = free[:3] @ right[turning:].T  # shifts without a turn
        turns = np.hstack([np.zeros((turning, 3)), left[:, :turning].T])
        still = np.vstack([turns, np.hstack([pure.T, np.zeros((pure.shape[1], 3))])])
        # central differences of step h leave h^2 / R^2 of a direction: of what is free it acts on the third order

        unknowns = np.zeros(6)
        for share in np.linspace(0.0, 1.0, steps + 1)[1:]:

            def asked(unknowns: Array, share: float = share) -> Array:
                return np.concatenate([self.errors(share * deviations, posed(unknowns)), still @ unknowns])

            found = least_squares(asked, unknowns, method="lm", xtol=1e-15, ftol=1e-15, gtol=1e-15)
            if np.abs(found.fun).max() > 1e-11:
                return None
            unknowns = found.x
        return posed(unknowns)


def errors_of(kind: str, own: tuple[Array, Array], other: tuple[Array, Array], radii: list[float]) -> list[float]:
    """Residuals of a contact, from origin and z of both sides."""
    (p, a), (q, b) = own, other
    match kind:
        case "ball on plane":
            return [float(b @ (p - q)) - radii[0]]
        case "plane on ball":
            return [float(a @ (q - p)) - radii[1]]
        case "cylinder on plane":
            return [float(b @ (p - q)) - radii[0], RADIUS * float(a @ b)]
        case "plane on cylinder":
            return [float(a @ (q - p)) - radii[1], RADIUS * float(a @ b)]
        case "cylinder across cylinder":
            away = np.linalg.lstsq(np.column_stack([a, -b]), q - p, rcond=None)[0]
            return [float(np.linalg.norm(p + away[0] * a - q - away[1] * b)) - sum(radii)]
        case "cylinder along cylinder" | "cylinder in bore" | "bore on cylinder":
            normal = np.cross(np.cross(b, p - q), b)
            distance = np.linalg.norm(np.cross(b, p - q))
            total = sum(radii) if kind == "cylinder along cylinder" else abs(radii[0] - radii[1])
            return [float(distance) - total, RADIUS * float(a @ normal) / float(np.linalg.norm(normal))]
        case "ball on ball" | "point on ball":
            return [float(np.linalg.norm(p - q)) - sum(radii)]
        case "ball in socket" | "socket on ball":
            return [float(np.linalg.norm(p - q)) - abs(radii[0] - radii[1])]
        case "ball on cylinder" | "point on cylinder":
            return [float(np.linalg.norm(np.cross(b, p - q))) - sum(radii)]
        case "ball in bore":
            return [float(np.linalg.norm(np.cross(b, p - q))) - (radii[1] - radii[0])]
        case "cylinder on ball" | "cylinder on point":
            return [float(np.linalg.norm(np.cross(a, p - q))) - sum(radii)]
        case "bore on ball":
            return [float(np.linalg.norm(np.cross(a, p - q))) - (radii[0] - radii[1])]
    raise NotImplementedError(kind)


def random_touch(seed: int, *, kinds: tuple[str, ...] | None = None) -> RandomTouch:
    """A touch of up to six equations whose contacts are well independent; the same for a seed."""
    rng = np.random.default_rng(seed)
    while True:
        chosen = kinds or _chosen(rng)
        made = _made(rng, chosen)
        step, nominal = 1e-3, np.zeros(made.assembly.width)
        start = made.assembly.part["part"].pose
        rows = []
        for h in step * np.eye(6):
            moved = start.copy()
            moved[:3, :3] = Rotation.from_rotvec(h[3:] / RADIUS).as_matrix() @ start[:3, :3]
            moved[:3, 3] += h[:3]
            rows.append((made.errors(nominal, moved) - made.errors(nominal, start)) / step)
        assert np.abs(made.errors(nominal, start)).max() < 1e-9
        sizes = np.linalg.svd(np.array(rows).T, compute_uv=False)
        if sizes[-1] > 0.1 * sizes[0]:
            return made


def _chosen(rng: np.random.Generator) -> tuple[str, ...]:
    count, found = int(rng.integers(1, 7)), list[str]()
    while True:
        kind = str(rng.choice(KINDS))
        size = sum(2 if own in TWO else 1 for own in (*found, kind))
        if size > count:
            return tuple(found) or ("ball on plane",)
        found.append(kind)


def _made(rng: np.random.Generator, kinds: tuple[str, ...]) -> RandomTouch:
    draft = Draft()
    for part in ("base", "part"):
        draft.part(part, turned(rng.normal(size=3), 40.0 * rng.normal(size=3)))
    contacts = []
    for k, kind in enumerate(kinds):
        own, _, other = kind.replace("along", "on").replace("across", "on").replace(" in ", " on ").partition(" on ")
        names = f"part.{own} {k}", f"base.{other} {k}"
        distance, shapes = _sizes(rng, own, other)
        normal = _unit(rng.normal(size=3))  # from the target to the part
        touching = 40.0 * rng.normal(size=3)
        start, end = touching + distance * normal, touching
        along = _unit(np.cross(normal, rng.normal(size=3)))
        across = _unit(np.cross(normal, rng.normal(size=3)))
        if "plane" in (own, other) or kind != "cylinder across cylinder":
            across = along
        directions = (-normal if own == "plane" else along), (normal if other == "plane" else across)
        at = (start, end)
        if own == "plane":
            at = (start + 20.0 * across, end)
        elif other == "plane":
            at = (start, end + 20.0 * across)
        elif kind == "cylinder across cylinder":
            at = (start + 8.0 * rng.normal() * along, end + 8.0 * rng.normal() * across)
        elif other in ("cylinder", "bore"):
            at = (start, end + 15.0 * rng.normal() * across)
        elif own in ("cylinder", "bore"):
            at = (start + 15.0 * rng.normal() * along, end)
        for name, point, direction, shape in zip(names, at, directions, shapes, strict=True):
            place = np.linalg.inv(draft.poses[name.split(".")[0]]) @ frame(point, direction)
            draft.feature(name, place, shape)
            if getattr(shape, "diameter", None) is not None:
                draft.size(name)
        contacts.append(Contact(*names))
    draft.feature("part.far", (30, -20, 25))
    draft.feature("base.zero", (0, 0, 0), deviates=False)
    measures = {
        axis: Measured(GapSpec.reads, ("base.zero", "part.far"), own)
        for axis, own in zip("xyz", np.eye(3), strict=True)
    }
    draft.feature("base.side", frame((0, 0, 0), rng.normal(size=3)), Plane((50.0, 40.0)))
    for k, contact in enumerate(contacts):
        pair = (contact.target, contact.moving)
        measures[f"gap {k}"] = Measured(SurfaceGapSpec.reads, pair)
        measures[f"angle {k}"] = Measured(ContactAngleSpec.reads, (*pair, "base.side"))
    assembly = draft.assembly((Fix("fix", "base"), Touch("touch", "part", tuple(contacts))), measures)
    return RandomTouch(assembly, kinds)


def _sizes(rng: np.random.Generator, own: str, other: str) -> tuple[float, tuple[Shape, Shape]]:
    """At what distance two touch, and their shapes."""
    small, large = 2.0 * rng.uniform(5.0, 12.0), 2.0 * rng.uniform(20.0, 40.0)
    if own in ("bore", "socket"):
        return (large - small) / 2, (_shape(own, large), _shape(other, small))
    if other in ("bore", "socket"):
        return (large - small) / 2, (_shape(own, small), _shape(other, large))
    radii = (0.0 if name in ("plane", "point") else size / 2 for name, size in ((own, small), (other, large)))
    return sum(radii), (_shape(own, small), _shape(other, large))


def _shape(word: str, diameter: float) -> Shape:
    match word:
        case "plane":
            return RoundPlane(25.0) if diameter > 30.0 else Plane((30.0, 25.0))
        case "ball" | "socket":
            return Point(diameter, word == "socket")
        case "point":
            return Point()
    return Axis(30.0, diameter, word == "bore")


def _unit(vector: Array) -> Array:
    return np.asarray(vector / np.linalg.norm(vector))
