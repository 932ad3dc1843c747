"""A REXS text as it stands: components with attributes, and relations between them.

Attributes are found under the names of all versions, with their units: a length is mm, an angle rad, whatever the file
writes.
"""

import math
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from decimal import Decimal
from typing import Final, Literal, ParamSpec, TypeVar

from tol3d.cad.step import shown
from tol3d.errors import InputError

VERSIONS: Final = ("1.", "2.0")
LENGTHS: Final = {"mm": 1.0, "mum": 1e-3, "um": 1e-3, "µm": 1e-3, "μm": 1e-3, "m": 1e3}  # in mm
ANGLES: Final = {"deg": math.pi / 180.0, "°": math.pi / 180.0, "rad": 1.0}  # in rad
NUMBERS: Final = {"none": 1.0, "": 1.0, "-": 1.0}
UNITS: Final[Mapping[str, Mapping[str, float]]] = {"length": LENGTHS, "angle": ANGLES, "number": NUMBERS}
Kind = Literal["length", "angle", "number"]
T = TypeVar("T")
P = ParamSpec("P")

OTHER_NAMES: Final[Mapping[str, tuple[str, ...]]] = {
    "tooth_thickness_deviation_tolerance_series_din_3967_1978": ("din_3967_deviation_tolerance_series",),
    "center_distance_tolerance_field_din_3964_1980": ("din_3964_center_distance_tolerance_field",),
    "global_tolerance_class_iso_1328_2013": ("tolerance_class_according_to_iso_1328_2013",),
    "minimum_radial_bearing_clearance": ("minimum_bearing_clearance",),
    "maximum_radial_bearing_clearance": ("maximum_bearing_clearance",),
    "radial_clearance_class": ("clearance_class",),
}
"""Names of attributes in other versions of the format."""

OTHER_TYPES: Final = {
    "flank_geometry": "cylindrical_gear_flank",
    "stage_gear_data": "cylindrical_stage_gear_data",
    "fixed_coupling": "coupling",
    "slide_bearing": "hydrodynamic_radial_plain_bearing",
}
"""Types of components in other versions, with the newest name of each."""

MOST_COMPONENTS: Final = 50_000  # of a gearbox that a scene can be of; and as many relations twice
SPOILT: Final = "false"
MOST_SHOWN: Final = 6  # components of a ring of references


class RexsError(InputError):
    """A REXS file is damaged, too large, or states what no gearbox is; exit code 2."""


class SpoiltError(RexsError):
    """A value is lost: some programs write `false` for every text and array."""


@dataclass(frozen=True)
class Attribute:
    """An attribute as it is written.

    Args:
        unit: as written; "" for none.
        values: one text, or those of an array.
        is_array: True of an array, also of one number.
    """

    unit: str
    values: tuple[str, ...]
    is_array: bool = False


@dataclass(frozen=True)
class Component:
    """A component: a shaft, a gear, a stage.

    Args:
        id: unique in the file.
        type: by its newest name.
        name: free text; "" for none.
        attributes: by the name that the file gives them.
    """

    id: int
    type: str
    name: str
    attributes: Mapping[str, Attribute]

    def __str__(self) -> str:
        """Words for messages: `cylindrical_gear 5 'pinion'`."""
        return f"{self.type} {self.id}" + (f" {shown(self.name)!r}" if self.name else "")

    def attribute(self, name: str) -> tuple[str, Attribute] | None:
        """An attribute under the name of any version, with that name.

        Raises:
            RexsError: the file has it under two names, with two values.
        """
        found = [(own, self.attributes[own]) for own in (name, *OTHER_NAMES.get(name, ())) if own in self.attributes]
        if len(found) > 1 and found[0][1].values != found[1][1].values:
            raise RexsError(f"{self}: expected one value, got two of {found[0][0]} and its old name {found[1][0]}")
        return found[0] if found else None

    def text(self, name: str) -> str | None:
        """A word, such as `cd25`; None without one.

        Raises:
            RexsError: it is spoilt: some programs write `false` for every text and array.
        """
        found = self.attribute(name)
        if found is None or found[1].values in ((), ("",)):
            return None
        return self._unspoilt(*found)

    def flag(self, name: str) -> bool | None:
        """True or false; None where the file does not say it."""
        found = self.attribute(name)
        return None if found is None or not found[1].values else found[1].values[0].strip().lower() in ("true", "1")

    def number(self, name: str, kind: Kind = "number") -> float | None:
        """A number, a length in mm or an angle in rad; None without one.

        Raises:
            RexsError: it is no finite number, or of another unit.
        """
        written = self.text(name)
        if written is None:
            return None
        known, attribute = self.attribute(name) or (name, Attribute("", ()))
        return self._finite(known, written) * self._factor(known, attribute.unit, kind)

    def last_digit(self, name: str, kind: Kind = "number") -> float:
        """A one in the last decimal of a number as it is written [mm, rad, 1]; 0 without decimals, or without it."""
        found = self.attribute(name)
        try:
            exponent = Decimal(found[1].values[0].strip()).as_tuple().exponent if found else 0
        except (ArithmeticError, IndexError):
            return 0.0
        if found is None or not isinstance(exponent, int) or exponent >= 0:
            return 0.0
        return 10.0**exponent * self._factor(found[0], found[1].unit, kind)

    def whole(self, name: str) -> int | None:
        """A whole number; None without one.

        Raises:
            RexsError: it is none.
        """
        value = self.number(name)
        if value is not None and value != round(value):
            raise RexsError(f"{self}: {name}: expected a whole number, got {value:g}")
        return None if value is None else int(value)

    def needed(self, name: str, kind: Kind = "number") -> float:
        """A number without which there is no gearbox.

        Raises:
            RexsError: it is missing, or as `number` raises.
        """
        value = self.number(name, kind)
        if value is None:
            raise RexsError(f"{self}: expected {name}, got none")
        return value

    def vector(self, name: str, kind: Kind = "length") -> tuple[float, float, float] | None:
        """Three numbers; None without them.

        Raises:
            RexsError: there are others, or as `number` raises.
        """
        found = self.attribute(name)
        if found is None:
            return None
        known, attribute = found
        if len(attribute.values) != 3:
            if not attribute.is_array:
                self._unspoilt(known, attribute)
            raise RexsError(f"{self}: {known}: expected 3 numbers, got {len(attribute.values)}")
        factor = self._factor(known, attribute.unit, kind)
        x, y, z = (self._finite(known, each) * factor for each in attribute.values)
        return x, y, z

    def _unspoilt(self, known: str, attribute: Attribute) -> str:
        written = attribute.values[0].strip() if len(attribute.values) == 1 else ""
        if written.lower() == SPOILT:
            raise SpoiltError(f"{self}: {known}: expected a value, got {SPOILT!r}; the program that wrote it lost it")
        if attribute.is_array or not written:
            raise RexsError(f"{self}: {known}: expected one value, got {len(attribute.values)}")
        return written

    def _finite(self, known: str, written: str) -> float:
        try:
            value = float(written)
        except ValueError:
            value = math.nan
        if not abs(value) < 1e9:  # mm or rad or pieces; no gearbox has more
            raise RexsError(f"{self}: {known}: expected a number, got {shown(written)!r}")
        return value

    def _factor(self, known: str, unit: str, kind: Kind) -> float:
        factors = UNITS[kind]
        if unit not in factors:
            units = ", ".join(repr(each) for each in factors)
            raise RexsError(f"{self}: {known}: expected the unit {units}, got {shown(unit)!r}")
        return factors[unit]


