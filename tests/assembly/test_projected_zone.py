"""A projected zone holds an axis where what is screwed in stands out: its own ends follow by the straight line."""

import math
from pathlib import Path

import numpy as np
import pytest
from numpy.typing import NDArray
from places import SCENES
from scene_texts import Edit, edited, refusal, scene_of, written

from tol3d import Overrides, run_scene
from tol3d.study.trials.draws import drawn
from tol3d.study.trials.overrides import simulation_of

Array = NDArray[np.float64]

BOLTED = (SCENES / "bolted_cover.yaml").read_text("utf-8")
STUD = "zone: {diameter: 0.1 mm, projected: 20 mm}, law: {kind: uniform}, datums: [face]"
OWN = "  own: {kind: inspected_position, of: base.stud hole, datums: [face]}\n"
LENGTH, BEYOND, ZONE = 10.0, 20.0, 0.1


def test_the_axis_fills_the_zone_beyond_its_end_and_leans_out_of_it_within(tmp_path: Path) -> None:
    """Both projected ends are uniform in discs of t/2 = R: the larger of two such radii has mean 4R/5 and mean square
    2R²/3. The near end of the axis is the projected one, the far end s(1 + L/p) - e L/p of both."""
    count = 20_000
    simulation = simulation_of(
        scene_of(edited(BOLTED, ("\nmeasures:\n", "\nmeasures:\n" + OWN)), tmp_path), Overrides()
    )
    trials = drawn(simulation, 0, count)
    names = [column for own in simulation.system.contributors for column in own.columns]
    start, end = (
        np.stack([trials.deviations[:, names.index(f"stud hole.{which} {x} [um]")] for x in "xy"], axis=1)
        for which in ("start", "end")
    )
    assert max(np.hypot(*start.T).max(), np.hypot(*end.T).max()) <= ZONE / 2
    far = start * (1 + LENGTH / BEYOND) - end * LENGTH / BEYOND
    expected = {
        "stud": 2 * np.maximum(np.hypot(*start.T), np.hypot(*end.T)),
        "own": 2 * np.maximum(np.hypot(*start.T), np.hypot(*far.T)),
    }
    measures = [own for own in simulation.system.measures if own.name in expected]
    for method in ("exact", "analytic"):
        found = simulation.system.method(method, None).answers(trials, measures).values
        for name, own in expected.items():
            np.testing.assert_allclose(found[name][:, 0], own, rtol=0, atol=2e-7)  # a slope of 1e-2, squared
    radius, sigma = ZONE / 2, ZONE * math.sqrt(2 / 3 - 16 / 25)
    assert expected["stud"].mean() == pytest.approx(2 * 0.8 * radius, abs=4 * sigma / math.sqrt(count))
    assert expected["own"].max() > ZONE


@pytest.mark.slow
def test_a_hole_inspected_within_its_plate_is_judged_by_another_zone(tmp_path: Path) -> None:
    limited = OWN.replace("[face]", "[face], upper_limit: 0.1 mm")
    path = written(edited(BOLTED, ("\nmeasures:\n", "\nmeasures:\n" + limited)), tmp_path)
    summary = run_scene(path, overrides=Overrides(trials=4000, engine="analytic"), out=tmp_path / "run").summary
    own, stud = summary["measures"]["own"], summary["measures"]["stud"]
    assert stud["analytic"]["above_limit_ppm"] == 0.0
    assert own["analytic"]["above_limit_ppm"] > 10_000


LEAN = "  lean: {kind: inspected_orientation, of: HOLE, datums: [DATUM]}\n"
UPRIGHT = "{diameter: 0.05 mm}, law: {kind: uniform}, datums: [under]"
REFINED = "{diameter: 0.05 mm}, modifier: mmc, datums: [face]"
STUD_UPRIGHT = "  upright: {kind: perpendicularity, of: base.stud hole, zone: {diameter: 0.03 mm}, datums: [face]}\n"


