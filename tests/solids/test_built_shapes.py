"""Shapes of mechanisms, with builders that come along: against closed forms, in files and in the cache."""

import importlib
import math
import os
import sys
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from subprocess import run
from typing import ClassVar

import cadquery as cq
import numpy as np
import pytest
import trimesh
from of_kind import of_kind
from places import ROOT, TESTS

from tol3d.cad.solids import BuiltShape, DisplayMesh, PosedShape, display_mesh, export_step
from tol3d.numerics.sources import source, sources_of
from tol3d.report.body import built_body

BUILDERS = """
import cadquery as cq
from tol3d.parts.named_solid import NamedSolid, numbered

def wedge(shape):
    return numbered(cq.Solid.makeWedge(shape.wide, shape.high, shape.deep, shape.wide, 0, shape.wide, shape.deep))

def moved_cut(shape):
    block = cq.Workplane().box(20, 20, shape.high).faces(">Z").workplane()
    return numbered(block.rect(10, 10, forConstruction=True).vertices().hole(shape.wide).solids().vals()[0])

def tube(shape):
    outer, inner = (cq.Solid.makeCylinder(radius, shape.length) for radius in (shape.outer, shape.inner))
    return numbered(outer.cut(inner).Solids()[0])
"""


@dataclass(frozen=True)
class Wedge(BuiltShape):
    """Half of a box, cut along a diagonal."""

    builder: ClassVar[str] = "builders_of_shapes:wedge"

    wide: float
    high: float
    deep: float


@dataclass(frozen=True)
class Holed(BuiltShape):
    """A square block with four holes, whose faces OCC keeps where they were before they were moved."""

    builder: ClassVar[str] = "builders_of_shapes:moved_cut"

    wide: float
    high: float


@dataclass(frozen=True)
class Tube(BuiltShape):
    """About z."""

    builder: ClassVar[str] = "builders_of_shapes:tube"

    outer: float
    inner: float
    length: float


