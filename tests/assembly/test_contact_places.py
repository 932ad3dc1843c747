"""Contacts on planes that tilt: a point lies on the plane where the trial puts it, also after it has slid along."""

from pathlib import Path

import numpy as np
import pytest
from assembly_trials import assembled, constant, uniform

from tol3d.assembly.model.statuses import OK
from tol3d.study.trials.draws import drawn

POINTS = {"1": (10, 10, 0), "2": (90, 12, 0), "3": (50, 70, 0), "4": (15, 0, 6), "5": (85, 0, 6), "6": (0, 40, 6)}
NORMALS = {**dict.fromkeys("123", (0, 0, 1)), **dict.fromkeys("45", (0, 1, 0)), "6": (1, 0, 0)}
WALLS = {**dict.fromkeys("123", "floor"), **dict.fromkeys("45", "back"), "6": "left"}
SLIDE = 2.0
"""mm, by the sixth locator along the floor and the back."""


def nest(kind: str, points_on: str) -> str:
    """A block in three walls that tilt: the points on the block and the walls in the nest, or the reverse."""
    on_part = points_on == "part"
    sign = 1 if on_part else -1  # out of the material of what has the walls
    points = "".join(
        f"      P{k}: {{kind: point, at: [{', '.join(f'{own} mm' for own in at)}]}}\n" for k, at in POINTS.items()
    )
    walls = "".join(
        f"      {name}: {{kind: plane, at: [{at}], normal: {[sign * own for own in NORMALS[k]]}, extent: [{extent}]}}\n"
        for name, k, at, extent in (
            ("floor", "1", "50 mm, 40 mm, 0 mm", "100 mm, 80 mm"),
            ("back", "4", "50 mm, 0 mm, 6 mm", "100 mm, 12 mm"),
            ("left", "6", "0 mm, 40 mm, 6 mm", "80 mm, 12 mm"),
        )
    )
    nest_has, block_has = (walls, points) if on_part else (points, walls)
    pairs = {
        k: f"{{from: block.{f'P{k}' if on_part else WALLS[k]}, to: nest.{WALLS[k] if on_part else f'P{k}'}}}"
        for k in POINTS
    }
    owner = "nest" if on_part else "block"
    listed = ", ".join(pairs.values())
    groups = {"primary": "123", "secondary": "45", "tertiary": "6"}
    laid = {
        "three_two_one": ", ".join(f"{own}: [{', '.join(pairs[k] for k in ks)}]" for own, ks in groups.items()),
        "six_plane": f"pairs: [{listed}]",
        "rest": f"contacts: [{listed}], force: {{direction: [-0.3, -0.4, -1], at: [50 mm, 40 mm, 5 mm]}}",
    }[kind]
    names = {k: k for k in POINTS}
    if kind == "three_two_one":
        names = {
            "1": "primary 1",
            "2": "primary 2",
            "3": "primary 3",
            "4": "secondary 1",
            "5": "secondary 2",
            "6": "tertiary 1",
        }
    laws = {k: constant(SLIDE) if k == "6" else uniform(0.05) for k in POINTS}
    locators = "".join(
        f"  L{k}: {{kind: locator, of: lay, pair: {own!r}, distribution: {laws[k]}}}\n" for k, own in names.items()
    )
    tilts = "".join(
        f"  {own}: {{kind: profile, of: {owner}.{own}, zone: {{width: 0.2 mm}}, law: {{kind: uniform}}}}\n"
        for own in ("floor", "back", "left")
    )
    heights = "".join(
        f"  h{k}: {{kind: point_plane, from: {'block' if on_part else 'nest'}.P{k}, to: {owner}.{WALLS[k]}}}\n"
        for k in POINTS
    )
    return (
        f"scene: nest\nparts:\n  nest:\n    kind: solid\n    features:\n{nest_has}"
        f"  block:\n    kind: solid\n    features:\n{block_has}"
        f"tolerances:\n{tilts}{locators}moves:\n  bench: {{kind: fix, part: nest}}\n"
        f"  lay: {{kind: {kind}, part: block, {laid}, points_on: {points_on}}}\nmeasures:\n{heights}"
    )


@pytest.mark.parametrize("points_on", ["part", "fixture"])
@pytest.mark.parametrize("kind", ["three_two_one", "six_plane", "rest"])
def test_a_contact_is_as_high_over_its_wall_as_its_locator_stands_off(
    kind: str, points_on: str, tmp_path: Path
) -> None:
    """After a slide of 2 mm over slopes of up to 0.1 / 40, 5 um if the wall counted where it is touched nominally.

    On the fixture locators move along its own normals: their cosine to the wall's is off by half a slope squared.
    """
    made = assembled(nest(kind, points_on), tmp_path)
    trials = drawn(made.simulation, 0, 50)
    answers = made.system.method("exact", None).answers(trials, made.system.measures)
    slopes = 0.1 / 40 + 0.1 / 6  # of the wall, and of the block that the shortest wall turns
    for contributor, its in made.slices:
        if contributor.name.startswith("L"):
            measure = f"h{contributor.name[1]}"
            assert (answers.status[measure] == OK).all()
            off = np.abs(answers.values[measure][:, 0] - trials.deviations[:, its][:, 0])
            stands = np.abs(trials.deviations[:, its]).max()
            assert off.max() < (1e-9 if points_on == "part" else slopes**2 / 2 * stands), measure