@dataclass(frozen=True)
class Relation:
    """A relation: roles and the components that play them, in the order of the file.

    Args:
        id: as written.
        type: such as `assembly`.
        refs: role and component.
    """

    id: int
    type: str
    refs: Sequence[tuple[str, int]]

    def one(self, role: str) -> int:
        """The component in a role.

        Raises:
            RexsError: there is none, or several.
        """
        found = [component for own, component in self.refs if own == role]
        if len(found) != 1:
            raise RexsError(f"{self.type} relation {self.id}: expected one ref with role {role!r}, got {len(found)}")
        return found[0]


@dataclass(frozen=True)
class Document:
    """A REXS text.

    Args:
        version: of the format.
        components: by id, in the order of the file.
        relations: in that order.
    """

    version: str
    components: Mapping[int, Component]
    relations: Sequence[Relation]
    of_type: Mapping[str, Sequence[Relation]] = field(init=False)

    def __post_init__(self) -> None:
        """Refuse what no file should have.

        Raises:
            RexsError: a version that is not known, a reference to nothing, or parts in a ring.
        """
        if not self.version.startswith(VERSIONS):
            raise RexsError(f"expected REXS 1.0 to 2.0, got version {shown(self.version)!r}")
        if len(self.components) > MOST_COMPONENTS or len(self.relations) > 2 * MOST_COMPONENTS:
            counts = f"{len(self.components)} and {len(self.relations)}"
            raise RexsError(f"expected at most {MOST_COMPONENTS} components and twice as many relations, got {counts}")
        by_type: dict[str, list[Relation]] = {}
        for relation in self.relations:
            by_type.setdefault(relation.type, []).append(relation)
            for role, component in relation.refs:
                if component not in self.components:
                    raise RexsError(
                        f"{shown(relation.type)} relation {relation.id}: {shown(role)}: expected a component of the "
                        f"file, got the id {component}, which it does not have"
                    )
        object.__setattr__(self, "of_type", by_type)
        parts: dict[int, list[int]] = {}
        for relation in by_type.get("assembly", ()):
            parts.setdefault(relation.one("assembly"), []).append(relation.one("part"))
        self._refuse_ring(parts, "be no part of itself")

    def _refuse_ring(self, uses: Mapping[int, Sequence[int]], expected: str) -> None:
        ring = ring_of(uses)
        if ring:
            told = " → ".join(str(each) for each in (*ring[:MOST_SHOWN], ring[0]))
            raise RexsError(f"{self.components[ring[0]]}: expected it to {expected}, got the ring {told}")

    def all_of(self, *types: str) -> Iterator[Component]:
        """Components of some types."""
        return (component for component in self.components.values() if component.type in types)


def ring_of(uses: Mapping[int, Sequence[int]]) -> list[int]:
    """The first ring of references, empty if there is none.

    >>> ring_of({1: [2], 2: [3], 3: [2]}), ring_of({1: [2, 3], 2: [3]})
    ([2, 3], [])
    """
    done: set[int] = set()
    for root in uses:
        path: dict[int, Iterator[int]] = {} if root in done else {root: iter(uses[root])}
        while path:
            last = next(reversed(path))
            following = next((each for each in path[last] if each not in done), None)
            if following is None:
                done.add(last)
                del path[last]
            elif following in path:
                names = list(path)
                return names[names.index(following) :]
            else:
                path[following] = iter(uses.get(following, ()))
    return []


@dataclass
class LeftOut:
    """Lines on what is not read, in the order in which it was met."""

    lines: list[str] = field(default_factory=list)

    def spared(self, read: Callable[P, T | None], *words: P.args, **named: P.kwargs) -> T | None:
        """A value that a gearbox does not need; None if it cannot be read, which is listed."""
        try:
            return read(*words, **named)
        except RexsError as error:
            if str(error) not in self.lines:
                self.lines.append(str(error))
            return None
