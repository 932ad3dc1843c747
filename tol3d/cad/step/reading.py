"""Foreign STEP files read: the text here, the geometry in a process of its own, the findings kept in the cache.

Nothing of a foreign file is ever a shape in this process. The other one has limits of time and memory; if it dies,
hangs or reads other faces than the text has, that is an error of the file, in one line.
"""

import hashlib
import io
import json
import os
import re
import signal
import subprocess
import sys
import tempfile
import warnings
import zipfile
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path
from typing import Any, Final

import numpy as np
from pydantic import TypeAdapter, ValidationError

from tol3d.cad.solids.cache import CacheWarning
from tol3d.cad.solids.lazy import Arrays
from tol3d.cad.step.bodies import Body, bodies_of, colours_of, layers_of, names_of
from tol3d.cad.step.face_mesh import FaceMesh
from tol3d.cad.step.faces import Face, Faces
from tol3d.cad.step.found_features import FoundFeature, Shell, Triple, cosines_of, lengths_of, shell_of
from tol3d.cad.step.machined import Machined
from tol3d.cad.step.outline import Named, named_in, read_step_text
from tol3d.cad.step.part21 import Part21, read_part21
from tol3d.cad.step.refused import StepError, shown
from tol3d.cad.step.structure import UNNAMED, Leaf
from tol3d.errors import InputError
from tol3d.files import FileContent, UnreadableFileError, read_contained
from tol3d.numerics.cache_folder import FOLDER_VARIABLE, cache_folder, read_entry, write_entry
from tol3d.numerics.sources import sources_of
from tol3d.scene.nearest import hint

SECONDS_VARIABLE: Final = "TOL3D_STEP_SECONDS"
SECONDS: Final = 120.0
"""s; default limit of computing time, twice that of the clock, for reading a file."""
MEGABYTES_VARIABLE: Final = "TOL3D_STEP_MEGABYTES"
MEGABYTES: Final = 8_000.0
"""Address space in which it must be; Open CASCADE alone takes 1 to 2 GB of it."""
DEFLECTION: Final = 0.05
"""mm; largest distance of the pictures' triangles from the faces; see tol3d.assembly.presenting."""
LARGEST_ANSWER: Final = 2_000_000_000
"""Largest output of the other process [bytes]."""
WORKER: Final = "tol3d.cad.step.worker"
PROGRAM: Final = f"from {WORKER} import main; main()"
THREAD: Final = re.compile(r"(?<![A-Za-z0-9])M[1-9][0-9]?(?:\.[0-9])?(?: ?[x×X*] ?[0-9]+(?:\.[0-9]+)?)?(?![A-Za-z0-9])")
"""Metric threads of ISO 261 in a name, such as M6 or M8x1.25."""
SAME: Final = 1e-6
"""mm, and fraction of the number; allowed difference of a face by Open CASCADE from the text."""


@dataclass(frozen=True)
class ReadPart:
    """A product with the features found on its faces, as it is kept.

    Args:
        body: the product.
        features: found on its faces, with names and colours.
        names: of its faces in the file, by their numbers.
        named: items that its drawing names on its faces: datums, tolerances, dimensions.
        colours: "#RRGGBB" of its faces that have one, by their numbers.
        unread: its faces that cannot be read, by their numbers, and why.
    """

    body: Body
    features: tuple[FoundFeature, ...]
    names: Mapping[int, str]
    named: tuple[Named, ...]
    colours: Mapping[int, str]
    unread: Mapping[int, str]


@dataclass(frozen=True)
class Use:
    """A part as it stands in a file.

    Args:
        path: names from the top assembly down, with / between them.
        product: the `#id` of its product definition.
        placed: its pose in the file's world, rows of a 4 by 4 matrix [mm].
    """

    path: str
    product: int
    placed: tuple[tuple[float, float, float, float], ...]

    @property
    def frame(self) -> tuple[Triple, Triple, Triple]:
        """Origin [mm], z axis and x axis in the file's world, without rounding noise."""
        (x, z, at) = ([row[k] for row in self.placed[:3]] for k in (0, 2, 3))
        return lengths_of(at), cosines_of(z), cosines_of(x)


