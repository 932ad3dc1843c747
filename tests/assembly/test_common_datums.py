"""Common datums of several features: the line of least squares through their centres, and what is refused."""

from pathlib import Path

import numpy as np
import pytest
from assembly.drafts import Draft, displacement
from assembly_trials import assembled
from scene_texts import refusal

from tol3d.assembly.model import Datum, Fix
from tol3d.assembly.placing import method as placing
from tol3d.assembly.torsors import method as torsors

PLACES = (0.0, 30.0, 70.0, 120.0)
"""Places of four centres along z [mm]."""
TIP = 200.0


def test_each_place_moves_the_line_as_a_regression_weighs_it() -> None:
    """x of a tip at h moves by 1/n + (h - m)(z - m) / S of the x of a place at z, S the sum of (z - m)²."""
    draft = Draft()
    draft.part("p")
    names = [draft.feature(f"p.c{k}", (0, 0, z)) for k, z in enumerate(PLACES)]
    held = draft.datum_frame("p", Datum(tuple(names)))
    draft.feature("p.zero", (0, 0, 0), deviates=False)
    draft.feature("p.tip", (0, 0, TIP), parent=held, deviates=False)
    assembly = draft.assembly((Fix("fix", "p"),), {"x": displacement("p.tip", (1, 0, 0), "p.zero")})
    off = np.array(PLACES) - np.mean(PLACES)
    weights = 1 / len(PLACES) + (TIP - np.mean(PLACES)) * off / (off @ off)
    rows = np.zeros((len(PLACES), assembly.width))
    for k, name in enumerate(names):
        rows[k, draft.columns.index(f"{name} {assembly.features[name].shape.components[0]}")] = 1e-3
    np.testing.assert_allclose(torsors.values(assembly, rows, ["x"])["x"], 1e-3 * weights, atol=1e-15)
    exact = placing.values(assembly, rows, ["x"])["x"][0]
    np.testing.assert_allclose(exact, 1e-3 * weights, atol=1e-3 * (1e-3 / 30) ** 2 * TIP)  # the cube of a turn


SCENE = """scene: crankcase
parts:
  case:
    kind: solid
    features:
      bore 1: {kind: cylinder, at: [0 mm, 0 mm, 0 mm], axis: [0, 0, 1], length: 20 mm, diameter: 30 mm, hole: true}
      bore 2: {kind: cylinder, at: [PLACE], axis: [0, 0, 1], length: 20 mm, diameter: 30 mm, hole: true}
      bore 3: {kind: cylinder, at: [0 mm, 0 mm, 100 mm], axis: [0, 0, 1], length: 20 mm, diameter: 30 mm, hole: true}
      nose: {kind: cylinder, at: [0 mm, 0 mm, 140 mm], axis: [0, 0, 1], length: 10 mm, diameter: 30 mm, hole: true}
tolerances:
  bores: {kind: position, of: case.bore 2, zone: {diameter: 40 um}, law: {kind: uniform}, datums: [bore 1]}
  nose: {kind: coaxiality, of: case.nose, zone: {diameter: 20 um}, law: {kind: uniform}, datums: [DATUMS]}
moves:
  bench: {kind: fix, part: case}
measures:
  nose off: {kind: inspected_position, of: case.nose, datums: [DATUMS], upper_limit: 20 um}
"""
ON, OFF, SAME = "0 mm, 0 mm, 40 mm", "0 mm, 3 mm, 40 mm", "0 mm, 0 mm, 100 mm"
ALL = "bore 1-bore 2-bore 3"


def written(place: str, datums: str) -> str:
    return SCENE.replace("PLACE", place).replace("DATUMS", datums)


def test_what_lies_to_a_common_datum_of_three_is_inspected_within_its_zone(tmp_path: Path) -> None:
    made = assembled(written(ON, ALL), tmp_path)
    for method in ("exact", "analytic"):
        values = made.drawn(2000, method)["nose off"]
        assert 0.9 * 0.02 < values.max() <= 0.02 + 1e-6


@pytest.mark.parametrize(
    ("place", "datums", "words"),
    [
        (OFF, ALL, "the centres of the common datum bore 1-bore 2-bore 3 lie off a line nominally, by 2.4"),
        (SAME, ALL, "two features of the common datum bore 1-bore 2-bore 3 have one centre: name one"),
        (SAME, "bore 2-bore 3", "two features of the common datum bore 2-bore 3 have one centre: name one"),
        (ON, "bore 1-bore 2-bore 2", "expected each feature once, got bore 1-bore 2-bore 2"),
        (ON, "bore 1-bore 2-bore 4", "bore 4"),
        (ON, "{feature: bore 1-bore 2, simulator: fitted, mmb: random}", "it at holes, pins, slots or tabs"),
    ],
)
def test_what_is_no_line_is_refused(place: str, datums: str, words: str, tmp_path: Path) -> None:
    assert words in refusal(written(place, datums), tmp_path)
