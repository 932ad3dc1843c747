"""The close-up of a gap: what is drawn of the gears is as far apart as the line between them says."""

import numpy as np
import pytest
import pyvista as pv
from places import SCENES
from scipy.spatial import cKDTree

from tol3d.gearing.presenting.panels import GapSection, _as_seen, gap_section
from tol3d.gearing.shown.display import seated_build
from tol3d.gearing.shown.placed import CONE_DEFLECTION, DISPLAY_DEFLECTION
from tol3d.gears import BevelPair
from tol3d.report.drawn_solids import poly_data
from tol3d.simulate import Overrides, run_scene
from tol3d.study.results.replaying import build_of
from tol3d.study.runs.run import Run

ABOUT = 0.5  # mm; about the gap, of the outlines that are held against each other
SLOW_CONES = pytest.param("every_bevel_field", marks=pytest.mark.slow)
STEPS = 200  # places on each segment of an outline


@pytest.fixture(scope="module", params=["bevel_pair", SLOW_CONES, "every_field"])
def run(request: pytest.FixtureRequest, tmp_path_factory: pytest.TempPathFactory) -> Run:
    """Equal and unequal cones, and a spur pair whose axes lean and whose faces are not equally wide."""
    overrides = Overrides(trials=4, engine="exact", witness=0)
    return run_scene(SCENES / f"{request.param}.yaml", overrides=overrides, out=tmp_path_factory.mktemp("gap") / "run")


def along(outline: pv.PolyData, near: np.ndarray) -> np.ndarray:
    """Points (n, 3) close together on that part of an outline that lies about a point."""
    segments = outline.points[outline.lines.reshape(-1, 3)[:, 1:]]
    shares = np.linspace(0.0, 1.0, STEPS)[:, None]
    points = (segments[:, None, 0] * (1 - shares) + segments[:, None, 1] * shares).reshape(-1, 3)
    return points[np.linalg.norm(points - near, axis=1) < ABOUT]


def distance(section: GapSection) -> float:
    """Smallest distance of both outlines about the gap [mm], of all places on the one to all on the other."""
    first, second = (along(outline, end) for outline, end in zip(section.outlines, section.ends, strict=True))
    return float(cKDTree(first).query(second)[0].min())


@pytest.mark.slow
@pytest.mark.parametrize("magnify", [1.0, 2.0])
@pytest.mark.parametrize("trial", [0, pytest.param(3, marks=pytest.mark.slow)])
def test_the_outlines_are_as_far_apart_as_the_gap_and_the_line_reaches_from_one_to_the_other(
    run: Run, trial: int, magnify: float
) -> None:
    """Within the chord errors of both display meshes: a cut at the front of a bevel pair would be 6 % off."""
    seated = _as_seen(seated_build(*build_of(run, trial), magnify=magnify).meshes[0])
    section = gap_section(seated, [poly_data(*part.mesh()) for part in (seated.driver, seated.driven)])
    chord = CONE_DEFLECTION if isinstance(seated.mesh.pair, BevelPair) else DISPLAY_DEFLECTION
    assert distance(section) == pytest.approx(seated.gap_value, abs=2 * chord)
    assert np.linalg.norm(section.ends[1] - section.ends[0]) == pytest.approx(seated.gap_value, rel=0.002)
    for end, outline in zip(section.ends, section.outlines, strict=True):
        assert np.linalg.norm(along(outline, end) - end, axis=1).min() < 2 * chord
    across = (section.ends[1] - section.ends[0]) / seated.gap_value
    assert abs(across @ section.towards) < 0.01  # one looks at the line from the side, not along it


@pytest.mark.slow
def test_a_cut_stays_inside_both_faces_where_the_gap_lies_at_an_end(run: Run) -> None:
    """Moved to the end of its face a gap is cut 2 % inside of it, where both gears are."""
    seated = _as_seen(seated_build(*build_of(run, 0)).meshes[0])
    meshes = [poly_data(*part.mesh()) for part in (seated.driver, seated.driven)]
    for far in (-1.0, 1.0):
        gap = seated.gap + far * np.array([0.0, 0.0, seated.driver.gear.face_width])
        moved = gap_section(type(seated)(**{**vars(seated), "gap": gap}), meshes)
        assert all(outline.n_cells > 100 for outline in moved.outlines)