@dataclass(frozen=True)
class PartElsewhere:
    """A part whose shape stands in another file.

    Args:
        use: here.
        file: as this file states it.
        name: of the product here; "" if this file says none.
    """

    use: Use
    file: str
    name: str


@dataclass(frozen=True)
class ReadFile:
    """A file as it is kept: its products with geometry, where each is used, and its layers, which are ignored.

    Beside them its parts that stand in other files, of which nothing is read here.
    """

    parts: tuple[ReadPart, ...]
    uses: tuple[Use, ...]
    layers: tuple[str, ...]
    elsewhere: tuple[PartElsewhere, ...] = ()

    @property
    def solids(self) -> "Solids":
        """Every solid by its number, with the numbers of its faces."""
        return _solids([part.body for part in self.parts])


Solids = Sequence[tuple[int, Sequence[int]]]
READ: Final = TypeAdapter(ReadFile)


@dataclass(frozen=True)
class StepPart(ReadPart):
    """A product of a file with its geometry, in its own frame; `file` is the file as it was read."""

    file: "StepFile"

    @property
    def name(self) -> str:
        """Name of the product in the file, or that of the file, numbered, where that says none."""
        if self.body.name != UNNAMED:
            return self.body.name
        unnamed = [part.body.product for part in self.file.read.parts if part.body.name == UNNAMED]
        stem = self.file.content.path.stem
        return stem if len(unnamed) == 1 else f"{stem} {unnamed.index(self.body.product) + 1}"

    @cached_property
    def shell(self) -> Shell:
        """Its faces as numbers."""
        return _shell(self.body, self.file.faces)

    @property
    def threads(self) -> tuple[str, ...]:
        """Threads that its name, or those of its tolerances and dimensions, state; its faces are plain cylinders."""
        texts = [self.body.name, *(own.name for own in self.named if own.what != "datum")]
        return tuple(dict.fromkeys(each for text in texts for each in THREAD.findall(text)))

    @cached_property
    def machined(self) -> Machined:
        """Its features that several surfaces make."""
        return Machined(self.features, lambda own, direction: self.shell.along(own.faces, direction))

    def mesh(self, deflection: float = DEFLECTION) -> FaceMesh:
        """Its solids as triangles, with the loose faces beside them; without faces that cannot be triangulated.

        Raises:
            StepError: they cannot be made.
        """
        return _mesh(self.file.content, deflection, self.file.read.solids).of_faces(self.body.faces | self.body.loose)

    @cached_property
    def bare(self) -> frozenset[int]:
        """Its faces without triangles; all of them where Open CASCADE does not live to make any."""
        try:
            return self.mesh().bare
        except StepError:
            return self.body.faces

    def point_on(self, faces: Sequence[int]) -> Triple:
        """A point of some of its faces."""
        return _point_on(faces, self.file.faces, self.mesh())


@dataclass(frozen=True)
class StepFile:
    """A file that was read.

    Args:
        content: its bytes.
        read: its products with geometry, and their uses.
    """

    content: FileContent
    read: ReadFile

    @property
    def name(self) -> str:
        """Name of the file, for messages."""
        return self.content.path.name

    @cached_property
    def text(self) -> Part21:
        """Its text, by the gate."""
        return read_part21(self.content.content, self.name)

    @cached_property
    def faces(self) -> Faces:
        """Faces of the file, read by Open CASCADE."""
        return _geometry(self.content, [part.body for part in self.read.parts])[0]

    @cached_property
    def parts(self) -> tuple[StepPart, ...]:
        """Its products with geometry of their own, in the order of the file."""
        return tuple(StepPart(**vars(part), file=self) for part in self.read.parts)

    def part(self, product: str | None, use: str | None = None) -> StepPart:
        """The product of that name, or that a use has; the only one by default.

        Raises:
            StepError: there is no such product or use, or several.
        """
        if use is not None:
            number = self.use(use).product
            return next(part for part in self.parts if part.body.product == number)
        names = [part.name for part in self.parts]
        fitting = self.parts if product is None else [part for part in self.parts if part.name == product]
        if len(fitting) == 1:
            return fitting[0]
        listed = _listed(names)
        if product is None:
            raise StepError(f"expected a product, for {self.name} has {len(names)}: {listed}; write `product:`")
        got = f"{len(fitting)} of that name" if fitting else "none of that name"
        raise StepError(f"expected a product of {self.name}, got {product!r}, {got}; it has {listed}")

    @property
    def uses(self) -> tuple[Use, ...]:
        """Placed parts with geometry, in the file's order."""
        return self.read.uses

    @property
    def elsewhere(self) -> tuple[PartElsewhere, ...]:
        """Placed parts whose shapes stand in other files."""
        return self.read.elsewhere

    @property
    def layers(self) -> tuple[str, ...]:
        """Names of its layers, which nothing here heeds."""
        return self.read.layers

    def use(self, path: str) -> Use:
        """A part as it stands in the file.

        Raises:
            StepError: there is none.
        """
        found = next((use for use in self.uses if use.path == path), None)
        if (other := next((own.file for own in self.read.elsewhere if own.use.path == path), None)) is not None:
            raise StepError(
                f"expected a use whose shape is in {self.name}, got {path!r}, which stands in {shown(other)!r}"
            )
        if found is None:
            known = [use.path for use in self.uses]
            near = hint(path, known)
            raise StepError(
                f"expected a use in {self.name}, got {path!r}, which is none{near}; it has {_listed(known)}"
            )
        return found


