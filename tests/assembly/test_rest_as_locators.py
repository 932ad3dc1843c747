"""Six one-sided contacts that all carry are locators: the same poses, with all that acts on contacts."""

from collections.abc import Mapping
from pathlib import Path

import numpy as np
import pytest
from assembly_trials import Assembled, assembled
from numpy.typing import NDArray
from places import SCENES

from tol3d import run_scene
from tol3d.simulate import Overrides
from tol3d.study.trials.draws import drawn

Array = NDArray[np.float64]

COVER = (SCENES / "cover_on_base.yaml").read_text("utf-8")
PAIRS = (
    ("A1", "floor"), ("A2", "floor"), ("A3", "floor"), ("B1", "back"), ("B2", "back"), ("C1", "left"),
)  # fmt: skip
SPREAD = "distribution: {kind: normal, mean: 0 mm, sigma: 20 um}"
MORE = f"""  flat floor: {{kind: flatness, of: base.floor, zone: {{width: 0.02 mm}}, law: {{kind: uniform}}}}
  back contact: {{kind: locator, of: cover on the base, pair: "4", {SPREAD}}}
  floor contact: {{kind: locator, of: cover on the base, pair: "2", {SPREAD}}}
"""


def cover(kind: str, key: str, folder: Path, further: str = "") -> Assembled:
    """The cover on the base, its six contacts as another move has them."""
    pairs = "".join(f"      - {{from: cover.{point}, to: base.{plane}}}\n" for point, plane in PAIRS)
    move = f"  cover on the base:\n    kind: {kind}\n    part: cover\n    {key}:\n{pairs}{further}"
    text = COVER[: COVER.index("  cover on the base:")] + move + COVER[COVER.index("\nmeasures:") :]
    text = text.replace("\nmoves:\n", f"\n{MORE}\nmoves:\n")
    return assembled(text, folder)


FORCE = "    force: {direction: [-1, -1, -3], at: [62 mm, 38 mm, 2 mm]}\n"


def values(own: Assembled, method: str) -> Mapping[str, Array]:
    return own.values(drawn(own.simulation, 0, 400), method)


@pytest.mark.parametrize("method", ["exact", "analytic"])
def test_six_contacts_that_a_force_presses_are_six_planes(method: str, tmp_path: Path) -> None:
    held = values(cover("six_plane", "pairs", tmp_path), method)
    resting = cover("rest", "contacts", tmp_path, FORCE)
    rested = values(resting, method)
    assert held.keys() == rested.keys()
    for name, own in rested.items():
        assert own.std() > 0.03
        assert np.abs(own - held[name]).max() < 1e-10
    method_of = resting.system.method("exact", None)
    carried = method_of.answers(drawn(resting.simulation, 0, 50), resting.system.measures).details
    assert set(carried["carries:cover on the base"].tolist()) == {"1 2 3 4 5 6"}


def test_a_study_whose_every_trial_rocks_says_so_and_warns_once(
    tmp_path: Path, recwarn: pytest.WarningsRecorder
) -> None:
    text = (SCENES / "four_pads.yaml").read_text("utf-8").replace("    rocking: largest ", "    # ")
    text = text.replace(", rocking: middle}", "}")
    scene = tmp_path / "pads.yaml"
    scene.write_text(text, "utf-8")
    found = run_scene(scene, overrides=Overrides(trials=2000), out=tmp_path / "run").summary
    counts = found["measures"]["gap at pad 1"]["status"]
    assert counts["ok"] + counts["not unique"] == 2000
    assert 900 < counts["not unique"] < 1100
    assert found["measures"]["tilt about x"]["status"]["not unique"] == 2000
    assert [str(own.message) for own in recwarn if own.category is RuntimeWarning] == []
