"""REXS texts written by tests: components and relations as XML, JSON or zip."""

import io
import json
import zipfile
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from math import cos, radians
from pathlib import Path
from xml.sax.saxutils import escape, quoteattr

from tol3d.files import FileContent

Value = float | int | str | bool | tuple[float, ...]
Attributes = Mapping[str, tuple[Value, str]]
"""Values with their units, by name."""


@dataclass(frozen=True)
class Rexs:
    """A REXS file: components by id with type, name and attributes, and relations with the components by role."""

    version: str
    components: Mapping[int, tuple[str, str, Attributes]]
    relations: Sequence[tuple[str, Mapping[str, int]]]

    def xml(self) -> bytes:
        relations = "".join(
            f'<relation id="{k}" type={quoteattr(kind)}>'
            + "".join(f'<ref id="{own}" role={quoteattr(role)} hint="x"/>' for role, own in refs.items())
            + "</relation>"
            for k, (kind, refs) in enumerate(self.relations, 1)
        )
        components = "".join(
            f'<component id="{k}" type={quoteattr(kind)} name={quoteattr(name)}>'
            + "".join(
                f'<attribute id="{key}" unit={quoteattr(unit)}>{xml_value(value)}</attribute>'
                for key, (value, unit) in attributes.items()
            )
            + "</component>"
            for k, (kind, name, attributes) in self.components.items()
        )
        return (
            f'<?xml version="1.0" encoding="UTF-8"?><model version="{self.version}" applicationId="a" '
            f'applicationVersion="1" date="2026-01-01T00:00:00+00:00"><relations>{relations}</relations>'
            f"<components>{components}</components></model>"
        ).encode()

    def json(self) -> bytes:
        relations = [
            {"id": k, "type": kind, "refs": [{"id": own, "role": role, "hint": "x"} for role, own in refs.items()]}
            for k, (kind, refs) in enumerate(self.relations, 1)
        ]
        components = [
            {
                "id": k,
                "type": kind,
                "name": name,
                "attributes": [
                    {"id": key, "unit": unit, json_type(value): list(value) if isinstance(value, tuple) else value}
                    for key, (value, unit) in attributes.items()
                ],
            }
            for k, (kind, name, attributes) in self.components.items()
        ]
        model = {"version": self.version, "relations": relations, "components": components}
        return json.dumps({"model": model}).encode()

    def file(self, name: str = "box.rexs") -> FileContent:
        """The file of that name, in the form that its ending says."""
        content = (
            self.json() if name.endswith("j") else zipped({"a.rexs": self.xml()}) if name.endswith("z") else self.xml()
        )
        return FileContent(Path(name), content)

    def having(self, component: int, **attributes: tuple[Value, str] | None) -> "Rexs":
        """The file with other attributes of a component; None leaves one out."""
        kind, name, own = self.components[component]
        merged = {**own, **attributes}
        kept = {key: value for key, value in merged.items() if value is not None}
        return replace(self, components={**self.components, component: (kind, name, kept)})

    def typed(self, component: int, kind: str) -> "Rexs":
        """The file with another type of a component."""
        _, name, own = self.components[component]
        return replace(self, components={**self.components, component: (kind, name, own)})

    def related(self, kind: str, **refs: int) -> "Rexs":
        """The file with one more relation."""
        return replace(self, relations=[*self.relations, (kind, refs)])


def xml_value(value: Value) -> str:
    if isinstance(value, tuple):
        return "<array>" + "".join(f"<c>{own}</c>" for own in value) + "</array>"
    return escape(str(value).lower() if isinstance(value, bool) else str(value))


def json_type(value: Value) -> str:
    match value:
        case bool():
            return "boolean"
        case tuple():
            return "floating_point_array"
        case int():
            return "integer"
        case float():
            return "floating_point"
    return "string"


