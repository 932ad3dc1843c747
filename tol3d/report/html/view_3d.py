"""The 3D view of a report: every mesh once, and the poses that builds were really seated in, as one packed model."""

import base64
import gzip
import json
import tempfile
from collections.abc import Callable, Iterator, Mapping, Sequence, Set
from io import BytesIO
from itertools import chain
from pathlib import Path
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray
from PIL import Image

from tol3d.errors import InputError, Tol3dError
from tol3d.numerics.arrays import Array
from tol3d.report.body import Surface
from tol3d.report.drawn_solids import poly_data
from tol3d.report.error_arrows import values_of
from tol3d.report.heading import shown_measures
from tol3d.report.html.blocks import Markup, tag
from tol3d.report.html.view_model import ViewModel
from tol3d.report.motion import travels_of
from tol3d.report.presenter import Display, Presenter, Which
from tol3d.report.shown_unit import shown_run
from tol3d.report.view import view_build, view_run
from tol3d.study.runs.run import Run

FACTORS: Final = (1.0, 10.0, 100.0)
"""Magnifications of a trial's deviations; a build that does not allow one says so."""
LARGEST: Final = 2_500_000
"""Bytes of the packed model; beyond it parts that deviate are shown nominal."""
MOST: Final = 3_400_000
"""Bytes of the packed model that leave a page of 5 MB; beyond it facets are coarser."""
FEWEST_FACETS: Final = 1000
"""Triangles of a mesh that is not made coarser."""
MOST_TRIES: Final = 4
LEAST_LEFT: Final = 0.02
"""Share of a mesh's triangles that is left at least."""
ERRORS: Final = ":errors"
"""Errors of places as pictures have them, in the place of a measure; `viewer.js` knows it."""
STILL_WIDTH, STILL_QUALITY = 1100, 80


def view_3d(run: Run, presenter: Presenter, trials: Sequence[int] = ()) -> Markup:
    """Nominal, worst and chosen builds in 3D; a sentence where there is nothing to show.

    Args:
        run: a finished run.
        presenter: of its system.
        trials: which are shown besides.
    """
    wanted: list[Which] = ["nominal", *(["worst"] if run.keeps_trials else []), *trials]
    model = ViewModel()
    for which in wanted:
        try:
            displays = _displays(run, presenter, which)
            _, first, _ = own = next(displays)
            if not model.builds and (motions := travels_of(first)):
                model = ViewModel(first.worlds[0].name, motion=motions[0])
            model.add(_called(which), chain([own], displays), _read(run, which, first))
        except Tol3dError as error:
            if not model.builds:
                return tag("p", f"no 3D view: {error}", class_="note")
    shown: Which = "worst" if run.keeps_trials else "nominal"
    return _page(model, lambda path: view_run(run, shown, screenshot=path))


def moving_3d(run: Run, display: Display, which: Which, motion: str | None, frames: int | None) -> Markup:
    """A build in 3D that moves as soon as it is seen, unless its reader wants no motion.

    Args:
        run: whose.
        display: the build.
        which: see `Presenter.display`.
        motion: its name; None: the first there is.
        frames: how many; None: as many as suit it.

    Raises:
        InputError: no such motion, or none that a page can show.
    """
    motions = travels_of(display)
    if not motions or motion not in (None, *motions):
        wanted = f"expected one of {', '.join(motions)}" if motions else "it has no poses and no path"
        raise InputError(f"{display.label}: a page cannot show it in motion: {wanted}")
    model = ViewModel(display.worlds[0].name, motion=motion or motions[0], frames=frames)
    words = "; ".join((display.label, *display.notes))
    values = _read(run, which, display)
    model.add(_called(which), [(display.worlds[0].magnify or 1.0, display, words)], values)
    return _page(model, lambda path: view_build(display, values, screenshot=path), plays="yes")


def _read(run: Run, which: Which, display: Display) -> Mapping[str, str]:
    """Values of the measures that are read in the worlds of a build, in words."""
    read = {name for own in display.worlds for name in own.measured}
    return values_of(run, which, display.label, [name for name in run.found.measures if name in read])


def _page(model: ViewModel, draw: Callable[[Path], object], plays: str | None = None) -> Markup:
    """A figure of builds, as small as a page can be, and the picture that stands there where nothing can be turned."""
    packed, nominal = _packed(model), tuple[str, ...]()
    if len(packed) > LARGEST:
        model, nominal = model.undeviated()
        packed = _packed(model)
    model, packed, coarser = _within(model, packed)
    return _figure(model, packed, _still(draw), _notes(model, nominal, coarser), plays)


def _displays(run: Run, presenter: Presenter, which: Which) -> Iterator[tuple[float, Display, str]]:
    """A build at every magnification, with its words."""
    for factor in (1.0,) if which == "nominal" else FACTORS:
        display = presenter.display(run, which, magnify=factor)
        measured = _measured(run, which, display.label) if factor == FACTORS[0] else display.label
        yield factor, display, "; ".join((measured, *display.notes))


def _packed(model: ViewModel) -> bytes:
    """The model as a GLB, packed the same way every time."""
    return gzip.compress(model.glb(), 9, mtime=0)


def _measured(run: Run, which: Which, label: str) -> str:
    """A build with the values of the measures that are shown."""
    values = values_of(run, which, label, shown_measures(shown_run(run.found).measures))
    told = [f"{name} {own}" for name, own in values.items()]
    return f"{label}: {', '.join(told)}" if told else label


