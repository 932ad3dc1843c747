"""Sets of features at the best place that their datums leave: against linear programmes, and by hand from the draws."""

import math
from collections.abc import Mapping
from pathlib import Path

import numpy as np
import pytest
from assembly.composite_plate import HOLES, columns, plate
from assembly_trials import Assembled, assembled
from scipy.optimize import linprog
from scipy.spatial.transform import Rotation

from tol3d.numerics.arrays import Array
from tol3d.study.trials.draws import drawn

PADS = ", ".join(f"plate.pad {k}" for k in range(1, 5))
ASKED = f"""  pads set: {{kind: inspected_set, of: [{PADS}], free: oriented}}
  pads by AB: {{kind: inspected_set, of: [{PADS}], free: oriented, datums: [A, B]}}
  pads by A: {{kind: inspected_set, of: [{PADS}], free: oriented, datums: [A]}}
  held: {{kind: inspected_set, of: [{PADS}], datums: [A, B, C]}}
  holes set: {{kind: inspected_set, of: [{", ".join(HOLES)}], free: oriented, datums: [A]}}
  bore set: {{kind: inspected_set, of: [plate.bore], surfaces: true, datums: [A, B, C]}}
  ball set: {{kind: inspected_set, of: [plate.ball], surfaces: true, middle: -0.02 mm}}
"""
ROUND = """  bore: {kind: profile, of: plate.bore, zone: {width: 0.1 mm}, law: {kind: uniform}, datums: [A, B, C]}
  ball: {kind: profile, of: plate.ball, zone: {width: 0.06 mm, outward: 0.01 mm}, law: {kind: normal}}
"""


def scene(turn: Array | None = None, at: Array | None = None) -> str:
    turned, there = np.eye(3) if turn is None else turn, np.zeros(3) if at is None else at
    place = [", ".join(f"{own!r} mm" for own in (turned @ own + there).tolist()) for own in ((0, 0, 5), (0, 20, 15))]
    features = (
        f"      bore: {{kind: cylinder, at: [{place[0]}], axis: {(turned @ (0, 0, 1)).tolist()}, length: 10 mm, "
        f"diameter: 8 mm, hole: true}}\n      ball: {{kind: sphere, at: [{place[1]}], diameter: 12 mm}}\n"
    )
    return plate(turn=turn, at=at, more=ROUND).replace("tolerances:\n", features + "tolerances:\n") + ASKED


@pytest.fixture(scope="module")
def made(tmp_path_factory: pytest.TempPathFactory) -> Assembled:
    """The plate as it is drawn."""
    return assembled(scene(), tmp_path_factory.mktemp("sets"))


def corners(made: Assembled, deviations: Array) -> tuple[Array, Array]:
    """Corners of the pads (16, 2), and their heights over the pads' zones (trials, 16), by hand."""
    own, rows, places = columns(made), [], []
    for k, middle in enumerate([(-20.0, -10.0), (20.0, -10.0), (-20.0, 10.0), (20.0, 10.0)], start=1):
        height, x, y = deviations[:, own[f"pads {k}"]].T
        for right, up in ((1, 1), (-1, 1), (-1, -1), (1, -1)):
            rows.append(height + right * x + up * y)
            places.append((middle[0] + 3.0 * right, middle[1] + 2.0 * up))
    return np.array(places), np.array(rows).T


def test_a_set_lies_where_its_farthest_corner_is_nearest(made: Assembled) -> None:
    """Chebyshev's plane through sixteen corners by a linear programme, tilted or only shifted; both methods."""
    trials = drawn(made.simulation, 0, 25)
    places, heights = corners(made, trials.deviations)
    found = {method: made.values(trials, method) for method in ("exact", "analytic")}
    tilts = np.column_stack([np.ones(16), places, -np.ones(16)])
    for trial, own in enumerate(heights):
        rows = np.concatenate([tilts, tilts * (-1, -1, -1, 1)])
        best = linprog([0, 0, 0, 1], rows, np.concatenate([own, -own]), bounds=[(None, None)] * 4).x[3]
        for method in found:
            assert found[method]["pads set"][trial] == pytest.approx(2 * best, abs=2e-6)
    assert (found["exact"]["pads set"] < found["exact"]["pads by A"]).all()
    assert (found["exact"]["pads by A"] < found["exact"]["held"]).all()


def test_parallel_holes_read_as_their_pattern_and_differences_are_of_order_two(made: Assembled) -> None:
    """Oracle: `inspected_pattern`, whose gauge is turned by a search over discs."""
    trials = drawn(made.simulation, 0, 60)
    apart: list[Mapping[str, float]] = []
    for scale in (1.0, 0.25):
        exact, linear = (made.values(trials.scaled(scale), method) for method in ("exact", "analytic"))
        assert exact["holes set"] == pytest.approx(exact["lower"], abs=1e-7)
        assert linear["holes set"] == pytest.approx(linear["lower"], abs=1e-9)
        apart.append({name: float(np.abs(exact[name] - linear[name]).max()) for name in exact})
    for name in ("pads set", "pads by A", "held", "holes set", "bore set", "ball set"):
        assert apart[1][name] < max(apart[0][name] / 10, 1e-9)


