"""The app's page in a headless Chromium: by keyboard, narrow and wide, dark and light, and nothing asked elsewhere."""

import html
import json
import math
import re
import socket
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from itertools import pairwise
from pathlib import Path
from threading import Thread
from typing import Any

import numpy as np
import pytest
import uvicorn
from app_folders import until
from browser import Page, browser
from machine.arm_by_hand import AXES, TOOL, arm_scene, tool_by_hand
from machine.arm_by_hand import POSES as ARM_POSES
from places import SCENES, SPUR_PAIR

from tol3d.apps.workbench.place import FolderLock
from tol3d.apps.workbench.server import Server, application
from tol3d.apps.workbench.workspace import Workspace

pytestmark = pytest.mark.slow

SCENE, CENTRE, BACKLASH = "pair.yaml", "centre distance", "normal backlash"
TEXT = SPUR_PAIR.read_text("utf-8").replace("trials: 2000", "trials: 200")
DOOR = (SCENES / "door.yaml").read_text("utf-8").replace("trials: 20000", "trials: 200")
ERRORS = """
  off up: {kind: position_error, of: link 3.tool, from: base, at: up}
  off at home: {kind: position_error, of: link 3.tool, from: base, at: home}"""
KEYS = {"ArrowRight": 39, "ArrowDown": 40, "Tab": 9, "PageUp": 33, "z": 90, "s": 83, "?": 191, "Escape": 27}
SLIDER = f'#sliders input[type=range][data-line="{CENTRE}"]'
FIELD = f'#sliders input[type=text][data-line="{CENTRE}"]'
SEEN = """window.seen = [];
new MutationObserver(() => seen.push(document.querySelector("#chart .legend .dashed") !== null)).observe(
  document.querySelector("#chart"), { childList: true })"""
"""Notes each picture of the histogram: with an estimate or without; a key moves a slider and releases it at once."""
WIDER = """["html", "#left", "#middle", "#card", "#moves"].filter((own) => {
  const { scrollWidth, clientWidth } = document.querySelector(own);
  return scrollWidth > (own === "html" ? innerWidth : clientWidth);
})"""
"""The page and its columns, as far as they can be scrolled sideways."""
CONTRAST = """(() => {
  const canvas = document.createElement("canvas").getContext("2d", { willReadFrequently: true });
  const colour = (text) => (canvas.clearRect(0, 0, 1, 1), canvas.fillStyle = text, canvas.fillRect(0, 0, 1, 1),
    [...canvas.getImageData(0, 0, 1, 1).data]);
  const light = (rgb) => rgb.slice(0, 3).map((own) => own / 255)
    .map((own) => own <= 0.03928 ? own / 12.92 : ((own + 0.055) / 1.055) ** 2.4)
    .reduce((sum, own, k) => sum + own * [0.2126, 0.7152, 0.0722][k], 0);
  const behind = (own) => !own ? colour("white") : colour(getComputedStyle(own).backgroundColor)[3] > 250
    ? colour(getComputedStyle(own).backgroundColor) : behind(own.parentElement);
  const found = [];
  for (const own of document.querySelectorAll("body *:not(#stage *):not(.cm-line *):not(option)")) {
    const text = own.matches("input[type=text], select") ? own.value || own.placeholder
      : [...own.childNodes].filter((node) => node.nodeType === 3).map((node) => node.data.trim()).join("");
    if (!text || !own.checkVisibility() || own.disabled) continue;
    const style = getComputedStyle(own), svg = own.closest("svg");
    const [one, two] = [light(colour(svg ? style.fill : style.color)), light(behind(own))].sort((a, b) => b - a);
    if ((one + 0.05) / (two + 0.05) < 4.5) found.push(`${own.tagName} ${text.slice(0, 30)}`);
  }
  return found;
})()"""
"""Texts of less than 4.5 to what is behind them; W3C, WCAG 2.2, 1.4.3."""


NARROW = 736  # px, 46rem: one column
ORDER = "[...document.querySelectorAll('*')]"
"""All elements in the order of the document, in which Tab goes."""
TICKS = """(() => {
  const all = [...document.querySelectorAll("#chart svg .tick[text-anchor=middle]")]
    .map((own) => own.getBoundingClientRect());
  const low = Math.max(...all.map((own) => own.y));
  return all.filter((own) => own.y > low - 2).map((own) => [own.left, own.right]).sort((a, b) => a[0] - b[0]);
})()"""
"""Ends of the words of the ticks below the histogram."""


