"""The 3D view of a scene without a run: its builds are those of a run, and a served page with the viewer draws them."""

import io
import json
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from pathlib import Path
from threading import Thread
from typing import Any

import numpy as np
import pytest
import trimesh
from browser import Page, browser
from places import ROOT

from tol3d import Overrides, run_scene
from tol3d.apps.workbench.builds import build_view
from tol3d.errors import Tol3dError
from tol3d.report.html.view_model import GRID, ViewModel
from tol3d.report.presenter import Display, presenter_of
from tol3d.simulate import load, simulation_of
from tol3d.study.system.stated import component_count
from tol3d.study.trials.draws import drawn
from tol3d.study.trials.simulation import Simulation

TRIAL = 3
SLOW = [pytest.param(name, marks=pytest.mark.slow) for name in ("stewart", "rv_250aii")]
Row = tuple[np.ndarray, Mapping[str, np.ndarray]]


def _simulation(scene: str, trials: int = 4) -> Simulation:
    return simulation_of(load(scene), Overrides(trials=trials, witness=0))


def _row(simulation: Simulation, trial: int = TRIAL) -> Row:
    found = drawn(simulation, trial, 1)
    return found.deviations[0], {name: own[0] for name, own in found.positions.items()}


@pytest.mark.parametrize("name", ["spur_pair", "door", *SLOW])
def test_builds_stand_as_those_of_a_run_to_the_bit(name: str, tmp_path: Path) -> None:
    run = run_scene(name, overrides=Overrides(trials=4, witness=0), out=tmp_path / "run")
    presenter = presenter_of(run.found)

    def words(display: Display) -> str:
        return "; ".join(("trial" if display.label.startswith("trial") else display.label, *display.notes))

    wanted = ViewModel()
    nominal = presenter.display(run, "nominal", magnify=1.0)
    wanted.add("nominal", [(1.0, nominal, words(nominal))])
    by_factor = [(factor, presenter.display(run, TRIAL, magnify=factor)) for factor in (1.0, 10.0)]
    wanted.add("trial", [(factor, own, words(own)) for factor, own in by_factor])
    simulation = _simulation(name)
    glb, told = build_view(simulation, {"trial": _row(simulation)}, factors=(1.0, 10.0))
    for build, again in zip(told["builds"], wanted.told()["builds"], strict=True):
        assert build["name"] == again["name"]
        for state, other in zip(build["states"], again["states"], strict=True):
            assert {key: state[key] for key in ("factor", "meshes", "poses", "names")} == {
                key: other[key] for key in ("factor", "meshes", "poses", "names")
            }
            assert state["words"].partition(";")[2] == other["words"].partition(";")[2]
    assert told["parts"] == wanted.told()["parts"]
    assert glb == wanted.glb()
    held = trimesh.load_scene(io.BytesIO(glb), file_type="glb").geometry
    assert {f"mesh-{mesh}" for build in told["builds"] for state in build["states"] for mesh in state["meshes"]} <= {
        *held
    }
    assert json.loads(json.dumps(told, allow_nan=False)) == json.loads(json.dumps(told))
    assert told["refused"] == {}


def test_builds_that_cannot_be_shown_say_why_and_the_others_are_there() -> None:
    simulation = _simulation("spur_pair")
    deviations, positions = _row(simulation)
    _, told = build_view(simulation, {"apart": (deviations + 40.0, positions), "trial": (deviations, positions)})
    assert [build["name"] for build in told["builds"]] == ["nominal", "trial"]
    assert told["refused"].keys() == {"apart"}
    assert told["refused"]["apart"].startswith("apart: ")


def test_a_build_without_positions_is_at_rest() -> None:
    simulation = _simulation("spur_pair")
    width = component_count(simulation.system)
    _, told = build_view(simulation, {"undeviated": (np.zeros(width), None)}, factors=(1.0,))
    nominal, other = (build["states"][0] for build in told["builds"])
    assert nominal["names"].keys() == other["names"].keys()
    np.testing.assert_allclose(other["poses"], nominal["poses"], rtol=0, atol=GRID / 2)  # fitted to rounded corners


