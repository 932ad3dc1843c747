"""Linkages of every kind, by numbers."""

import numpy as np
from linkage.linked_bodies import Array, Joint, Linkage, Part, axis, point, sphere
from oracles.closed_loops import pose

ZERO = {"zero": point((0.0, 0.0, 0.0))}


def placed(
    at: Array | tuple[float, float, float] = (0.0, 0.0, 0.0), turn: tuple[float, float, float] = (0, 0, 0)
) -> Array:
    return pose(turn, at)


CRANK, ROD, GUIDE = 30.0, 100.0, np.array([0.0, 15.0, 8.0])


def slider_crank() -> Linkage:
    """Spatial: the guide runs along x, off the plane of the crank; revolute, ball, universal, prismatic."""
    pin = np.array([0.0, CRANK, 0.0])
    x = GUIDE[0] + np.sqrt(ROD**2 - (CRANK - GUIDE[1]) ** 2 - GUIDE[2] ** 2)
    end = np.array([x, GUIDE[1], GUIDE[2]])
    along = end - pin
    square = np.cross(along, [0.0, 0.0, 1.0])
    return Linkage(
        parts={
            "frame": Part(
                placed(),
                {**ZERO, "shaft": axis((0, 0, 0), (0, 0, 1)), "guide": axis((100.0, *GUIDE[1:]), (1, 0, 0), 60.0)},
            ),
            "crank": Part(
                placed(), {"bore": axis((0, 0, 0), (0, 0, 1)), "pin": point(pin), "probe": point((12.0, 30.0, 5.0))}
            ),
            "rod": Part(
                placed(pin),
                {"big": point((0, 0, 0)), "small": axis(along, square, 10.0), "probe": point(along / 2 + [0, 0, 9.0])},
            ),
            "slider": Part(
                placed(end),
                {
                    "sleeve": axis((0, 0, 0), (1, 0, 0)),
                    "pin": axis((0, 0, 0), (0, 0, 1)),
                    "probe": point((10.0, 4.0, -3.0)),
                },
            ),
        },
        fixed=("frame",),
        joints={
            "main": Joint("revolute", "frame.shaft", "crank.bore"),
            "big": Joint("ball", "crank.pin", "rod.big"),
            "small": Joint("universal", "rod.small", "slider.pin"),
            "slide": Joint("prismatic", "frame.guide", "slider.sleeve"),
        },
        inputs={"angle": ("main", "turn")},
        probes=("crank.probe", "rod.probe", "slider.probe"),
        poses={"up": {"angle": 0.0}, "far": {"angle": -0.9}, "back": {"angle": 2.2}},
    )


FOUR = {"crank": 40.0, "coupler": 110.0, "rocker": 80.0, "ground": 120.0}


def four_bar_points(angle: float) -> tuple[Array, Array]:
    """Joints of crank and coupler, and of coupler and rocker: by the cosine rule."""
    first = FOUR["crank"] * np.array([np.cos(angle), np.sin(angle)])
    away = np.array([FOUR["ground"], 0.0]) - first
    far = float(np.linalg.norm(away))
    inner = np.arccos((FOUR["coupler"] ** 2 + far**2 - FOUR["rocker"] ** 2) / (2 * FOUR["coupler"] * far))
    at = np.arctan2(away[1], away[0]) + inner
    return first, first + FOUR["coupler"] * np.array([np.cos(at), np.sin(at)])


