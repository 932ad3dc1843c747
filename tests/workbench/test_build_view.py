"""The 3D view of a scene without a run: its builds are those of a run, and a served page with the viewer draws them."""

import io
import json
import re
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import replace
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
from tol3d.apps.workbench.builds import Known, Row, Stage, build_view, positions_at, turnable
from tol3d.errors import Tol3dError
from tol3d.report.html.view_model import GRID, ViewModel
from tol3d.report.presenter import Display, presenter_of
from tol3d.simulate import load, replayed, simulation_of
from tol3d.study.system import Trials
from tol3d.study.system.stated import component_count
from tol3d.study.trials.draws import drawn
from tol3d.study.trials.simulation import Simulation

TRIAL = 3
SLOW = [pytest.param(name, marks=pytest.mark.slow) for name in ("stewart", "rv_250aii")]


def _simulation(scene: str, trials: int = 4) -> Simulation:
    return simulation_of(load(scene), Overrides(trials=trials, witness=0))


def _row(simulation: Simulation, trial: int = TRIAL) -> Row:
    found = drawn(simulation, trial, 1)
    return Row(found.deviations[0], {name: own[0] for name, own in found.positions.items()})


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
    model, told = build_view(simulation, {"trial": _row(simulation)}, factors=(1.0, 10.0))
    glb, at_rest = model.glb(), build_view(simulation, {})[1]["builds"]
    for build, again in zip([*at_rest, told["builds"][1]], wanted.told()["builds"], strict=True):
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


@pytest.mark.parametrize(
    ("name", "allowed"), [("door", (100.0,)), ("spur_pair", (15.0, 25.0)), ("two_plates", (1.0, 2.0))]
)
def test_a_state_has_the_factor_that_its_words_tell(name: str, allowed: tuple[float, ...]) -> None:
    """Parts of a door are free; teeth and pins have no room for all, and beyond what they allow nothing is tried."""
    simulation = _simulation(name)
    _, told = build_view(simulation, {"trial": _row(simulation)})
    states = told["builds"][-1]["states"]
    for state in states[1:]:
        (words,) = re.findall(r"deviations (?:magnified )?([\d.]+) times", state["words"])
        assert f"{state['factor']:.3g}" == words
    assert [state["asked"] for state in states] == [own for own in (1.0, 10.0, 100.0) if own < 10.0 * allowed[-1]]
    assert all(state["factor"] == state["asked"] for state in states[:-1])
    assert allowed[0] <= states[-1]["factor"] <= allowed[-1]


def test_builds_that_cannot_be_shown_say_why_and_the_others_are_there() -> None:
    simulation = _simulation("spur_pair")
    trial = _row(simulation)
    _, told = build_view(simulation, {"apart": replace(trial, deviations=trial.deviations + 40.0), "trial": trial})
    assert [build["name"] for build in told["builds"]] == ["nominal", "trial"]
    assert told["refused"].keys() == {"apart"}
    assert told["refused"]["apart"].startswith("apart: ")


def test_a_build_without_positions_is_at_rest() -> None:
    simulation = _simulation("spur_pair")
    width = component_count(simulation.system)
    _, told = build_view(simulation, {"undeviated": Row(np.zeros(width))}, factors=(1.0,))
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


def _state(simulation: Simulation, rows: Mapping[str, Row], **how: Any) -> dict[str, Any]:
    """The state of the last build as it is without magnification."""
    found: dict[str, Any] = build_view(simulation, rows, factors=(1.0,), **how)[1]["builds"][-1]["states"][0]
    return found


SIGN = {"um": 1e-3, "µm": 1e-3, "mm": 1.0}


