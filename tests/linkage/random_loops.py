"""Loops of joints of any kinds, at random places."""

from collections.abc import Sequence

import numpy as np
from linkage.linked_bodies import Array, Feature, Joint, Linkage, Part, point, random_pose
from oracles.closed_loops import conditioned, facing, followed

FREEDOMS = {"revolute": 1, "prismatic": 1, "screw": 1, "cylindrical": 2, "universal": 2, "swing": 2, "ball": 3}
MOTIONS = {
    "revolute": ("turn",),
    "prismatic": ("slide",),
    "screw": ("turn",),
    "cylindrical": ("turn", "slide"),
    "universal": ("first", "second"),
    "swing": ("x", "y"),
    "ball": (),
}
REACH = 60.0  # mm, of where joints lie
WELL = 300.0  # condition number of the oracle's equations up to which a loop counts


def kinds_at_random(rng: np.random.Generator, freedoms: int) -> list[str]:
    """Joints of so many freedoms together, at most one ball and two slides: more may leave a motion that none holds."""
    while True:
        found: list[str] = []
        while (left := freedoms - sum(FREEDOMS[own] for own in found)) > 0:
            found.append(str(rng.choice([own for own in FREEDOMS if FREEDOMS[own] <= left])))
        if found.count("ball") <= 1 and found.count("prismatic") <= 2 and len(found) >= 3:
            return found


def _direction(rng: np.random.Generator) -> Array:
    own = rng.normal(size=3)
    return np.asarray(own / np.linalg.norm(own))


def _ends(kind: str, rng: np.random.Generator) -> tuple[Array, Array]:
    """Both frames of a joint in the world, as all is drawn (4, 4)."""
    at, z = REACH * rng.uniform(-1, 1, 3), _direction(rng)
    first = facing(z, at)
    if kind == "universal":
        return first, facing(np.cross(z, _direction(rng)), at)
    if kind in ("ball", "swing"):
        return first, facing(_direction(rng), at)
    return first, facing(z * rng.choice([-1.0, 1.0]), at + rng.uniform(-10, 10) * z)


def _drawn(kind: str, frame: Array) -> Feature:
    """By its place and z, which is all that a scene says."""
    return Feature("point" if kind in ("ball", "swing") else "axis", facing(frame[:3, 2], frame[:3, 3]))


def random_loop(
    seed: int, kinds: Sequence[str] | None = None, *, given: int | None = None, two: bool = False
) -> Linkage:
    """A loop of bodies from the frame to the frame; with `two`, a second one that ends on a body of the first.

    Args:
        seed: of its places; the first from there that reaches its far pose and is well conditioned.
        kinds: of its joints, 7 freedoms together; at random if not given.
        given: which joint has the input; any that can if not given.
        two: whether there is a second loop, of 6 freedoms.
    """
    rng = np.random.default_rng(seed)
    while True:
        found = _one(rng, kinds or kinds_at_random(rng, 7), given, two)
        far = followed(found.loops, found.loops, found.poses["on"], found.steps)
        if far is not None and max(conditioned(found.loops, own) for own in (found.loops.bodies, far)) < WELL:
            return found


def _one(rng: np.random.Generator, kinds: Sequence[str], given: int | None, two: bool) -> Linkage:
    placed: dict[str, Array] = {"frame": random_pose(rng, REACH)}
    features: dict[str, dict[str, Feature]] = {"frame": {"zero": point(rng.normal(size=3))}}
    joints: dict[str, Joint] = {}

    def chain(prefix: str, own: Sequence[str], last: str) -> None:
        before = "frame"
        for k, kind in enumerate(own):
            after = last if k == len(own) - 1 else f"{prefix}{k}"
            if after not in placed:
                placed[after] = random_pose(rng, REACH)
                features[after] = {"probe": point(20 * rng.normal(size=3))}
            name, frames = f"{prefix} {k}", _ends(kind, rng)
            for part, frame in zip((before, after), frames, strict=True):
                features[part][name if part != "frame" or before == part else f"{name} last"] = _drawn(
                    kind, np.linalg.inv(placed[part]) @ frame
                )
            names = [f"{before}.{name}", f"{after}.{name if after != 'frame' else f'{name} last'}"]
            if rng.random() < 0.5:
                names.reverse()
            lead = float(rng.uniform(5, 60) * rng.choice([-1, 1])) if kind == "screw" else 0.0
            joints[name] = Joint(kind, names[0], names[1], lead)
            before = after

    chain("a", kinds, "frame")
    if two:
        chain("b", kinds_at_random(rng, 6), f"a{int(rng.integers(len(kinds) - 1))}")
    can = [k for k, kind in enumerate(kinds) if MOTIONS[kind]]
    which = int(rng.choice(can)) if given is None else given
    motion = str(rng.choice(MOTIONS[kinds[which]]))
    order = rng.permutation(list(joints)).tolist()
    own = Linkage(
        {name: Part(placed[name], features[name]) for name in placed},
        ("frame",),
        {name: joints[name] for name in order},
        {"input": (f"a {which}", motion)},
        [f"{name}.probe" for name in placed if name != "frame"],
        {"drawn": {"input": 0.0}, "on": {"input": float(3.0 if motion == "slide" else 0.05)}},
        rng.permutation([name for name in placed if name != "frame"]).tolist(),
        steps=1,
    )
    return own


def open_chain() -> Linkage:
    """Every kind of joint in a row, each motion given: nothing closes."""
    rng = np.random.default_rng(4)
    kinds = ("cylindrical", "universal", "swing", "screw", "revolute", "prismatic", "universal", "swing")
    placed, features = {"frame": random_pose(rng, 20.0)}, {"frame": {"zero": point(rng.normal(size=3))}}
    joints, inputs, before = dict[str, Joint](), dict[str, tuple[str, str]](), "frame"
    for k, kind in enumerate(kinds):
        after, name = f"link {k}", f"joint {k}"
        placed[after] = random_pose(rng, 20.0)
        features[after] = {"probe": point(20 * rng.normal(size=3))}
        for part, frame in zip((before, after), _ends(kind, rng), strict=True):
            features[part][name] = _drawn(kind, np.linalg.inv(placed[part]) @ frame)
        names = [f"{before}.{name}", f"{after}.{name}"]
        on, of = names[::-1] if k >= 5 else names
        joints[name] = Joint(kind, on, of, 12.0 if kind == "screw" else 0.0)
        inputs |= {f"{name} {motion}": (name, motion) for motion in MOTIONS[kind]}
        before = after
    values = {name: float(rng.uniform(-1, 1) * (15.0 if own[1] == "slide" else 0.8)) for name, own in inputs.items()}
    return Linkage(
        {name: Part(placed[name], features[name]) for name in placed},
        ("frame",),
        joints,
        inputs,
        [f"link {k}.probe" for k in (0, 1, 2, 3, 5, 7)],
        {"drawn": dict.fromkeys(inputs, 0.0), "on": values},
    )
