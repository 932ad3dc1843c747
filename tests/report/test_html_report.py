"""A report as one page: its numbers against the summary, nothing from outside, and names that do nothing."""

import base64
import hashlib
import json
import re
import shlex
from collections.abc import Iterator
from html.parser import HTMLParser
from pathlib import Path

import numpy as np
import pytest
import trimesh
from places import ROOT, SPUR_PAIR
from toys.parabola import PARABOLA
from toys.pins import PINS
from toys.registered import TOYS, known

from tol3d import InputError, load_scene, run_scene
from tol3d.analyses.side_by_side import methods
from tol3d.analyses.subject import KEPT, Subject
from tol3d.analyses.tolerance_effects import effects
from tol3d.analyses.what_to_change import ChangesQuestion, changes_of
from tol3d.import_path import is_named
from tol3d.notebook import write_report
from tol3d.report.bars import Bars
from tol3d.report.chart import Filled
from tol3d.report.compare import comparison_report
from tol3d.report.comparison_picture import comparison_figure
from tol3d.report.displayed_run import DisplayedRun
from tol3d.report.html import view_3d
from tol3d.report.html.blocks import escaped, tag
from tol3d.report.html.document import report_html
from tol3d.report.measure_charts import histogram
from tol3d.report.report_sections import report_sections
from tol3d.report.trial_charts import running
from tol3d.scene.bundled import bundled_scenes
from tol3d.simulate import Execution, Overrides, simulation_again
from tol3d.study.runs.bare import MissingMechanismWarning
from tol3d.study.runs.run import Run, open_run

PACKED = "H4sI"
"""First characters of base64 text packed by gzip."""
BARS = '{"bars"'
"""Data of a histogram begin so."""
HOSTILE = ("<script>alert(1)</script>", "\"'>", "</script>", "a" * 2000, "&lt;", "javascript:alert(1)")


class _Read(HTMLParser):
    """Elements of a page with their attributes, and the text in each kind of element."""

    def __init__(self, text: str) -> None:
        super().__init__()
        self.elements: list[tuple[str, dict[str, str | None]]] = []
        self.texts: list[tuple[str, str]] = []
        self._open: list[str] = []
        self.feed(text)
        self.close()

    def handle_starttag(self, name: str, attributes: list[tuple[str, str | None]]) -> None:
        self.elements.append((name, dict(attributes)))
        if name not in ("meta", "br", "img", "input"):
            self._open.append(name)

    def handle_endtag(self, name: str) -> None:
        assert self._open.pop() == name, "elements are closed in order"

    def handle_data(self, text: str) -> None:
        if self._open:
            self.texts.append((self._open[-1], text))

    def inside(self, name: str) -> Iterator[str]:
        return (text for own, text in self.texts if own == name)


@pytest.fixture(scope="module")
def spur(tmp_path_factory: pytest.TempPathFactory) -> Run:
    folder = tmp_path_factory.mktemp("spur") / "spur"
    return run_scene("spur_pair", overrides=Overrides(trials=300, witness=0), out=folder)


@pytest.fixture(scope="module")
def text(spur: Run) -> str:
    return report_html([spur])


@pytest.fixture(scope="module")
def flat(spur: Run) -> str:
    """The same without parts in 3D, which CAD has to triangulate first."""
    return report_html([spur], in_3d=False)


def _no_way_out(text: str) -> _Read:
    """A page that asks nothing of anybody, whose scripts and styles are those that its policy allows."""
    page = _Read(text)
    policy = next(own["content"] or "" for name, own in page.elements if own.get("http-equiv"))
    assert page.elements[2][1].get("http-equiv") == "Content-Security-Policy", "before anything that it rules"
    for kind in ("script", "style"):
        rule = next(own for own in policy.split(";") if f"{kind}-src" in own)
        own = [text for text in page.inside(kind) if not text.startswith(("{", PACKED))]
        hashes = [base64.b64encode(hashlib.sha256(text.encode()).digest()).decode() for text in own]
        assert re.findall(r"'sha256-([^']+)'", rule) == hashes
    for name, attributes in page.elements:
        for key, value in attributes.items():
            assert key != "style"
            assert not key.startswith("on")
            assert key not in ("srcset", "action")
            assert key != "src" or str(value).startswith("data:")
            assert key != "href" or str(value).startswith("#"), f"{name} leads out: {value}"
    return page