@dataclass(frozen=True)
class App:
    """A page of the app, and the server behind it."""

    page: Page
    server: Server
    address: str
    file: Path

    def load(self, width: int = 1400) -> None:
        """Open the page as it is after a reload, all there, in its scene of the start."""
        self.page.open("about:blank")
        self.server.thread.submit(lambda: None).result()  # what the page before has asked is answered
        self.file.write_text(TEXT, "utf-8")
        (self.server.workspace.notes_folder / f"{SCENE}.json").unlink(missing_ok=True)
        self.page.told.clear()
        self.page.asked.clear()
        self.page.open(self.address, width)
        self.shown()

    def shown(self) -> None:
        """Wait until the page shows all."""
        self.page.wait(
            "document.querySelector('#answer table') !== null && document.querySelector('#sliders') !== null"
        )
        self.page.wait(
            "document.querySelector('#sliders .share') !== null && document.querySelector('#tree li') !== null"
        )
        self.page.wait("document.querySelector('#stage').dataset.ready === 'yes'")
        self.page.ask(SEEN)

    def key(self, name: str, *, control: bool = False) -> None:
        """Press a key."""
        own = {"key": name, "windowsVirtualKeyCode": KEYS[name], "modifiers": 2 if control else 0}
        text = {"text": name} if len(name) == 1 and not control else {}
        self.page.call("Input.dispatchKeyEvent", type="keyDown" if text else "rawKeyDown", **own, **text)
        self.page.call("Input.dispatchKeyEvent", type="keyUp", **own)

    def focus(self, selector: str) -> None:
        self.page.ask(f"document.querySelector({json.dumps(selector)}).focus()")

    def click(self, name: str) -> None:
        """Press a button by its name."""
        self.page.ask(f"document.querySelector('#{name}').click()")

    def told(self, selector: str, event: str, value: object) -> None:
        """Give a control a value, as a hand on a mouse does."""
        change = f"(own.value = {json.dumps(value)}, own.dispatchEvent(new Event('{event}', {{ bubbles: true }})))"
        self.page.ask(f"(own => {change})(document.querySelector({json.dumps(selector)}))")

    def now(self) -> Any:
        return self.page.ask("tol3dApp.app.now")

    def card(self, now: Mapping[str, str], measure: str = BACKLASH) -> str:
        """Words of a card, as the server answers."""
        asked = {"scene": SCENE, "measure": measure, "now": now}
        return words(self.server.thread.submit(lambda: self.server.questions.card(asked)).result()["answer"])

    def solid(self, now: Mapping[str, str], measure: str = BACKLASH) -> None:
        """Wait until the card is that of these tolerances."""
        wanted = json.dumps(self.card(now, measure))
        self.page.wait(f"document.querySelector('#answer').textContent.replace(/\\s/g, '') === {wanted}")
        self.page.wait("document.querySelector('#chart .legend .dashed') === null")
        assert self.now() == now


def words(markup: str) -> str:
    """Its text without spaces."""
    return re.sub(r"\s", "", html.unescape(re.sub(r"<[^>]*>", "", markup)))


@pytest.fixture(scope="module")
def app(tmp_path_factory: pytest.TempPathFactory) -> Iterator[App]:
    folder = tmp_path_factory.mktemp("app")
    file = folder / SCENE
    file.write_text(TEXT, "utf-8")
    (folder / "other.yaml").write_text(TEXT, "utf-8")
    (folder / "door.yaml").write_text(DOOR, "utf-8")
    (folder / "arm.yaml").write_text(arm_scene(measures=ERRORS).replace("trials: 400", "trials: 50"), "utf-8")
    (folder / "crank.yaml").write_text((SCENES / "slider_crank.yaml").read_text("utf-8"), "utf-8")
    with socket.create_server(("127.0.0.1", 0)) as listening, FolderLock(folder) as lock, browser() as page:
        own = Server(Workspace.of(file), lock)
        guarded = application(own, listening.getsockname()[1])
        server = uvicorn.Server(
            uvicorn.Config(guarded, log_level="warning", access_log=False, lifespan="off", ws="none")
        )
        thread = Thread(target=server.run, kwargs={"sockets": [listening]})
        thread.start()
        try:
            yield App(page, own, f"{guarded.origin}/#{guarded.token}", file)
        finally:
            server.should_exit = True
            thread.join()
            own.close()


def test_the_page_is_there_says_nothing_and_asks_nobody_else(app: App) -> None:
    app.load()
    app.solid({})
    assert app.page.ask("location.href") == f"{app.address.partition('#')[0]}#/scene/{SCENE}"
    assert app.page.told == []
    origin = app.address.partition("#")[0]
    assert {url for url in app.page.asked if not url.startswith(origin)} <= {"about:blank", "data:,"}
    assert app.page.ask("document.querySelector('#trouble').hidden")
    picture = app.page.picture("#stage canvas")
    lively = picture.max(axis=-1) - picture.min(axis=-1) > 60
    assert lively.mean() > 0.05, "the pair is drawn"


