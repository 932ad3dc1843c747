"""The page of drawings on a part drawn elsewhere: origin, names and order of its features change nothing."""

import re
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import yaml
from assembly.drafts import frame
from assembly_trials import Assembled
from numpy.typing import NDArray

from tol3d.analyses.response import Values, response_of
from tol3d.simulate import load, simulation_of
from tol3d.study.system.stated import component_slices
from tol3d.study.trials.draws import drawn

PAGE = Path(__file__).parents[2] / "docs" / "drawings.md"
SCENES: Mapping[str, str] = {
    re.findall(r"scene: (.*)", own)[0]: own
    for own in re.findall(r"```yaml\n(scene: .*?)```", PAGE.read_text(), flags=re.DOTALL)
}
FAR = (-2000.0, 700.0, -900.0)
TRIALS = 40
REFERENCES = {"of", "datums", "feature", "from", "rigid_with", "to"}


def elsewhere(scene: Mapping[str, Any]) -> Mapping[str, Any]:
    """The same drawing about another origin, its features in reverse order under other names."""
    parts, names = {}, dict[str, str]()
    for part, own in scene["parts"].items():
        names |= {feature: f"f{len(own['features']) - k}x" for k, feature in enumerate(own["features"])}
        moved = {names[feature]: {**what, "at": shifted(what["at"])} for feature, what in own["features"].items()}
        parts[part] = {**own, "features": dict(reversed(moved.items()))}
    longest_first = sorted(names, key=len, reverse=True)
    pattern = re.compile(rf"(?<![\w ])({'|'.join(map(re.escape, longest_first))})(?![\w])")

    def renamed(value: Any, key: str = "") -> Any:
        if isinstance(value, dict):
            return {own: renamed(what, own) for own, what in value.items()}
        if key == "targets":
            return [shifted(own) for own in value]
        if isinstance(value, list):
            return [renamed(own, key) for own in value]
        return pattern.sub(lambda found: names[found[1]], value) if key in REFERENCES else value

    return {**scene, "parts": parts} | {key: renamed(scene[key]) for key in ("tolerances", "moves", "measures")}


def shifted(at: list[str]) -> list[str]:
    return [f"{float(own.removesuffix(' mm')) + by} mm" for own, by in zip(at, FAR, strict=True)]


@pytest.mark.parametrize("name", SCENES)
def test_a_drawing_means_the_same_elsewhere_under_other_names(name: str, tmp_path: Path) -> None:
    scene = yaml.safe_load(SCENES[name])
    found = list[tuple[tuple[str, ...], NDArray[np.float64], Values]]()
    for own in (scene, elsewhere(scene)):
        path = tmp_path / f"{len(found)}.yaml"
        path.write_text(yaml.safe_dump(own, sort_keys=False))
        simulation = simulation_of(load(path))
        for analytic in (False, True):
            response = response_of(simulation, analytic=analytic)
            deviations, positions = response.drawn(TRIALS, seed=5)
            slices = component_slices(simulation.system)
            for each in simulation.system.contributors:  # a datum's shift has the name of its features, and draws by it
                if each.kind == "datum_shift" and len(found) > 1:
                    deviations[:, slices[each.name]] = found[-2][1][:, slices[each.name]]
            found.append((response.names, deviations, response.values(deviations, positions)))
    for (names, deviations, here), (others, moved, there) in zip(found[:2], found[2:], strict=True):
        assert names == others
        np.testing.assert_allclose(moved, deviations, atol=1e-12, rtol=0)
        np.testing.assert_array_equal(there.codes, here.codes)
        np.testing.assert_allclose(there.values, here.values, atol=1e-6, rtol=0)
        assert np.nanstd(here.values, axis=0).max() > 0.0


FACES = {  # of the block on targets: middle, normal, x, half extents, targets
    "A": ((0, 0, 0), (0, 0, -1), (1, 0, 0), (50, 30), ((-40, -20, 0), (40, -20, 0), (0, 20, 0))),
    "B": ((0, -30, 10), (0, -1, 0), (1, 0, 0), (50, 10), ((-30, -30, 8), (35, -30, 12))),
    "C": ((-50, 0, 10), (-1, 0, 0), (0, 1, 0), (30, 10), ((-50, 5, 9),)),
}


def test_a_frame_on_targets_is_a_three_two_one_on_points_to_second_order(tmp_path: Path) -> None:
    """Points of the part touch the frame's planes, points of the fixture those of the part: it slides past them.

    By Taylor's theorem a face is as much higher there as its slope over what it slides; the six heights move the tip.
    """
    path = tmp_path / "scene.yaml"
    path.write_text(SCENES["block on targets"])
    made = Assembled(simulation_of(load(path)))
    trials = drawn(made.simulation, 0, 60)
    own = {contributor.name: trials.deviations[:, where] for contributor, where in made.slices}
    rows, heights, slopes, places = [], [], [], []
    for name, (middle, normal, along, reach, targets) in FACES.items():
        pose = frame(middle, normal, along)
        for target in targets:
            x, y, _ = pose[:3, :3].T @ (np.array(target) - middle)
            rises = own[name][:, 1:] / reach
            rows.append(np.concatenate([pose[:3, 2], np.cross(target, pose[:3, 2])]))
            heights.append(own[name][:, 0] + rises @ (x, y))
            slopes.append(rises @ pose[:3, :2].T)
            places.append(target)
    motions = -np.linalg.solve(np.array(rows), np.array(heights))  # shift of the origin and turn (6, trials)
    tip = np.array([40.0, 20.0, 20.0])
    by_heights = np.linalg.inv(np.array(rows))
    moved = by_heights[:3] + np.cross(by_heights[3:].T, tip).T
    apart = np.zeros(len(trials))
    for k, (row, place, slope) in enumerate(zip(rows, places, slopes, strict=True)):
        slid = (motions[:3] + np.cross(motions[3:].T, place).T).T
        slope = slope + np.cross(row[:3], motions[3:].T)  # of the face where the part has turned
        apart += np.linalg.norm(moved[:, k]) * np.abs((slope * slid).sum(axis=1) - slope @ row[:3] * (slid @ row[:3]))
    linear = made.values(trials, "analytic")
    np.testing.assert_allclose(linear["inspected"], 2 * linear["placed"], atol=1e-12, rtol=0)
    off = []
    for scale in (1.0, 0.25):
        found = made.values(trials.scaled(scale))
        off.append(np.abs(found["inspected"] / 2 - found["placed"]))
        assert (off[-1] <= 1.1 * scale**2 * apart + 1e-9).all()  # a tenth for terms of third order
    assert (off[0] / apart).max() > 0.2  # it is no loose bound
    assert off[1].max() < off[0].max() / 12