def _listed(names: Sequence[str]) -> str:
    return ", ".join(repr(shown(name)) for name in names[:8]) + (", …" if len(names) > 8 else "")


def read_step(content: FileContent) -> StepFile:
    """Read a foreign file: its text, then its faces in a process of its own, unless that was done before.

    Raises:
        StepError: it is damaged, too large, refers to other files, or cannot be read within the limits; in one line.
    """

    def make() -> Arrays:
        text = read_step_text(content.content, content.path.name)
        structure = text.structure
        elsewhere = tuple(
            PartElsewhere(_used(leaf), structure.elsewhere[leaf.product], "" if name == UNNAMED else name)
            for leaf in structure.leaves_elsewhere
            for name in [structure.products[leaf.product].name]
        )
        if elsewhere and not structure.leaves:
            return _kept(ReadFile((), (), layers_of(text.file), elsewhere))
        bodies = bodies_of(text.file, structure)
        faces, mesh = _geometry(content, bodies, text.file)
        named = tuple(named_in(text))
        parts = tuple(_read_part(text.file, body, faces, mesh, named) for body in bodies)
        own = {body.product for body in bodies}
        uses = tuple(_used(leaf) for leaf in structure.leaves if leaf.product in own)
        return _kept(ReadFile(parts, uses, layers_of(text.file), elsewhere))

    sources = sources_of(__name__)
    arrays = _cached(f"step-read-{_key(content, {'sources': sources})}.npz", make)
    try:
        return StepFile(content, READ.validate_json(arrays["read"].tobytes()))
    except (KeyError, ValidationError):
        raise StepError(f"{cache_folder()}: a cache entry was changed; delete the folder") from None


def _used(leaf: Leaf) -> Use:
    return Use("/".join(leaf.path), leaf.product, leaf.placement)


def _kept(found: ReadFile) -> Arrays:
    return {"read": np.frombuffer(READ.dump_json(found), dtype=np.uint8)}


def _read_part(text: Part21, body: Body, faces: Faces, mesh: FaceMesh | None, named: Sequence[Named]) -> ReadPart:
    own = body.faces | body.loose
    names, colours = names_of(text, own), colours_of(text, body)
    unread = {number: why for number, why in faces.unread if number in own}
    found = (
        *(replace(each, on=_point_on(each.faces, faces, mesh)) for each in _shell(body, faces).features),
        *(_unread(number, loose=number in body.loose) for number in sorted(unread)),
    )
    features = tuple(_described(each, names, colours) for each in found)
    return ReadPart(body, features, names, tuple(each for each in named if own & {*each.faces}), colours, unread)


def _unread(face: int, *, loose: bool) -> FoundFeature:
    """A face that cannot be read, as a feature of which nothing is known."""
    return FoundFeature((face,), "unread", (0.0, 0.0, 0.0), (0.0, 0.0, 1.0), (1.0, 0.0, 0.0), loose=loose)


def _point_on(ids: Sequence[int], faces: Faces, mesh: FaceMesh | None) -> Triple:
    """A point of some faces: of their triangles, or of the surface of the first where they have none."""
    found = None if mesh is None else mesh.middle(ids)
    return lengths_of(faces.by_id[ids[0]].place) if found is None else found


