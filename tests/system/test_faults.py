"""Faults of a mechanism from outside: reported under its name with exit code 3, and not as the user's mistake."""

import pickle
import re
import sys
from collections.abc import Callable, Iterator
from importlib import import_module
from pathlib import Path
from typing import Any

import pytest
from fixtures import Command

import tol3d
from tol3d import kinds
from tol3d.errors import InputError, MechanismError, SceneError
from tol3d.study.execution.pools import Execution
from tol3d.study.system.faults import Origin, UnfitError, faults_of

MODULE = """
from dataclasses import dataclass
from typing import ClassVar, Literal
from tol3d.scene.bases import MoveSpec
from tol3d.scene.name import Name
from tol3d.scene.bases import PartSpec
from tol3d.scene.entry import Reference
from tol3d.scene.bases import ToleranceSpec
from tol3d.study.system.mechanism import Mechanism
from tol3d.study.system.plain import LengthSpec, PlainSystem, contributors_of, measures_of
from tol3d.study.system.method import MethodKind

class BlockSpec(PartSpec):
    words: ClassVar = "a block"
    kind: Literal["block"]

class HeightSpec(ToleranceSpec):
    kind: Literal["height"]
    of: Name
    def references(self):
        return (Reference(("of",), self.of, (BlockSpec,)),)

class LieSpec(MoveSpec):
    words: ClassVar = "lying"
    kind: Literal["lie"]
    def references(self):
        return ()

class TopSpec(LengthSpec):
    kind: Literal["top"]
    def references(self):
        return (Reference(("of",), self.of, (LieSpec,)),)

@dataclass(frozen=True)
class Block(PlainSystem):
    methods: ClassVar = {name: MethodKind("block", threads=False) for name in ("analytic", "exact")}

    def analytic(self, trials, measure):
        return self.deviations(trials, "height")[:, 0]

    def exact(self, trials, measure):
        return self.deviations(trials, "height")[:, 0]

def block(scene):
    return Block(scene.scene, contributors_of(scene, {}), measures_of(scene))

BLOCKS = Mechanism(
    name="blocks", parts=(BlockSpec,), tolerances=(HeightSpec,), moves=(LieSpec,), measures=(TopSpec,),
    system="broken_blocks:block",
)
"""
SCENE = """\
scene: a block
parts: {block: {kind: block}}
tolerances: {height: {kind: height, of: block, distribution: {kind: normal, lower: -3 um, upper: 3 um}}}
moves: {lie: {kind: lie}}
measures: {top: {kind: top, of: lie}}
study: {trials: 40}
"""
SURELY = "a fault in the mechanism 'blocks' (Python module 'broken_blocks'), not in your scene: "
ANALYTIC = 'def analytic(self, trials, measure):\n        return self.deviations(trials, "height")[:, 0]'
EXACT = ANALYTIC.replace("analytic", "exact")
MAKING = "return Block(scene.scene, contributors_of(scene, {}), measures_of(scene))"
Broken = Callable[[str, str], None]

FAULTS = {
    "no such function": ("broken_blocks:block", "broken_blocks:blocked", "AttributeError: module 'broken_blocks' has"),
    "no such module": ('"broken_blocks:', '"broken_blocks.away:', "ModuleNotFoundError: No module named 'broken"),
    "its function fails": (MAKING, "(part,) = ()", "ValueError: not enough values to unpack"),
    "it misuses what tol3d offers": ("contributors_of(scene, {})", "contributors_of(scene, None)", "AttributeError: "),
    "nothing is made": (
        MAKING,
        "pass",
        "expected a tol3d.study.system.system.System, got NoneType without name, contributo",
    ),
    "an attribute is missing": (
        MAKING,
        "class Half: name, measures, contributors = 'half', (), ()\n    return Half()",
        "expected a tol3d.study.system.system.System, got Half without statuses, breakdowns, warnings, problems",
    ),
    "a measure is none": (
        "measures_of(scene))",
        "(3,))",
        "expected a tol3d.study.system.measure.Measure, got int without name, positions, take, lower_limit",
    ),
    "a contributor is none": (
        "contributors_of(scene, {})",
        "('height',)",
        "expected a tol3d.study.system.contributor.Contributor, got str without name, kind",
    ),
    "the analytic method fails": (ANALYTIC, "def analytic(self, *_): return {}['lost']", "KeyError: 'lost'"),
    "the exact method fails": (EXACT, "def exact(self, *_): return 1 / 0", "ZeroDivisionError: division by zero"),
    "the analytic method is missing": (ANALYTIC, "", "Block lacks analytic(trials, measure), its values by theory"),
    "the exact method is missing": (EXACT, "", "Block lacks exact(trials, measure), its values of placed parts"),
    "a column too many": (
        EXACT,
        EXACT.replace("[:, 0]", ""),
        "Block.exact of 'top': expected values (trials,) of 64 trials, got an array of shape (64, 1)",
    ),
    "one number for all": (
        ANALYTIC,
        "def analytic(self, *_): return 0.0",
        "Block.analytic of 'top': expected values (trials,) of 64 trials, got an array of shape ()",
    ),
    "an attribute of a trial's making": (
        "def analytic(",
        "def acting(self, measure): return self.absent\n    def analytic(",
        "AttributeError: 'Block' object has no attribute 'absent'",
    ),
}


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[Path]:
    """A folder with the scene, in which `broken_blocks` is found."""
    (tmp_path / "block.yaml").write_text(SCENE.replace("a block", tmp_path.name), "utf-8")  # a process keeps methods
    monkeypatch.chdir(tmp_path)
    monkeypatch.syspath_prepend(tmp_path)
    monkeypatch.setattr(kinds, "_registered", {})
    yield tmp_path
    sys.modules.pop("broken_blocks", None)