@pytest.fixture(autouse=True)
def builders(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[Path]:
    """A module of a mechanism's own folder, and an empty cache."""
    monkeypatch.setenv("TOL3D_CACHE", str(tmp_path / "cache"))
    path = tmp_path / "builders_of_shapes.py"
    path.write_text(BUILDERS, "utf-8")
    monkeypatch.syspath_prepend(str(tmp_path))
    yield path
    sys.modules.pop(path.stem, None)


def whole(mesh: DisplayMesh) -> trimesh.Trimesh:
    return trimesh.Trimesh(mesh.vertices, mesh.triangles, process=False)


def test_flat_faces_are_met_exactly() -> None:
    mesh = display_mesh(Wedge(4.0, 5.0, 6.0), 0.5)
    assert whole(mesh).is_watertight
    assert whole(mesh).volume == pytest.approx(4 * 5 * 6 / 2, rel=1e-12)
    assert mesh.chord_error == 0.0


def test_round_faces_are_met_within_the_chord_error_that_is_stated() -> None:
    """A facet between points of a circle of radius r lies at most e inside it: areas fall by less than 2 pi r e."""
    tube = Tube(10.0, 7.0, 30.0)
    for deflection in (0.1, 0.01):
        mesh = display_mesh(tube, deflection)
        assert whole(mesh).is_watertight
        error = mesh.chord_error
        assert error < 2 * deflection
        exact = math.pi * (10.0**2 - 7.0**2) * 30.0
        assert abs(whole(mesh).volume - exact) < 2 * math.pi * 10.0 * error * 30.0
        radii = np.hypot(*mesh.vertices[:, :2].T)
        assert np.minimum(np.abs(radii - 10.0), np.abs(radii - 7.0)).max() < 1e-9


def test_faces_that_a_builder_has_moved_lie_where_the_solid_has_them() -> None:
    mesh = display_mesh(Holed(4.0, 6.0), 0.01)
    assert whole(mesh).is_watertight
    assert mesh.chord_error < 0.02
    # each of four holes is a polygon on its circle: smaller, by less than the chord error all around
    volume = (400.0 - 4 * math.pi * 4.0) * 6.0
    assert 0.0 < whole(mesh).volume - volume < 4 * 2 * math.pi * 2.0 * mesh.chord_error * 6.0


def test_it_stands_in_files_where_its_pose_says(tmp_path: Path) -> None:
    pose = np.array([[0.0, -1.0, 0.0, 3.0], [1.0, 0.0, 0.0, 4.0], [0.0, 0.0, 1.0, 5.0], [0.0, 0.0, 0.0, 1.0]])
    body = built_body("wedge", Wedge(4.0, 5.0, 6.0), pose, "#123456", deflection=0.1)
    assert body.posed is not None
    export_step([body.posed(), PosedShape("tube", Tube(10.0, 7.0, 30.0), np.eye(4))], tmp_path / "both.step")
    solids = [of_kind(cq.Solid, own) for own in cq.importers.importStep(str(tmp_path / "both.step")).solids().vals()]
    wedge, tube = sorted(solids, key=lambda solid: solid.Volume())
    assert wedge.Volume() == pytest.approx(60.0, rel=1e-9)
    assert tube.Volume() == pytest.approx(math.pi * 51.0 * 30.0, rel=1e-9)
    box = wedge.BoundingBox()  # x from -5 to 0 by the turn, y from 0 to 4, and then shifted
    assert (box.xmin, box.xmax, box.ymin, box.ymax) == pytest.approx((-2.0, 3.0, 4.0, 8.0), abs=1e-6)
    vertices, triangles = body.mesh
    assert trimesh.Trimesh(vertices, triangles).bounds == pytest.approx(np.array([[-2, 4, 5], [3, 8, 11]]), abs=1e-9)


def test_what_was_built_is_kept_until_its_builder_changes(builders: Path) -> None:
    """Under the shape's numbers and all sources of its builder."""
    first = display_mesh(Wedge(4.0, 5.0, 6.0), 0.5)
    sys.modules.pop(builders.stem)
    again = display_mesh(Wedge(4.0, 5.0, 6.0), 0.5)
    assert builders.stem not in sys.modules
    assert np.array_equal(first.vertices, again.vertices)
    assert whole(display_mesh(Wedge(4.0, 5.0, 7.0), 0.5)).volume == pytest.approx(70.0)


def test_a_builder_that_changes_builds_again(builders: Path) -> None:
    """As a process does that begins then: it has read no source yet."""
    found = []
    for height in ("shape.high", "2 * shape.high"):
        builders.write_text(BUILDERS.replace("shape.high", height), "utf-8")
        sys.modules.pop(builders.stem, None)
        source.cache_clear()
        importlib.invalidate_caches()
        found.append(whole(display_mesh(Wedge(4.0, 5.0, 6.0), 0.5)).volume)
    assert found == pytest.approx([60.0, 120.0])


def test_sources_of_a_builder_s_own_package_count(builders: Path) -> None:
    """Whatever module of it the builder imports, and what it imports of tol3d."""
    package = builders.parent / "shapes_of_others"
    package.mkdir()
    (package / "__init__.py").write_text("", "utf-8")
    (package / "sizes.py").write_text("WIDE = 3.0", "utf-8")
    (package / "wedge.py").write_text("import os\nfrom tol3d.units import ARCMIN\nfrom .sizes import WIDE\n", "utf-8")
    found = sources_of("shapes_of_others.wedge")
    assert {"shapes_of_others.wedge", "shapes_of_others.sizes", "tol3d.units"} <= found.keys()
    assert "os" not in found


def test_describing_a_shape_loads_no_cad() -> None:
    words = "import sys; import toys.parabola.showing; print('cadquery' in sys.modules)"
    ended = run(
        (sys.executable, "-c", words),
        capture_output=True,
        text=True,
        env={**os.environ, "PYTHONPATH": f"{TESTS}:{ROOT}"},
        check=True,
    )
    assert ended.stdout.strip() == "False"
