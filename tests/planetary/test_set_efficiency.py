"""Efficiencies of a scene's set: those of the design, textbook formulas, and what summaries and tables show of them."""

import io
from dataclasses import replace
from pathlib import Path

import pytest
from places import SCENES
from planetary_sets import external, reducer_3k, ring, set_of
from rich.console import Console
from scene_texts import edited, refusal

from tol3d import Overrides, run_scene
from tol3d.apps.design.shifted_set import ShiftedSet
from tol3d.apps.design.working_mesh import BasicRack
from tol3d.gearing.planetary.model.tooth_set import wolfrom
from tol3d.gearing.planetary.sections import formula_efficiency, mesh_efficiencies, set_efficiency
from tol3d.report import run_report

FRICTION = 0.08


@pytest.mark.parametrize("sharing", ["formula", "equal shares"])
def test_meshes_lose_what_those_of_the_design_lose(sharing: str) -> None:
    designed = ShiftedSet(wolfrom(25, 27, 79, 24, 76), BasicRack(), 26.0, (0.0, 0.0))
    found = mesh_efficiencies(reducer_3k(), FRICTION, sharing)  # type: ignore[arg-type]
    assert found == pytest.approx(designed.mesh_efficiencies(FRICTION, sharing), rel=1e-12)  # type: ignore[arg-type]


def test_the_published_set_has_its_printed_efficiencies() -> None:
    """The digits that a balance of torques and the closed form have by hand: E 0.69265, 0.97524, 0.97470."""
    found = formula_efficiency(reducer_3k(), FRICTION)
    assert found is not None
    assert (found.forward, found.backward) == pytest.approx((0.85163, 0.82856), abs=5e-6)
    balanced = set_efficiency(reducer_3k(), FRICTION)
    assert (balanced.forward, balanced.backward) == pytest.approx((0.85330, 0.83083), abs=1e-5)


def test_a_simple_set_has_the_efficiency_of_the_books() -> None:
    """Ring held, sun to carrier: (1 + eta_0 z_R/z_S)/(1 + z_R/z_S), eta_0 of both meshes; 1 without friction."""
    planet = external("P", 21)
    own = set_of([(external("sun", 24), planet), (ring("ring", 66), planet)], 22.5, 3, ("ring", "sun", "carrier"))
    meshes = mesh_efficiencies(own, FRICTION, "equal shares")
    both = meshes["sun"] * meshes["ring"]
    assert set_efficiency(own, FRICTION).forward == pytest.approx((1 + both * 66 / 24) / (1 + 66 / 24), rel=1e-12)
    assert set_efficiency(own, 0.0).forward == pytest.approx(1.0, rel=1e-12)
    assert formula_efficiency(own, FRICTION) is None


def test_a_carrier_of_another_name_and_a_set_driven_backwards_are_the_same_set() -> None:
    own = reducer_3k()
    turned = replace(own, carrier="spider", input="ring 2", output="sun")
    there, back = set_efficiency(own, FRICTION), set_efficiency(turned, FRICTION)
    assert (there.forward, there.backward) == (back.backward, back.forward)


def test_summaries_and_tables_show_ours_beside_the_published_ones(tmp_path: Path) -> None:
    run = run_scene(SCENES / "reducer_3k.yaml", overrides=Overrides(trials=20), out=tmp_path / "run")
    own = run.summary["planetary_sets"]["reducer"]
    assert own["ratio"] == pytest.approx(54.72)
    assert own["efficiency"]["forward_percent"] == pytest.approx(85.330, abs=1e-3)
    assert own["efficiency_by_formula"]["backward_percent"] == pytest.approx(82.856, abs=1e-3)
    console = Console(file=io.StringIO(), width=300)
    console.print(run_report(run.found))
    assert isinstance(console.file, io.StringIO)
    rows = [" ".join(line.split()) for line in console.file.getvalue().splitlines()]
    assert "torques in equilibrium, pairs in contact carry alike 85.33 83.08" in rows
    assert "closed form of a 3K set, published E 85.16 82.86" in rows
    assert "planetary_sets · reducer · efficiency · forward_percent 85.32992 85.32992 75.99 –" in rows


def test_a_published_set_that_the_scene_lacks_is_refused(tmp_path: Path) -> None:
    own = "    planetary_sets:\n      reducer:"
    text = edited((SCENES / "reducer_3k.yaml").read_text("utf-8"), (own, own.replace("reducer", "reduser")))
    assert "expected a planetary set, got 'reduser'; did you mean \"reducer\"?" in refusal(text, tmp_path)
