"""Composite tolerances: a pattern in its upper zone, its features in narrower ones, both held in every trial."""

import math
from collections.abc import Mapping
from pathlib import Path

import numpy as np
import pytest
from assembly.composite_plate import columns, plate
from assembly_trials import Assembled, assembled
from numpy.typing import NDArray
from of_kind import known, of_kind
from scene_texts import Edit, edited, refusal, scene_of
from scipy.spatial.transform import Rotation

from tol3d.assembly.grammar.tolerances.location import PositionSpec
from tol3d.assembly.moments import moments_of
from tol3d.study.system.contributor import Contributor
from tol3d.study.trials.draws import drawn

Array = NDArray[np.float64]

UPPER, LOWER = 0.3, 0.1
PITCH = (40.0, 20.0)
PLACES = np.array([[-20.0, -10.0], [20.0, -10.0], [-20.0, 10.0], [20.0, 10.0]])
LEVER = math.hypot(20.0, 10.0)
HOLES = [f"holes {k}" for k in range(1, 5)]


def ends_of(made: Assembled, deviations: Array) -> tuple[Array, Array]:
    """Ends of the holes (trials, holes, ends, 2) off their true places, and off the pattern's; by hand."""
    own = columns(made)
    motion = deviations[:, own["holes shift and turn"]]
    spin = np.stack([-PLACES[:, 1], PLACES[:, 0]], axis=1) / LEVER
    pattern = motion[:, None, :2] + motion[:, 2, None, None] * spin
    free = np.stack([deviations[:, own[hole]].reshape(-1, 2, 2) for hole in HOLES], axis=1)
    return pattern[:, :, None] + free, free


@pytest.mark.parametrize("law", ["uniform", "normal"])
def test_a_million_builds_hold_both_segments(law: str, tmp_path: Path) -> None:
    """Every end of every hole, straight from the draws; a tenth of the room or less is left unused."""
    made = assembled(plate(law), tmp_path)
    most, least, block = 0.0, 0.0, 100_000
    for first in range(0, 1_000_000, block):
        upper, lower = ends_of(made, drawn(made.simulation, first, block).deviations)
        most = max(most, float(np.hypot(*np.moveaxis(upper, -1, 0)).max()))
        least = max(least, float(np.hypot(*np.moveaxis(lower, -1, 0)).max()))
    assert 0.9 * UPPER / 2 < most <= UPPER / 2 * (1 + 1e-12)
    assert 0.9 * LOWER / 2 < least <= LOWER / 2 * (1 + 1e-12)


def test_what_moves_the_holes_is_what_their_measures_read(tmp_path: Path) -> None:
    """By hand from the draws, without the datum's tilt; a gauge of four pins finds each pattern in the lower zone.

    A turn is a small displacement: it widens a pattern by half of its square, 22 mm (0.1/22)²/2 = 0.23 um a side.
    """
    made = assembled(plate().replace("width: 0.05 mm}, law", "width: 0.001 um}, law"), tmp_path)
    found, deviations = made.drawn(400), drawn(made.simulation, 0, 400).deviations
    upper, _ = ends_of(made, deviations)
    assert found["upper"] == pytest.approx(2 * np.hypot(*np.moveaxis(upper[:, 1], -1, 0)).max(axis=1), abs=2e-6)
    assert found["x"] == pytest.approx(70.0 - upper[:, 0, :, 0].mean(axis=1), abs=2e-6)
    assert found["lower"].max() < LOWER
    assert found["upper"].max() > LOWER


def test_the_motion_has_the_law_that_rejection_has(tmp_path: Path) -> None:
    """Shift and turn uniform where their lengths sum up to 0.1: sigmas by 10^6 draws of the box, kept inside."""
    made = assembled(plate(), tmp_path)
    box = np.random.default_rng(1).uniform(-1, 1, (1_000_000, 3)) * 0.1
    kept = box[np.hypot(box[:, 0], box[:, 1]) + np.abs(box[:, 2]) <= 0.1]
    own = next(own for own in made.system.contributors if own.name == "holes shift and turn")
    mean, covariance = moments_of(own)
    assert np.abs(mean).max() == 0.0
    assert np.sqrt(np.diagonal(covariance)) == pytest.approx(kept.std(axis=0), rel=4 / math.sqrt(len(kept)))


@pytest.mark.parametrize("law", ["uniform", "normal"])
def test_both_methods_differ_by_second_order(law: str, tmp_path: Path) -> None:
    made = assembled(plate(law), tmp_path)
    trials = drawn(made.simulation, 0, 200)
    apart = []
    for scale in (1.0, 0.25):
        exact, linear = (made.values(trials.scaled(scale), method) for method in ("exact", "analytic"))
        apart.append({name: float(np.abs(exact[name] - linear[name]).max()) for name in exact})
    for name in ("x", "upper", "lower"):
        assert apart[1][name] < max(apart[0][name] / 10, 1e-12)
        assert apart[0][name] < 1e-3