def _solids(bodies: Sequence[Body]) -> Solids:
    return [(number, own) for body in bodies for number, own in body.solids.items()]


def _described(feature: FoundFeature, names: Mapping[int, str], colours: Mapping[int, str]) -> FoundFeature:
    """A feature with the names and the colour that the file gives its faces."""
    ids = (*feature.faces, *feature.repeated)
    found = {colours.get(face, "") for face in feature.faces}
    colour = found.pop() if len(found) == 1 else ""
    return replace(feature, names=tuple(dict.fromkeys(names[own] for own in ids if own in names)), colour=colour)


def _shell(body: Body, faces: Faces) -> Shell:
    wanted = body.faces | body.loose
    return shell_of(faces, [root.id for root in faces.roots if any(face.id in wanted for face in root.faces)])


def _geometry(
    content: FileContent, bodies: Sequence[Body], text: Part21 | None = None
) -> tuple[Faces, FaceMesh | None]:
    """Faces of a file, read by Open CASCADE and checked against its text, and their triangles for pictures.

    The triangles are None where Open CASCADE does not live to make them.
    """
    made: dict[str, Arrays] = {}

    def make() -> Arrays:
        own = text or read_part21(content.content, content.path.name)
        order = {"with_faces": True, "ids": list(own.spans), "solids": _solids(bodies), "deflection": DEFLECTION}
        answer, made["mesh"] = _asked(content, order)
        return {"faces": np.frombuffer(_checked(answer, own, bodies).model_dump_json().encode(), dtype=np.uint8)}

    arrays = _cached(f"step-faces-{_key(content, {})}.npz", make)
    faces = Faces.model_validate_json(arrays["faces"].tobytes())
    try:
        return faces, _mesh(content, DEFLECTION, _solids(bodies), made.get("mesh"))
    except StepError:
        return faces, None


def _mesh(content: FileContent, deflection: float, solids: Solids, made: Arrays | None = None) -> FaceMesh:
    """Triangles of all solids and shells of a file.

    Args:
        content: the file.
        deflection: largest distance from the faces [mm].
        solids: each with its faces.
        made: existing ones; empty where they could not be made.
    """

    def make() -> Arrays:
        if made is not None:
            return _meshed(made, content)
        text = read_part21(content.content, content.path.name)
        order = {"with_faces": False, "deflection": deflection, "ids": list(text.spans), "solids": solids}
        return _meshed(_asked(content, order)[1], content)

    arrays = _cached(f"step-mesh-{_key(content, {'deflection': deflection})}.npz", make)
    try:
        return FaceMesh.of(arrays)
    except (KeyError, TypeError, ValueError):
        raise StepError(f"{content.path.name}: its triangles cannot be made") from None


def _meshed(arrays: Arrays, content: FileContent) -> Arrays:
    """Triangles, if there are any arrays of them.

    Raises:
        StepError: there are none: nothing is kept.
    """
    if "nodes" not in arrays:
        raise StepError(f"{content.path.name}: its triangles cannot be made")
    return arrays


def _checked(answer: Any, text: Part21, bodies: Sequence[Body]) -> Faces:
    """Faces from the other process, if they match the text; those that it does not read are `unread`.

    Raises:
        StepError: it is no answer, it has other faces, or none of a solid.
    """
    try:
        unread = _without_bad_faces(answer)
        found = Faces.model_validate_json(json.dumps(answer))
    except ValidationError as error:
        first = error.errors(include_url=False)[0]
        place = ".".join(map(str, first["loc"]))
        raise StepError(f"{text.name}: Open CASCADE reads numbers that no part has ({place}: {first['msg']})") from None
    of_solids = {face.id for root in found.roots if root.solid for face in root.faces}
    wanted = {face for body in bodies for face in body.faces}
    if not of_solids & wanted:
        words = f"Open CASCADE reads 0 of {len(wanted)} faces"
        raise StepError(f"{text.place(min(wanted))}: {words}; mend the solid in the CAD system and export it again")
    if stray := sorted(of_solids - wanted):
        raise StepError(f"{text.place(stray[0])}: the solid of this face belongs to no product")
    by_id = found.by_id
    for body in bodies:
        for number in sorted(body.faces & of_solids):
            _check_surface(text, by_id[number], body.unit)
    told = dict([*((face, "Open CASCADE makes no face of it") for face in wanted - of_solids), *found.unread, *unread])
    return found.model_copy(update={"unread": tuple(sorted(told.items()))})


