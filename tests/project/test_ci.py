"""Contents of CI: README's commands as they stand, its system libraries, the oldest versions that are promised."""

import os
import re
import shutil
import subprocess
import sys
import tomllib
from pathlib import Path

import pytest
from places import ROOT
from sets import SETS

README = (ROOT / "README.md").read_text("utf-8")
RUN = ROOT / ".ci" / "run"
OLDEST = ROOT / ".ci" / "oldest.py"
PROJECT = tomllib.loads((ROOT / "pyproject.toml").read_text("utf-8"))["project"]
HANGS = 120  # s; a guard against waiting for ever, no claim

STAND_IN = """#!/bin/bash
name=$(basename "$0")
echo "$PWD|$name $*" >>"$CALLS"
if [ "$name $1 $2" = "python3 -m venv" ]; then
    mkdir -p "$3/bin"
    for made in python pip tol3d pytest ruff mypy lint-imports; do cp "$0" "$3/bin/$made"; done
elif [ "$1" = ".ci/oldest.py" ]; then
    exec REAL "$@"
elif [ "$1" = "-m" ] && [ "$2" = "slow" ]; then
    echo "3 passed in 1.00s"
fi
"""


def output(*arguments: str) -> list[str]:
    done = subprocess.run(arguments, cwd=ROOT, capture_output=True, text=True, check=True, timeout=HANGS)
    return done.stdout.split()


@pytest.fixture(scope="module")
def calls(tmp_path_factory: pytest.TempPathFactory) -> list[tuple[str, str]]:
    """Calls of .ci/run, and their folders, with stand-ins for Python and for the contents of a virtual environment."""
    if shutil.which("git") is None or shutil.which("bash") is None:
        pytest.skip("no git or bash here")
    folder = tmp_path_factory.mktemp("ci")
    tree, stand_ins = folder / "tree", folder / "bin"
    for name in (".ci", "README.md", "pyproject.toml"):
        target = tree / name
        target.parent.mkdir(parents=True, exist_ok=True)
        shutil.copytree(ROOT / name, target) if (ROOT / name).is_dir() else shutil.copy(ROOT / name, target)
    (tree / ".venv").mkdir()
    (tree / ".venv" / "mine").touch()
    (tree / ".gitignore").write_text(".venv/\n")
    git = ("git", "-c", "user.name=a", "-c", "user.email=a@b")
    for words in (("init", "-q"), ("add", "-A"), ("commit", "-q", "-m", "all")):
        subprocess.run((*git, *words), cwd=tree, check=True)
    stand_ins.mkdir()
    for name in ("python3", "apt-get", "dpkg"):
        (stand_ins / name).write_text(STAND_IN.replace("REAL", sys.executable))
        (stand_ins / name).chmod(0o755)
    told = folder / "calls"
    environment = os.environ | {"PATH": f"{stand_ins}:{os.environ['PATH']}", "CALLS": str(told), "TMPDIR": str(folder)}
    done = subprocess.run(
        [tree / ".ci" / "run"], cwd=tree, env=environment, capture_output=True, text=True, timeout=HANGS
    )
    assert done.returncode == 0, done.stderr
    assert done.stdout.splitlines()[-1] == "3 passed in 1.00s"  # pytest's own summary
    assert [path.name for path in (tree / ".venv").iterdir()] == ["mine"]  # the caller's own
    assert sorted(path.name for path in tree.iterdir()) == [
        ".ci",
        ".git",
        ".gitignore",
        ".venv",
        "README.md",
        "pyproject.toml",
    ]
    assert sorted(path.name for path in folder.iterdir()) == ["bin", "calls", "tree"]  # nothing is left
    return [(line.partition("|")[0], line.partition("|")[2]) for line in told.read_text("utf-8").splitlines()]