def test_numbers_of_a_page_are_those_of_its_summary(spur: Run, flat: str) -> None:
    page = _no_way_out(flat)
    told = {float(own["data-value"] or "nan") for name, own in page.elements if name == "td" and "data-value" in own}
    for measure in spur.found.measures.values():
        for sample in (measure.analytic, measure.geometric):
            assert sample is not None
            assert {sample.mean, sample.sigma, sample.p50, sample.sample_min} <= told
    assert "too few trials to say" in [*page.inside("p")], "of 300 trials none is out: less than 1.2 % are, at 95 %"


def test_bars_hold_every_trial_and_name_some_of_theirs(spur: Run, flat: str) -> None:
    page = _no_way_out(flat)
    counted = [int(own[1]) for text in page.inside("title") if (own := re.search(r": (\d+) trials$", text))]
    measures = len(spur.found.measures)
    assert sum(counted) == 2 * 2 * measures * spur.trials, "for two widths: in its histogram, and in the differences'"
    data = [json.loads(text) for text in page.inside("script") if text.startswith(BARS)]
    assert len(data) == measures
    edges = [own for own in page.elements if own[1].get("data-bar")]
    assert {own[1]["data-bar"] for own in edges} >= {bar for own in data for bar in own["bars"]}
    values = spur.columns("geometric:normal backlash")["geometric:normal backlash"]
    groups = [values[trials].max() - values[trials].min() for trials in data[0]["bars"].values()]
    assert max(groups) < 0.1 * (values.max() - values.min()), "trials of one bar are alike"


def test_the_same_run_gives_the_same_bytes(spur: Run, text: str, tmp_path: Path) -> None:
    """But for one element, which says when and where."""
    written = write_report(spur, tmp_path / "report.html")
    made = r'<p class="note" id="made">.*?</p>'
    assert re.sub(made, "", written.read_text()) == re.sub(made, "", text)
    with pytest.raises(InputError, match="there is one already"):
        write_report(spur, written)