def test_the_first_story_by_keyboard_alone(app: App) -> None:
    app.load()
    app.focus(SLIDER)
    app.key("ArrowRight")
    wider = {CENTRE: "±20.2 µm"}
    app.solid(wider)
    assert not app.page.ask("seen.at(-1)"), "an estimate is not drawn over what is simulated"
    assert app.page.ask(f"document.querySelector({json.dumps(FIELD)}).value") == "±20.2 µm"
    assert app.page.ask("document.activeElement.dataset.line") == CENTRE
    app.key("PageUp")
    app.solid({CENTRE: "±22.4 µm"})  # 20 µm × 1.01 ** 11, ten steps further
    app.key("z", control=True)
    app.solid(wider)
    app.key("z", control=True)
    app.solid({})
    app.focus(FIELD)
    app.page.ask("document.activeElement.select()")
    app.page.call("Input.insertText", text="±33 um")
    app.page.ask("document.activeElement.blur()")
    app.solid({CENTRE: "±33 um"})
    app.key("s", control=True)
    app.page.wait("document.querySelector('#diff').open")
    diff = app.page.ask("document.querySelector('#diff pre').textContent").splitlines()
    assert [line for line in diff if re.match(r"[-+] ", line)] == [
        "-    distribution: {kind: normal, lower: -20 um, upper: 20 um}",
        "+    distribution: {kind: normal, lower: -33 um, upper: 33 um}",
    ]
    assert app.file.read_text("utf-8") == TEXT
    app.click("write")
    app.page.wait("!document.querySelector('#diff').open && document.querySelector('#keep').disabled")
    app.solid({})
    assert app.file.read_text("utf-8") == TEXT.replace("-20 um, upper: 20 um", "-33 um, upper: 33 um")
    app.focus("#left input")
    app.page.ask("document.activeElement.blur()")
    app.key("?")
    app.page.wait("document.querySelector('#help').open")
    app.key("Escape")
    app.page.wait("!document.querySelector('#help').open")
    assert app.page.told == []


def test_a_slider_on_its_way_shows_an_estimate_until_it_is_released(app: App) -> None:
    app.load()
    before = app.page.ask("document.querySelector('#answer').textContent")
    app.told(SLIDER, "input", 40)
    app.page.wait("document.querySelector('#chart .legend .dashed') !== null")
    assert app.page.ask("document.querySelector('#answer').textContent") == before
    assert app.now() == {}
    app.told(SLIDER, "change", 40)
    app.solid({CENTRE: "±29.8 µm"})


def test_the_worst_build_in_3d_is_that_of_the_tolerances_that_are_tried(app: App) -> None:
    app.load()
    gap = "[...document.querySelectorAll('.names span')].map(own => own.textContent).find(own => own.startsWith('gap'))"
    for now in ({}, {CENTRE: "±29.8 µm"}):
        if now:
            app.told(SLIDER, "change", 40)
        else:
            app.told("#build", "change", "worst")
        app.solid(now)
        session = app.server.questions.session(SCENE)
        low = session.evaluated(BACKLASH, now).good.min()
        app.page.wait(f"({gap} ?? '').startsWith('gap {low:.3f}')")
    app.told("#build", "change", "nominal")


def test_the_number_beside_deviations_is_that_of_the_words_beneath(app: App) -> None:
    app.load()
    app.told("#build", "change", "trial")
    app.page.wait("document.querySelector('#factor').max === '2'")
    app.told("#factor", "input", 2)
    words = app.page.ask("document.querySelector('#stage-words').textContent")
    (factor,) = re.findall(r"magnified ([\d.]+) times, not 100", words)
    assert app.page.ask("document.querySelector('#stage output').value") == factor
    assert app.page.ask("document.querySelector('#factor').ariaValueText") == f"{factor} times"
    app.told("#trial", "change", 7)
    app.page.wait("document.querySelector('#stage-words').textContent.startsWith('trial 7;')")
    words = app.page.ask("document.querySelector('#stage-words').textContent")
    assert f"magnified {app.page.ask('document.querySelector(`#stage output`).value')} times, not 100" in words
    app.told("#build", "change", "nominal")


def _opened(app: App, name: str) -> None:
    """Choose another scene, and wait until it is there in 3D."""
    app.told("#scene", "change", name)
    app.page.wait(f"tol3dApp.app.scene === {name!r} && document.querySelector('#stands select') !== null")
    app.page.wait("document.querySelector('#stage-words').textContent.startsWith('nominal')")
    app.page.wait("document.querySelectorAll('.names span').length > 0")


HEADS = 19.4
"""Pixels of the two sides of the head of an arrow."""
PLACE = "[...document.querySelectorAll('.names span')].find((own) => own.textContent.startsWith('{}')).place.toArray()"
"""Place of a feature in 3D, in mm."""