@pytest.fixture
def registered(folder: Path) -> Callable[[str, str], None]:
    """Writes and registers the mechanism, with a text in its module put in another's place."""

    def with_fault(text: str, other: str) -> None:
        assert MODULE.count(text) == 1, text
        (folder / "broken_blocks.py").write_text(MODULE.replace(text, other), "utf-8")
        tol3d.register(import_module("broken_blocks").BLOCKS)

    return with_fault


def test_as_it_is_written_it_runs(registered: Broken) -> None:
    registered("a block", "a block")
    assert tol3d.run_scene("block.yaml", out="run").trials == 40


@pytest.mark.parametrize("what", FAULTS)
def test_a_fault_is_the_mechanisms_and_not_the_users(registered: Broken, tol3d: Command, what: str) -> None:
    text, other, words = FAULTS[what]
    registered(text, other)
    code, out, err = tol3d("run", "block.yaml", "--out", "run")
    assert (code, out) == (3, "")
    first, second, *lines = (line for line in err.splitlines() if line)  # one is empty where a progress bar was
    assert first.replace("broken_blocks.away", "broken_blocks").startswith(SURELY + words)
    assert second == "please report it to its authors with the scene and these lines:"
    assert lines[-1].startswith(("tol3d.study.system.faults.UnfitError: ", words.partition(":")[0]))


@pytest.mark.parametrize("command", ["run", "check"])
def test_of_what_breaks_in_tol3d_both_are_named(registered: Broken, tol3d: Command, command: str) -> None:
    registered("def analytic(", "def describe(self, measure): return None\n    def analytic(")
    code, _, err = tol3d(command, "block.yaml")
    assert code == 3
    assert SURELY.replace(", not", " or in tol3d, not") in err
    assert re.search(r"^(Type|Attribute)Error: 'NoneType' object ", err, re.MULTILINE)


def test_a_scene_that_it_refuses_is_the_users(registered: Broken, tol3d: Command) -> None:
    registered(MAKING, "raise scene.refuse(('parts', 'block'), 'expected two blocks')")
    code, _, err = tol3d("run", "block.yaml")
    assert code == 2
    assert err.endswith("block.yaml:2: parts.block: expected two blocks\n")


@pytest.mark.slow
def test_a_fault_in_a_process_comes_back_with_its_name(registered: Broken, monkeypatch: pytest.MonkeyPatch) -> None:
    """Beyond the pilot trials, which the parent process runs."""
    monkeypatch.setenv("PYTHONPATH", str(Path.cwd()))
    late = "def exact(self, trials, measure):\n        if len(trials) > 64: raise KeyError('late')\n"
    registered(EXACT, late + "        return self.deviations(trials, 'height')[:, 0]")
    with pytest.raises(MechanismError, match=r"mechanism 'blocks' .* not in your scene: KeyError: 'late'"):
        tol3d.run_scene(
            "block.yaml", overrides=tol3d.Overrides(trials=30_000), out="run", execution=Execution(workers=2)
        )


def test_a_fault_in_a_replay_is_named_too(registered: Broken) -> None:
    registered("a block", "a block")
    run = tol3d.run_scene("block.yaml", out="run")
    broken: Any = sys.modules["broken_blocks"].Block

    def fails(*_: Any) -> None:
        raise KeyError("again")

    broken.display = fails
    with pytest.raises(MechanismError, match="KeyError: 'again'"):
        tol3d.replay(run, 3)


def test_a_kind_that_lacks_a_method_is_refused_where_it_is_registered(registered: Broken) -> None:
    returned = "        return ()\n"
    with pytest.raises(InputError, match=r"^blocks\.moves: LieSpec lacks references$"):
        registered("    def references(self):\n" + returned, "")


def test_errors_for_people_warnings_and_what_a_disk_refuses_pass() -> None:
    origin = Origin("blocks", "broken_blocks")
    for error in (InputError("mend it"), SceneError("line 3"), UserWarning("beware"), OSError(28, "full")):
        with pytest.raises(type(error)) as raised, faults_of(origin):
            raise error
        assert raised.value is error


def test_faults_of_tol3ds_own_mechanisms_stay_as_they_are() -> None:
    for origin in (None, Origin("gears", "tol3d.gearing.system")):
        with pytest.raises(KeyError), faults_of(origin):
            raise KeyError("mine")


def test_it_pickles_and_its_cause_is_what_was_raised() -> None:
    with pytest.raises(MechanismError) as raised, faults_of(Origin("blocks", "broken_blocks")):
        raise UnfitError("no values")
    assert isinstance(raised.value.__cause__, UnfitError)
    assert str(pickle.loads(pickle.dumps(raised.value))) == str(raised.value) == SURELY + "no values"