def zipped(members: Mapping[str, bytes]) -> bytes:
    """A zip of files."""
    stream = io.BytesIO()
    with zipfile.ZipFile(stream, "w", zipfile.ZIP_DEFLATED) as packed:
        for name, content in members.items():
            packed.writestr(name, content)
    return stream.getvalue()


@dataclass
class Writer:
    """Components and relations that are collected; ids count from 1, the gear unit, and 2, its casing."""

    version: str = "1.7"
    components: dict[int, tuple[str, str, Attributes]] = field(
        default_factory=lambda: {1: ("gear_unit", "unit", {}), 2: ("gear_casing", "housing", {})}
    )
    relations: list[tuple[str, Mapping[str, int]]] = field(default_factory=list)

    def add(self, kind: str, name: str = "", /, **attributes: tuple[Value, str]) -> int:
        number = len(self.components) + 1
        self.components[number] = (kind, name, attributes)
        return number

    def relate(self, kind: str, **refs: int) -> None:
        self.relations.append((kind, refs))

    def shaft(self, name: str, at: tuple[float, float, float], towards: float = 1.0) -> int:
        """A shaft along x, with its w along z."""
        number = self.add(
            "shaft",
            name,
            reference_component_for_position=(1, "none"),
            support_vector=(at, "mm"),
            u_axis_vector=((towards, 0.0, 0.0), "mm"),
            w_axis_vector=((0.0, 0.0, 1.0), "mm"),
        )
        self.relate("assembly", assembly=1, part=number)
        return number

    def gear(
        self, name: str, shaft: int, teeth: int, module: float, shift: float | None, *,
        helix: float = 0.0, ring: bool = False, start: float = 20.0, series: str = "", angle: float = 20.0,
    ) -> int:  # fmt: skip
        """A gear on a shaft, 15 mm wide, and its flanks."""
        name_of_series = "tooth_thickness_deviation_tolerance_series_din_3967_1978"
        stated: dict[str, tuple[Value, str]] = {name_of_series: (series, "none")} if series else {}
        number = self.add(
            "ring_gear" if ring else "cylindrical_gear",
            name,
            number_of_teeth=(teeth, "none"),
            normal_module=(module, "mm"),
            helix_angle_reference_diameter=(helix, "deg"),
            face_width=(15.0, "mm"),
            u_coordinate_on_shaft=(start, "mm"),
            **stated,
        )
        self.relate("assembly", assembly=shaft, part=number)
        shifted: dict[str, tuple[Value, str]] = (
            {} if shift is None else {"addendum_modification_coefficient": (shift, "none")}
        )
        kind = "flank_geometry" if self.version < "1.3" else "cylindrical_gear_flank"
        sides = [self.add(kind, normal_pressure_angle=(angle, "deg"), **shifted) for _ in range(2)]
        self.relate("flank", gear=number, left=sides[0], right=sides[1])
        return number

    def stage(self, name: str, first: int, second: int, distance: float, **attributes: tuple[Value, str]) -> int:
        """A mesh."""
        number = self.add("cylindrical_stage", name, center_distance=(distance, "mm"), **attributes)
        self.relate("stage", stage=number, gear_1=first, gear_2=second)
        return number

    def bearing(
        self, name: str, shaft: int, at: float, kind: str = "concept_bearing", **attributes: tuple[Value, str]
    ) -> int:
        """A bearing in the casing."""
        number = self.add(kind, name, u_coordinate_on_shaft_inner_side=(at, "mm"), **attributes)
        self.relate("side", assembly=number, inner_part=shaft, outer_part=2)
        return number

    def rexs(self) -> Rexs:
        """The file."""
        return Rexs(self.version, dict(self.components), list(self.relations))


