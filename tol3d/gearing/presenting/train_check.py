"""Shafts and trains of a scene as tables: how they turn with each other and where they lie."""

from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray

from tol3d.gearing.model import Model, Train
from tol3d.gearing.model.links import LoadPath, Parallel, links_of
from tol3d.gearing.model.trains import gravity_torque
from tol3d.gears import LEFT
from tol3d.report.number import NOTHING
from tol3d.report.page import Heading, Line, PageItem, Row, Table, line, title

Array = NDArray[np.float64]


def train_blocks(model: Model) -> list[PageItem]:
    """What a scene says of shafts, where any of them carries or drives more than one gear; else nothing."""
    if len(model.layout.links) == len(model.layout.drives) and not model.trains:
        return []
    words = [Heading(word, words=True) for word in ("driven by", "carries", "axis through [mm]", "along")]
    table = Table("", [*words, Heading("turns")], list(_shaft_rows(model)))
    note = line(" turns per turn of the first shaft; below 0: they turn opposite, each about its own axis", "dim")
    return [title("shafts"), table, note, *(_train_line(model, train) for train in model.trains)]


def _shaft_rows(model: Model) -> Iterator[Row]:
    layout = model.layout
    for shaft, turning in layout.shaft_turn.items():
        pose = layout.world_from_shaft[shaft]
        link = layout.driving.get(shaft)
        carried = [gear for gear, (carrier, _) in layout.carrying.items() if carrier == shaft and gear != shaft]
        cells = (
            link.name if link else NOTHING,
            ", ".join(carried) or NOTHING,
            _vector_text(pose[:3, 3], 2),
            _vector_text(pose[:3, 2], 3),
            str(turning.rate),
        )
        yield Row(shaft, cells)


def _train_line(model: Model, train: Train) -> Line:
    layout = model.layout
    path = layout.load_path(train.driven, train.output)
    ratio = layout.ratio(train.driven, train.output)
    sense = "opposite" if ratio < 0 else "alike"
    pieces = [(f"\n{train.name}: ", "bold"), (" → ".join(dict.fromkeys(_path(train.driven, path))), "")]
    pieces.append((f" · i = {abs(float(ratio)):.6g}, they turn {sense} · {train.held} held", ""))
    on_the_path = {link.name for link in links_of(path)}
    meshes = [mesh for mesh in model.meshes if mesh.name in on_the_path]
    flanks = ", ".join(f"{mesh.name} {'left' if mesh.working_flank == LEFT else 'right'}" for mesh in meshes)
    pieces.append((f"\n working flanks of the drivers{_load(model, train)}: {flanks or NOTHING}", "dim"))
    for link in (link for link in model.links if link.remark and link.name in on_the_path):
        pieces.append((f"\n {link.name}: {link.remark}", "dim"))
    return Line(tuple(pieces))


def _load(model: Model, train: Train) -> str:
    torque = gravity_torque(train, model.layout, model.arms, 0.0)
    return " at 0° of the output under gravity" if torque else ""


def _path(first: str, path: LoadPath) -> Iterator[str]:
    yield first
    at = first
    for element in path:
        if isinstance(element, Parallel):
            yield f"({element.name})"
        if at not in (element.driver, element.driven):  # a carrier: its path has ended, that of what it carries begins
            at = element.driver
            yield at
        at = element.driven if at == element.driver else element.driver
        yield at


def _vector_text(vector: Array, digits: int) -> str:
    """Coordinates, without a sign of what is 0 in print.

    >>> _vector_text(np.array([172.5, -1e-17, 1.0]), 2)
    '172.5, 0, 1'
    """
    return ", ".join(f"{round(float(value), digits) + 0.0:g}" for value in vector)