@pytest.mark.parametrize(
    ("edits", "hole", "datum", "lean"),
    [
        # of 8 mm, held within 0.05 mm over 16 mm
        ([(UPRIGHT, UPRIGHT.replace("mm}", "mm, projected: 16 mm}"))], "cover.hole 1", "under", 0.025),
        # of 10 mm, within 0.05 mm over 40 mm, beside a position of the hole itself
        ([(REFINED, "{diameter: 0.05 mm, projected: 40 mm}, datums: [face]")], "base.hole 1", "face", 0.0125),
        # a projected position, and an orientation of the 10 mm themselves
        ([("tolerances:\n", "tolerances:\n" + STUD_UPRIGHT)], "base.stud hole", "face", 0.03),
        # both projected: 0.03 mm over 20 mm
        (
            [("tolerances:\n", "tolerances:\n" + STUD_UPRIGHT.replace("0.03 mm}", "0.03 mm, projected: 20 mm}"))],
            "base.stud hole",
            "face",
            0.015,
        ),
    ],
)
def test_an_orientation_holds_an_axis_over_the_length_that_it_states(
    edits: list[tuple[str, str]], hole: str, datum: str, lean: float, tmp_path: Path
) -> None:
    """The lean over the own length is that of a straight line over the stated one; it fills it, by both methods."""
    own = LEAN.replace("HOLE", hole).replace("DATUM", datum)
    longer = own.replace("lean:", "over 24 mm:").replace("]}", "], projected: 24 mm}")
    simulation = simulation_of(
        scene_of(edited(BOLTED, *edits, ("\nmeasures:\n", "\nmeasures:\n" + own + longer)), tmp_path), Overrides()
    )
    trials = drawn(simulation, 0, 8000)
    over = next(each for each in simulation.system.measures if each.name == "over 24 mm")
    length = {"cover.hole 1": 8.0, "base.hole 1": 10.0, "base.stud hole": 10.0}[hole]
    (measure,) = (each for each in simulation.system.measures if each.name == "lean")
    read = {}
    for method in ("exact", "analytic"):
        read[method] = simulation.system.method(method, None).answers(trials, [measure]).values["lean"][:, 0]
        assert 0.97 * lean < read[method].max() <= lean * (1 + 1e-5)
        stretched = simulation.system.method(method, None).answers(trials, [over]).values[over.name][:, 0]
        np.testing.assert_allclose(stretched, 24.0 / length * read[method], rtol=1e-9)
    np.testing.assert_allclose(read["exact"], read["analytic"], rtol=0, atol=2e-7)
    scaled = simulation.system.method("exact", None).answers(trials.scaled(0.25), [measure]).values["lean"][:, 0]
    np.testing.assert_allclose(scaled, 0.25 * read["analytic"], rtol=0, atol=2e-8)  # of order 2


@pytest.mark.parametrize(
    ("edits", "place", "words"),
    [
        (
            [
                (
                    "tolerances:\n",
                    "tolerances:\n  under: {kind: parallelism, of: base.under, zone: {width: 1 um, projected: 9 mm}, "
                    "law: {kind: uniform}, datums: [face]}\n",
                ),
                (
                    "    features:\n",
                    "    features:\n      under: {kind: plane, at: [50 mm, 30 mm, -10 mm], "
                    "normal: [0, 0, -1], extent: [100 mm, 60 mm]}\n",
                ),
            ],
            "tolerances.under.zone.projected",
            "expected an axis or a cylinder, got 'base.under'; take projected out",
        ),
        (
            [(REFINED, REFINED.replace("mm}", "mm, projected: 40 mm}"))],
            "tolerances.base hole 1 upright.modifier",
            "expected none, for 'base hole 1' holds the axis over another length; leave it out, or project both alike",
        ),
        (
            [("of: base.stud hole, projected: 20 mm", "of: base.face, projected: 20 mm")],
            "measures.stud.of",
            "expected an axis or cylinder, got 'base.face', which is a plane",
        ),
    ],
)
def test_what_no_zone_projects_is_refused(edits: list[Edit], place: str, words: str, tmp_path: Path) -> None:
    assert f"{place}: {words}" in refusal(edited(BOLTED, *edits), tmp_path)
