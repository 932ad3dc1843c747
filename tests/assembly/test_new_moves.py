"""A move from outside the package joins bundled scenes; and how many places of the package still tell moves apart."""

import re
from collections import Counter
from collections.abc import Iterator
from dataclasses import replace
from importlib import import_module
from pathlib import Path
from typing import Any, Literal

import numpy as np
import pytest
from numpy.typing import NDArray
from of_kind import of_kind
from places import ROOT, SCENES
from toys.registered import known
from toys.shim import ACTS, SHIMS, ShimSpec

from tol3d import Overrides, SceneError, load_scene, run_scene
from tol3d.assembly.grammar.moves import AssemblyMoveSpec, PlacingSpec
from tol3d.assembly.model import Move
from tol3d.assembly.placing.placer import Placer
from tol3d.assembly.presenting.parts_tree import parts_tree
from tol3d.assembly.presenting.tables import freedom_blocks
from tol3d.assembly.system import AssemblySystem
from tol3d.errors import InputError
from tol3d.import_path import named
from tol3d.scene.entry import kind_of
from tol3d.simulate import simulation_of
from tol3d.study.system.mechanism import Mechanism
from tol3d.study.system.stated import component_slices
from tol3d.study.trials.draws import drawn

Array = NDArray[np.float64]

UNIFORM = {"kind": "uniform", "lower": "-20 um", "upper": "50 um"}
SHIMMED = {
    "door": ("hanging", "door", "door.upper hinge", "body.upper hinge"),
    "cover_on_base": ("cover on the base", "cover", "cover.A1", "base.floor"),
}
"""By bundled scene: the move that a shim stands for, the part, and the seat."""
COUNT = 50


def shimmed(name: str) -> Any:
    """A bundled scene with a shim for its move."""
    move, part, start, end = SHIMMED[name]
    own = {"kind": "shim", "part": part, "seat": {"from": start, "to": end}, "thickness": UNIFORM}
    return load_scene(SCENES / f"{name}.yaml").with_({f"moves.{move}": own})


@pytest.fixture(autouse=True)
def shims() -> Iterator[None]:
    with known(SHIMS):
        yield


@pytest.mark.parametrize("method", ["exact", "analytic"])
def test_a_shim_joins_two_bundled_scenes(method: str) -> None:
    """By hand, as points without turns only shift: gaps and flushes are sums of deviations in mm."""
    for name in SHIMMED:
        simulation = simulation_of(shimmed(name))
        system, trials = simulation.system, drawn(simulation, 0, COUNT)
        rows = {own: trials.deviations[:, columns.start] for own, columns in component_slices(system).items()}
        found = system.method(method, None).answers(trials, system.measures).values
        shim = rows[f"thickness of {SHIMMED[name][0]}"]
        assert np.ptp(shim) > 0.03
        if name == "door":
            hinge = {axis: rows[f"body upper hinge {axis}"] - rows[f"door upper hinge {axis}"] for axis in "xyz"}
            expected = {
                "upper gap": 4.0 + rows["upper edge x"] - hinge["x"],
                "lower gap": 4.0 + rows["lower edge x"] - hinge["x"],
                "roof gap": 4.0 + rows["roof edge z"] - hinge["z"],
                "upper flush": hinge["y"] + shim - rows["upper edge y"],
            }
        else:
            expected = {"flush": rows["cover thickness"] + shim - rows["rim height"]}
        for key, values in expected.items():
            np.testing.assert_allclose(found[key][:, 0], values, rtol=0, atol=1e-9, err_msg=f"{name}: {key}")


def test_a_shim_is_told_as_any_move(tmp_path: Path) -> None:
    simulation = simulation_of(shimmed("door"))
    assembly = of_kind(AssemblySystem, simulation.system).assembly
    assert "door: shimmed on body (move hanging)" in repr(parts_tree(assembly))
    assert "('all six of door', 'body.upper hinge')" in repr(freedom_blocks(assembly))
    summary = run_scene(shimmed("door"), overrides=Overrides(trials=200), out=tmp_path / "run").summary
    flush = summary["measures"]["upper flush"]
    assert flush["agreement"]["explanation"]["faults"] == []
    assert "thickness of hanging" in [own["name"] for own in flush["contributors"]]