def displaced(made: Assembled, feature: str) -> Array:
    """Covariance of a feature's components by all that moves it but its datums, from the closed moments."""
    own: Mapping[str, Contributor] = {own.name: own for own in made.system.contributors}
    found = np.zeros((4, 4))
    for each in made.system.assembly.features[feature].moved_by:
        found += each.matrix @ moments_of(own[each.contributor])[1] @ each.matrix.T
    return np.asarray(found)


COVERED = {"none": "zone: {diameter: 0.1 mm}", "A": "zone: {diameter: 0.1 mm}, datums: [A]"}


@pytest.mark.parametrize("lower", COVERED.values(), ids=COVERED)
@pytest.mark.parametrize("seed", [1, 2])
def test_coordinates_of_the_part_change_nothing(lower: str, seed: int, tmp_path: Path) -> None:
    """Shifted ones trial by trial; turned ones where features state their x, as pads do. Holes state none, and keep
    the moments of their ends by length."""
    rng = np.random.default_rng(seed)
    turn, at = Rotation.random(rng=rng).as_matrix(), rng.uniform(-500, 500, 3)
    here, moved = (assembled(plate(lower=lower, at=own), tmp_path) for own in (np.zeros(3), at))
    before, after = here.drawn(50), moved.drawn(50)
    for name in ("x", "upper", "lower", "pad"):
        np.testing.assert_allclose(after[name], before[name], rtol=0, atol=1e-9)
    turned = assembled(plate(lower=lower, at=at, turn=turn), tmp_path)
    np.testing.assert_allclose(turned.drawn(50)["pad"], before["pad"], rtol=0, atol=1e-9)
    for k in range(1, 5):
        sizes = [np.linalg.eigvalsh(displaced(own, f"plate.hole {k}")) for own in (here, turned)]
        np.testing.assert_allclose(sizes[0], sizes[1], rtol=1e-9)


@pytest.mark.parametrize(
    ("lower", "components"),
    [
        ("datums: [A]", 3),  # shifts, and the turn about A's normal
        ("datums: [A, B]", 2),  # B holds it, by its direction alone
        ("datums: [A, B, C]", 2),  # and never a place
        ("", 5),  # both tilts too
    ],
)
def test_the_lower_segment_frees_all_shifts_and_the_turns_that_its_datums_leave(
    lower: str, components: int, tmp_path: Path
) -> None:
    words = "zone: {diameter: 0.1 mm}" + (f", {lower}" if lower else "")
    made = assembled(plate(lower=words), tmp_path)
    (own,) = (own for own in made.system.contributors if own.name.startswith("holes shift"))
    assert len(own.draw.components) == components
    assert own.name == ("holes shift" if components == 2 else "holes shift and turn")


def test_names_and_the_order_of_features_change_nothing(tmp_path: Path) -> None:
    """Draws are by the names of tolerances: the same bits where features have other names and another order."""
    text = plate()
    pads = next(line for line in text.splitlines(keepends=True) if line.startswith("      pad: "))
    other = text.replace(pads, "").replace("    features:\n", f"    features:\n{pads}")
    other = other.replace("plate.hole", "plate.bore").replace("      hole: ", "      bore: ")
    before, after = (assembled(own, tmp_path).drawn(50) for own in (text, other))
    for name, values in before.items():
        np.testing.assert_array_equal(after[name], values)


def test_pads_that_may_tilt_together_stay_in_both_zones_at_all_corners(tmp_path: Path) -> None:
    """Without datums the lower segment makes pads flush: they shift along their normal and tilt as one."""
    made = assembled(plate(), tmp_path)
    own = columns(made)
    deviations = drawn(made.simulation, 0, 100_000).deviations
    corners = np.array([(1, 1), (-1, 1), (-1, -1), (1, -1)])
    total = []
    for k in range(1, 5):
        feature = made.system.assembly.features[f"plate.pad {k}"]
        parts = {each.contributor: deviations[:, each.columns] @ each.matrix.T for each in feature.moved_by}
        assert set(parts) == {f"pads {k}", "pads shift and turn"}
        assert np.abs(parts[f"pads {k}"][:, :1] + parts[f"pads {k}"][:, 1:] @ corners.T).max() <= 0.025 * (1 + 1e-12)
        both = moved_by(made, f"plate.pad {k}", deviations)
        total.append(np.abs(both[:, :1] + both[:, 1:] @ corners.T).max())
    assert 0.085 < max(total) <= 0.1 * (1 + 1e-12)
    assert own["pads shift and turn"].stop - own["pads shift and turn"].start == 3


def moved_by(made: Assembled, feature: str, deviations: Array) -> Array:
    """Components (trials, components) of a feature by all that moves it."""
    found = made.system.assembly.features[feature].moved_by
    return np.asarray(np.sum([deviations[:, own.columns] @ own.matrix.T for own in found], axis=0))


