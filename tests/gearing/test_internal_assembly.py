"""A scene whose gear does not go into its ring along the line of centres says so; others do not."""

from pathlib import Path

from places import SCENES

from tol3d import load_scene
from tol3d.gearing.model import model_from_scene


def warnings_of(scene: Path) -> tuple[str, ...]:
    return model_from_scene(load_scene(scene)).warnings


def test_a_ring_with_few_teeth_more_takes_its_gear_along_the_axis_only(tmp_path: Path) -> None:
    text = (SCENES / "internal_pair.yaml").read_text("utf-8")
    changes = {
        "teeth: 22": "teeth: 40\n    addendum: 0.6",
        "teeth: 66": "teeth: 46",
        "addendum: 0.9": "addendum: 0.6",
        "centre_distance: 32.9 mm": "centre_distance: 4.45 mm",
        "outer_diameter: 115 mm": "outer_diameter: 90 mm",
    }
    for old, new in changes.items():
        assert old in text
        text = text.replace(old, new, 1)
    few = tmp_path / "few.yaml"
    few.write_text(text, "utf-8")
    assert warnings_of(few) == (
        "gear pair: the gear of 40 teeth goes into the ring of 46 along its axis only: moved along the line of "
        "centres its teeth meet the ring's",
    )
    assert [warnings_of(SCENES / f"{name}.yaml") for name in ("internal_pair", "ring_train", "spur_pair")] == [
        (),
        (),
        (),
    ]