def _called(which: Which) -> str:
    return which if isinstance(which, str) else f"trial {which}"


def _within(model: ViewModel, packed: bytes) -> tuple[ViewModel, bytes, frozenset[int]]:
    """The model with as few triangles as make it small enough, packed; and which of its meshes are coarser."""
    coarser = frozenset[int]()
    for _ in range(MOST_TRIES):
        large = [k for k, (_, own) in enumerate(model.surfaces) if len(own) > FEWEST_FACETS]
        if len(packed) <= MOST or not large:
            break
        left = max(0.8 * MOST / len(packed), LEAST_LEFT)
        coarser |= set(large)
        model = model.remeshed(
            [fewer_facets(*own, left) if k in coarser else own for k, own in enumerate(model.surfaces)]
        )
        packed = _packed(model)
    return model, packed, coarser


def fewer_facets(vertices: Array, triangles: NDArray[np.int64], left: float) -> Surface:
    """A surface with a share of its triangles, where it bends least fewer (quadric error: Garland, Heckbert 1997)."""
    merged = poly_data(vertices, triangles).clean()
    found = merged.decimate(1.0 - left, volume_preservation=True)
    return np.asarray(found.points, dtype=np.float64), found.regular_faces


def _notes(model: ViewModel, nominal: Sequence[str], coarser: Set[int]) -> list[str]:
    """Notes on differences between the picture and the build."""
    states = [state for build in model.builds for state in build.states]
    rough = {k for state in states for k, mesh in enumerate(state.meshes) if mesh in coarser}
    named = ", ".join(model.parts[k].name for k in sorted(rough))
    notes = [f"shown nominal: {', '.join(nominal)}"] if nominal else []
    return [*notes, *([f"coarser facets, for the size of this page: {named}"] if named else [])]


def _still(draw: Callable[[Path], object]) -> str:
    """The picture that stands there where nothing can be turned: as `tol3d view` draws it."""
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "still.png"
        try:
            draw(path)
        except Tol3dError:
            return ""
        picture = BytesIO()
        with Image.open(path) as drawn:
            drawn.thumbnail((STILL_WIDTH, STILL_WIDTH))
            drawn.convert("RGB").save(picture, "JPEG", quality=STILL_QUALITY)
        return base64.b64encode(picture.getvalue()).decode()


def _figure(model: ViewModel, packed: bytes, still: str, notes: Sequence[str], plays: str | None) -> Markup:
    data = json.dumps(_plain(model.told()), sort_keys=True, separators=(",", ":")).replace("<", "\\u003c")
    picture = tag("img", src=f"data:image/jpeg;base64,{still}", alt="the parts, as tol3d view shows them")
    return tag(
        "figure",
        tag("div", tag("canvas"), picture if still else None, class_="stage"),
        *_controls(model),
        tag("p", class_="state note"),
        *(tag("p", note, class_="note") for note in notes),
        tag("script", Markup(data), type="application/json", id="view-data"),
        tag("script", Markup(base64.b64encode(packed).decode()), type="text/plain", id="view-model"),
        class_="view",
        data_plays=plays,
    )


def _controls(model: ViewModel) -> Iterator[Markup]:
    if any(state.motion for own in model.builds for state in own.states):
        yield tag(
            "div",
            tag("button", "play", type="button", name_="play"),
            tag("label", f"{model.motion} ", tag("input", type="range", name_="moment", min=0, max=0, value=0, step=1)),
            tag("span", class_="caption"),
            tag("span", class_="swing dim"),
            class_="controls moving",
        )
    options = (tag("option", own.name, value=number) for number, own in enumerate(model.builds))
    states = [state for own in model.builds for state in own.states]
    stops = [own for state in states if state.motion for own in state.motion.stops.values()]
    lines = [*(state.measured for state in states), *(own.measured for own in stops)]
    measured = dict.fromkeys(name for own in lines for name in own)
    has_errors = any(state.errors for state in states) or any(own.errors for own in stops)
    errors = tag("option", "errors of places", value=ERRORS) if has_errors else None
    measures = (tag("option", name, value=name) for name in measured)
    slider = tag("input", type="range", name_="factor", min=0, max=len(FACTORS) - 1, value=0, step=1)
    number = tag("output", f"{FACTORS[0]:g}", name_="times")
    yield tag(
        "div",
        tag("label", "build ", tag("select", *options, name_="build")),
        tag("label", "deviations × ", number, " ", slider),
        tag("label", tag("input", type="checkbox", name_="names", checked=""), " names"),
        tag("label", "measure ", tag("select", errors, tag("option", "none", value=""), *measures, name_="measured"))
        if measured
        else None,
        tag("button", "fit", type="button", name_="fit"),
        tag("span", "drag turns, wheel zooms, double click fits", class_="dim"),
        class_="controls",
    )
    boxes = (
        tag("label", tag("input", type="checkbox", name_="part", value=k, checked=""), f" {own.name}")
        for k, own in enumerate(model.parts)
    )
    yield tag("details", tag("summary", "parts"), tag("div", *boxes, class_="controls"), open="")


def _plain(told: Any) -> Any:
    """Data for JSON with whole numbers as such: 28 for 28.0, which a browser reads alike."""
    if isinstance(told, Mapping):
        return {key: _plain(own) for key, own in told.items()}
    if isinstance(told, list | tuple):
        return [_plain(own) for own in told]
    return int(told) if isinstance(told, float) and told.is_integer() else told