def test_the_command_that_shows_a_trial_finds_the_run_from_where_the_report_was_written(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    made = run_scene("spur_pair", overrides=Overrides(trials=40, witness=0), out=Path("my runs/pair $1"))
    assert made.path.is_absolute()
    for given in (Path("my runs/pair $1"), made):
        page = _no_way_out(write_report(given, tmp_path / "report.html", in_3d=False, force=True).read_text())
        words = {json.loads(text)["run"] for text in page.inside("script") if text.startswith(BARS)}
        assert words == {"'my runs/pair $1'"}  # as a shell takes it for one word
        assert open_run(Path(*shlex.split(words.pop()))).found.seed == made.found.seed


def test_the_verdict_has_the_best_change_that_the_run_keeps(tmp_path: Path) -> None:
    scene = tmp_path / "scene.yaml"
    scene.write_text(SPUR_PAIR.read_text("utf-8").replace("lower_limit: 15 um", "lower_limit: 45 um"), "utf-8")
    run = run_scene(scene, overrides=Overrides(trials=300, witness=0), out=tmp_path / "run")
    assert 'class="advice"' not in write_report(run, tmp_path / "plain.html", in_3d=False).read_text()
    subject = Subject(simulation_again(run), run)
    subject.keep("changes", changes_of(subject.response, ChangesQuestion(builds=400)))
    page = write_report(run, tmp_path / "report.html", in_3d=False).read_text()
    advice = re.search(r'<p class="advice">what to change: (normal backlash: .*?)</p>', page)
    assert advice
    assert page.index("<h2>verdict</h2>") < advice.start() < page.index("<table>")
    section = _Read(page[page.index("<h2>what to change</h2>") :].partition("</section>")[0]).texts
    first, _, best = advice[1].partition("; ")
    told = [text.strip() for _, text in section]
    assert told.index(best) == told.index(first) + 1


@pytest.mark.parametrize("name", HOSTILE)
def test_a_name_is_a_text_and_nothing_else(name: str) -> None:
    page = _Read(tag("p", name, title=name, class_=name))
    assert page.elements == [("p", {"title": name, "class": name})]
    assert "".join(text for _, text in page.texts) == name


def test_signs_that_turn_or_hide_text_are_told() -> None:
    assert escaped("a\u202eb\u0000c") == "a\\u202eb\\u0000c"


def test_a_scene_of_hostile_names_is_shown_with_them(tmp_path: Path) -> None:
    hostile = "<script>alert(1)<img onerror=x>"
    text = load_scene("spur_pair").source.read_text()
    for name in ("scene: spur pair at the drive end", "normal backlash:"):
        text = text.replace(
            name, name.replace("spur pair at the drive end", f"'{hostile}'").replace("normal backlash", f"'{hostile}'")
        )
    text = re.sub("^description: .*$", "description: </script><script>alert(1)</script>", text, flags=re.MULTILINE)
    path = tmp_path / "hostile.yaml"
    path.write_text(text)
    run = run_scene(path, overrides=Overrides(trials=50, witness=0), out=tmp_path / "run")
    page = _no_way_out(report_html([run], in_3d=False))
    assert hostile in "".join(page.inside("h1"))
    assert len([1 for name, own in page.elements if name == "script" and own.get("type") is None]) == 1


def test_what_a_run_keeps_is_read_and_shown_by_code_that_is_there() -> None:
    assert all(is_named(path) for own in KEPT.values() for path in (own.section, own.report, own.charts))
    assert len({own.title for own in KEPT.values()}) == len(KEPT)


def test_what_a_run_keeps_of_analyses_is_shown(spur: Run, tmp_path: Path) -> None:
    subject = Subject(simulation_again(spur), spur)
    subject.keep("methods", methods(subject.response.of("lost motion")))
    found = effects(subject.response.of("normal backlash", "lost motion"), base=128)
    subject.keep("effects", found)
    page = _Read(write_report(spur, tmp_path / "report.html", in_3d=False).read_text())
    assert {"methods side by side", "effects"} <= set(page.inside("h2"))
    assert "lost motion by methods" in page.inside("title")
    own = found.measures["lost motion"].contributors["centre distance"]
    assert own.total is not None
    assert f"centre distance, lost motion: {100 * own.total.share:.1f} %" in page.inside("title")
    values = {float(own["data-value"] or "nan") for name, own in page.elements if name == "td" and "data-value" in own}
    assert 100 * own.total.share in values, "the column says per cent"


def test_runs_without_trials_or_simulation_and_runs_beside_each_other(spur: Run, tmp_path: Path) -> None:
    bare = run_scene(
        "spur_pair",
        overrides=Overrides(trials=200, engine="analytic"),
        out=tmp_path / "bare",
        execution=Execution(keep_trials=False),
    )
    assert not [
        text for text in _no_way_out(report_html([bare], in_3d=False)).inside("script") if text.startswith(BARS)
    ]
    together = _no_way_out(report_html([spur, bare]))
    assert {"spur", "bare"} <= set(together.inside("th"))
    other = run_scene("door", overrides=Overrides(trials=50), out=tmp_path / "door")
    told = []
    for shown in (report_html, report_sections, comparison_report, comparison_figure):
        with pytest.raises(InputError) as refused:
            shown([spur, other])
        told.append(str(refused.value))
    wanted = "expected a measure that another of these runs has too, got none; show each by itself"
    assert set(told) == {f"spur, door: {wanted}"}, "the page, its tables and both of compare's say the same"
    with pytest.raises(InputError, match=f"^door: {wanted}"):
        report_html([spur, other, bare])


@pytest.mark.slow
@pytest.mark.parametrize("name", ["two_sided_te", "gearbox_in_housing", "spherical_drive", "rv_250aii", "reducer_3k"])
def test_every_kind_of_system_has_a_page(name: str, tmp_path: Path) -> None:
    """Curves, limits, failed trials, sections of its own."""
    run = run_scene(name, overrides=Overrides(trials=60, witness=0), out=tmp_path / name)
    page = _no_way_out(report_html([run]))
    assert sum(own == "svg" for own, _ in page.elements) >= len(run.found.measures)


@pytest.mark.parametrize(
    ("bundle", "licence"),
    [("report/html/viewer", "LICENSE.three"), ("apps/workbench/page/editor", "LICENSE.codemirror")],
)
def test_bundles_are_those_that_were_made_with_their_licences(bundle: str, licence: str) -> None:
    script = (ROOT / "tol3d" / f"{bundle}.js").read_bytes()
    told = (ROOT / "viewer" / Path(bundle).name).with_suffix(".sha256").read_text().strip()
    assert hashlib.sha256(script).hexdigest() == told
    assert b"</script" not in script
    assert "Permission is hereby granted" in (ROOT / "tol3d" / bundle).with_name(licence).read_text()


# runs of every sort -------------------------------------------------------------------------------


def _run_of(tmp_path: Path, name: str, trials: int = 60, **replaced: str) -> Run:
    """A run of a bundled scene, without what others published, in whose text `old => new` is replaced."""
    text = load_scene(name).source.read_text("utf-8").partition("\npublished:")[0]
    for words in replaced.values():
        old, _, new = words.partition(" => ")
        assert old in text
        text = text.replace(old, new)
    path = tmp_path / f"{name}.yaml"
    path.write_text(text)
    return run_scene(path, overrides=Overrides(trials=trials, witness=0), out=tmp_path / "run")


def test_a_run_with_failed_trials_says_how_many_and_why(tmp_path: Path) -> None:
    run = _run_of(tmp_path, "spur_pair", 400, closer="centre_distance: 172.5 mm => centre_distance: 172.445 mm")
    failed = run.trials - run.found.measures["normal backlash"].seated
    assert 0 < failed < run.trials
    page = _no_way_out(report_html([run], in_3d=False))
    assert f"trials: {run.trials - failed} assembled, {failed} could not be assembled (" in "".join(
        text for _, text in page.texts
    )
    counted = [int(own[1]) for text in page.inside("title") if (own := re.search(r": (\d+) trials$", text))]
    seated = sum(own.seated for own in run.found.measures.values())
    assert sum(counted) <= 2 * 2 * seated, "none of them is in a bar, for either width"


def test_a_run_without_limits_has_no_verdict_and_no_line_for_one(tmp_path: Path) -> None:
    run = _run_of(tmp_path, "spur_pair", limit="lower_limit: 15 um => # no limit")
    text = report_html([run], in_3d=False)
    assert "no limits to judge" in [*_no_way_out(text).inside("p")]
    assert 'class="limit"' not in text


def test_a_bar_across_a_limit_that_no_trial_is_beyond_is_not_out(tmp_path: Path) -> None:
    run = run_scene("cover_on_base", overrides=Overrides(trials=100, witness=0), out=tmp_path / "run")
    own = run.found.measures["flush"]
    bars = histogram("flush", own).panels[0].series[0]
    assert isinstance(bars, Filled)
    assert bars.beyond is not None
    assert own.geometric is not None
    assert own.geometric.sample_max is not None
    assert own.geometric.sample_max < 150 < bars.edges[-1], "um, the upper limit lies in the last bar"
    assert not bars.beyond.any()


def test_a_bar_across_a_limit_is_out_from_the_limit_on() -> None:
    bars = Bars(np.array([0.0, 1.0, 2.0, 4.0]), np.array([3.0, 5.0, 2.0]), 10)
    pieces = bars.cut((0.25, 2.0))
    assert pieces.edges.tolist() == [0.0, 0.25, 1.0, 2.0, 4.0]
    assert pieces.bars.tolist() == [0, 0, 1, 2]
    assert pieces.beyond.tolist() == [True, False, False, True]


def test_curves_stand_over_their_positions(tmp_path: Path) -> None:
    run = run_scene("two_sided_te", overrides=Overrides(trials=40, witness=0), out=tmp_path / "run")
    page = _no_way_out(report_html([run], in_3d=False))
    curves = [name for name, own in run.found.measures.items() if own.take == "curve"]
    assert curves
    assert {f"{name} over its positions" for name in curves} <= set(page.inside("title"))


def test_an_analytic_run_has_one_method_and_no_difference(tmp_path: Path) -> None:
    run = run_scene("door", overrides=Overrides(trials=60, engine="analytic"), out=tmp_path / "run")
    page = _no_way_out(report_html([run], in_3d=False))
    assert "difference of both methods" not in page.inside("title")
    assert "3D simulation" not in "".join(page.inside("figcaption"))


def test_a_mechanism_without_a_presenter_has_tables_and_says_why_nothing_is_in_3d(tmp_path: Path) -> None:
    with known(PINS):
        run = run_scene(TOYS / "pins" / "pins.yaml", overrides=Overrides(trials=60), out=tmp_path / "run")
        page = _no_way_out(report_html([run]))
    assert sum(own == "svg" for own, _ in page.elements) >= len(run.found.measures)
    assert [text for text in page.inside("p") if text.startswith("no 3D view: ")]


@pytest.mark.parametrize("toy", ["pins", "parabola"])
def test_a_mechanism_that_is_not_installed_is_named_and_its_run_has_tables(toy: str, tmp_path: Path) -> None:
    scene, own = {"pins": ("pins/pins.yaml", PINS), "parabola": ("parabola/spring.yaml", PARABOLA)}[toy]
    with known(own):
        run = run_scene(TOYS / scene, overrides=Overrides(trials=60), out=tmp_path / "run")
    with pytest.warns(MissingMechanismWarning, match=f"^the mechanism '{toy}'"):
        written = write_report(run.path, tmp_path / "report.html")
    page = _no_way_out(written.read_text())
    told = [text for text in page.inside("p") if text.startswith(f"the mechanism '{toy}' (Python module 'toys.{toy}.")]
    assert len(told) == 1
    values = {float(own["data-value"] or "nan") for name, own in page.elements if name == "td" and "data-value" in own}
    for measure in run.summary["measures"].values():
        assert measure["take"] == "curve" or measure["analytic"]["mean"] in values
    with pytest.warns(MissingMechanismWarning):
        files = write_report(run.path, tmp_path / "tables", format="csv")
    assert (files / "01-verdict.csv").is_file()


def test_a_page_does_not_grow_with_the_trials(tmp_path: Path) -> None:
    """No raw rows: of a hundred times as many only bars, digits of their counts and trials of rarer bars are more."""
    sizes = []
    for trials in (2000, 200_000):
        run = run_scene("door", overrides=Overrides(trials=trials), out=tmp_path / str(trials))
        sizes.append(len(report_html([run], in_3d=False)))
    assert sizes[1] < 1.5 * sizes[0]


@pytest.mark.parametrize("name", ["<script>alert(1)<img onerror=x>", "\"'>", "&lt;b&gt; <!--", "=1+1 `${x}`"])
def test_hostile_names_of_parts_and_contributors_are_shown_as_they_are(name: str, tmp_path: Path) -> None:
    quoted = json.dumps(name)
    own = f"of: wheel => of: {quoted}", f"  wheel: => \n  {quoted}:", f"driven: wheel => driven: {quoted}"
    run = _run_of(
        tmp_path,
        "spur_pair",
        of=own[0],
        part=own[1],
        driven=own[2],
        gear=f"gear: wheel => gear: {quoted}",
        contributor=f"centre distance: => {json.dumps(name + ' moves')}:",
    )
    page = _no_way_out(report_html([run]))
    assert f"{name} moves" in [*page.inside("th")]
    assert [text for text in page.inside("label") if text.strip() == name], "a part in the 3D view"
    assert sum(own == "script" and "type" not in said for own, said in page.elements) == 2


def test_parts_that_make_a_page_large_have_coarser_facets_and_it_says_which(
    spur: Run, text: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(view_3d, "MOST", 60_000)
    coarse = report_html([spur])
    assert "coarser facets, for the size of this page: pinion, wheel" in [*_no_way_out(coarse).inside("p")]
    models = [next(own for own in _Read(each).inside("script") if own.startswith(PACKED)) for each in (text, coarse)]
    assert len(models[1]) < 60_000 * 4 / 3 + 4 < len(models[0])


def test_a_coarser_surface_keeps_its_box_and_its_volume() -> None:
    ball = trimesh.creation.icosphere(subdivisions=4, radius=10.0)
    vertices, triangles = view_3d.fewer_facets(ball.vertices, ball.faces, 0.2)
    assert 0.1 < len(triangles) / len(ball.faces) < 0.25
    assert trimesh.Trimesh(vertices, triangles).volume == pytest.approx(ball.volume, rel=0.02)
    assert np.ptp(vertices, axis=0) == pytest.approx([20.0, 20.0, 20.0], rel=0.02)


@pytest.mark.parametrize("pieces", [(300,), (1, 299), (128, 128, 44)])
def test_means_and_sigmas_of_the_first_trials_are_those_of_numpy_however_they_are_read(pieces: tuple[int, ...]) -> None:
    values = 1e6 + np.random.default_rng(3).normal(size=300)
    parts = np.split(values, np.cumsum(pieces)[:-1])
    found = running(parts, np.array([10, 50, 128, 129, 300]))
    assert [*found.counts] == [10, 50, 128, 129, 300]
    expected = [(values[:n].mean(), values[:n].std(ddof=1)) for n in (10, 50, 128, 129, 300)]
    assert np.column_stack([found.mean, found.sigma]) == pytest.approx(np.array(expected), rel=1e-8)
    assert running(parts, np.array([10, 400])).counts.tolist() == [10, 300], "as many as there are"


def test_several_runs_say_why_they_have_no_3d(spur: Run, tmp_path: Path) -> None:
    other = run_scene("spur_pair", overrides=Overrides(trials=100, seed=2, witness=0), out=tmp_path / "other")
    assert [text for text in _no_way_out(report_html([spur, other])).inside("p") if text.startswith("no 3D view of")]


def test_a_run_shows_itself_in_notebooks(spur: Run) -> None:
    assert isinstance(spur, DisplayedRun)
    page = _Read(spur._repr_html_())
    told = " ".join(text for _, text in page.texts)
    assert "spur pair at the drive end" in told
    assert "trials: all 300 assembled" in told
    values = {float(own["data-value"] or "nan") for name, own in page.elements if name == "td" and "data-value" in own}
    sample = spur.found.measures["normal backlash"].geometric
    assert sample is not None
    assert sample.mean in values


@pytest.mark.slow
@pytest.mark.parametrize("name", bundled_scenes())
def test_every_bundled_scene_has_a_page(name: str, tmp_path: Path) -> None:
    run = run_scene(name, overrides=Overrides(trials=24, witness=0), out=tmp_path / name)
    page = _no_way_out(report_html([run], in_3d=False))
    assert sum(own == "svg" for own, _ in page.elements) >= min(len(run.found.measures), 20)
    assert "provenance" in page.inside("h2")