def _without_bad_faces(answer: Any) -> list[tuple[int, str]]:
    """Take faces of impossible numbers out of an answer; their numbers in the file, and why."""
    bad: list[tuple[int, str]] = []
    roots = answer.get("roots") if isinstance(answer, dict) else None
    for root in roots if isinstance(roots, list) else ():
        if not isinstance(root, dict) or not isinstance(root.get("faces"), list):
            continue  # refused with the whole answer
        kept = []
        for face in root["faces"]:
            try:
                kept.append(Face.model_validate_json(json.dumps(face)).model_dump())
            except ValidationError as error:
                first = error.errors(include_url=False)[0]
                if not isinstance(face, dict) or not isinstance(face.get("id"), int):
                    raise
                place = ".".join(map(str, first["loc"]))
                bad.append((face["id"], f"Open CASCADE reads numbers that no face has ({place}: {first['msg']})"))
        root["faces"] = kept
    return bad


def _check_surface(text: Part21, face: Face, unit: float) -> None:
    """Refuse a plane, cylinder or sphere that differs from the text: a wrong join, or a wrong unit.

    Raises:
        StepError: it does.
    """
    surface = text[text[face.id].needed("ADVANCED_FACE", "FACE_SURFACE").reference(2)]
    record = surface.record("PLANE", "CYLINDRICAL_SURFACE", "SPHERICAL_SURFACE")
    if record is None:
        return
    placement = text[record.reference(1)].needed("AXIS2_PLACEMENT_3D")
    point = text[placement.reference(1)].needed("CARTESIAN_POINT").numbers(1)
    stated = [unit * own for own in point] + ([] if record.keyword == "PLANE" else [unit * record.number(2)])
    found = [*face.at] + ([] if record.keyword == "PLANE" else [face.radius])
    if len(stated) != len(found) or any(abs(a - b) > SAME * (1 + abs(a)) for a, b in zip(stated, found, strict=True)):
        said = ", ".join(f"{own:.6g}" for own in stated)
        got = ", ".join(f"{own:.6g}" for own in found)
        raise StepError(f"{text.place(face.id)}: expected its surface at {said} mm as the text has it, got {got}")


# the process ---------------------------------------------------------------------------------------------


def _asked(content: FileContent, order: Mapping[str, Any]) -> tuple[Any, Arrays]:
    """Answer of a process of its own about a file, and the arrays that it writes.

    Raises:
        StepError: it refuses, dies, takes too long or too much memory.
    """
    seconds, megabytes = (
        _limit(SECONDS_VARIABLE, SECONDS, "seconds"),
        _limit(MEGABYTES_VARIABLE, MEGABYTES, "megabytes"),
    )
    with tempfile.TemporaryDirectory(prefix="tol3d-step-") as name:
        folder = Path(name)  # mode 700
        (folder / "file.stp").write_bytes(content.content)
        whole = {**order, "seconds": seconds, "megabytes": int(megabytes)}
        (folder / "order.json").write_text(json.dumps(whole), "utf-8")
        command = [sys.executable, "-P", "-c", PROGRAM, str(folder)]  # -P: nothing is imported from where it is called
        longer = f"{SECONDS_VARIABLE}={10 * seconds:g} would give it longer"
        try:
            done = subprocess.run(
                command, stdin=subprocess.DEVNULL, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE,
                timeout=2 * seconds, check=False, cwd=folder, env=_environment(),
            )  # fmt: skip
        except subprocess.TimeoutExpired:
            why = f"Open CASCADE does not read it within {2 * seconds:g} s; {longer}"
        else:
            why = "" if done.returncode == 0 else _ended(done.returncode, done.stderr, longer)
        answer = _answer(folder / "answer.json")
        if answer is None or (why and not order["with_faces"]):  # faces are written before triangles are tried
            raise StepError(f"{content.path.name}: {why or _ended(0, b'', longer)}")
        if isinstance(answer, dict) and "refused" in answer:
            raise StepError(
                f"{content.path.name}: {answer['refused']}; mend the file in the CAD system and export it again"
            )
        return answer, _arrays(folder / "mesh.npz")