def test_sliders_of_joints_move_an_arm_and_its_error_is_an_arrow_at_the_tool(app: App) -> None:
    app.load()
    _opened(app, "arm.yaml")
    slider = '#stands input[data-coordinate="joint {}"]'
    values = "[...document.querySelectorAll('#stands input')].map((own) => own.valueAsNumber)"
    assert app.page.ask(values) == [*ARM_POSES["up"]], "as the first measure is read"
    app.told("#stands select", "change", "home")
    assert app.page.ask(values) == [*ARM_POSES["home"]]
    angles = (-40.0, 25.0, 60.0)
    for k, angle in enumerate(angles, 1):
        app.told(slider.format(k), "input", angle)
        app.told(slider.format(k), "change", angle)
    assert app.page.ask("document.querySelector('#stands output').value") == "-40.0°"
    tool = json.dumps([*tool_by_hand(AXES, TOOL, [math.radians(own) for own in angles])])
    app.page.wait(f"Math.hypot(...{PLACE.format('link 3.tool')}.map((own, k) => own - {tool}[k])) < 2e-3")
    app.told("#build", "change", "trial")
    app.page.wait("document.querySelector('#factor').max === '2'")
    long = "(own => own ? own.getTotalLength() : 0)(document.querySelector('.measured .error'))"
    number = "document.querySelector('.names .number i').textContent"
    arrow = "[...document.querySelectorAll('.names .number i')].at(-1).textContent"
    app.page.wait(f"{number}.startsWith('off up ') && {number}.endsWith(', as it stands')")
    found = {}
    for factor in (0, 2):
        app.told("#factor", "input", factor)
        found[factor] = app.page.ask(number), app.page.ask(long), app.page.ask(arrow)
    assert found[0][0] == found[2][0]
    times = [float(words.removeprefix("arrow × ")) for _, _, words in found.values()]
    assert times[0] > 1.0, "it is seen of a build whose deviations are not magnified"
    assert times[1] >= 100.0
    # heads have one size; and links turn by more, whose arcs are no lines
    lengths = [length - HEADS for _, length, _ in found.values()]
    assert lengths[1] / lengths[0] == pytest.approx(times[1] / times[0], rel=0.15)
    app.told("#factor", "input", 0)
    app.told("#stands select", "change", "")
    app.page.wait(f"!{number}.endsWith(', as it stands')")
    app.told("#build", "change", "nominal")
    assert app.page.told == []


def test_an_arm_goes_through_its_poses_and_stops(app: App) -> None:
    app.load()
    _opened(app, "arm.yaml")
    button, caption = (f"document.querySelector('#stage {own}')" for own in ("[name=play]", ".caption"))
    assert not app.page.ask("document.querySelector('#stage .moving').hidden")
    app.page.ask(f"{button}.click()")
    app.page.wait(f"{caption}.textContent === 'home to up'")
    assert app.page.ask(f"{button}.textContent") == "pause"
    last = app.page.ask("document.querySelector('#stage [name=moment]').max")
    for frame, pose in (("0", "home"), (last, "up")):
        app.told("#stage [name=moment]", "input", frame)
        assert app.page.ask(f"{caption}.textContent") == pose
        assert app.page.ask(f"{button}.textContent") == "play"
        tool = tool_by_hand(AXES, TOOL, [math.radians(own) for own in ARM_POSES[pose]])
        assert math.dist(app.page.ask(PLACE.format("link 3.tool")), tool) < 2e-3
    app.told("#stands select", "change", "home")
    app.page.wait(f"{caption}.textContent === ''")
    assert app.page.told == []


def test_a_path_is_played(app: App) -> None:
    app.load()
    _opened(app, "crank.yaml")
    face = PLACE.format("slider.face")
    app.page.ask(f"window.faces = [], window.looking = setInterval(() => faces.push({face}[0]), 10)")
    app.page.ask("document.querySelector('#stands button').click()")
    app.page.wait("document.querySelector('#stands output').value === 'step 24 of 24'")
    app.page.wait(f"Math.abs({face}[0] - (126.491106 - 40)) < 1e-3")  # crank and rod on one line
    faces = app.page.ask("clearInterval(looking), faces")
    assert len({*faces}) > 12
    assert faces in (sorted(faces), sorted(faces, reverse=True)), "it goes one way"
    app.told("#stands select", "change", "far")
    app.page.wait(f"Math.abs({face}[0] - (126.491106 + 40)) < 1e-3")
    assert app.page.ask("[...document.querySelectorAll('#stands output')].at(-1).value") == "far"
    assert app.page.told == []


def test_reset_aside_and_a_reload(app: App) -> None:
    app.load()
    wider, other = {CENTRE: "±20.2 µm"}, "lost motion"
    app.focus(SLIDER)
    app.key("ArrowRight")
    app.solid(wider)
    app.click("aside")
    app.page.wait("document.querySelectorAll('#beside article').length === 1")
    app.click("reset")
    app.solid({})
    app.click("undo")
    app.solid(wider)
    app.page.ask(
        f"(own => (own.value = {other!r}, own.dispatchEvent(new Event('change'))))(document.querySelector('#measure'))"
    )
    app.solid(wider, other)
    for reload in (lambda: app.page.call("Page.reload"), lambda: app.page.open(app.address.partition("#")[0])):
        app.page.ask("window.old = true")
        reload()
        app.page.wait("window.old === undefined && document.readyState === 'complete'")
        app.shown()
        app.solid(wider, other)
        app.page.wait("document.querySelectorAll('#beside article').length === 1")
        assert f"{CENTRE} ±20.2 µm" in app.page.ask("document.querySelector('#beside .dim').textContent")
        app.click("undo")
        app.solid({}, other)
        app.page.ask("document.querySelector('#beside button').click()")
        app.solid(wider, other)
    app.page.ask("document.querySelectorAll('#beside button')[1].click()")
    app.page.wait("document.querySelectorAll('#beside article').length === 0")
    assert app.page.told == []