def four_bar(angle: float = 1.1) -> Linkage:
    """Planar: revolute, ball, cylindrical, revolute."""
    first, last = four_bar_points(angle)
    a, b = np.append(first, 0.0), np.append(last, 0.0)
    ground = (FOUR["ground"], 0.0, 0.0)
    return Linkage(
        parts={
            "frame": Part(placed(), {**ZERO, "A": axis((0, 0, 0), (0, 0, 1)), "D": axis(ground, (0, 0, 1))}),
            "crank": Part(placed(), {"A": axis((0, 0, 0), (0, 0, 1)), "B": point(a), "probe": point((9.0, 20.0, 6.0))}),
            "coupler": Part(
                placed(a),
                {
                    "B": point((0, 0, 0)),
                    "C": axis(b - a, (0, 0, 1), 30.0),
                    "probe": point((b - a) / 2 + [3.0, 8.0, -5.0]),
                },
            ),
            "rocker": Part(
                placed(ground),
                {
                    "C": axis(b - ground, (0, 0, 1), 30.0),
                    "D": axis((0, 0, 0), (0, 0, 1)),
                    "probe": point((5.0, 30.0, 2.0)),
                },
            ),
        },
        fixed=("frame",),
        joints={
            "a": Joint("revolute", "frame.A", "crank.A"),
            "b": Joint("ball", "crank.B", "coupler.B"),
            "c": Joint("cylindrical", "coupler.C", "rocker.C"),
            "d": Joint("revolute", "frame.D", "rocker.D"),
        },
        inputs={"angle": ("a", "turn")},
        probes=("crank.probe", "coupler.probe", "rocker.probe"),
        poses={"here": {"angle": 0.0}, "on": {"angle": 1.5}, "round": {"angle": 4.0}},
    )


def rssr() -> Linkage:
    """Crank and rocker about skew axes, a rod between two balls."""
    skew = np.array([0.3, -0.8, 0.52])
    pivot, b, c = np.array([130.0, 10.0, 20.0]), np.array([0.0, 35.0, 5.0]), np.array([140.0, 60.0, 75.0])
    return Linkage(
        parts={
            "frame": Part(placed(), {**ZERO, "A": axis((0, 0, 0), (0, 0, 1)), "D": axis(pivot, skew)}),
            "crank": Part(placed(), {"A": axis((0, 0, 0), (0, 0, 1)), "B": point(b), "probe": point((9.0, 20.0, 6.0))}),
            "rod": Part(placed(b), {"B": point((0, 0, 0)), "C": point(c - b)}),
            "rocker": Part(
                placed(pivot), {"C": point(c - pivot), "D": axis((0, 0, 0), skew), "probe": point((5.0, 30.0, 2.0))}
            ),
        },
        fixed=("frame",),
        joints={
            "a": Joint("revolute", "frame.A", "crank.A"),
            "b": Joint("ball", "crank.B", "rod.B"),
            "c": Joint("ball", "rod.C", "rocker.C"),
            "d": Joint("revolute", "frame.D", "rocker.D"),
        },
        inputs={"angle": ("a", "turn")},
        probes=("crank.probe", "rocker.probe"),
        poses={"here": {"angle": 0.0}, "on": {"angle": 0.8}, "back": {"angle": -0.5}},
    )


