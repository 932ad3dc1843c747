"""Numbers that no scene means: each is refused with its place and what would do, or simulated; none is a fault."""

import random
import re
import shutil
import warnings
from collections.abc import Iterator
from io import StringIO
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from fixtures import Command
from places import SCENES
from rich.console import Console
from ruamel.yaml import YAML
from scene_texts import edited, refusal, written

from tol3d import InputError, Overrides, run_scene
from tol3d.report import check_report, run_report
from tol3d.simulate import load, simulation_of
from tol3d.units import FACTORS, LARGEST, LEAST_POSITIVE

NUMBER_UNIT = re.compile(r"\s*[+-]?[0-9.]+(?:[eE][+-]?[0-9]+)?\s+(\S+)\s*")
NUMBERS = ("1e300", "-1e300", "1e-300", "1e12", "-1e9", "1e6", "1e-12", "0")
WHOLE = (10**30, 10**9, 10**6, 0, -1)
REAL = (1e300, -1e300, 1e-300, 1e9, 0.0)
KeyPath = tuple[str | int, ...]


def leaves(value: Any, path: KeyPath = ()) -> Iterator[tuple[KeyPath, Any]]:
    if isinstance(value, dict):
        for key, item in value.items():
            yield from leaves(item, (*path, key))
    elif isinstance(value, list):
        for index, item in enumerate(value):
            yield from leaves(item, (*path, index))
    else:
        yield path, value


def absurd(value: Any) -> list[Any]:
    """Values that may stand in a number's place."""
    if isinstance(value, str) and (match := NUMBER_UNIT.fullmatch(value)):
        return [f"{number} {match[1]}" for number in NUMBERS]
    if isinstance(value, bool) or not isinstance(value, int | float):
        return []
    return list(WHOLE if isinstance(value, int) else REAL)


def made_absurd(name: str, share: float) -> Iterator[tuple[KeyPath, Any, str]]:
    """Scenes with one absurd number, the same ones every time."""
    text, chosen = (SCENES / f"{name}.yaml").read_text("utf-8"), random.Random(name)
    for path, value in leaves(_read(text)):
        for wrong in absurd(value):
            if chosen.random() < share:
                data = at = _read(text)
                for key in path[:-1]:
                    at = at[key]
                at[path[-1]] = wrong
                stream = StringIO()
                YAML().dump(data, stream)
                yield path, wrong, stream.getvalue()


def _read(text: str) -> Any:
    return YAML(typ="safe", pure=True).load(text)


def printed(report: Any) -> str:
    page = StringIO()
    Console(file=page, width=120, markup=False).print(report)
    return page.getvalue()


@pytest.mark.parametrize(
    ("name", "share"),
    [
        ("spur_pair", 0.15),
        pytest.param("every_field", 0.02, marks=pytest.mark.slow),
        pytest.param("every_field", 0.15, marks=pytest.mark.slow),
        ("every_bevel_field", 0.15),
        pytest.param("robot_shoulder_swing", 0.15, marks=pytest.mark.slow),
    ],
)
def test_an_absurd_number_is_refused_or_checked(name: str, share: float, tmp_path: Path) -> None:
    for file in SCENES.glob("*.csv"):
        shutil.copy(file, tmp_path)
    said, checked = [], 0
    for _, _, text in made_absurd(name, share):
        scene = written(text, tmp_path)
        try:
            printed(check_report(simulation_of(load(scene))))
            checked += 1
        except InputError as error:  # anything else would be a fault
            said.append(str(error))
    assert checked > 5
    assert len(said) > 15
    assert all(text.startswith(str(tmp_path / "scene.yaml")) for text in said)


TILTED = """
scene: a dimension along a tilted direction
parts:
  pin: {{kind: solid, features: {{
    foot: {{kind: plane, at: [0 mm, 0 mm, 0 mm], normal: {down}, extent: [9 mm, 9 mm]}},
    bore: {{kind: cylinder, at: [3 mm, 4 mm, 20 mm], axis: {aside}, length: 8 mm, diameter: 4 mm, hole: true}}}}}}
tolerances:
  height: {{kind: plus_minus, of: pin.bore, datums: [foot], along: {up}, distribution: {{kind: uniform, lower: -1 um, upper: 3 um}}}}
moves:
  put: {{kind: fix, part: pin}}
measures:
  rise: {{kind: gap, from: pin.foot, to: pin.bore, along: {askew}}}
study: {{trials: 30, seed: 2}}
"""  # noqa: E501
DIRECTIONS = {"up": (0.0, 0.0, 1.0), "down": (0.0, 0.0, -1.0), "aside": (1.0, 0.0, 0.0), "askew": (0.0, 0.6, 0.8)}


