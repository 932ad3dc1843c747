"""Scenes as they are written: parts drawn in other coordinates, with all that is said in them, measure the same.

tests/assembly/test_shifted_coordinates.py turns the models of all bundled scenes; here it is what a scene file says,
and which frame each of its directions is read in. A round zone is drawn along axes that follow from the part's
coordinates where nothing says where x points: its law is the same and its trials are not, so that what it acts on is
compared by its closed form.
"""

from collections.abc import Iterator, Mapping
from io import StringIO
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from assembly_trials import Assembled, assembled
from numpy.typing import NDArray
from places import SCENES
from ruamel.yaml import YAML
from scipy.spatial.transform import Rotation

from tol3d.assembly.from_scene.features import poses_of
from tol3d.simulate import load

Array = NDArray[np.float64]
Change = tuple[Array, Array]
"""Turn (3, 3) and shift [mm] from a part's old coordinates to its new ones."""

DIRECTIONS = ("axis", "normal", "along", "across", "about", "pressed")


def turned(direction: Any, turn: Array) -> Any:
    if isinstance(direction[0], list):
        return [turned(own, turn) for own in direction]
    return (turn @ np.array(direction, dtype=float)).tolist()


def moved(place: Any, change: Change) -> list[str]:
    at = change[0] @ [float(own.removesuffix(" mm")) for own in place] + change[1]
    return [f"{own!r} mm" for own in at.tolist()]


def redraw_directions(said: dict[str, Any], turn: Array) -> None:
    for key in DIRECTIONS:
        if key in said:
            said[key] = turned(said[key], turn)


def redraw_part(name: str, part: dict[str, Any], change: Change, pose: Array, drawn: Assembled) -> None:
    """Its features, with x said of faces, and the pose (4, 4) at which it is drawn in the world."""
    turn, shift = change
    for own, said in part.get("features", {}).items():
        frame = drawn.system.assembly.features[f"{name}.{own}"].frame
        redraw_directions(said, turn)
        said["at"] = moved(said["at"], change)
        if "extent" in said:
            said["along"] = (turn @ frame[:3, 0]).tolist()
    new = pose[:3, :3] @ turn.T
    at = pose[:3, 3] - new @ shift
    part["placed"] = {"at": [f"{own!r} mm" for own in at.tolist()], "x": new[:, 0].tolist(), "z": new[:, 2].tolist()}


def pairs_of(move: Mapping[str, Any]) -> Iterator[dict[str, Any]]:
    for key in ("primary", "secondary", "tertiary", "pairs", "contacts", "relations"):
        yield from move.get(key, [])


def redrawn(text: str, drawn: Assembled, poses: Mapping[str, Array]) -> str:
    """The scene with each part in coordinates of its own; parts that are alike keep one drawing."""
    yaml = YAML(typ="safe", pure=True)
    yaml.sort_base_mapping_type_on_output = False  # type: ignore[assignment]  # moves are made in order
    scene = yaml.load(text)
    rng, changes = np.random.default_rng(11), dict[str, Change]()
    for name, part in scene["parts"].items():
        known = changes.get(part.get("like", ""))
        changes[name] = known or (Rotation.random(rng=rng).as_matrix(), rng.uniform(-900, 900, 3))
        redraw_part(name, part, changes[name], poses[name], drawn)

    def turn_of(feature: str | list[str]) -> Array:
        first = feature if isinstance(feature, str) else feature[0]
        return changes[first.partition(".")[0]][0]

    for said in scene["tolerances"].values():
        redraw_directions(said, turn_of(said["of"]))
    for move in scene["moves"].values():
        for pair in pairs_of(move):
            redraw_directions(pair, turn_of(pair["to"]))
        if "pressed" in move:
            redraw_directions(move, turn_of(move["contacts"][0]["to"]))
        if "force" in move:
            move["force"]["at"] = moved(move["force"]["at"], changes[move["part"]])
        if "along" in move.get("float", {}):
            redraw_directions(move["float"], turn_of(move["float"]["at"]))
    for said in scene["measures"].values():
        if "from" in said:
            redraw_directions(said, turn_of(said["from"]))
    page = StringIO()
    yaml.dump(scene, page)
    return page.getvalue()


WITHOUT_ROUND_DRAWS = {
    "door": (),
    "four_pads": (),
    "clutch": (),
    "box_with_discs": (("  socket position: {kind: position", "  # {"),),
    "hole_and_slot": (("float: {kind: random}", "float: {kind: centred}"),),
}
"""Lines left out of a scene so that nothing is drawn in a disc or a ball."""


@pytest.mark.slow
@pytest.mark.parametrize("name", WITHOUT_ROUND_DRAWS)
def test_every_trial_of_a_scene_is_the_same_however_its_parts_are_drawn(name: str, tmp_path: Path) -> None:
    """The ends of what may rock on four pads are sought by steps, to 1e-7 mm."""
    text = (SCENES / f"{name}.yaml").read_text("utf-8")
    for old, new in WITHOUT_ROUND_DRAWS[name]:
        assert old in text
        text = text.replace(old, new)
    made = assembled(text, tmp_path)
    other = assembled(redrawn(text, made, poses_of(load(SCENES / f"{name}.yaml"))), tmp_path)
    for method in ("exact", "analytic"):
        for measure, values in made.drawn(40, method).items():
            within = 1e-7 if name == "four_pads" else 1e-9
            np.testing.assert_allclose(other.drawn(40, method)[measure], values, atol=within, rtol=0, err_msg=measure)


@pytest.mark.slow
@pytest.mark.parametrize("name", ["cover_on_base", "box_with_discs", "bolted_cover"])
def test_closed_forms_of_round_zones_are_the_same_however_parts_are_drawn(name: str, tmp_path: Path) -> None:
    text = (SCENES / f"{name}.yaml").read_text("utf-8")
    made = assembled(text, tmp_path)
    other = assembled(redrawn(text, made, poses_of(load(SCENES / f"{name}.yaml"))), tmp_path)
    compared = 0
    for measure, its in zip(made.system.measures, other.system.measures, strict=True):
        one, two = made.system.closed_form(measure), other.system.closed_form(its)
        assert (one is None) == (two is None)
        if one is not None and two is not None:
            compared += 1
            assert (two.mean, two.sigma) == pytest.approx((one.mean, one.sigma), rel=1e-9, abs=1e-9)
    assert compared > 0
