"""Contacts that would have to pull are lost; parts that are welded or placed in sequence touch too."""

from dataclasses import replace

import numpy as np
import pytest
from assembly.drafts import Draft, displacement, frame, turned
from numpy.typing import NDArray
from scipy.optimize import nnls

from tol3d.assembly.model import Assembly, Axis, Contact, Fix, Plane, Point, Touch, Weld
from tol3d.assembly.model.statuses import NO_CONTACT, OK
from tol3d.assembly.placing import method as placing
from tol3d.assembly.torsors import method as torsors
from tol3d.errors import InputError

Array = NDArray[np.float64]


def corner(socket: bool) -> tuple[Assembly, Array]:
    """A ball on three planes, or a ball in a socket on two; and normals of force on the part (3, 3), in the base."""
    draft = Draft()
    draft.part("base", turned((0.4, -0.2, 0.7), (10, 20, 30)))
    draft.part("ball", draft.poses["base"] @ turned((1.0, 0.3, 0.2)))
    normals = np.array([[0.9, 0.1, 0.3], [-0.2, 1.0, 0.1], [0.1, -0.3, 0.8]])
    normals /= np.linalg.norm(normals, axis=1)[:, None]
    draft.feature("ball.surface", turned((0, 0, 0)), Point(20.0))
    contacts = []
    for k, normal in enumerate(normals):
        if socket and k == 2:
            draft.feature("base.2", frame(5.0 * normal), Point(30.0, inner=True))  # touches on the other side
        else:
            draft.feature(
                f"base.{k}", frame(-10.0 * normal + 7.0 * np.cross(normal, normals[k - 1]), normal), Plane((9, 9))
            )
        contacts.append(Contact("ball.surface", f"base.{k}"))
    draft.feature("base.zero", (0, 0, 0))
    measures = {"x": displacement("ball.surface", (1, 0, 0), "base.zero")}
    assembly = draft.assembly((Fix("fix", "base"), Touch("touch", "ball", tuple(contacts))), measures)
    return assembly, normals


@pytest.mark.parametrize("socket", [False, True])
def test_a_force_holds_where_it_is_balanced_by_contacts_that_push(socket: bool) -> None:
    assembly, normals = corner(socket)
    rng, count = np.random.default_rng(4), 0
    for direction in rng.normal(size=(300, 3)):
        direction /= np.linalg.norm(direction)
        pushes, left = nnls(normals.T, -direction)
        touch = assembly.moves[1]
        assert isinstance(touch, Touch)
        pressed = replace(touch, pressed=direction)
        own = replace(assembly, moves=(assembly.moves[0], pressed))
        if left < 1e-9 and pushes.min() > 1e-6:
            _, codes = placing.values(own, np.zeros((1, own.width)), ["x"])["x"]
            assert codes[0] == OK
            count += 1
        else:
            with pytest.raises(InputError, match="ball has no contact even without deviations"):
                placing.values(own, np.zeros((1, own.width)), ["x"])
    assert 20 < count < 280


def test_a_lost_contact_is_lost_in_the_trials_that_lose_it() -> None:
    """A ball between two walls of a V, pressed along the one nearly: tilts of that wall decide."""
    draft = Draft()
    draft.part("base")
    draft.part("ball", turned((0, 0, 0), (0, 0, 0)))
    draft.feature("ball.surface", turned((0, 0, 0)), Point(20.0))
    draft.feature("base.floor", frame((0, -10, 0), (0, 1, 0)), Plane((40.0, 40.0)))
    draft.feature("base.wall", frame((-10, 0, 0), (1, 0, 0), (0, 1, 0)), Plane((40.0, 40.0)))
    contacts = (Contact("ball.surface", "base.floor"), Contact("ball.surface", "base.wall"))
    pressed = np.array([-0.001, -1.0, 0.0]) / np.sqrt(1.0 + 1e-6)
    measures = {"x": displacement("ball.surface", (1, 0, 0), "base.floor")}
    assembly = draft.assembly((Fix("fix", "base"), Touch("touch", "ball", contacts, pressed)), measures)
    tilt = np.random.default_rng(5).normal(size=400) * 0.03  # rise of the floor at its end: 20 mm
    deviations = np.zeros((400, assembly.width))
    deviations[:, draft.columns.index("base.floor rise x")] = tilt
    _, codes = placing.values(assembly, deviations, ["x"])["x"]
    # the floor pushes along (-tilt / 20, 1): the wall has to push what the force has beyond that
    assert codes.tolist() == np.where(-tilt / 20.0 < 0.001, OK, NO_CONTACT).tolist()
    assert 0.05 < (codes == NO_CONTACT).mean() < 0.6