def stewart(seed: int = 0) -> Linkage:
    """Six legs, each a cylinder on a universal joint and a piston that ends in a ball."""
    rng = np.random.default_rng(seed)
    angles = np.radians([-10, 10, 110, 130, 230, 250])
    base = np.stack([150 * np.cos(angles), 150 * np.sin(angles), np.zeros(6)], axis=1) + rng.uniform(-8, 8, (6, 3))
    turned = np.radians([-50, 50, 70, 170, 190, 290])
    top = np.stack([90 * np.cos(turned), 90 * np.sin(turned), np.zeros(6)], axis=1) + rng.uniform(-8, 8, (6, 3))
    platform = pose(rng.uniform(-0.1, 0.1, 3), np.array([0.0, 0.0, 180.0]) + rng.uniform(-10, 10, 3))
    parts = {
        "frame": Part(placed(), dict(ZERO)),
        "platform": Part(
            platform,
            {"probe": point((10.0, 20.0, 5.0)), "other": point((-30.0, 15.0, -8.0)), "third": point((7.0, -40.0, 3.0))},
        ),
    }
    joints, inputs = dict[str, Joint](), dict[str, tuple[str, str]]()
    frame, plate = dict(ZERO), dict(parts["platform"].features)
    for k in range(6):
        end = (platform @ np.append(top[k], 1.0))[:3]
        along = end - base[k]
        first = np.cross(along, [1.0, 0.2, 0.1])
        second = np.cross(first, along)
        length = float(np.linalg.norm(along))
        frame[f"foot {k}"] = axis(base[k], first)
        plate[f"ball {k}"] = point(top[k])
        # the cylinder's second axis lies across the first; the leg slides along the third direction
        parts[f"cylinder {k}"] = Part(
            placed(base[k]), {"foot": axis((0, 0, 0), second), "bore": axis(along / 2, along, 60.0)}
        )
        parts[f"piston {k}"] = Part(placed(base[k]), {"rod": axis(along / 2, along, 60.0), "ball": point(along)})
        joints |= {
            f"foot {k}": Joint("universal", f"frame.foot {k}", f"cylinder {k}.foot"),
            f"leg {k}": Joint("prismatic", f"cylinder {k}.bore", f"piston {k}.rod"),
            f"ball {k}": Joint("ball", f"piston {k}.ball", f"platform.ball {k}"),
        }
        inputs[f"length {k}"] = f"leg {k}", "slide"
        assert length > 0
    parts = {"frame": Part(placed(), frame), **parts}
    parts["frame"], parts["platform"] = Part(placed(), frame), Part(platform, plate)
    poses = {
        "drawn": dict.fromkeys(inputs, 0.0),
        "far": dict(zip(inputs, (12.0, -8.0, 15.0, 4.0, -11.0, 6.0), strict=True)),
    }
    return Linkage(parts, ("frame",), joints, inputs, ("platform.probe", "platform.other", "platform.third"), poses)


def delta() -> Linkage:
    """Three arms about tangents, each with two rods to a platform that never turns."""
    base, arm, plate, rod, half = 100.0, 90.0, 40.0, 200.0, 25.0
    down = 60.0
    high = np.sqrt(rod**2 - (base + arm * np.cos(np.radians(down)) - plate) ** 2)
    centre = np.array([0.0, 0.0, -arm * np.sin(np.radians(down)) - high])
    frame, top = (
        dict(ZERO),
        {"probe": point((3.0, 5.0, -4.0)), "other": point((-20.0, 8.0, 2.0)), "third": point((1.0, 15.0, 7.0))},
    )
    parts, joints, inputs = {}, {}, {}
    for k in range(3):
        out = np.array([np.cos(2 * np.pi * k / 3), np.sin(2 * np.pi * k / 3), 0.0])
        side = np.cross([0.0, 0.0, 1.0], out)
        elbow = arm * (np.cos(np.radians(down)) * out - np.sin(np.radians(down)) * np.array([0.0, 0.0, 1.0]))
        frame[f"arm {k}"] = axis(base * out, side)
        features = {"bore": axis((0, 0, 0), side)}
        for j, sign in enumerate((-1.0, 1.0)):
            features[f"elbow {j}"] = point(elbow + sign * half * side)
            top[f"ball {k} {j}"] = point(plate * out + sign * half * side)
            start = base * out + elbow + sign * half * side
            end = centre + plate * out + sign * half * side
            parts[f"rod {k} {j}"] = Part(placed(start), {"start": point((0, 0, 0)), "end": point(end - start)})
            joints[f"elbow {k} {j}"] = Joint("ball", f"arm {k}.elbow {j}", f"rod {k} {j}.start")
            joints[f"wrist {k} {j}"] = Joint("ball", f"rod {k} {j}.end", f"platform.ball {k} {j}")
        parts[f"arm {k}"] = Part(placed(base * out), features)
        joints[f"shoulder {k}"] = Joint("revolute", f"frame.arm {k}", f"arm {k}.bore")
        inputs[f"angle {k}"] = f"shoulder {k}", "turn"
    return Linkage(
        {"frame": Part(placed(), frame), "platform": Part(placed(centre), top), **parts},
        ("frame",),
        joints,
        inputs,
        ("platform.probe", "platform.other", "platform.third"),
        {"drawn": dict.fromkeys(inputs, 0.0), "far": dict(zip(inputs, (0.3, -0.2, 0.25), strict=True))},
    )


