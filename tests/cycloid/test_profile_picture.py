"""The picture of a profile: how far its clearance is magnified, and that it is drawn for every kind of modification."""

from dataclasses import replace
from pathlib import Path

import pytest
from disc_profile import draw_profile, magnified_by

from tol3d.gearing.cycloid.model.profile import UNMODIFIED, DiscProfile, Modification

RV_250 = DiscProfile(pins=40, pin_circle_radius=114.5, pin_radius=5.0, eccentricity=2.2)


@pytest.mark.parametrize(
    ("modification", "factor"),
    # half a pin's radius is 2.5 mm: over 7.2 um 347, over 20 um 125, over 3 mm less than 1
    [
        (Modification(-0.02, -0.0128), 200),
        (Modification(offset=0.02), 100),
        (Modification(offset=3.0), 1),
        (UNMODIFIED, 1),
    ],
)
def test_the_largest_clearance_is_drawn_as_up_to_half_a_pins_radius(modification: Modification, factor: float) -> None:
    assert magnified_by(replace(RV_250, modification=modification)) == factor


def test_a_profile_is_drawn(tmp_path: Path) -> None:
    draw_profile(replace(RV_250, modification=Modification(-0.02, -0.0128, 1e-5)), tmp_path / "profile.svg")
    drawn = (tmp_path / "profile.svg").read_text("utf-8")
    assert drawn.count("<path") > 50