@pytest.mark.parametrize("width", [1400, 390])
def test_three_what_ifs_can_be_read_and_a_move_leaves_the_sliders_where_they_are(app: App, width: int) -> None:
    app.load(width)
    top = f"document.querySelector({SLIDER!r}).closest('#moves').getBoundingClientRect().y"
    before = app.page.ask(top)
    for count, step in enumerate((10, 20, 30), 1):
        app.told(SLIDER, "change", step)
        app.page.wait(f"document.querySelector('#answer [scope=col]') && tol3dApp.app.past.length === {count}")
        app.page.wait("!document.querySelector('#aside').disabled")
        if width == 1400:
            assert app.page.ask(top) == before
        app.click("aside")
        app.page.wait(f"document.querySelectorAll('#beside article').length === {count}")
    outside = """[...document.querySelectorAll("#beside :is(th, td, button)")].filter((own) => {
      const inner = own.getBoundingClientRect(), outer = own.closest("article").getBoundingClientRect();
      return inner.right > outer.right || own.scrollWidth > own.clientWidth + 1;
    }).map((own) => own.textContent)"""
    assert app.page.ask(outside) == []


def test_a_limit_that_is_emptied_shows_at_once_that_of_the_scene(app: App) -> None:
    app.load()
    app.focus("#lower_limit")
    app.told("#lower_limit", "change", "")
    assert app.page.ask("document.querySelector('#lower_limit').value") == "15 µm"


def test_a_text_is_saved_once_and_while_it_cannot_be_read_there_is_nothing_to_press(app: App) -> None:
    app.load()
    line = 1 + TEXT[: TEXT.index("of: gear pair")].count("\n")
    for saves, text in enumerate(("    of: gear par", "    of: gear pair"), 1):
        app.focus("#editor .cm-content")
        app.page.ask(f"tol3dApp.editor.go({line})")
        app.page.call("Input.insertText", text=text)
        app.key("s", control=True)
        broken = "true" if saves == 1 else "false"
        app.page.wait(
            f"document.querySelector('#run').disabled === {broken} && tol3dApp.editor.text() === tol3dApp.app.saved"
        )
        assert app.page.ask("document.querySelector('#card').inert") is (saves == 1)
        assert len([url for url in app.page.asked if url.endswith("/api/save")]) == saves
    app.shown()
    assert app.page.told == []


def test_a_wrong_word_is_marked_at_its_line_and_in_the_tree(app: App) -> None:
    app.load()
    line = 1 + TEXT[: TEXT.index("of: gear pair")].count("\n")
    app.focus("#editor .cm-content")
    app.page.ask(f"tol3dApp.editor.go({line})")
    app.page.call("Input.insertText", text="    of: gear par")
    app.page.wait("document.querySelector('#problems .error') !== null")
    assert "gear par" in app.page.ask("document.querySelector('#problems').textContent")
    assert app.page.ask("[...document.querySelectorAll('#tree .wrong')].map(own => own.dataset.name)") == [CENTRE]
    mark = "(own => own && own.getBoundingClientRect().y)(document.querySelector('#editor .cm-lint-marker-error'))"
    number = (
        f"[...document.querySelectorAll('.cm-lineNumbers .cm-gutterElement')].find(own => own.textContent === '{line}')"
    )
    app.page.wait(f"{mark} !== null")
    assert app.page.ask(f"Math.abs({mark} - {number}.getBoundingClientRect().y) < 8")
    assert app.file.read_text("utf-8") == TEXT, "nothing is written while one types"
    app.page.ask(f"tol3dApp.editor.go({line})")
    app.page.call("Input.insertText", text="    of: gear pair")
    app.page.wait("document.querySelector('#problems .error') === null")
    assert app.page.ask("document.querySelector('#tree .wrong')") is None
    assert app.page.told == []


def test_words_that_a_tolerance_cannot_have_are_refused_at_their_field(app: App) -> None:
    app.load()
    app.focus(FIELD)
    app.page.ask("document.activeElement.select()")
    app.page.call("Input.insertText", text="±3 kg")
    app.page.ask("document.activeElement.blur()")
    app.page.wait("document.querySelector('#sliders .wrong') !== null")
    assert "expected a length with its unit" in app.page.ask("document.querySelector('#sliders .wrong').textContent")
    app.solid({})


STAGED = "!/building/.test(document.querySelector('#stage-words').textContent)"
POSES = "JSON.stringify([...document.querySelectorAll('.names span')].map((own) => own.place.toArray()))"


def test_a_position_is_turned_by_its_slider_and_meshes_are_not_sent_again(app: App) -> None:
    app.load()
    app.page.wait(STAGED)
    before, number = app.page.ask(POSES), "document.querySelector('#turns output').value"
    assert app.page.ask(number) == "0.0°"
    app.page.ask("window.sent = []; window.asked = window.fetch")
    app.page.ask(
        "window.fetch = async (...own) => { const found = await asked(...own);"
        " if (own[0] === '/api/view') sent.push((await found.clone().arrayBuffer()).byteLength); return found; }, 0"
    )
    for event in ("input", "change"):
        app.told("#turns input", event, 25)
        app.page.wait(f"{POSES} !== {json.dumps(before)} && sent.length > 0 && {STAGED}")
    assert app.page.ask(number) == "45.0°"
    assert max(app.page.ask("sent")) < 20_000, "bytes: poses, no triangles"
    app.told("#build", "change", "trial")
    app.page.wait(f"document.querySelector('#stage-words').textContent.startsWith('trial 0') && {STAGED}")
    app.told("#turns input", "change", 0)
    assert app.page.ask(number) == "45.0°"
    app.told("#turns input", "input", 0)
    assert app.page.ask(number) == "as in the trial"
    assert app.page.told == []