def _environment() -> dict[str, str]:
    """Environment of this process; the other one has one thread, so that its limit of memory is not spent on stacks."""
    paths = os.pathsep.join(path for path in sys.path if path)
    return {**os.environ, "PYTHONPATH": paths, "OMP_NUM_THREADS": "1", "OPENBLAS_NUM_THREADS": "1"}


def _limit(variable: str, usual: float, words: str) -> float:
    text = os.environ.get(variable) or f"{usual:g}"
    try:
        limit = float(text)
    except ValueError:
        limit = 0.0
    if not 0.0 < limit < 1e8:
        raise InputError(f"{variable}: expected a number of {words}, such as {usual:g}, got {text!r}")
    return limit


def _answer(path: Path) -> Any:
    """Answer of the process; None where there is none."""
    try:
        return json.loads(read_contained(path, path.parent, LARGEST_ANSWER))
    except (UnreadableFileError, ValueError, RecursionError):
        return None


def _arrays(path: Path) -> Arrays:
    """Arrays that it wrote; empty if there are none, or they are too large unpacked."""
    try:
        stream = io.BytesIO(read_contained(path, path.parent, LARGEST_ANSWER))
        with zipfile.ZipFile(stream) as archive:
            if sum(own.file_size for own in archive.infolist()) > LARGEST_ANSWER:
                return {}
        with np.load(stream, allow_pickle=False) as entries:
            return {name: entries[name] for name in entries.files}
    except (UnreadableFileError, OSError, ValueError, EOFError, zipfile.BadZipFile):
        return {}


def _ended(code: int, said: bytes, longer: str) -> str:
    """The end of the process in words, with the remedy."""
    last = (said.decode(errors="replace").strip().splitlines() or [""])[-1]
    if code in (-signal.SIGXCPU if hasattr(signal, "SIGXCPU") else 1, -getattr(signal, "SIGKILL", 9)):
        return f"Open CASCADE does not read it within its limits; {longer}"
    if "MemoryError" in last or "bad_alloc" in last or "Standard_OutOfMemory" in last:
        return f"Open CASCADE needs too much memory; {MEGABYTES_VARIABLE}={2 * MEGABYTES:g} would give it more"
    if code < 0:
        name = signal.Signals(-code).name if -code in set(signal.Signals) else f"signal {-code}"
        return f"Open CASCADE crashes on it ({name}); mend it in the CAD system and export it again"
    why = " ".join("".join(sign if sign.isprintable() else " " for sign in last).split())[:200]
    return f"Open CASCADE fails on it ({why or f'exit code {code}'}); mend it in the CAD system and export it again"


# the cache -----------------------------------------------------------------------------------------------


def _key(content: FileContent, settings: Mapping[str, Any]) -> str:
    made_of = {"file": content.sha256, "settings": dict(settings), "sources": sources_of(WORKER), "ocp": _versions()}
    return hashlib.sha256(json.dumps(made_of, sort_keys=True).encode()).hexdigest()


def _versions() -> dict[str, str]:
    found = {}
    for package in ("cadquery-ocp", "numpy"):
        try:
            found[package] = version(package)
        except PackageNotFoundError:  # conda installs OCP without naming it so
            found[package] = ""
    return found


def _cached(name: str, make: Any) -> Arrays:
    """Arrays from the cache, or made and kept; a cache that cannot be written causes a warning."""
    kept = read_entry(name)
    if kept is not None:
        try:
            with np.load(io.BytesIO(kept), allow_pickle=False) as entries:
                return {entry: entries[entry] for entry in entries.files}
        except (ValueError, EOFError, zipfile.BadZipFile):  # whole, but no arrays
            pass
    arrays: Arrays = make()
    buffer = io.BytesIO()
    np.savez_compressed(buffer, allow_pickle=False, **arrays)
    try:
        write_entry(name, buffer.getvalue())
    except OSError as error:
        advice = f"set {FOLDER_VARIABLE} to a folder that can be written"
        warnings.warn(f"{cache_folder()}: cannot cache the read file ({error.strerror}); {advice}", CacheWarning, 3)
    return arrays
