"""Places of the names of bodies in a picture, and what they point at."""

import itertools
from dataclasses import replace

import numpy as np
import pytest
import pyvista as pv
import trimesh
from rendering import renders

from tol3d.cad.solids import PosedBody
from tol3d.report.body import Body, World
from tol3d.report.view import choose_window
from tol3d.report.whole import Frame, _best_eye, _places, draw_whole

SIZE = (1188, 1050)  # pixels, the larger part of the window


@pytest.fixture(autouse=True, scope="module")
def window() -> None:
    choose_window(needs_display=False)


def cube(name: str, side: float, middle: tuple[float, float, float]) -> Body:
    solid = trimesh.creation.box((side,) * 3)
    pose = np.eye(4)
    pose[:3, 3] = middle

    def unposed() -> PosedBody:
        raise AssertionError("no STEP file is written")

    return Body(name, pose, lambda: (np.asarray(solid.vertices), np.asarray(solid.faces)), unposed, "#888888")


@renders
def test_a_body_within_another_is_seen_nowhere_not_even_at_an_edge() -> None:
    """Bodies are found by the colours of their numbers: half of the second's at an edge would be the first's."""
    middle = (3.0, 4.0, 5.0)
    _, named = _best_eye(World("nested", (cube("inner", 2.0, middle), cube("outer", 20.0, middle))), 1.0)
    assert named["inner"].point == pytest.approx([3.0, 4.0, 5.0])
    assert np.abs(named["outer"].point - [3.0, 4.0, 5.0]).max() == pytest.approx(10.0, abs=0.1)  # mm, a pixel
    assert [name for name, own in named.items() if own.hidden] == ["inner"]


@renders
def test_the_label_of_a_hidden_body_says_so_and_no_dot_is_set_on_what_hides_it() -> None:
    plotter = pv.Plotter(off_screen=True, window_size=list(SIZE))
    try:
        bodies = (cube("inner", 2.0, (0.0, 0.0, 0.0)), cube("outer", 20.0, (0.0, 0.0, 0.0)))
        draw_whole(plotter, World("nested", bodies), SIZE[0] / SIZE[1])
        actors = list(plotter.renderer.actors.values())
        texts = {actor.input.strip() for actor in actors if isinstance(actor, pv.Text)}
        meshes = [actor.mapper.dataset for actor in actors if isinstance(actor, pv.Actor)]
        dots = [mesh for mesh in meshes if np.ptp(mesh.bounds[:2]) < 1.0 and mesh.n_cells > 100]
    finally:
        plotter.close()
    assert texts == {"inner (hidden)", "outer"}
    assert len(dots) == 1


@renders
@pytest.mark.parametrize("is_clear", [False, True])
def test_what_is_within_a_clear_body_is_seen(is_clear: bool) -> None:
    """The label of the inner cube points at its middle where nothing is seen of it, else at its surface."""
    outer = replace(cube("outer", 20.0, (3.0, 4.0, 5.0)), opacity=0.3 if is_clear else 1.0)
    _, named = _best_eye(World("nested", (cube("inner", 4.0, (3.0, 4.0, 5.0)), outer)), 1.0)
    off = {name: float(np.abs(own.point - (3.0, 4.0, 5.0)).max()) for name, own in named.items()}
    assert off["inner"] == pytest.approx(2.0 if is_clear else 0.0, abs=0.1)  # mm, a pixel
    assert off["outer"] == pytest.approx(10.0, abs=0.1)


def label_boxes(names: list[str], places: np.ndarray) -> dict[str, tuple[float, float, float, float]]:
    """Left, right, lower and upper edge [pixels] of each label beside a cube with these points (n, 3) named."""
    plotter = pv.Plotter(off_screen=True, window_size=list(SIZE))
    points = dict(zip(names, places, strict=True))
    try:
        draw_whole(plotter, World("w", (cube("the cube", 20.0, (0.0, 0.0, 0.0)),), points=points), SIZE[0] / SIZE[1])
        plotter.render()
        boxes = {}
        for actor in plotter.renderer.actors.values():
            if isinstance(actor, pv.Text):
                actor.GetBoundingBox(plotter.renderer, extent := [0.0] * 4)
                x, y = actor.GetActualPositionCoordinate().GetComputedViewportValue(plotter.renderer)
                boxes[actor.input] = (x + extent[0], x + extent[1], y + extent[2], y + extent[3])
    finally:
        plotter.close()
    return boxes


@pytest.mark.slow
@renders
@pytest.mark.parametrize("count", [1, 12, 60])
@pytest.mark.parametrize("name", ["p{}", "{} has a name that is longer than the room beside the cube", "${}_1$"])
def test_no_two_labels_overlap_and_none_leaves_the_picture(count: int, name: str) -> None:
    names = [name.format(k) for k in range(count)]
    boxes = label_boxes(names, np.random.default_rng(count).uniform(-10, 10, (count, 3)))
    assert len(boxes) == count + 1  # none is left out, and those that are cut still differ
    for left, right, low, high in boxes.values():
        assert 0 <= left < right <= SIZE[0]
        assert 0 <= low < high <= SIZE[1]
    for (text, one), (other, two) in itertools.combinations(boxes.items(), 2):
        assert one[1] <= two[0] or two[1] <= one[0] or one[3] <= two[2] or two[3] <= one[2], (text, other)
    if len(name) < 10:
        assert {text.replace("\\", "") for text in boxes} == {f" {whole} " for whole in [*names, "the cube"]}


@renders
def test_names_of_points_in_the_middle_of_the_picture_fill_both_columns() -> None:
    boxes = label_boxes([f"p{k}" for k in range(60)], np.zeros((60, 3)))
    assert len(boxes) == 61
    left = sum(box[1] < SIZE[0] / 2 for box in boxes.values())
    assert left in (30, 31)


def test_lines_to_labels_never_cross() -> None:
    rng = np.random.default_rng(3)
    frame = Frame(np.zeros(3), 200.0, 100.0, np.full(3, -40.0), np.full(3, 40.0), 80.0)
    for _ in range(50):
        points = rng.uniform(-40, 40, (9, 3))
        places = _places(points, 45.0, frame)
        assert np.diff(np.sort(places[:, 1])).min() > 100.0 / 26 * 0.999  # rows do not overlap
        assert np.abs(places[:, 1]).max() < 50.0
        for one in range(9):
            for other in range(one):
                assert not cross(points[one, :2], places[one], points[other, :2], places[other])


def cross(a: np.ndarray, b: np.ndarray, c: np.ndarray, d: np.ndarray) -> bool:
    def side(p: np.ndarray, q: np.ndarray, r: np.ndarray) -> float:
        return float((q[0] - p[0]) * (r[1] - p[1]) - (q[1] - p[1]) * (r[0] - p[0]))

    return side(a, b, c) * side(a, b, d) < 0 and side(c, d, a) * side(c, d, b) < 0
