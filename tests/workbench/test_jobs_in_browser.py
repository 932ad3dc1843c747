"""Long work from the page, in a headless Chromium: runs, analyses, their answers, and a folder that changes."""

import json
import shutil
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

import pytest
from app_folders import EVIL, HOSTILE, started, until
from browser import Page, browser
from places import SPUR_PAIR

from tol3d.apps.workbench.attempt import JOBS

pytestmark = pytest.mark.slow

WIDER = """[...document.querySelectorAll("html, dialog[open], dialog[open] *")]
  .filter((own) => !own.closest(".wide, svg, .unseen"))
  .filter((own) => own.scrollWidth > (own.matches("html") ? innerWidth : own.clientWidth + 1) && own.clientWidth)
  .map((own) => own.tagName + own.id)"""
"""The page and what is open above it, as far as they can be scrolled sideways, but for tables, which may."""


@dataclass(frozen=True)
class App:
    """A page of the app, and its folder."""

    page: Page
    folder: Path

    def click(self, name: str, within: str = "body") -> None:
        """Press a button by its words."""
        buttons = f"[...document.querySelectorAll({json.dumps(f'{within} button')})]"
        self.page.ask(f"{buttons}.find((own) => own.textContent === {json.dumps(name)}).click()")

    def told(self, argument: str, value: str) -> None:
        """Fill in a field of a form."""
        field = f"document.querySelector({json.dumps(f'#fields [data-argument={argument}]')})"
        self.page.ask(f"{field}.value = {json.dumps(value)}")

    def choose(self, selector: str, value: str) -> None:
        """Choose one of a list."""
        change = f"(own.value = {json.dumps(value)}, own.dispatchEvent(new Event('change')))"
        self.page.ask(f"(own => {change})(document.querySelector({json.dumps(selector)}))")

    def text(self, selector: str) -> str:
        return str(self.page.ask(f"document.querySelector({json.dumps(selector)}).textContent"))

    def wait(self, selector: str, words: str) -> None:
        """Wait until an element has these words."""
        self.page.wait(f"document.querySelector({json.dumps(selector)})?.textContent.includes({json.dumps(words)})")

    def ready(self) -> None:
        self.page.wait("!!document.querySelector('#answer .verdict') && tol3dApp.app.digest !== ''")


@pytest.fixture(scope="module")
def app(tmp_path_factory: pytest.TempPathFactory) -> Iterator[App]:
    folder = tmp_path_factory.mktemp("jobs")
    shutil.copy(SPUR_PAIR, folder / "pair.yaml")
    with started(folder) as (_, origin, token), browser() as page:
        page.open(f"{origin}/#{token}")
        own = App(page, folder)
        own.ready()
        yield own