def orange(picture: np.ndarray) -> float:
    """Share of the picture that is drawn in the wheel's colour."""
    return float((picture[..., 0] > picture[..., 2] + 60).mean())


def test_an_entry_of_the_tree_is_lit_and_flags_and_the_measure_are_drawn(app: App) -> None:
    app.load()
    app.page.wait(STAGED)
    texts = "[...document.querySelectorAll('.names .flag')].map((own) => own.textContent)"
    flags = app.page.ask(texts)
    assert [own for own in flags if own.startswith("pinion, wheelcentre distance ±20 µm")]
    assert [own for own in flags if own.startswith("pinion") and "tooth thickness -30 µm..-19 µm" in own]
    assert BACKLASH in app.page.ask("document.querySelector('.names .number').textContent")
    assert app.page.ask("document.querySelectorAll('.measured path').length") == 2
    app.page.ask("document.querySelector('[name=flags]').click()")
    assert app.page.ask(texts) == []
    plain = orange(app.page.picture("#stage .stage"))
    assert plain > 0.05
    app.page.ask("document.querySelector('#tree button[data-name=pinion]').click()")
    until(lambda: orange(app.page.picture("#stage .stage")) < 0.1 * plain)  # the wheel is grey
    app.page.ask(f"document.querySelector('#tree button[data-name={json.dumps(BACKLASH)}]').click()")
    until(lambda: abs(orange(app.page.picture("#stage .stage")) - plain) < 5e-3)  # a measure has no part of its own
    assert app.page.told == []


def test_a_feature_that_is_clicked_is_found_in_tree_and_text_and_a_tolerance_lights_its_own(app: App) -> None:
    app.load()
    app.told("#scene", "change", "door.yaml")
    labels = "[...document.querySelectorAll('.names span:not([hidden])')]"
    app.page.wait(f"{labels}.some((own) => own.textContent.startsWith('body.striker')) && {STAGED}")
    app.page.ask("document.querySelector('#stage').scrollIntoView()")
    striker = f"{labels}.find((own) => own.textContent.startsWith('body.striker'))"
    x, y = app.page.ask(f"(({{ x, y }}) => [x, y])({striker}.getBoundingClientRect())")
    for kind in ("mousePressed", "mouseReleased"):
        app.page.call("Input.dispatchMouseEvent", type=kind, button="left", clickCount=1, x=x, y=y)
    feature, line = app.page.ask(
        "[document.activeElement.dataset.feature, Number(document.activeElement.dataset.line)]"
    )
    assert feature in ("body.striker", "door.striker"), "they touch"
    assert DOOR.splitlines()[line - 1].strip().startswith("striker:")
    assert app.page.ask("document.querySelector('.cm-activeLine').textContent").strip().startswith("striker:")
    assert app.page.ask("document.querySelector('#middle').scrollTop") < 300, "the assembly stays in sight"
    colours = "new Set([...document.querySelectorAll('#parts input')].map((own) => own.dataset.part)).size"
    assert app.page.ask(colours) == 2
    plain = app.page.picture("#stage .stage")
    app.page.ask("document.querySelector('#tree button[data-name=\"body striker y\"]').click()")
    lit = app.page.picture("#stage .stage")
    blue = [float((own[..., 2] > own[..., 0] + 60).mean()) for own in (plain, lit)]
    assert 0.0 < blue[1] < blue[0], "the striker alone is in colour"
    assert app.page.told == []


def test_a_scene_that_cannot_be_read_shows_its_text_and_nothing_of_the_one_before(app: App) -> None:
    app.load()
    (app.file.parent / "broken.yaml").write_text("scene: broken\nparts: {}\n", "utf-8")
    app.page.wait("[...document.querySelector('#scene').options].some((own) => own.value === 'broken.yaml')")
    app.told("#scene", "change", "other.yaml")
    app.told("#scene", "change", "broken.yaml")
    app.page.wait("document.querySelector('#problems .error') !== null")
    shown = "['#card', '#stage', '#editor'].map((own) => document.querySelector(own).checkVisibility())"
    assert app.page.ask(shown) == [False, False, True]
    assert app.now() == {}
    app.told("#scene", "change", SCENE)
    app.page.wait(f"{shown}.every((own) => own)")
    app.solid({})
    (app.file.parent / "broken.yaml").unlink()


def test_what_another_program_writes_is_shown(app: App) -> None:
    app.load()
    app.file.write_text(TEXT.replace("scene: spur pair", "scene: another pair"), "utf-8")
    app.page.wait("document.querySelector('#title').textContent === 'another pair at the drive end'")


