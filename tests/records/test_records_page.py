"""The example of docs/records.md does what the page shows."""

import json
import re
import shlex
from pathlib import Path

import jsonschema
import pytest
from fixtures import Command
from places import ROOT
from records.rigged import LARGEST, LEAST

from tol3d import run_scene
from tol3d.cli.console import out_console

PAGE = (ROOT / "docs" / "records.md").read_text("utf-8")
WIDTH = 100


def fences(kind: str) -> list[str]:
    return re.findall(rf"^```{kind}\n(.*?)^```", PAGE, re.MULTILINE | re.DOTALL)


def commands(first: int = 1, last: int = 3) -> list[list[str]]:
    """Commands of some of the page's fences, without tol3d: of the example and the plan."""
    lines = "\n".join(fences("sh")[first:last]).replace("\\\n", " ").splitlines()
    return [shlex.split(line)[1:] for line in lines if line.strip()]


def plain(said: str) -> str:
    return "\n".join(line.rstrip() for line in said.splitlines())


def played(tol3d: Command, folder: Path, monkeypatch: pytest.MonkeyPatch) -> str:
    """Output of the commands, but for the run."""
    monkeypatch.chdir(folder)
    monkeypatch.setattr(out_console, "_width", WIDTH)
    monkeypatch.setattr(out_console, "_height", 100)
    (folder / "pair.yaml").write_text(fences("yaml")[0], encoding="utf-8")
    printed = ""
    for arguments in commands():
        if arguments[0] != "run":
            code, out, err = tol3d(*arguments)
            assert (code, err) == (0, ""), arguments
            printed += plain(out) + "\n"
    return printed


def test_the_example_prints_what_the_page_shows(
    tol3d: Command, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    printed = played(tol3d, tmp_path, monkeypatch)
    names = {"identified.json", "identified.csv", "identified.yaml", "backlash.csv", "backlash.png", "residual.png"}
    assert {path.name for path in (tmp_path / "identified").iterdir()} == names
    assert [arguments[0] for arguments in commands()] == ["rig", "identify", "run", "plan-rig"]
    for shown in fences("text"):
        assert plain(shown) in printed


def test_the_json_is_as_its_schema_says(tol3d: Command, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    played(tol3d, tmp_path, monkeypatch)
    code, schema, _ = tol3d("schema", "--identified")
    assert code == 0
    kept = json.loads((tmp_path / "identified" / "identified.json").read_text("utf-8"))
    jsonschema.validate(kept, json.loads(schema))
    assert kept["figures"]["jmin"]["unit"] == "arcsec"


@pytest.mark.slow
def test_the_identified_scene_of_the_example_runs(
    tol3d: Command, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    played(tol3d, tmp_path, monkeypatch)
    found = run_scene("identified/identified.yaml", out="run").found.measures
    for name, true in (("least backlash", LEAST), ("largest backlash", LARGEST)):
        geometric = found[name].geometric
        assert geometric is not None
        assert geometric.mean is not None
        assert 60 * geometric.mean == pytest.approx(true, abs=0.1)


@pytest.mark.slow
def test_the_rigs_of_the_exact_engine_on_the_page_measure(
    tol3d: Command, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    shown = commands(3, 4)
    assert [arguments[:2] for arguments in shown] == [["rig", "tooth_deviations"], ["rig", "housed_gears"]]
    for arguments in shown:
        code, out, err = tol3d(*arguments)
        assert (code, err) == (0, "")
        assert out.split() == ["measured/drive.csv", "measured/back.csv"]