def test_round_surfaces_count_with_their_size(made: Assembled) -> None:
    """By hand from the draws: |outward| + the farther end, of an unequal zone from its middle; within the zone."""
    trials = drawn(made.simulation, 0, 2000)
    own, found = columns(made), made.values(trials, "exact")
    out, *ends = trials.deviations[:, own["bore"]].T
    far = np.maximum(np.hypot(*ends[:2]), np.hypot(*ends[2:]))
    assert found["bore set"] == pytest.approx(2 * (np.abs(out) + far), abs=1e-7)
    out, *centre = trials.deviations[:, own["ball"]].T
    assert found["ball set"] == pytest.approx(2 * (np.abs(out + 0.02) + np.linalg.norm(centre, axis=0)), abs=1e-7)
    assert 0.95 * 0.1 < found["bore set"].max() <= 0.1 + 1e-7
    assert 0.8 * 0.06 < found["ball set"].max() <= 0.06 + 1e-7


def test_coordinates_of_the_part_change_nothing(made: Assembled, tmp_path: Path) -> None:
    rng = np.random.default_rng(3)
    turn, at = Rotation.random(rng=rng).as_matrix(), rng.uniform(-500, 500, 3)
    drawn_elsewhere = [made]
    for folder, text in (("b", scene(at=at)), ("c", scene(turn, at))):
        (tmp_path / folder).mkdir()
        drawn_elsewhere.append(assembled(text, tmp_path / folder))
    stated = ("pads set", "pads by A", "pads by AB", "held")  # pads state their x
    for method in ("exact", "analytic"):
        found = [own.drawn(40, method) for own in drawn_elsewhere]
        for name in (*stated, "bore set", "ball set"):
            assert found[1][name] == pytest.approx(found[0][name], abs=1e-9)
        for name in stated:
            assert found[2][name] == pytest.approx(found[0][name], abs=1e-9)


def test_other_names_and_another_order_change_nothing(made: Assembled, tmp_path: Path) -> None:
    """Pads are studs, holes are bores, named last to first, and listed in another order in the part."""
    text = (
        scene().replace(PADS, ", ".join(reversed(PADS.split(", ")))).replace(", ".join(HOLES), ", ".join(HOLES[::-1]))
    )
    lines = text.splitlines(keepends=True)
    first, last = (next(k for k, own in enumerate(lines) if own.startswith(f"      {name}: ")) for name in ("A", "pad"))
    text = "".join(lines[:first] + lines[first : last + 1][::-1] + lines[last + 1 :])
    text = text.replace("plate.pad", "plate.stud").replace("      pad:", "      stud:")
    text = text.replace("plate.hole", "plate.drilled").replace("      hole:", "      drilled:")
    there, here = assembled(text, tmp_path).drawn(40), made.drawn(40)
    for name in ("pads set", "pads by A", "held", "holes set", "bore set", "ball set"):
        assert there[name] == pytest.approx(here[name], abs=1e-9)


@pytest.mark.parametrize(
    ("old", "new", "words"),
    [
        ("surfaces: true, datums", "surfaces: true, modifier: mmc, datums", "none of surfaces"),
        ("oriented, datums: [A]}\n  held", "oriented, datums: [{feature: C, mmb: least}]}\n  held", "regardless of"),
        ("of: [plate.ball], surfaces: true", "of: [plate.ball], free: oriented", "ball"),
    ],
)  # fmt: skip
def test_a_set_that_makes_no_sense_is_refused(old: str, new: str, words: str, tmp_path: Path) -> None:
    with pytest.raises(Exception, match=words):
        assembled(scene().replace(old, new), tmp_path)


def test_round_pieces_let_a_face_bow_by_its_longest_chord(tmp_path: Path) -> None:
    """0.002 on each piece of 40 mm: 0.017 over the diagonal of 117 mm; of 10 mm 0.27, for which 0.05 has no room."""
    flat = "  A flat: {kind: flatness, of: plate.A, zone: {width: 0.002 mm}, per: PIECE}\n"
    for piece, taken in (("40 mm", 0.002 * (math.hypot(100, 60) / 40) ** 2), ("10 mm", 0.002)):
        made = assembled(plate(more=flat.replace("PIECE", piece)), tmp_path)
        own = next(own for own in made.system.contributors if own.name == "A")
        assert own.draw.distribution.high == pytest.approx((0.05 - taken) / 2)