def test_any_world_of_a_scene_can_be_shown() -> None:
    simulation = _simulation("slider_crank")
    views = {world: build_view(simulation, {}, world=world)[1] for world in build_view(simulation, {})[1]["worlds"]}
    assert len(views) > 2
    assert all(told["world"] == world for world, told in views.items())
    assert len({json.dumps(told["builds"][0]["states"][0]["poses"]) for told in views.values()}) == len(views)
    with pytest.raises(Tol3dError, match="there is nothing to show in 3D"):
        build_view(simulation, {}, world="none")


# in a browser -------------------------------------------------------------------------------------

POLICY = (
    "default-src 'none'; script-src 'self'; style-src 'self'; img-src 'self' data:; connect-src 'self'; "
    "base-uri 'none'; form-action 'none'; frame-ancestors 'none'"
)
HTML = """<!doctype html><html lang="en"><head><meta charset="utf-8"><title>parts</title>
<link rel="stylesheet" href="style.css"><link rel="icon" href="data:,"></head>
<body><figure class="view"></figure><script src="viewer.js"></script><script src="page.js"></script></body></html>"""
STYLE = """.stage { position: relative; width: 800px; height: 600px; background: #fff; }
.stage canvas, .names { position: absolute; inset: 0; } .names { pointer-events: none; visibility: hidden; }"""
SCRIPT = """const got = async (name, as) => (await fetch(name))[as]();
window.opened = async (name) => [await got(`${name}.glb`, "arrayBuffer"), await got(`${name}.json`, "json")];
window.picks = [];
(async () => {
  window.view = tol3dView(document.querySelector("figure"), ...await opened("first"));
  view.onpick((...names) => picks.push(names));
})();"""
STAGE = ".stage"
PROJECTED = """Object.fromEntries([...document.querySelectorAll('.names span')].map(own => {
  const at = own.place.clone().project(view.camera);
  return [own.textContent, [(at.x + 1) * 400, (1 - at.y) * 300]];
}))"""
"""Places of names in the stage, by what is written there."""


@contextmanager
def _served(files: Mapping[str, tuple[str, bytes]]) -> Iterator[str]:
    """Within it these files, with their types, at the address that it gives, under a strict policy."""

    class Handler(BaseHTTPRequestHandler):
        def do_GET(self) -> None:
            kind, content = files[self.path.strip("/")]
            self.send_response(200)
            self.send_header("Content-Type", kind)
            self.send_header("Content-Length", str(len(content)))
            self.send_header("Content-Security-Policy", POLICY)
            self.end_headers()
            self.wfile.write(content)

        def log_message(self, *_: object) -> None:
            pass

    with ThreadingHTTPServer(("127.0.0.1", 0), Handler) as server:
        thread = Thread(target=server.serve_forever)
        thread.start()
        try:
            yield f"http://127.0.0.1:{server.server_port}/"
        finally:
            server.shutdown()
            thread.join()


@pytest.fixture(scope="module")
def page() -> Iterator[Page]:
    pair, door = _simulation("spur_pair"), _simulation("door")
    first, second = build_view(pair, {"trial": _row(pair)}), build_view(door, {})
    files = {
        "": ("text/html", HTML.encode()),
        "style.css": ("text/css", STYLE.encode()),
        "page.js": ("text/javascript", SCRIPT.encode()),
        "viewer.js": ("text/javascript", (ROOT / "tol3d" / "report" / "html" / "viewer.js").read_bytes()),
    }
    for name, (glb, told) in {"first": first, "second": second}.items():
        files |= {
            f"{name}.glb": ("model/gltf-binary", glb),
            f"{name}.json": ("application/json", json.dumps(told).encode()),
        }
    with _served(files) as address, browser() as own:
        own.open(address)
        own.wait("window.view !== undefined && document.querySelector('figure').dataset.ready === 'yes'")
        yield own