@pytest.mark.parametrize("name", ["spur_pair", "door", "slider_crank", SLOW[0]])
def test_the_line_of_a_length_is_as_long_as_its_value(name: str) -> None:
    """From places of features in one, from the value of the method that simulates in the other."""
    simulation, seen = _simulation(name), 0
    row = _row(simulation)
    positions = {key: np.atleast_1d(own) for key, own in (row.positions or {}).items()}
    values = replayed(simulation, Trials(row.deviations[None], positions))
    for measure in simulation.system.measures:
        if measure.unit not in SIGN or measure.take != "value" or "taper" in measure.name:
            continue
        _, told = build_view(simulation, {"trial": row}, factors=(1.0,), measure=measure.name)
        assert told["measured"], measure.name
        state = told["builds"][-1]["states"][0]
        ((points, is_error),) = state["measured"][measure.name]
        long = float(np.linalg.norm(np.subtract(points[1], points[0])))
        value = float(values.geometric[measure.name]) * SIGN[measure.unit]
        assert long == pytest.approx(abs(value), abs=1e-5), "mm; places are told to nine digits"
        number, unit = state["values"][measure.name].split(" ")
        assert float(number.replace("−", "-")) * SIGN[unit] == pytest.approx(value, rel=1e-3, abs=1e-6)
        assert is_error == (name == "stewart")
        seen += 1
    assert seen >= 1


def test_each_measure_is_shown_where_it_is_read() -> None:
    simulation = _simulation("slider_crank")
    read = {own.name: build_view(simulation, {}, measure=own.name)[1] for own in simulation.system.measures}
    assert {name: told["world"] for name, told in read.items() if told["measured"]} == {
        "far end": "far",
        "halfway": "up",
        "near end": "near",
    }
    assert not read["worst place"]["measured"], "it is read in all places of a path"
    asked = build_view(simulation, {}, measure="far end", world="near")[1]
    assert (asked["world"], asked["measured"]) == ("near", False)


def test_a_feature_is_told_where_its_part_is_drawn() -> None:
    """Its box holds the marks of it, and its place moves with the build."""
    simulation = _simulation("hole_and_slot")
    model, told = build_view(simulation, {"trial": _row(simulation)}, factors=(1.0,))
    nominal, trial = (build["states"][0] for build in told["builds"])
    assert told["features"].keys() == nominal["features"].keys() == trial["features"].keys()
    assert nominal["features"] != trial["features"]
    seen = 0
    for part, mesh, pose in zip(told["parts"], nominal["meshes"], nominal["poses"], strict=True):
        vertices, triangles = model.surfaces[mesh]
        matrix = np.reshape(pose, (4, 4)).T
        for name, first, count in part["features"]:
            own = told["features"][name]
            assert own["part"] == part["part"]
            frame = np.reshape(own["frame"], (4, 4)).T
            assert frame[:3, 3].tolist() == nominal["features"][name]
            marks = vertices[np.unique(triangles[first : first + count])] @ matrix[:3, :3].T + matrix[:3, 3]
            within = np.abs((marks - frame[:3, 3]) @ frame[:3, :3]).max(axis=0)
            assert np.all(within <= np.array(own["reach"]) + THICK), name
            assert np.all(within >= np.array(own["reach"]) - THICK), name
            seen += 1
    assert seen == len(told["features"]) > 8


THICK = 3.0
"""mm; symbols are about a hundredth of the size of all plates thick, marks likewise to both sides."""


def _sent(stage: Stage, known: Known, rows: Mapping[str, Row], **how: Any) -> tuple[dict[str, Any], bytes, Known]:
    answer = stage.picture(rows, known=known, **how)
    end = 4 + int.from_bytes(answer[:4], "big")
    told = json.loads(answer[4:end])
    return told, answer[end:], Known(told["collection"], told["meshes"])


def _meshes(glb: bytes) -> set[str]:
    return {*trimesh.load_scene(io.BytesIO(glb), file_type="glb").geometry} if glb else set()


def test_each_mesh_is_sent_once_and_a_position_is_poses_alone() -> None:
    simulation = _simulation("spur_pair")
    stage, system = Stage(simulation), simulation.system
    first, glb, known = _sent(stage, Known(), {})
    assert _meshes(glb) == {"mesh-0", "mesh-1"}
    (turn,) = turnable(system)
    told, glb, known = _sent(stage, known, {}, at=positions_at(system, {turn["name"]: turn["share"] / 8}))
    assert (glb, told["first"]) == (b"", 2)
    assert told["builds"][0]["states"][0]["meshes"] == first["builds"][0]["states"][0]["meshes"]
    assert told["builds"][0]["states"][0]["poses"] != first["builds"][0]["states"][0]["poses"]
    told, glb, after = _sent(stage, known, {"trial": _row(simulation)})
    assert _meshes(glb) == {f"mesh-{k}" for k in range(known.meshes, after.meshes)}
    used = {mesh for build in told["builds"] for state in build["states"] for mesh in state["meshes"]}
    assert used <= {*range(after.meshes)}
    _, glb, _ = _sent(stage, Known("another", 2), {})
    assert _meshes(glb) == {f"mesh-{k}" for k in range(after.meshes)}, "a page that has others gets all"
    _, glb, _ = _sent(Stage(simulation), after, {})
    assert _meshes(glb) == {"mesh-0", "mesh-1"}, "after a restart too"


