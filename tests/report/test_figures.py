"""Figures of a measure: what they draw against the trials they are of."""

from pathlib import Path
from typing import Any

import numpy as np
import pytest

from tol3d import InputError, Run, RunError, run_scene
from tol3d.notebook import Report
from tol3d.report.page import Heading, Row, Table, page
from tol3d.simulate import Execution, Overrides


@pytest.fixture(scope="module")
def run(tmp_path_factory: pytest.TempPathFactory) -> Run:
    return run_scene("door", overrides=Overrides(trials=400), out=tmp_path_factory.mktemp("run") / "door")


def test_a_convergence_ends_at_the_mean_and_sigma_of_all(run: Run) -> None:
    name = next(iter(run.found.measures))
    figure, sample = run.measure(name).convergence(), run.found.measures[name].geometric
    assert sample is not None
    last = [float(np.asarray(axes.lines[0].get_ydata())[-1]) for axes in figure.axes]
    assert last == pytest.approx([sample.mean, sample.sigma], rel=1e-9)


def test_bars_of_a_difference_are_all_trials_and_shares_are_all_contributors(run: Run) -> None:
    name = next(iter(run.found.measures))
    figures = run.measure(name)
    bars: Any = figures.difference().axes[0].collections[0]
    assert sum(path.get_extents().y1 for path in bars.get_paths()) == pytest.approx(run.trials)
    assert len(figures.pareto().axes[0].get_yticklabels()) == len(figures.summary.contributors)
    assert figures.histogram().axes


def test_what_cannot_be_drawn_is_told(run: Run, tmp_path: Path) -> None:
    with pytest.raises(InputError, match="expected a measure, got 'gpa'"):
        run.measure("gpa")
    bare = run_scene(
        "door", overrides=Overrides(trials=50), out=tmp_path / "bare", execution=Execution(keep_trials=False)
    )
    with pytest.raises(RunError, match="kept its statistics only"):
        bare.measure(next(iter(bare.found.measures))).convergence()


def test_tables_show_themselves_in_notebooks() -> None:
    shown = Report(page(Table("part", [Heading("<mass>")], [Row("a & b", ["1"])])))._repr_html_()
    assert '<th scope="row">a &amp; b</th>' in shown
    assert "&lt;mass&gt;" in shown