def test_a_run_of_some_trials_an_analysis_and_their_end(app: App, tmp_path: Path) -> None:
    page, downloads = app.page, tmp_path
    page.ask("document.querySelector('#trials').value = 'many'")
    app.click("run")
    app.wait("#trouble", "trials: expected a whole number from 1 on, got 'many'")
    page.ask("document.querySelector('#trials').value = '50'")
    app.click("run")
    app.wait("#job", "run done 50 of 50 trials")
    assert page.ask("document.querySelector('#trouble').hidden")
    app.click("analyses…")
    page.wait("document.querySelector('#analyses').open")
    app.told("base", "many")
    app.click("start", "#analyses")
    app.wait("#fields [data-field=base] .wrong", "expected a whole number from 2 on, got 'many'")
    app.told("base", "63")
    app.click("start", "#analyses")
    app.wait("#fields [data-field=base] .wrong", "expected a power of two")
    app.told("base", "64")
    app.click("start", "#analyses")
    page.wait("document.querySelector('#found').open")
    assert not page.ask("document.querySelector('#analyses').open")
    assert "sum of first indices" in app.text("#found-page")
    numbers = (app.folder / JOBS / "0002" / "answer.csv").read_text("utf-8")
    assert numbers.count("\n") > 10
    page.call("Page.setDownloadBehavior", behavior="allow", downloadPath=str(downloads))
    app.click("numbers as CSV")
    until(lambda: (downloads / "pair effects.csv").exists())
    assert (downloads / "pair effects.csv").read_text("utf-8") == numbers
    for width in (1400, 390):
        page.call("Emulation.setDeviceMetricsOverride", width=width, height=900, deviceScaleFactor=1, mobile=False)
        assert page.ask(WIDER) == [], width
    app.click("close", "#found")
    app.click("analyses…")
    page.wait("document.querySelector('#analyses').open")
    app.choose("#analysis", "sweep")
    app.page.wait("document.querySelectorAll('#numbers option').length > 20")
    assert page.ask(WIDER) == []
    app.told("vary", "parts.pinion.teeth=20..28")
    app.told("trials", "20")
    app.click("start", "#analyses")
    app.wait("#fields [data-field=vary] .wrong", "expected a step behind it")
    app.told("vary", "parts.pinion.teeth=27,28")
    app.click("start", "#analyses")
    page.wait("document.querySelector('#found').open")
    assert "2 variants of 20 trials" in app.text("#found-page")
    assert app.text("#found-title") == "variants of pair.yaml"
    app.click("close", "#found")
    app.click("jobs (3)")
    app.wait("#made", "runs/pair: 50 trials")
    assert page.ask(WIDER) == []
    app.click("delete…", "#jobs li:nth-child(2)")
    app.wait("#jobs .asks", "delete this job?")
    app.click("delete it", "#jobs")
    page.wait("document.querySelectorAll('#jobs li').length === 2")
    app.click("close", "#work")
    page.call("Emulation.setDeviceMetricsOverride", width=1400, height=900, deviceScaleFactor=1, mobile=False)
    assert sorted(own.name for own in (app.folder / JOBS).iterdir()) == ["0001", "0003"]
    assert page.told == []


def test_a_report_is_a_link_that_stays_until_it_is_opened(app: App) -> None:
    app.click("jobs (2)")
    app.click("report", "#made")
    app.page.wait("document.querySelector('#made a') !== null")
    app.page.ask("new Promise((done) => setTimeout(done, 1500))")  # jobs are looked at meanwhile
    assert app.page.ask("document.querySelector('#made a').getAttribute('href').startsWith('/report/')")
    app.click("close", "#work")


def test_forms_say_that_what_is_moved_is_not_kept(app: App) -> None:
    app.page.ask("tol3dApp.app.now = { 'centre distance': 'x1.65' }")
    for kind, words in (("allocate", "1 change not kept"), ("what_if", "The fields begin with what is moved.")):
        app.click("analyses…")
        app.page.wait("document.querySelector('#analyses').open")
        app.choose("#analysis", kind)
        app.wait("#analysis-note", words)
        app.click("close", "#analyses")
    assert app.page.ask("document.querySelector('#fields [data-of=\"centre distance\"]').value") == "±33 µm"
    app.page.ask("tol3dApp.app.now = {}")


def test_scenes_that_come_and_go_are_seen_and_names_of_strangers_are_text(app: App) -> None:
    name = f"{EVIL}.yaml"
    (app.folder / name).write_text(HOSTILE, "utf-8")
    options = "[...document.querySelectorAll('#scene option')].map((own) => own.textContent)"
    app.page.wait(f"{options}.length === 2")
    assert app.page.ask(options) == [name, "pair.yaml"]
    app.choose("#scene", name)
    app.wait("#title", EVIL)
    app.ready()
    app.page.ask("document.querySelector('#trials').value = '5'")
    app.click("run")
    app.wait("#job", "run done 5 of 5 trials")
    app.click("analyses…")
    app.wait("#fields", f"{EVIL} measure")
    app.click("close", "#analyses")
    app.click("jobs (1)")
    app.wait("#work-title", EVIL)
    app.wait("#made", EVIL)
    app.click("close", "#work")
    assert app.page.ask("document.querySelectorAll('img').length") == 0
    (app.folder / name).unlink()
    app.wait("#trouble", f"{name} is gone: it was moved or deleted")
    assert app.page.ask(options) == ["pair.yaml", f"{name}, gone"]
    assert app.page.told == []