def test_what_a_page_keeps_is_bounded(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("tol3d.apps.workbench.builds.MOST_MESHES", 2)
    simulation = _simulation("spur_pair")
    stage, row = Stage(simulation), {"trial": _row(simulation)}
    _, glb, known = _sent(stage, Known(), row)
    assert known.meshes > 2
    _, again, after = _sent(stage, known, row)
    assert after.collection != known.collection
    assert again == glb


def test_positions_turn_parts_by_as_much_as_they_say() -> None:
    """The driver's pose against the number at its slider."""
    simulation = _simulation("spur_pair")
    (turn,) = turnable(simulation.system)
    assert (turn["words"], turn["unit"], turn["low"], turn["high"]) == ("gear pair", "deg", 0.0, pytest.approx(360.0))
    standing = [positions_at(simulation.system, {turn["name"]: own}) for own in (0.0, turn["share"] / 8)]
    poses = [np.reshape(_state(simulation, {}, at=own)["poses"][0], (4, 4)).T for own in standing]
    turned = poses[1][:3, :3] @ np.linalg.inv(poses[0][:3, :3])
    assert np.degrees(np.arccos((np.trace(turned) - 1.0) / 2.0)) == pytest.approx(45.0, abs=1e-3)


def test_every_position_that_is_drawn_has_a_slider_and_moves_alone() -> None:
    simulation = _simulation("robot_shoulder_swing")
    sliders = turnable(simulation.system)
    assert len(sliders) == len(simulation.system.streams) > 0
    rest = positions_at(simulation.system, {})
    for own in sliders:
        moved = positions_at(simulation.system, {own["name"]: own["share"]})
        assert {name for name in rest if moved[name] != rest[name]}
    assert positions_at(simulation.system, {sliders[0]["name"]: 7.0}) == positions_at(
        simulation.system, {sliders[0]["name"]: 1.0}
    ), "no further than trials go"


def test_all_builds_stand_at_positions_that_are_asked_for_and_the_nominal_one_at_those_of_a_trial() -> None:
    simulation = _simulation("spur_pair")
    row = _row(simulation)
    at = positions_at(simulation.system, {turnable(simulation.system)[0]["name"]: 0.01})

    def pinion(build: dict[str, Any]) -> list[float]:
        return list(build["states"][0]["poses"][0])

    nominal, trial = build_view(simulation, {"trial": row}, factors=(1.0,))[1]["builds"]
    assert pinion(nominal) == pinion(build_view(simulation, {}, at=row.positions)[1]["builds"][0])
    assert pinion(nominal) != pinion(build_view(simulation, {})[1]["builds"][0])
    nominal, other = build_view(simulation, {"trial": row}, factors=(1.0,), at=at)[1]["builds"]
    assert pinion(nominal) == pinion(build_view(simulation, {}, at=at)[1]["builds"][0])
    assert pinion(other) != pinion(trial)


# in a browser -------------------------------------------------------------------------------------

POLICY = (
    "default-src 'none'; script-src 'self'; style-src 'self'; img-src 'self' data:; connect-src 'self'; "
    "base-uri 'none'; form-action 'none'; frame-ancestors 'none'"
)
HTML = """<!doctype html><html lang="en"><head><meta charset="utf-8"><title>parts</title>
<link rel="stylesheet" href="style.css"><link rel="icon" href="data:,"></head>
<body><figure class="view"></figure><script src="viewer.js"></script><script src="page.js"></script></body></html>"""
STYLE = """.stage { position: relative; width: 800px; height: 600px; background: #fff; }
.stage canvas, .names { position: absolute; inset: 0; } .names { pointer-events: none; visibility: hidden; }
.names :is(span, b) { position: absolute; left: 0; top: 0; white-space: nowrap; font: 13px/15px sans-serif; }"""
SCRIPT = """const got = async (name, as) => (await fetch(name))[as]();
window.opened = async (name) => [await got(`${name}.glb`, "arrayBuffer"), await got(`${name}.json`, "json")];
window.picks = [];
(async () => {
  window.view = tol3dView(document.querySelector("figure"), ...await opened("first"));
  view.onpick((...names) => picks.push(names));
})();"""
STAGE = ".stage"
HEIGHT = "height leaning"
LOOK = """(name => {
  const own = view.told.features[name], at = (k) => view.camera.position.clone().fromArray(own.frame, 4 * k);
  view.camera.up.copy(at(0));
  view.controls.target.copy(at(3));
  view.camera.position.copy(at(3)).addScaledVector(at(2), 4 * view.reach);
  view.camera.zoom = 1;
  view.controls.update();
  view.draw();
  const [x, y] = own.reach, seen = (u, v) => {
    const one = at(3).addScaledVector(at(0), u * x).addScaledVector(at(1), v * y).project(view.camera);
    return [(one.x + 1) * 400, (1 - one.y) * 300];
  };
  return [-0.9, -0.5, 0.5, 0.9].flatMap((u) => [-0.9, 0, 0.9].map((v) => seen(u, v)));
})"""
"""Looks straight at a face, and gives places on it, or where it is open."""
LABELS = """[...document.querySelectorAll('.names span')].map((own) => {
  const { x, y, width, height } = own.firstChild.getBoundingClientRect();
  return { text: own.textContent, kind: own.className.split(" ")[0], box: [x, y, width, height],
    seen: !own.hidden && !own.classList.contains("crowded") };
})"""
PROJECTED = """Object.fromEntries([...document.querySelectorAll('.names span')].map(own => {
  const at = own.place.clone().project(view.camera);
  return [own.textContent, [(at.x + 1) * 400, (1 - at.y) * 300]];
}))"""
"""Places of names in the stage, by what is written there."""


DOTS = """[...document.querySelectorAll('.names span:not(.covered)')].map((own) => {
  const at = own.place.clone().project(view.camera);
  return [own.querySelector('i').textContent, [(at.x + 1) * 400, (1 - at.y) * 300]];
}).filter(([words]) => view.told.features[words.replace(" ◣", "").split(",")[0]])"""
"""Dots of features in the stage."""


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
    box, hexapod = _simulation("bracket_in_box"), _simulation("stewart")
    models = {
        "first": build_view(pair, {"trial": _row(pair)}),
        "second": build_view(door, {}),
        "box": build_view(box, {}),
        "housing": build_view(_simulation("gearbox_in_housing"), {}),
        "hexapod": build_view(hexapod, {"trial": _row(hexapod)}, factors=(1.0, 10.0), measure=HEIGHT),
    }
    files = {
        "": ("text/html", HTML.encode()),
        "style.css": ("text/css", STYLE.encode()),
        "page.js": ("text/javascript", SCRIPT.encode()),
        "viewer.js": ("text/javascript", (ROOT / "tol3d" / "report" / "html" / "viewer.js").read_bytes()),
    }
    for name, (model, told) in models.items():
        files |= {
            f"{name}.glb": ("model/gltf-binary", model.glb()),
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


@pytest.mark.slow
def test_a_click_on_a_face_names_its_feature(page: Page) -> None:
    """The faces of solids have no triangles of their own in the model; their marks have."""
    page.ask("opened('box').then(found => view.replace(...found)).then(() => view.fit())")
    for part, feature in (("bracket", "bracket.A"), ("box", "box.A")):
        others = f"view.parts.forEach((own) => {{ own.visible = own.userData.part === {json.dumps(part)}; }})"
        page.ask(others)
        picked = list[str]()
        for x, y in page.ask(f"{LOOK}({json.dumps(feature)})"):
            _press(page, x, y)
            picked += [name for name in page.ask("picks.splice(0)")[0] if name]
        assert picked.count(feature) >= 4, picked
        assert {name for name in picked if "." not in name} == {part}
    page.ask("view.parts.forEach((own) => { own.visible = true; }), view.fit()")


@pytest.mark.slow
def test_a_click_on_the_dot_of_a_feature_names_it_whatever_lies_before_it(page: Page) -> None:
    page.ask("opened('box').then(found => view.replace(...found)).then(() => view.fit())")
    datums = ["box.A", "box.D", "bracket.A", "bracket.B"]
    page.ask(f"view.flags({json.dumps([{'name': '', 'of': [own], 'words': 'datum'} for own in datums])})")
    dots = page.ask(DOTS)
    apart = [
        (text.removesuffix(" ◣"), place)
        for text, place in dots
        if all(np.hypot(*np.subtract(place, other)) > 12.0 for words, other in dots if words != text)
    ]
    assert len(apart) > 5
    assert {text for text, _ in apart} & {*datums}
    for text, (x, y) in apart:
        feature = text.partition(",")[0]
        _press(page, x + 2.0, y - 2.0)
        assert page.ask("picks.splice(0)") == [[feature.partition(".")[0], feature]]
    page.ask("view.flags([])")


@pytest.mark.slow
def test_a_click_goes_through_what_is_clear_to_the_part_within(page: Page) -> None:
    """Gears within a housing are opaque; a bracket in a box is as clear as the box."""
    page.ask("opened('housing').then(found => view.replace(...found)).then(() => view.fit())")
    gears = page.ask("view.parts.filter((own) => own.userData.opacity === 1).map((own) => own.userData.part)")
    clear = page.ask("view.parts.filter((own) => own.userData.opacity < 1).map((own) => own.userData.part)")
    assert len(gears) > 1
    assert clear == ["housing", "cover"]
    _require_picked_within(page, gears, clear)
    page.ask("opened('box').then(found => view.replace(...found)).then(() => view.fit())")
    _require_picked_within(page, ["bracket"], ["box"])


def _require_picked_within(page: Page, inner: Sequence[str], outer: Sequence[str]) -> None:
    """Clicks where an inner part is seen alone pick it through the outer ones, but for marks of their features."""
    places = [(float(x), float(y)) for x in range(100, 800, 50) for y in range(80, 600, 50)]
    seen = list[list[tuple[str, str]]]()
    for names in (inner, outer, (*inner, *outer)):
        some = f"own.visible = {json.dumps([*names])}.includes(own.userData.part)"
        page.ask(f"view.parts.forEach((own) => {{ {some}; }}), view.draw()")
        for place in places:
            _press(page, *place)
        seen.append([(part, feature) for part, feature in page.ask("picks.splice(0)")])
    page.ask("view.parts.forEach((own) => { own.visible = true; })")
    rows = [*zip(*seen, strict=True)]
    within = [both for (alone, _), _, both in rows if alone]
    assert sum(part in inner for part, _ in within) > max(5, 0.6 * len(within))
    assert all(feature is not None for part, feature in within if part not in inner)
    assert {part for (alone, _), (around, _), (part, _) in rows if around and not alone} <= {*outer}


@pytest.mark.slow
def test_flags_of_tolerances_that_do_not_act_are_grey(page: Page) -> None:
    page.ask("opened('hexapod').then(found => view.replace(...found)).then(() => view.fit())")
    flags = [
        {"name": "", "of": ["foot 1.seat"], "words": "datum"},
        {"name": "", "of": ["platform.P2"], "words": "datum"},
        {"name": "idle", "of": ["platform.P1"], "words": "idle words"},
        {"name": "acts", "of": ["platform.P1"], "words": "words that act"},
        {"name": "far", "of": ["platform.P3"], "words": "far words"},
        {"name": "whole", "of": ["platform"], "words": "whole words"},
    ]
    page.ask(f"view.flags({json.dumps(flags)})")
    grey = """[...document.querySelectorAll('.names .flag')].map((own) => [
      own.textContent, own.classList.contains("idle"),
      [...own.querySelectorAll("i.idle")].map((line) => line.textContent),
    ])"""
    assert {(text, idle) for text, idle, _ in page.ask(grey)} >= {("platform.P1idle wordswords that act", False)}
    page.ask("view.light(['platform'], ['acts'])")
    assert {text: (idle, lines) for text, idle, lines in page.ask(grey)} == {
        "foot 1.seat ◣": (True, []),
        "platform.P2 ◣": (False, []),
        "platform.P1words that actidle words": (False, ["idle words"]),
        "platform.P3far words": (True, ["far words"]),
        "platformwhole words": (True, ["whole words"]),
    }
    page.ask("view.light(['platform.P3'])")
    assert {idle for _, idle, _ in page.ask(grey)} == {False}, "no tolerances are named"
    page.ask("view.light(null), view.flags([])")


def _overlap(one: list[float], other: list[float]) -> bool:
    return all(abs(2 * (one[k] - other[k]) + one[k + 2] - other[k + 2]) < one[k + 2] + other[k + 2] - 1 for k in (0, 1))


@pytest.mark.slow
def test_words_lie_beside_each_other_and_those_that_count_are_there(page: Page) -> None:
    page.ask("opened('hexapod').then(found => view.replace(...found)).then(() => view.fit())")
    flags = [
        {"name": "", "of": ["foot 1.seat"], "words": "datum"},
        {"name": "lean of P1", "of": ["platform.P1"], "words": "∥ | ⌀20 µm | seat"},
        {"name": "<b>hostile</b>", "of": ["platform.P1"], "words": "<img src=x>"},
        {"name": "of no part", "of": ["nowhere"], "words": "lost"},
    ]
    page.ask(f"view.flags({json.dumps(flags)})")
    page.ask(f"view.measure({json.dumps(HEIGHT)}), view.show('trial', 1)")
    labels = page.ask(LABELS)
    seen = [own for own in labels if own["seen"]]
    assert len(seen) > 8
    assert not [1 for k, one in enumerate(seen) for other in seen[k + 1 :] if _overlap(one["box"], other["box"])]
    texts = {own["text"]: own["kind"] for own in labels}
    assert texts["platform.P1∥ | ⌀20 µm | seat<img src=x>"] == "flag"
    assert texts["foot 1.seat ◣"] == "flag"
    assert "platform.P1" not in texts, "its flag has its name"
    assert "lost" not in "".join(texts)

    (number,) = (text for text, kind in texts.items() if kind == "number")
    state = "view.told.builds[1].states[0]"
    [[points, is_error]] = page.ask(f"{state}.measured[{json.dumps(HEIGHT)}]")
    whole = 1000.0 * float(np.linalg.norm(np.subtract(points[-1], points[0])))
    value = page.ask(f"{state}.values[{json.dumps(HEIGHT)}]")
    assert is_error
    assert number.startswith(f"{HEIGHT} {value}")
    told = float(number.removeprefix(f"{HEIGHT} {value}").partition(" µm off its nominal place")[0])
    assert told == pytest.approx(whole, rel=5e-3), "three digits, of the build itself"
    long = page.ask("document.querySelector('.measured .error').getTotalLength()")
    page.ask("view.show('trial', 10)")
    assert page.ask("view.told.builds[1].states[0] !== view.told.builds[1].states.at(-1)")
    larger = page.ask(LABELS + ".find((own) => own.kind === 'number').text")
    assert larger.partition("arrow ×")[0] == number.partition("arrow ×")[0], "as it is, however it is drawn"
    assert page.ask("document.querySelector('.measured .error').getTotalLength()") > long

    page.ask("view.prefer(['lean of P1'])")
    bore = next(own for own in page.ask(LABELS) if own["text"].startswith("platform.P1"))
    assert bore["seen"]
    page.ask("view.measure(''), view.flags([])")
    assert {own["kind"] for own in page.ask(LABELS)} == {"name"}
    assert page.ask("document.querySelectorAll('.measured path').length") == 0
    page.ask("view.clear()")
    assert page.ask("document.querySelectorAll('.names span').length") == 0
    assert page.ask("document.querySelector('.stage').checkVisibility()") is False
    page.ask("opened('first').then(found => view.replace(...found))")
    assert page.ask("document.querySelector('.stage').checkVisibility()") is True
    assert page.told == []
