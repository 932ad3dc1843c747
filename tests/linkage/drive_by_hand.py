"""The spherical drive as joints by hand, without a scene: its kinematics alone."""

from typing import Literal

import numpy as np
from linkage.linked_bodies import Array
from oracles.spherical_drive import HALF, RADIUS, ROD

from tol3d.assembly.linkage.kinematics import Kinematics
from tol3d.assembly.linkage.structure import KINDS, Joint, Output, structured


def at(x: float, y: float, z: float) -> Array:
    found = np.eye(4)
    found[:3, 3] = x, y, z
    return found


def turned(columns: tuple[int, int, int]) -> Array:
    """Axes of the world by their places."""
    found = np.eye(4)
    found[:3, :3] = np.eye(3)[:, list(columns)]
    return found


def drive(middle: Literal["swing", "universal"] = "swing") -> Kinematics:
    """The ring on a swing joint, or on a universal one whose first axis, x, is the frame's."""
    balls = [RADIUS * np.array([np.cos(own), np.sin(own), 0.0]) for own in (np.pi / 2 + HALF, np.pi / 2 - HALF)]
    drawn = {"frame": np.eye(4), "gear 1": np.eye(4), "ring": np.eye(4), "gear 2": at(0.0, 0.0, 100.0)}
    frames = dict.fromkeys(
        ("frame.centre", "ring.centre", "gear 1.sphere", "gear 2.sphere", "ring.axis", "frame.axis"), np.eye(4)
    )
    joints = [Joint("roll", KINDS["rolling"], "gear 1.sphere", "gear 2.sphere", ratio=2.0, carrier="ring")]
    if middle == "swing":
        joints.append(Joint("middle", KINDS["swing"], "frame.centre", "ring.centre"))
    else:
        frames |= {"frame.yoke": turned((1, 2, 0)), "ring.yoke": turned((2, 0, 1))}
        joints.append(Joint("middle", KINDS["universal"], "frame.yoke", "ring.yoke"))
    for k, ball in enumerate(balls, start=1):
        foot = at(ball[0], ball[1], -ROD)
        drawn |= {f"nut {k}": foot, f"rod {k}": foot}
        frames |= {f"frame.guide {k}": foot, f"ring.ball {k}": at(*ball), f"rod {k}.top": at(0.0, 0.0, ROD)}
        frames |= dict.fromkeys((f"nut {k}.axis", f"nut {k}.ball", f"rod {k}.bottom"), np.eye(4))
        joints += [
            Joint(f"guide {k}", KINDS["prismatic"], f"frame.guide {k}", f"nut {k}.axis"),
            Joint(f"lower {k}", KINDS["ball"], f"nut {k}.ball", f"rod {k}.bottom"),
            Joint(f"upper {k}", KINDS["ball"], f"rod {k}.top", f"ring.ball {k}"),
        ]
    bodies = ["ring", "gear 2", "rod 1", "nut 1", "rod 2", "nut 2"]
    inputs = {f"travel {k}": (f"guide {k}", 0) for k in (1, 2)}
    return Kinematics(
        structured("drive", bodies, joints, inputs, Output("ring.axis", "frame.axis", False), drawn, frames, None),
        drawn,
    )


def tilt(angle: float, azimuth: float) -> Array:
    """The rotation vector (2,) of a tilt towards an azimuth [rad]."""
    return angle * np.array([-np.sin(azimuth), np.cos(azimuth)])