def test_welded_bodies_and_sequences_touch_alike() -> None:
    """A carrier with a roller welded to it lies on a floor by the roller and a ball of its own, then carries a disc."""
    draft = Draft()
    pose = turned((0.2, 0.5, -0.3), (15, -5, 8))
    draft.part("base", pose)
    draft.part("carrier", pose @ turned((0, 0, 0), (30, 12, 0)))
    draft.part("roller", pose @ turned((0, 0, 0), (0, 10, 0)))
    draft.part("disc", pose @ turned((0, 0, 0), (45, 32, 0)))
    draft.feature("base.floor", frame((20, 0, 0), (0, 1, 0)), Plane((120.0, 60.0)))
    draft.feature("base.stop", frame((-10, 20, 0), (1, 0, 0), (0, 1, 0)), Plane((40.0, 60.0)))
    draft.feature("base.post", frame((59, 32, 0)), Axis(30.0, 8.0))
    draft.feature("roller.rim", turned((0, 0, 0)), Axis(25.0, 20.0))
    draft.feature("carrier.foot", frame((40, -7, 0)), Point(10.0))
    draft.feature("carrier.top", frame((10, 10, 0), (0, 1, 0)), Plane((60.0, 30.0)))
    draft.feature("disc.rim", turned((0, 0, 0)), Axis(10.0, 20.0))
    for name in ("roller.rim", "carrier.foot", "disc.rim", "base.post"):
        draft.size(name)
    draft.feature("disc.far", (3, 4, 5))
    draft.feature("base.zero", (0, 0, 0))
    moves = (
        Fix("base fixed", "base"),
        Fix("carrier drawn", "carrier"),
        Fix("roller drawn", "roller"),
        Weld("weld", "carrier", ("roller",)),
        Touch("lay", "carrier", (Contact("roller.rim", "base.floor"), Contact("roller.rim", "base.stop"),
                                 Contact("carrier.foot", "base.floor"))),
        Touch("put", "disc", (Contact("disc.rim", "carrier.top"), Contact("disc.rim", "base.post"))),
    )  # fmt: skip
    measures = dict(zip("xyz", [displacement("disc.far", axis, "base.zero") for axis in np.eye(3)], strict=True))
    assembly = draft.assembly(moves, measures)
    deviations = np.random.default_rng(6).normal(size=(40, assembly.width)) * 0.02
    poses = placing.placed(assembly, deviations)
    features = placing.features_placed(assembly, deviations)

    def size(name: str, nominal: float) -> Array:
        return nominal + deviations[:, draft.columns.index(f"{name} size")]

    floor, stop, top = (features[f"{name}"] for name in ("base.floor", "base.stop", "carrier.top"))
    for feature, plane, radius in (
        ("roller.rim", floor, size("roller.rim", 20.0) / 2),
        ("roller.rim", stop, size("roller.rim", 20.0) / 2),
        ("carrier.foot", floor, size("carrier.foot", 10.0) / 2),
        ("disc.rim", top, size("disc.rim", 20.0) / 2),
    ):
        apart = features[feature][:, :3, 3] - plane[:, :3, 3]
        np.testing.assert_allclose((apart * plane[:, :3, 2]).sum(axis=1), radius, rtol=0.0, atol=1e-10)
    post, disc = features["base.post"], features["disc.rim"]
    distance = np.linalg.norm(np.cross(post[:, :3, 2], disc[:, :3, 3] - post[:, :3, 3]), axis=1)
    np.testing.assert_allclose(distance, (size("disc.rim", 20.0) + size("base.post", 8.0)) / 2, rtol=0.0, atol=1e-10)
    relative = np.linalg.inv(poses["carrier"]) @ poses["roller"]
    np.testing.assert_allclose(relative, np.broadcast_to(relative[0], relative.shape), rtol=0.0, atol=1e-12)
    for name in measures:
        whole, tenth = (
            np.abs(placing.values(assembly, own, [name])[name][0] - torsors.values(assembly, own, [name])[name]).max()
            for own in (deviations, 0.1 * deviations)
        )
        assert whole < 5e-3
        assert tenth < 1.3e-2 * whole + 1e-11