def test_a_flat_and_a_projected_zone_hold_both_segments_where_they_judge(tmp_path: Path) -> None:
    flat = "{width: 0.1 mm, along: [1, 0, 0]}, datums: [A]"
    made = assembled(plate(upper="{width: 0.3 mm, along: [1, 0, 0]}", lower=f"zone: {flat}"), tmp_path)
    deviations = drawn(made.simulation, 0, 100_000).deviations
    for k in range(1, 5):
        moved = moved_by(made, f"plate.hole {k}", deviations)
        assert 0.12 < np.abs(moved[:, [0, 2]]).max() <= 0.15 * (1 + 1e-12)
        assert np.abs(moved[:, [1, 3]]).max() == 0.0
    projected = "zone: {diameter: 0.1 mm, projected: 30 mm}"
    made = assembled(plate(upper="{diameter: 0.3 mm, projected: 30 mm}", lower=projected), tmp_path)
    deviations = drawn(made.simulation, 0, 100_000).deviations
    most = 0.0
    for k in range(1, 5):
        moved = moved_by(made, f"plate.hole {k}", deviations)
        beyond = moved[:, 2:] + 3.0 * (moved[:, 2:] - moved[:, :2])  # 30 mm over 10 mm
        most = max(most, np.hypot(*moved[:, 2:].T).max(), np.hypot(*beyond.T).max())
    assert 0.12 < most <= 0.15 * (1 + 1e-12)


def test_a_bonus_widens_both_segments_alike(tmp_path: Path) -> None:
    size = "  size: {kind: size, of: plate.hole, distribution: {kind: uniform, lower: 0 um, upper: 200 um}}\n"
    text = plate(more=size).replace("    kind: position\n", "    kind: position\n    modifier: mmc\n")
    made = assembled(text, tmp_path)
    own = columns(made)
    deviations = drawn(made.simulation, 0, 50_000).deviations
    upper, lower = ends_of(made, deviations)
    bonus = np.stack([deviations[:, own[f"size {k}"]][:, 0] for k in range(1, 5)], axis=1)[:, :, None]
    for ends, width in ((upper, UPPER), (lower, LOWER)):
        left = (width + bonus) / 2 - np.hypot(ends[..., 0], ends[..., 1])
        assert left.min() > -1e-12
        assert left.min() < 0.01


def test_a_part_that_is_like_another_has_a_motion_of_its_own_and_one_factor_scales_both_segments(
    tmp_path: Path,
) -> None:
    text = plate().replace("tolerances:\n", "  other: {kind: solid, like: plate}\ntolerances:\n")
    text = text.replace("part: plate}\n", "part: plate}\n  shelf: {kind: fix, part: other}\n", 1)
    made = assembled(text, tmp_path)
    names = [own.name for own in made.system.contributors]
    assert {"holes shift and turn", "holes shift and turn of other"} <= set(names)
    spec = of_kind(PositionSpec, scene_of(text, tmp_path).tolerances["holes"])
    half = spec.scaled(0.5, "middle", scene_of(text, tmp_path).files)
    assert (half.zone.stated, known(half.lower_segment).zone.stated) == ("0.15 mm", "0.05 mm")


UNIFORM, CONSTANT = "{kind: uniform}", "{kind: constant, value: 0 um}"
POSITION = "    kind: position\n    of: plate.hole\n"


@pytest.mark.parametrize(
    ("change", "place", "words"),
    [
        (
            ("zone: {diameter: 0.1 mm}", "zone: {diameter: 0.4 mm}"),
            "lower_segment.zone",
            "expected a zone narrower than 0.3 mm, that of the upper segment, got 0.4 mm; swap the two, or leave "
            "lower_segment out",
        ),
        (
            ("zone: {diameter: 0.1 mm}", "zone: {width: 0.1 mm, along: [1, 0, 0]}"),
            "lower_segment.zone",
            "expected a diameter, as in the upper segment, got a width",
        ),
        (
            ("diameter: 0.1 mm}, datums: [A]", "diameter: 0.1 mm}, datums: [B]"),
            "lower_segment.datums",
            "expected the first datums of the upper segment (A, B, C), in their order, got B",
        ),
        (
            (POSITION, POSITION.replace("hole", "hole 1")),
            "lower_segment",
            "expected a pattern of 'plate.hole 1' or rigid_with, features that lie to each other, got one alone; "
            "of one feature write an orientation tolerance of 0.1 mm beside 'holes'",
        ),
        (
            (f"law: {UNIFORM}\n    datums", "law: {kind: ring}\n    datums"),
            "law",
            "expected uniform or normal of a composite tolerance, got ring",
        ),
        (
            ("moves:\n", f"  holes shift: {{kind: size, of: plate.hole, distribution: {CONSTANT}}}\nmoves:\n"),
            "holes shift",
            "expected another name: 'holes' has 'holes shift' for its pattern",
        ),
        (
            (
                "moves:\n",
                "  upright: {kind: perpendicularity, of: plate.hole, zone: {diameter: 0.2 mm}, datums: [A]}\nmoves:\n",
            ),
            "lower_segment.zone",
            "expected more than the 200 um of 'upright', which refines it, got 100 um",
        ),
    ],
)
def test_what_no_composite_tolerance_says_is_refused(change: Edit, place: str, words: str, tmp_path: Path) -> None:
    assert f"{place}: {words}" in refusal(edited(plate(), change), tmp_path)