def test_text_that_is_not_saved_is_there_to_copy_when_another_program_has_changed_the_file(app: App) -> None:
    app.load()
    app.page.ask("window.copied = []; navigator.clipboard.writeText = async (own) => void copied.push(own); 0")
    app.focus("#editor .cm-content")
    app.page.call("Input.insertText", text="# mine\n")
    app.page.wait("!document.querySelector('#save').disabled")
    other = TEXT.replace("scene: spur pair", "scene: another pair")
    app.file.write_text(other, "utf-8")
    app.page.wait("!document.querySelector('#changed').hidden")
    assert "is lost when the page is loaded again" in app.page.ask("document.querySelector('#changed').textContent")
    app.click("save")
    app.page.wait("document.querySelector('#trouble').textContent.includes('was changed by another program')")
    assert app.file.read_text("utf-8") == other
    app.click("copy")
    app.page.wait("document.querySelector('#copied').textContent === 'copied'")
    (copied,) = app.page.ask("copied")
    assert "# mine" in copied
    app.click("load")
    app.page.wait("document.querySelector('#title').textContent === 'another pair at the drive end'")
    assert app.page.ask("document.querySelector('#changed').hidden && tol3dApp.editor.text() === tol3dApp.app.saved")
    app.page.told.clear()  # Chromium notes the refusal


def test_no_sideways_scroll_and_no_faint_text_at_any_width(app: App) -> None:
    app.load()
    app.focus(SLIDER)
    for number in (1, 2, 3):
        app.key("ArrowRight")
        app.page.wait(f"tol3dApp.app.past.length === {number}")
        app.click("aside")
        app.page.wait(f"document.querySelectorAll('#beside article td').length >= {number} * 4")
    for width in (1400, 1024, 768, 390, 320):
        size = {"width": width, "height": 900, "deviceScaleFactor": 1, "mobile": False}
        app.page.call("Emulation.setDeviceMetricsOverride", **size)
        for scheme in ("light", "dark"):
            feature = {"name": "prefers-color-scheme", "value": scheme}
            app.page.call("Emulation.setEmulatedMedia", features=[feature])
            aside = json.dumps(width > NARROW)
            app.page.wait(f"(document.querySelector('#text').parentElement.id === 'middle') === {aside}")
            assert app.page.ask(WIDER) == [], (width, scheme)
            assert app.page.ask(CONTRAST) == [], (width, scheme)
        ticks = app.page.ask(TICKS)
        assert len(ticks) >= 3, width
        assert all(one[1] < other[0] for one, other in pairwise(ticks)), "words of ticks stand apart"
    places = ("#answer .verdict", "#chart", "#sliders", "#stage", "#left", "#text")
    tops = [app.page.ask(f"document.querySelector('{own}').getBoundingClientRect().y") for own in places]
    assert tops == sorted(tops), "one below the other"
    order = [app.page.ask(f"{ORDER}.indexOf(document.querySelector('{own}'))") for own in places]
    assert order == sorted(order), "Tab goes as one reads"


def test_verdict_and_histogram_stay_in_sight_while_the_sliders_scroll(app: App) -> None:
    app.load()
    size = {"width": 1400, "height": 900, "deviceScaleFactor": 1, "mobile": False}
    app.page.call("Emulation.setDeviceMetricsOverride", **size)
    app.page.ask("document.querySelector('#sliders li:last-child').scrollIntoView()")
    assert app.page.ask("scrollY") == 0
    for own in ("#measure", "#answer .verdict", "#chart svg", "#keep", "#sliders li:last-child input[type=range]"):
        box = app.page.ask(f"(b => [b.top, b.bottom])(document.querySelector('{own}').getBoundingClientRect())")
        assert 0 <= box[0] < box[1] <= 900, own
    assert app.page.ask("document.querySelector('#moves').scrollTop") > 0


def test_limits_are_typed_told_once_undone_and_kept(app: App) -> None:
    app.load()
    app.focus("#upper_limit")
    app.page.call("Input.insertText", text="71 µm")
    app.page.ask("document.activeElement.blur()")
    limited = {f"limits: {BACKLASH}": "..71 µm"}
    app.solid(limited)
    assert app.page.ask("document.querySelector('#state').textContent") == "1 change not kept"
    assert "USL 71 µm" in app.page.ask("document.querySelector('#chart svg').textContent")
    app.click("aside")
    app.page.wait("document.querySelector('#beside article') !== null")
    assert "limits 15 to 71 µm" in app.page.ask("document.querySelector('#beside article').textContent")
    app.key("z", control=True)
    app.solid({})
    assert app.page.ask("document.querySelector('#upper_limit').value") == ""
    app.told("#lower_limit", "change", "none")
    app.solid({f"limits: {BACKLASH}": "none.."})
    app.told("#lower_limit", "change", "")
    app.solid({})
    assert app.page.ask("document.querySelector('#lower_limit').value") == "15 µm", "empty: that of the scene"
    app.told("#upper_limit", "change", "9 um")
    app.page.wait("!document.querySelector('#limits-wrong').hidden")
    assert app.page.ask("document.querySelector('#limits-wrong').textContent").endswith("got 15 µm and 9 µm")
    app.told("#upper_limit", "change", "71 µm")
    app.solid(limited)
    app.key("s", control=True)
    app.page.wait("document.querySelector('#diff').open")
    app.click("write")
    app.page.wait("!document.querySelector('#diff').open && document.querySelector('#keep').disabled")
    app.solid({})
    wanted = TEXT.replace("# the paper's lower limit", "# the paper's lower limit\n    upper_limit: 71 um")
    assert app.file.read_text("utf-8") == wanted