def test_ci_runs_the_readme_s_commands_each_in_a_copy_of_its_own(calls: list[tuple[str, str]]) -> None:
    said = [words for _, words in calls]
    first, second = (  # environments are made meanwhile
        [words for folder, words in calls if Path(folder).name == copy] for copy in ("first", "second")
    )
    assert first[:3] == ["python3 -m venv .venv", "pip install -e .", "tol3d run scenes/spur_pair.yaml"]
    assert second[:3] == ["python3 -m venv .venv", "pip install -e .[test]", "pytest "]
    assert said.index("tol3d schema") < said.index(second[2])
    folders = {Path(folder).name for folder, words in calls if words.startswith(("pip", "tol3d", "pytest"))}
    assert folders == {"first", "oldest", "second"}
    assert all("pip install" not in words or "[test]" not in words for f, words in calls if Path(f).name == "first")


def test_a_scene_and_a_report_come_from_the_wheel_in_the_bare_environment_without_the_tree(
    calls: list[tuple[str, str]],
) -> None:
    first = [words for folder, words in calls if Path(folder).name == "first"]
    made = first[first.index("tol3d schema") + 1 :]
    assert made == ["pip install -q ./*.whl", "tol3d run spur_pair", "tol3d report runs/spur_pair"]
    (built,) = (folder for folder, words in calls if words.startswith("python -m build --wheel"))
    assert Path(built).name == "second"


def test_it_checks_style_types_and_layers_and_runs_the_slow_tests(calls: list[tuple[str, str]]) -> None:
    said = [words for _, words in calls]
    slow = next(words for words in said if words.startswith("pytest -m slow"))
    last = said[said.index("pytest ") + 1 :]
    assert {"ruff check .", "mypy ", "lint-imports --no-cache", slow} <= set(last)


def test_the_oldest_versions_are_tested(calls: list[tuple[str, str]]) -> None:
    tests = " ".join(output(sys.executable, str(OLDEST), "--tests"))
    said = [(Path(folder).name, words) for folder, words in calls]
    assert ("oldest", f"pytest {tests}") in said


def test_it_asks_for_the_system_s_libraries_that_the_readme_lists(calls: list[tuple[str, str]]) -> None:
    (listed,) = re.findall(r"Debian's `([^`]*)`", README)
    assert ("dpkg", f"-s {listed}") in {(words.split()[0], words.partition(" ")[2]) for _, words in calls}
    assert "libgl1" not in RUN.read_text("utf-8").replace("`libgl1[^`]*`", "")  # read out of the README


def test_the_oldest_versions_are_the_lower_bounds(calls: list[tuple[str, str]]) -> None:
    versions = output(sys.executable, str(OLDEST), "pyproject.toml")
    declared = [*PROJECT["dependencies"], *PROJECT["optional-dependencies"]["test"]]
    assert len(versions) == len(declared)
    for version, requirement in zip(versions, declared, strict=True):
        name, _, number = version.partition("==")
        assert requirement.partition(",")[0] == f"{name}>={number}"
    (asked,) = (words for _, words in calls if "oldest.txt" in words and words.startswith("pip"))
    assert asked == "pip install -q -c oldest.txt -e .[test]"


def test_a_package_has_one_lower_bound() -> None:
    """pip would find no version for two of them taken as the oldest."""
    extras = [requirement for group in PROJECT["optional-dependencies"].values() for requirement in group]
    bounds: dict[str, set[str]] = {}
    for requirement in [*PROJECT["dependencies"], *extras]:
        name, _, bound = requirement.partition(">=")
        bounds.setdefault(name, set()).add(bound)
    assert {name: found for name, found in bounds.items() if len(found) > 1} == {}


def test_the_tests_that_meet_the_oldest_versions_are_there() -> None:
    named = output(sys.executable, str(OLDEST), "--tests")
    assert len(named) == len(set(named)) > 5
    assert [name for name in named if not (ROOT / name).is_file()] == []


@pytest.mark.parametrize("chosen", ["default", "ci"])
def test_tests_that_leave_a_set_are_there(chosen: str) -> None:
    listed = [test.split("::") for test in SETS[chosen]]
    assert [own for own in listed if f"\ndef {own[1]}(" not in (ROOT / own[0]).read_text("utf-8")] == []