def _share(picture: np.ndarray, hue: str) -> float:
    """Share of a picture that is blue (the pinion), orange (the wheel) or grey."""
    red, _, blue = np.moveaxis(picture, -1, 0)
    lively = picture.max(axis=-1) - picture.min(axis=-1) > 60
    grey = (picture.max(axis=-1) < 235) & (picture.max(axis=-1) - picture.min(axis=-1) < 25)
    found = {"blue": lively & (blue > red), "orange": lively & (red > blue), "grey": grey}
    return float(found[hue].mean())


def _press(page: Page, x: float, y: float, *, to: tuple[float, float] | None = None) -> None:
    """Press at a place of the stage, and release there or elsewhere."""
    box = page.ask("(b => [b.x, b.y])(document.querySelector('.stage').getBoundingClientRect())")
    along = [(x, y), *([to] if to else [])]
    places: list[dict[str, Any]] = [{"x": box[0] + own[0], "y": box[1] + own[1]} for own in along]
    page.call("Input.dispatchMouseEvent", type="mousePressed", button="left", clickCount=1, **places[0])
    for place in places[1:]:
        page.call("Input.dispatchMouseEvent", type="mouseMoved", button="left", buttons=1, **place)
    page.call("Input.dispatchMouseEvent", type="mouseReleased", button="left", clickCount=1, **places[-1])


@pytest.mark.slow
def test_a_served_page_draws_lights_and_picks_parts_and_shows_other_builds_and_models(page: Page) -> None:
    whole = page.picture(STAGE)
    assert _share(whole, "blue") > 0.005
    assert _share(whole, "orange") > 0.1
    page.ask("view.light(['pinion'])")
    lit = page.picture(STAGE)
    assert _share(lit, "blue") == pytest.approx(_share(whole, "blue"), abs=2e-3)
    assert _share(lit, "orange") < 1e-3
    assert _share(lit, "grey") > 0.1
    page.ask("view.light(null)")
    assert np.array_equal(page.picture(STAGE), whole)
    page.ask("view.show('trial', 100)")
    assert np.abs(page.picture(STAGE) - whole).max() > 60, "it deviates"
    page.ask("view.show('nominal')")
    assert np.array_equal(page.picture(STAGE), whole)

    rows, columns = np.nonzero((whole.max(axis=-1) - whole.min(axis=-1) > 60) & (whole[..., 2] > whole[..., 0]))
    place = int(np.median(columns)), int(np.median(rows[columns == int(np.median(columns))]))
    _press(page, *place)
    _press(page, 3.0, 3.0)
    assert page.ask("picks.splice(0)") == [["pinion", None], [None, None]]
    _press(page, *place, to=(place[0] + 30.0, place[1]))
    assert page.ask("picks.splice(0)") == [], "a drag is no click"
    assert not np.array_equal(page.picture(STAGE), whole), "it turns"

    page.ask("opened('second').then(found => view.replace(...found)).then(() => view.fit())")
    picture = page.picture(STAGE)
    seen = set[str]()
    for label, (x, y) in page.ask(PROJECTED).items():
        _press(page, x, y)
        ((part, feature),) = page.ask("picks.splice(0)")
        assert feature.startswith(f"{part}.")
        places = page.ask("view.told.builds[0].states[0].names")
        at = next(place for name, place in places.items() if name.partition(",")[0] == feature)
        assert np.linalg.norm(np.subtract(at, places[label])) < 10.0, "mm; features of both parts lie at some places"
        seen.add(feature)
    assert 6 <= len(seen) <= 12, "where they do the nearer one is picked"
    page.ask(f"view.light([{json.dumps(min(seen))}])")
    assert 0.0 < _share(page.picture(STAGE), "grey") > _share(picture, "grey")
    assert page.told == []
    assert {own.partition(":")[0] for own in page.asked} <= {"http", "blob", "data"}