def test_who_sees_or_moves_little_can_use_it(app: App) -> None:
    """A chart is told by a title and a table, a result once, when a slider is released; what has the focus shows it."""
    app.load()
    app.page.ask("""window.said = [];
      new MutationObserver(() => said.push(document.querySelector("#result").textContent)).observe(
        document.querySelector("#result"), { childList: true })""")
    assert app.page.ask(
        "[...document.querySelectorAll(':is([aria-live], [role=status]):not(#editor *)')].map(own => own.id)"
    ) == [
        "state",
        "result",
        "analysis-state",
    ]
    headings = app.page.ask("[...document.querySelectorAll('h1, main h2')].map(own => own.textContent)")
    assert headings[1:] == ["measure", "assembly in 3D and scene as text", "tree of the scene"]
    app.page.wait("document.querySelector('#stage canvas[aria-label=\"parts in 3D\"]') !== null")
    for step in (10, 20, 30):
        app.told(SLIDER, "input", step)
        app.page.wait("document.querySelector('#chart .legend .dashed') !== null")
    assert app.page.ask("said") == []
    app.told(SLIDER, "change", 30)
    app.solid({CENTRE: "±27 µm"})
    app.page.wait("said.length > 0")
    (said,) = app.page.ask("said")
    assert re.fullmatch(r"too few trials; out of limits .+, Ppk \d\.\d\d", said)
    assert (
        app.page.ask("document.querySelector('#chart svg[role=img] > title').textContent") == f"histogram of {BACKLASH}"
    )
    rows = app.page.ask("[...document.querySelectorAll('#chart table td')].map(own => own.textContent)")
    for name in ("scene", "simulated"):
        shares = [float(own) for row in rows for own in re.findall(rf"{name} ([\d.]+) %", row)]
        assert sum(shares) == pytest.approx(100.0, abs=0.05 * len(shares))
    kinds = set()
    app.focus("#measure")
    for _ in range(16):
        app.key("Tab")
        kind, style, wide = app.page.ask(
            "(own => [own.type ?? own.tagName, getComputedStyle(own).outlineStyle,"
            " parseFloat(getComputedStyle(own).outlineWidth)])(document.activeElement)"
        )
        assert (style, wide) == ("solid", 2.0), kind
        kinds.add(kind)
    assert {"text", "button", "range"} <= kinds
    app.focus("#measure")
    app.key("ArrowDown")
    app.page.wait("tol3dApp.app.measure === 'lost motion'")
    for reduced in ("no-preference", "reduce"):
        app.page.call("Emulation.setEmulatedMedia", features=[{"name": "prefers-reduced-motion", "value": reduced}])
        moving = app.page.ask(
            "[...document.querySelectorAll('body *')].filter(own => "
            "getComputedStyle(own).transitionDuration !== '0s' && !own.closest('#editor')).length"
        )
        assert (moving == 0) == (reduced == "reduce")
    app.page.call("Emulation.setEmulatedMedia", features=[])


def test_a_renamed_tolerance_drops_its_move_with_a_sentence(app: App) -> None:
    app.load()
    app.told(SLIDER, "change", 30)
    app.solid({CENTRE: "±27 µm"})
    app.file.write_text(TEXT.replace("  centre distance:", "  distance of centres:"), "utf-8")
    app.page.wait("!document.querySelector('#dropped').hidden")
    assert app.page.ask("document.querySelector('#dropped').textContent") == (
        "centre distance is no longer in the scene: its move was dropped."
    )
    app.solid({})


def test_every_control_has_a_name(app: App) -> None:
    app.load()
    controls = {"button", "combobox", "slider", "textbox", "checkbox", "spinbutton", "searchbox", "ComboBoxMenuList"}
    nodes = [own for own in app.page.call("Accessibility.getFullAXTree")["nodes"] if not own["ignored"]]
    found = [(own["role"]["value"], own.get("name", {}).get("value", "")) for own in nodes if "role" in own]
    named = [own for own in found if own[0] in controls]
    assert len(named) > 40
    assert [own for own in named if not own[1].strip()] == []
    assert ("slider", f"{CENTRE}: how wide") in named
    width = "document.querySelector('#sliders input[type=range]').getAttribute('aria-valuetext')"
    assert app.page.ask(f"{width} === document.querySelector('#sliders input[type=text]').value")
    assert (
        app.page.ask("document.querySelectorAll('[onclick], :is(div, span):not(.cm-scroller)[tabindex]').length") == 0
    )
    every = app.page.ask("[...document.querySelectorAll('[id]')].map(own => own.id)")
    assert len({*every}) == len(every)
