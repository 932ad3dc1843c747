"""The spherical drive without tolerances: the paper's table, rates, where it is singular, forward and back."""

import numpy as np
import pytest
from linkage.drive_by_hand import drive, tilt
from linkage.linked_bodies import Array
from oracles.spherical_drive import MEANT, MISPRINT, TABLE, rates, travels
from scipy.spatial.transform import Rotation

from tol3d.assembly.linkage.kinematics import Kinematics, Position, UnreachedError

CM = 10.0


@pytest.fixture(scope="module")
def own() -> Kinematics:
    return drive()


def at(own: Kinematics, angle: float, azimuth: float, start: Position | None = None) -> Position:
    """Position with the ring tilted by an angle towards an azimuth [deg]."""
    return own.at_output(tilt(np.radians(angle), np.radians(azimuth)), start)


def nuts(own: Kinematics, position: Position) -> Array:
    found = own.inputs_at(position)
    return np.array([found["travel 1"], found["travel 2"]])


@pytest.mark.parametrize("row", TABLE)
def test_table_1_of_the_paper(own: Kinematics, row: tuple[float, float, float, float]) -> None:
    """Its digits are off by 1.2e-6 cm at most where it is no misprint; the closed formula is met to rounding."""
    angle, azimuth, *printed = row
    found = nuts(own, at(own, angle, azimuth)) / CM
    meant = [MEANT if value == MISPRINT else value for value in printed]
    assert found == pytest.approx(meant, abs=1.2e-6)
    assert found == pytest.approx(travels(np.radians(angle), np.radians(azimuth)) / CM, abs=1e-11)


def test_two_values_of_table_1_are_misprints(own: Kinematics) -> None:
    """30e-6 cm off, 25 times what the others are."""
    off = [
        (angle, azimuth, k)
        for angle, azimuth, *printed in TABLE
        for k, value in enumerate(printed)
        if abs(nuts(own, at(own, angle, azimuth))[k] / CM - value) > 1.2e-6
    ]
    assert off == [(10, 0, 1), (10, 60, 0)]


def test_the_rates_at_20_and_10_degrees(own: Kinematics) -> None:
    """Central differences of the nominal inverse; they are off by step^2 / 6 times the third rate, 1e-7 cm/rad."""
    step = 1e-4

    def there(angle: float, azimuth: float) -> Array:
        return nuts(own, own.at_output(tilt(angle, azimuth))) / CM

    angle, azimuth = np.radians(20.0), np.radians(10.0)
    found = np.array(
        [
            (there(angle + step, azimuth) - there(angle - step, azimuth)) / (2 * step),
            (there(angle, azimuth + step) - there(angle, azimuth - step)) / (2 * step),
        ]
    )
    assert found == pytest.approx(np.array([[2.5770898, -4.8112027], [-2.5740278, -2.0916124]]), abs=2e-7)
    assert found == pytest.approx(rates(angle, azimuth) / CM, abs=2e-7)
    assert np.linalg.det(found) == pytest.approx(-17.774443, abs=2e-6)


@pytest.mark.parametrize("azimuth", [50.93, 129.07])
def test_the_first_singular_pose_is_at_76_1655_degrees(own: Kinematics, azimuth: float) -> None:
    """Within 1e-4 deg; the least singular value falls like the distance, and no pose beyond is reached."""
    near, nearer = (at(own, 76.1655 - off, azimuth).singular[-1] for off in (0.02, 0.01))
    assert near / nearer == pytest.approx(2.0, rel=0.02)
    assert at(own, 76.1653, azimuth).sign == own.drawn.sign
    with pytest.raises(UnreachedError) as caught:
        at(own, 76.1657, azimuth)
    reached = np.degrees(np.linalg.norm(own.tilt_at(caught.value.position)))
    assert 76.0 < reached < 76.1657


@pytest.mark.parametrize(("azimuth", "reaches"), [(50.93, False), (60.0, True), (90.0, True), (40.0, True)])
def test_elsewhere_the_ring_tilts_further(own: Kinematics, azimuth: float, reaches: bool) -> None:
    """By the determinant of the closed formula's rates, which keeps its sign on the way there and no further."""
    ways = np.array(
        [np.linalg.det(rates(angle, np.radians(azimuth))) for angle in np.radians(np.arange(1.0, 76.3, 0.01))]
    )
    assert (ways < 0).all() == reaches
    if reaches:
        assert nuts(own, at(own, 76.2, azimuth)) == pytest.approx(
            travels(np.radians(76.2), np.radians(azimuth)), abs=1e-9
        )
    else:
        with pytest.raises(UnreachedError):
            at(own, 76.2, azimuth)


@pytest.mark.parametrize("angle", [0.0, 1e-5, 1e-3, 30.0, 60.0, 75.0])
def test_forward_and_back_meet_within_1e_10_rad(own: Kinematics, angle: float) -> None:
    for azimuth in np.arange(0.0, 360.0, 45.0) + 5.0:
        there = at(own, angle, azimuth)
        found = nuts(own, there)
        assert found == pytest.approx(travels(np.radians(angle), np.radians(azimuth)), abs=1e-9)
        back = own.at_inputs(dict(zip(("travel 1", "travel 2"), found, strict=True)))
        assert own.tilt_at(back) == pytest.approx(tilt(np.radians(angle), np.radians(azimuth)), abs=1e-10)


def test_travels_beyond_the_curve_have_a_root_on_the_near_branch_and_that_is_kept(own: Kinematics) -> None:
    """By the closed formula both 78 deg and a smaller tilt have these travels; from rest the smaller one is reached."""
    far = np.radians([78.0, 50.93])
    found = own.at_inputs(dict(zip(("travel 1", "travel 2"), travels(*far), strict=True)))
    x, y = own.tilt_at(found)
    angle, azimuth = np.hypot(x, y), np.arctan2(-x, y)
    assert found.sign == own.drawn.sign
    assert 70.0 < np.degrees(angle) < 76.1655
    assert travels(float(angle), float(azimuth)) == pytest.approx(travels(*far), abs=1e-9)
    assert np.linalg.det(rates(float(angle), float(azimuth))) < 0 < np.linalg.det(rates(*far))


def test_on_a_universal_joint_the_nuts_go_elsewhere() -> None:
    """At 40 and 25 deg S1 is -0.10577 cm, not 0.44869 cm."""
    found = nuts(drive("universal"), at(drive("universal"), 40.0, 25.0)) / CM
    assert found[0] == pytest.approx(-0.10577, abs=5e-6)
    assert nuts(drive(), at(drive(), 40.0, 25.0))[0] / CM == pytest.approx(0.44869, abs=5e-6)


def test_gear_2_tilts_twice_as_far_and_does_not_spin(own: Kinematics) -> None:
    """r1 = r2: its rotation vector is twice the ring's, and its centre lies on the ring's axis."""
    there = at(own, 35.0, 110.0)
    gear = there.poses[own.structure.body_of["gear 2"]]
    turned = Rotation.from_matrix(gear[:3, :3]).as_rotvec()
    assert turned[:2] == pytest.approx(2 * tilt(np.radians(35.0), np.radians(110.0)), abs=1e-10)
    assert turned[2] == pytest.approx(0.0, abs=1e-10)
    azimuth, angle = np.radians(110.0), np.radians(35.0)
    out = np.array([np.sin(angle) * np.cos(azimuth), np.sin(angle) * np.sin(azimuth), np.cos(angle)])
    assert gear[:3, 3] == pytest.approx(100.0 * out, abs=1e-9)