def test_a_shim_is_refused_as_any_move() -> None:
    own = shimmed("door")
    with pytest.raises(
        SceneError, match=r"moves\.hanging\.part: expected a part that is not placed yet, got 'door', which 'car'"
    ):
        own.with_({"moves.car.part": "door"})
    with pytest.raises(
        SceneError, match=r"seat\.from: expected a feature of the part that is placed, got 'body\.striker'"
    ):
        own.with_({"moves.hanging.seat.from": "body.striker"})


class NowhereSpec(ShimSpec):
    """A move without its exact method."""

    acts = replace(ACTS, placing=f"{__name__}:forgotten")

    kind: Literal["nowhere"]  # type: ignore[assignment]


class UnstatedSpec(ShimSpec):
    """A move that nothing makes."""

    stated_by = ""

    kind: Literal["unstated"]  # type: ignore[assignment]


class IdleSpec(PlacingSpec):
    """A move without methods."""

    kind: Literal["idle"]


@pytest.mark.parametrize(
    ("spec", "lack"),
    [
        (NowhereSpec, f"its placing: expected `package.module:function`, got '{__name__}:forgotten', where nothing is"),
        (UnstatedSpec, "`stated_by`: expected `package.module:function`, got '', where nothing is"),
        (IdleSpec, "`acts`, the two methods that carry it out"),
    ],
    ids=lambda own: own.__name__ if isinstance(own, type) else "",
)
def test_a_move_that_lacks_code_is_refused_as_it_is_registered(spec: type[AssemblyMoveSpec], lack: str) -> None:
    own = Mechanism(name="own", extends=("assembly",), moves=(spec,))
    with pytest.raises(InputError, match=rf"^own\.moves: {kind_of(spec)} lacks {re.escape(lack)}$"), known(own):
        pass


# one door -------------------------------------------------------------------------------------------

TOLD_APART = {
    "tol3d/assembly/grammar/moves/assembly_move.py: AssemblyMoveSpec": 2,
    "tol3d/gearing/machine/from_scene.py: AssemblyMoveSpec": 1,
    "tol3d/assembly/placing/plan.py: RockingPlacer": 1,
    "tol3d/assembly/placing/plan.py: RoomPlacer": 1,
    "tol3d/assembly/linkage/presenting/workspace_picture.py: CloseLoopSpec": 1,
    "tol3d/assembly/linkage/presenting/workspace_picture.py: ClosedLoop": 1,
}
"""Places that tell a kind of move by its class: those where other moves stand beside, and a move's own code. These may
only become fewer."""


ASKS = re.compile(r"is(?:instance|subclass)\((?:[^()]|\([^()]*\))*\)|^ +case .*$", re.MULTILINE)


def kinds_of(base: type) -> Iterator[type]:
    """A class, and all that are derived from it."""
    yield base
    derived: list[type] = base.__subclasses__()
    for own in derived:
        yield from kinds_of(own)


def test_no_more_places_tell_kinds_of_moves_by_their_classes() -> None:
    """isinstance and `case` of moves, of their specs and of their placers; a name may be of another class, too."""
    for spec in kinds_of(AssemblyMoveSpec):
        if (acts := getattr(spec, "acts", None)) is not None and acts.placing.startswith("tol3d."):
            named(acts.placing)
    kinds = {own.__name__: own for base in (Move, AssemblyMoveSpec, Placer) for own in kinds_of(base)}
    assert len(kinds) > 30
    found: Counter[str] = Counter()
    for path in (path for room in ("assembly", "gearing/machine") for path in (ROOT / "tol3d" / room).rglob("*.py")):
        place = path.relative_to(ROOT)
        words = [word for asked in ASKS.findall(path.read_text("utf-8")) for word in re.findall(r"[A-Z]\w+", asked)]
        for word in (word for word in words if word in kinds):
            module = import_module(".".join(place.with_suffix("").parts).removesuffix(".__init__"))
            if getattr(module, word) is kinds[word]:
                found[f"{place}: {word}"] += 1
    assert found == TOLD_APART
