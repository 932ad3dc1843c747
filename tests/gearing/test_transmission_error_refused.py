"""Refused requests for a transmission error: one message each, with its place."""

import json
from pathlib import Path
from typing import Any

import pytest
from places import SCENES
from ruamel.yaml import YAML
from scene_texts import scene_of

from tol3d.errors import SceneError
from tol3d.gearing.effects import TurningOffset
from tol3d.gearing.model import Model, model_from_scene


def model_of(folder: Path, scene: str, of: str, moves: dict[str, Any] | None = None, **fields: Any) -> Model:
    """A shipped scene that asks for a transmission error and nothing else."""
    known: dict[str, Any] = YAML(typ="safe").load((SCENES / f"{scene}.yaml").read_text("utf-8"))
    known.pop("published", None)
    for name, changed in (moves or {}).items():
        known["moves"][name] |= changed
    known["measures"] = {"error": {"kind": "transmission_error", "of": of} | fields}
    return model_from_scene(scene_of(json.dumps(known, ensure_ascii=False), folder))


def refused(folder: Path, scene: str, of: str, moves: dict[str, Any] | None = None, **fields: Any) -> str:
    with pytest.raises(SceneError) as caught:
        model_of(folder, scene, of, moves, **fields)
    (message,) = str(caught.value).splitlines()
    assert message.startswith(f"{folder / 'scene.yaml'}:")
    return message


def test_a_reducer_whose_error_nobody_states(tmp_path: Path) -> None:
    message = refused(tmp_path, "robot_shoulder", "shoulder swing", over="turn")
    assert "measures.error.of: expected meshes in series from 'motor' to 'shoulder flange', got" in message
    assert "'planetary reducer', a reducer whose error from position to position is not known" in message


def test_load_paths_in_parallel(tmp_path: Path) -> None:
    message = refused(tmp_path, "split_train", "stage", over="turn")
    assert (
        "got the parallel load paths left fast + left slow ∥ right fast + right slow; measure mesh by mesh" in message
    )


@pytest.mark.parametrize("over", ["random", {"at": "3 deg"}])
def test_one_position_has_no_error(over: object, tmp_path: Path) -> None:
    assert "measures.error.over: expected turn or long_period" in refused(
        tmp_path, "two_sided_te", "gear pair", over=over
    )


def test_a_value_at_one_position_is_not_taken(tmp_path: Path) -> None:
    assert "measures.error.take: expected" in refused(tmp_path, "two_sided_te", "gear pair", take="value")


def test_of_something_that_is_no_mesh_and_no_train(tmp_path: Path) -> None:
    assert "measures.error.of" in refused(tmp_path, "two_sided_te", "gear pear")


def test_more_positions_than_a_trial_may_have(tmp_path: Path) -> None:
    model_of(tmp_path, "spur_pair", "gear pair", positions=18_181)
    message = refused(tmp_path, "spur_pair", "gear pair", positions=18_182)
    assert "expected up to 1000000 positions in all, got 18182 a turn over 55 turns" in message


def test_fewer_than_sixteen_positions_a_tooth_where_teeth_deviate(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    model_of(tmp_path, "two_sided_te", "gear pair", positions=431)
    monkeypatch.setattr(TurningOffset, "deviates_teeth", lambda effect, gear: gear == "wheel")
    model_of(tmp_path, "two_sided_te", "gear pair", positions=432)  # 16 times 27
    message = refused(tmp_path, "two_sided_te", "gear pair", positions=431)
    assert "measures.error.positions: expected at least 432, 16 for each tooth that 'gear pair' goes through" in message
    assert "because single teeth of 'wheel' deviate; got 431" in message
