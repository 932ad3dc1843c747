"""Surfaces and products by the text against what Open CASCADE says of the same faces."""

import numpy as np
import pytest
from foreign_parts import nist_file
from nist import FILES, step_text

from tol3d.cad.step.meaning import surfaces_of
from tol3d.cad.step.reading import read_step

pytestmark = pytest.mark.slow

PLACE = 1e-6  # mm; both read the same digits, and multiply by the unit
SLOPE = 1e-9


@pytest.mark.parametrize("model", FILES)
def test_every_face_has_the_surface_that_open_cascade_reads(model: str) -> None:
    read = read_step(nist_file(model.lower().replace("-", "_")))
    text = step_text(model)
    by_text = surfaces_of(text)
    assert {face for part in read.parts for face in part.body.faces | part.body.loose} == set(by_text)
    for face, own in by_text.items():
        theirs = read.faces.by_id[face]
        if own.kind == "other":
            continue  # a spline, which only the geometry recognises
        assert own.kind == theirs.kind
        off = np.subtract(own.at, theirs.at)
        if own.kind == "plane":
            assert np.array(own.direction) == pytest.approx(np.array(theirs.normal), abs=SLOPE)  # out of the material
            assert abs(np.dot(off, own.direction)) < PLACE
            continue
        assert own.radius == pytest.approx(theirs.minor_radius if own.kind == "torus" else theirs.radius, abs=PLACE)
        if own.kind != "sphere":
            assert abs(np.dot(own.direction, theirs.axis)) == pytest.approx(1.0, abs=SLOPE)
            off = off - np.dot(off, theirs.axis) * np.array(theirs.axis)
        assert np.linalg.norm(off) < PLACE
        assert own.same_sense != theirs.is_hollow


@pytest.mark.parametrize("model", FILES)
def test_products_have_the_faces_and_names_of_the_geometry(model: str) -> None:
    read = read_step(nist_file(model.lower().replace("-", "_")))
    products = [each for each in step_text(model).structure.products.values() if each.faces]
    assert [each.name for each in products] == [each.name for each in read.parts]
    for ours, theirs in zip(products, read.parts, strict=True):
        assert {face for solid in ours.solids for face in solid.faces} == theirs.body.faces
        assert set(ours.loose_faces) == theirs.body.loose