def test_directions_of_any_length_mean_the_same(tmp_path: Path) -> None:
    found = {}
    for length in (1.0, 3e155, 7e-200):
        words = {name: str([length * number for number in direction]) for name, direction in DIRECTIONS.items()}
        scene = written(TILTED.format(**words), tmp_path)
        found[length] = run_scene(scene, out=tmp_path / f"{length}").columns()
    # the height's deviation is along z, of which the measure's direction has 0.8; -1 to 3 um, mean 1 um
    rise = found[1.0]["geometric:rise"]
    assert np.ptp(rise) > 2.0 * 0.8
    assert abs(rise.mean() - (0.6 * 4e3 + 0.8 * 20e3) - 0.8 * 1.0) < 4 * 0.8 * 4.0 / 12**0.5 / 30**0.5
    for length, columns in found.items():
        for name, values in ((name, own) for name, own in columns.items() if own.dtype.kind == "f"):
            assert np.allclose(values, found[1.0][name], rtol=1e-12, atol=1e-9), (length, name)


@pytest.mark.slow
@pytest.mark.filterwarnings("ignore")
@pytest.mark.parametrize("engine", ["exact", "analytic"])
@pytest.mark.parametrize("name", ["spur_pair", "every_field", "every_bevel_field", "robot_shoulder_swing"])
def test_an_absurd_number_is_refused_or_simulated(name: str, engine: str, tmp_path: Path) -> None:
    for file in SCENES.glob("*.csv"):
        shutil.copy(file, tmp_path)
    simulated = 0
    for _, _, text in made_absurd(name, 0.2):
        scene = written(text, tmp_path)
        study = Overrides(trials=3, engine=engine, witness=0)
        try:
            run = run_scene(scene, overrides=study, out=tmp_path / "run", force=True)
            printed(run_report(run.found))
            simulated += 1
        except InputError:
            continue
    assert simulated > 5


ABSURD = {
    "face_width": ("face_width: 20 mm", "face_width: 1e300 mm", "parts.pinion.face_width", "1e+06 mm"),
    "module": ("module: 2.5 mm", "module: 1e300 mm", "parts.pinion.module", "1e+06 mm"),
    "fine module": ("module: 2.5 mm", "module: 1e-300 mm", "parts.pinion.module", "at least 1e-09 mm"),
    "teeth": ("teeth: 28", "teeth: 1000000000", "parts.pinion.teeth", "at most 10000"),
    "distance": ("centre_distance: 172.5 mm", "centre_distance: 1e9 m", "moves.gear pair.centre_distance", "1e+06 mm"),
    "law": ("scale: 4.5 um", "scale: 1e200 um", "tolerances.pinion eccentricity.distribution.scale", "1e+06 mm"),
    "limit": ("lower_limit: 15 um", "lower_limit: -1e100 m", "measures.normal backlash.lower_limit", "1e+06 mm"),
    "trials": ("trials: 2000", f"trials: {10**30}", "study.trials", "at most 1e+10"),
    "seed": ("seed: 1", f"seed: {10**30}", "study.seed", "at most"),
}


@pytest.mark.parametrize(("old", "new", "place", "expected"), ABSURD.values(), ids=ABSURD)
def test_an_absurd_number_is_refused_with_its_place_and_what_would_do(
    old: str, new: str, place: str, expected: str, tmp_path: Path
) -> None:
    said = refusal(edited((SCENES / "spur_pair.yaml").read_text("utf-8"), (old, new)), tmp_path)
    assert place in said
    assert expected in said


def test_a_limit_as_a_run_s_option_is_refused_alike(tol3d: Command, tmp_path: Path) -> None:
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        code, _, err = tol3d("run", "spur_pair", "--trials", str(10**30), "--out", str(tmp_path / "run"))
    assert code == 2
    assert "trials" in err
    assert not (tmp_path / "run").exists()


def test_bounds_of_quantities_stay_finite_in_products() -> None:
    # volumes and fourth powers of the largest length, and the curvature of the least, are far from a double's ends
    assert LARGEST["length"] ** 4 / LEAST_POSITIVE**2 < 1e300
    assert LARGEST.keys() == FACTORS.keys()