def pair(version: str = "1.7", *, module: float = 2.0, helix: float = 0.0) -> Rexs:
    """A pair of 23 and 37 teeth, with bearings of the first shaft; gears are 5 and 8, the stage is 11."""
    writer = Writer(version)
    first, second = writer.shaft("in", (0.0, 0.0, 0.0)), writer.shaft("out", (5.0, 0.0, 60.6))
    pinion = writer.gear("pinion", first, 23, module, 0.2, helix=helix, series="c25")
    wheel = writer.gear("wheel", second, 37, module, 0.15, helix=-helix, series="d 24")
    writer.stage("mesh", pinion, wheel, 60.6, center_distance_tolerance_field_din_3964_1980=(8, "none"))
    writer.bearing("front", first, 0.0, radial_clearance=(12.0, "mum"))
    writer.bearing(
        "rear", first, 70.0, "rolling_bearing_with_catalog_geometry",
        minimum_radial_bearing_clearance=(5.0, "mum"), maximum_radial_bearing_clearance=(20.0, "mum"),
    )  # fmt: skip
    return writer.rexs()


def planetary(
    planets: int = 3, *, series: tuple[str, str, str] = ("c25", "c25", "c25"), field: int = 7, helix: float = 0.0
) -> Rexs:
    """A sun of 17 teeth, planets of 22, a ring of 61 that is coupled to the casing; m_n 4 mm, 78 mm/cos β apart."""
    distance = 78.0 / cos(radians(helix)) if helix else 78.0
    writer = Writer("1.1")
    sun_shaft, ring_shaft, carrier_shaft = (writer.shaft(own, (0.0, 0.0, 0.0)) for own in ("sun shaft", "rim", "web"))
    stage, carrier = writer.add("planetary_stage", "set"), writer.add("planet_carrier", "carrier")
    held = writer.add("switchable_coupling", "lock", is_engaged=(True, "none"))
    writer.relate("side", assembly=held, inner_part=ring_shaft, outer_part=2)
    writer.relate("assembly", assembly=stage, part=carrier)
    writer.relate("assembly", assembly=carrier, part=carrier_shaft)
    writer.relate("planet_carrier_shaft", planetary_stage=stage, shaft=carrier_shaft)
    for own in (sun_shaft, ring_shaft):
        writer.relate("central_shaft", planetary_stage=stage, shaft=own)
    sun = writer.gear("sun", sun_shaft, 17, 4.0, None, helix=-helix, series=series[0])
    ring = writer.gear("ring", ring_shaft, 61, 4.0, None, helix=helix, ring=True, series=series[2])
    writer.add("external_load", "load")
    for k in range(planets):
        shaft = writer.shaft(f"pin @ {k}", (0.0, 0.0, distance))
        writer.relate("planet_shaft", planetary_stage=stage, shaft=shaft)
        planet = writer.gear(f"planet wheel @ {k}", shaft, 22, 4.0, 0.0, helix=helix, series=series[1])
        for first, second in ((sun, planet), (planet, ring)):
            mesh = writer.stage(
                f"mesh @ {k}", first, second, distance, center_distance_tolerance_field_din_3964_1980=(field, "none")
            )
            writer.relate("assembly", assembly=stage, part=mesh)
    return writer.rexs()


def two_stages() -> Rexs:
    """Two helical stages on three shafts, the third in line with the first; both without backlash."""
    writer = Writer("1.4")
    first, second, third = (
        writer.shaft(own, at)
        for own, at in (("one", (-70.0, 0.0, 0.0)), ("two", (-25.0, 0.0, -190.0)), ("three", (90.0, 0.0, 0.0)))
    )
    gears = [
        writer.gear("a", first, 27, 4.5, 0.231415, helix=21.0, start=117.0),
        writer.gear("b", second, 51, 4.5, 0.231415, helix=-21.0, start=72.0),
        writer.gear("c", second, 23, 6.5, 0.15074, helix=-10.0, start=180.0),
        writer.gear("d", third, 34, 6.5, 0.15074, helix=10.0, start=65.0),
    ]
    writer.stage("fast", gears[0], gears[1], 190.0)
    writer.stage("slow", gears[2], gears[3], 190.0)
    return writer.rexs()