def swash(kind: str = "swing") -> Linkage:
    """A plate on a swing or universal joint, pushed by two inclined screws and rods of unequal length."""
    frame = {**ZERO, "centre": point((0, 0, 0), (0.1, -0.2, 1.0))}
    plate = {
        "centre": point((0, 0, 0), (0.05, 0.1, 1.0)),
        "probe": point((10.0, 12.0, 5.0)),
        "other": point((-8.0, 3.0, 9.0)),
    }
    parts, joints, inputs = {}, {}, {}
    if kind == "universal":
        frame["yoke"], plate["yoke"] = axis((0, 0, 0), (1.0, 0.3, 0.0)), axis((0, 0, 0), (-0.3, 1.0, 0.4))
        joints["middle"] = Joint("universal", "frame.yoke", "plate.yoke")
    else:
        joints["middle"] = Joint("swing", "frame.centre", "plate.centre")
    for k, (ball, rod, guide) in enumerate(
        (
            ((-40.0, 69.0, 3.0), (4.0, -7.0, 240.0), (0.1, 0.05, 1.0)),
            ((42.0, 65.0, -2.0), (-6.0, 3.0, 215.0), (-0.12, 0.02, 1.0)),
        )
    ):
        end = np.array(ball)
        foot = end - np.array(rod)
        frame[f"guide {k}"] = axis(foot, guide, 100.0)
        plate[f"ball {k}"] = point(end)
        parts[f"nut {k}"] = Part(placed(foot), {"bore": axis((0, 0, 0), guide, 30.0), "ball": point((1.0, 2.0, 3.0))})
        parts[f"rod {k}"] = Part(placed(foot), {"low": point((1.0, 2.0, 3.0)), "high": point(end - foot)})
        joints |= {
            f"guide {k}": Joint("screw", f"frame.guide {k}", f"nut {k}.bore", lead=5.0 + 90.0 * k),
            f"low {k}": Joint("ball", f"nut {k}.ball", f"rod {k}.low"),
            f"high {k}": Joint("ball", f"rod {k}.high", f"plate.ball {k}"),
        }
        inputs[f"turn {k}"] = f"guide {k}", "turn"
    return Linkage(
        {"frame": Part(placed(), frame), "plate": Part(placed(), plate), **parts},
        ("frame",),
        joints,
        inputs,
        ("plate.probe", "plate.other"),
        {"drawn": dict.fromkeys(inputs, 0.0), "tilted": {"turn 0": 2.5, "turn 1": -2.0}},
    )


def planet() -> Linkage:
    """A spherical gear that rolls on a fixed one, on a ring that swings by its two tilts."""
    frame = {**ZERO, "centre": point((0, 0, 0)), "sphere": sphere((0, 0, 0), 100.0)}
    ring = {"centre": point((0, 0, 0)), "probe": point((10.0, 12.0, 5.0))}
    gear = {"sphere": sphere((0, 0, 0), 80.0), "probe": point((3.0, 6.0, 25.0)), "other": point((9.0, -6.0, 5.0))}
    return Linkage(
        {"frame": Part(placed(), frame), "ring": Part(placed(), ring), "gear": Part(placed((0.0, 0.0, 90.0)), gear)},
        ("frame",),
        {
            "swing": Joint("swing", "frame.centre", "ring.centre"),
            "roll": Joint("rolling", "frame.sphere", "gear.sphere", carrier="ring"),
        },
        {"tilt x": ("swing", "x"), "tilt y": ("swing", "y")},
        ("ring.probe", "gear.probe", "gear.other"),
        {"rest": {"tilt x": 0.0, "tilt y": 0.0}, "tilted": {"tilt x": 0.5, "tilt y": -0.7}},
    )


ALL = {
    "slider crank": slider_crank,
    "four-bar": four_bar,
    "rssr": rssr,
    "stewart": stewart,
    "delta": delta,
    "swash on swing": swash,
    "swash on universal": lambda: swash("universal"),
    "planet": planet,
}
