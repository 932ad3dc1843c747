"""Assemblies from the text: placements by matrices of numpy, names, units, and what is refused."""

import math
from pathlib import Path

import numpy as np
import pytest

from tol3d.cad.step import Leaf, StepError, StepText, read_step_text

HEAD = "ISO-10303-21;\nHEADER;\nFILE_SCHEMA(('AP242'));\nENDSEC;\nDATA;\n"
UNITS = """#1=(LENGTH_UNIT()NAMED_UNIT(*)SI_UNIT(.MILLI.,.METRE.));
#2=LENGTH_MEASURE_WITH_UNIT(LENGTH_MEASURE(25.4),#1);
#3=(CONVERSION_BASED_UNIT('INCH',#2)LENGTH_UNIT()NAMED_UNIT(*));
#4=(GEOMETRIC_REPRESENTATION_CONTEXT(3)GLOBAL_UNIT_ASSIGNED_CONTEXT((#1))REPRESENTATION_CONTEXT('',''));
#5=(GEOMETRIC_REPRESENTATION_CONTEXT(3)GLOBAL_UNIT_ASSIGNED_CONTEXT((#3))REPRESENTATION_CONTEXT('',''));
#6=ADVANCED_FACE('of the bolt',(),$,.T.);
#7=CLOSED_SHELL('',(#6));
#8=MANIFOLD_SOLID_BREP('bolt',#7);
"""
Axes = tuple[tuple[float, float, float], tuple[float, float, float], tuple[float, float, float]]
TURNED: Axes = ((1.0, 2.0, 3.0), (0.6, 0.0, 0.8), (0.0, 1.0, 0.0))  # origin, z, x
UPSIDE_DOWN: Axes = ((-5.0, 0.5, 0.25), (0.0, 0.0, -2.0), (3.0, 4.0, 1.0))
PLAIN: Axes = ((0.0, 0.0, 0.0), (0.0, 0.0, 1.0), (1.0, 0.0, 0.0))


class Writer:
    """A file with an assembly, written line by line."""

    def __init__(self) -> None:
        self.lines = [UNITS]
        self.last = 100

    def add(self, body: str) -> int:
        self.last += 1
        self.lines.append(f"#{self.last}={body};\n")
        return self.last

    def axes(self, axes: Axes) -> int:
        point = self.add(f"CARTESIAN_POINT('',({','.join(f'{each:.6f}' for each in axes[0])}))")
        z, x = (self.add(f"DIRECTION('',({','.join(f'{each:.6f}' for each in own)}))") for own in axes[1:])
        return self.add(f"AXIS2_PLACEMENT_3D('',#{point},#{z},#{x})")

    def product(self, name: str, items: str, context: int = 4) -> tuple[int, int]:
        """A product with a representation of these items: its definition, and the representation."""
        made = self.add(f"PRODUCT('{name}','{name}','',())")
        formation = self.add(f"PRODUCT_DEFINITION_FORMATION('','',#{made})")
        definition = self.add(f"PRODUCT_DEFINITION('','',#{formation},$)")
        shape = self.add(f"PRODUCT_DEFINITION_SHAPE('','',#{definition})")
        representation = self.add(f"SHAPE_REPRESENTATION('',({items}),#{context})")
        self.add(f"SHAPE_DEFINITION_REPRESENTATION(#{shape},#{representation})")
        return definition, representation

    def use(
        self, name: str, parent: tuple[int, int], part: tuple[int, int], at: Axes, own: Axes = PLAIN, swap: bool = False
    ) -> None:
        """A use of a product, placed so that its frame `own` lies on the assembly's frame `at`."""
        used = self.add(f"NEXT_ASSEMBLY_USAGE_OCCURRENCE('1','{name}','',#{parent[0]},#{part[0]},$)")
        shape = self.add(f"PRODUCT_DEFINITION_SHAPE('','',#{used})")
        items = self.axes(own), self.axes(at)
        representations = part[1], parent[1]
        if swap:
            items, representations = items[::-1], representations[::-1]
        transformation = self.add("ITEM_DEFINED_TRANSFORMATION('','',#{},#{})".format(*items))
        relation = self.add(
            "(REPRESENTATION_RELATIONSHIP('','',#{},#{})REPRESENTATION_RELATIONSHIP_WITH_TRANSFORMATION(#{})"
            "SHAPE_REPRESENTATION_RELATIONSHIP())".format(*representations, transformation)
        )
        self.add(f"CONTEXT_DEPENDENT_SHAPE_REPRESENTATION(#{relation},#{shape})")

    def text(self) -> bytes:
        return (HEAD + "".join(self.lines) + "ENDSEC;\nEND-ISO-10303-21;\n").encode()

    def read(self) -> StepText:
        return read_step_text(self.text(), "assembly.stp")


def matrix(axes: Axes, unit: float = 1.0) -> np.ndarray:
    """The frame of an origin, a z direction and one near x, by Gram and Schmidt."""
    z = np.array(axes[1]) / np.linalg.norm(axes[1])
    x = np.array(axes[2]) - z * (z @ np.array(axes[2]))
    found = np.eye(4)
    found[:3, :3] = np.column_stack((x / np.linalg.norm(x), np.cross(z, x / np.linalg.norm(x)), z))
    found[:3, 3] = unit * np.array(axes[0])
    return found


def placed(leaf: Leaf) -> np.ndarray:
    return np.array(leaf.placement)


@pytest.mark.parametrize("swap", [False, True])
def test_placements_multiply_down_the_assembly_each_in_its_own_unit(swap: bool) -> None:
    writer = Writer()
    bolt = writer.product("bolt", "#8", context=5)  # in inches
    pair = writer.product("pair", "")
    top = writer.product("top", "")
    writer.use("a", pair, bolt, TURNED, UPSIDE_DOWN, swap)
    writer.use("b", pair, bolt, UPSIDE_DOWN, PLAIN, swap)
    writer.use("left", top, pair, TURNED, PLAIN, swap)
    writer.use("right", top, pair, UPSIDE_DOWN, TURNED, swap)
    leaves = writer.read().structure.leaves
    in_pair = [matrix(TURNED) @ np.linalg.inv(matrix(UPSIDE_DOWN, 25.4)), matrix(UPSIDE_DOWN)]
    in_top = [matrix(TURNED), matrix(UPSIDE_DOWN) @ np.linalg.inv(matrix(TURNED))]
    assert [each.path for each in leaves] == [("left", "a"), ("left", "b"), ("right", "a"), ("right", "b")]
    for leaf, expected in zip(leaves, [outer @ inner for outer in in_top for inner in in_pair], strict=True):
        assert placed(leaf) == pytest.approx(expected, abs=1e-9)  # numbers up to 200 mm in double precision
    assert {each.product for each in leaves} == {bolt[0]}


def test_parts_of_older_files_are_placed_by_mapped_items() -> None:
    writer = Writer()
    bolt = writer.product("bolt", "#8", context=5)  # in inches
    own = writer.axes(UPSIDE_DOWN)
    source = writer.add(f"REPRESENTATION_MAP(#{own},#{bolt[1]})")
    items = [writer.add(f"MAPPED_ITEM('',#{source},#{writer.axes(at)})") for at in (TURNED, UPSIDE_DOWN)]
    top = writer.product("top", ",".join(f"#{each}" for each in items))
    for _ in items:
        writer.add(f"NEXT_ASSEMBLY_USAGE_OCCURRENCE('1','','',#{top[0]},#{bolt[0]},$)")
    leaves = writer.read().structure.leaves
    assert [each.path for each in leaves] == [("bolt",), ("bolt_2",)]
    for leaf, at in zip(leaves, (TURNED, UPSIDE_DOWN), strict=True):
        assert placed(leaf) == pytest.approx(matrix(at) @ np.linalg.inv(matrix(UPSIDE_DOWN, 25.4)), abs=1e-9)


@pytest.mark.parametrize("listed", [0, 1, 2])
def test_mapped_items_that_no_parts_list_has_are_parts_too(listed: int) -> None:
    """Two bolts are shown, of which the parts list has none, one or both; one is placed by an operator."""
    writer = Writer()
    bolt = writer.product("bolt", "#8")
    source = writer.add(f"REPRESENTATION_MAP(#{writer.axes(UPSIDE_DOWN)},#{bolt[1]})")
    at, z, x = TURNED
    point = writer.add(f"CARTESIAN_POINT('',({','.join(map(str, at))}))")
    ways = [writer.add(f"DIRECTION('',({','.join(map(str, own))}))") for own in (x, z)]
    operator = writer.add(f"CARTESIAN_TRANSFORMATION_OPERATOR_3D('','',#{ways[0]},$,#{point},1.,#{ways[1]})")
    items = [writer.add(f"MAPPED_ITEM('',#{source},#{own})") for own in (operator, writer.axes(UPSIDE_DOWN))]
    top = writer.product("top", ",".join(f"#{each}" for each in items))
    for _ in range(listed):
        writer.add(f"NEXT_ASSEMBLY_USAGE_OCCURRENCE('1','','',#{top[0]},#{bolt[0]},$)")
    leaves = writer.read().structure.leaves
    assert [each.path for each in leaves] == [("bolt",), ("bolt_2",)]
    for leaf, own in zip(leaves, (TURNED, UPSIDE_DOWN), strict=True):
        assert placed(leaf) == pytest.approx(matrix(own) @ np.linalg.inv(matrix(UPSIDE_DOWN)), abs=1e-9)


def test_a_mapped_item_without_axes_is_refused() -> None:
    writer = Writer()
    bolt = writer.product("bolt", "#8")
    source = writer.add(f"REPRESENTATION_MAP(#{writer.axes(PLAIN)},#{bolt[1]})")
    point = writer.add("CARTESIAN_POINT('',(0.,0.,0.))")
    item = writer.add(f"MAPPED_ITEM('',#{source},#{point})")
    writer.product("top", f"#{item}")
    with pytest.raises(StepError, match=r"expected a MAPPED_ITEM that is placed by axes .*, got CARTESIAN_POINT; exp"):
        writer.read()


def test_uses_without_a_name_are_told_apart() -> None:
    writer = Writer()
    bolt, top = writer.product("bolt", "#8"), writer.product("top", "")
    for name in ("", "", "bolt_2", "x"):
        writer.use(name, top, bolt, PLAIN)
    assert [each.path for each in writer.read().structure.leaves] == [("bolt",), ("bolt_2",), ("bolt_2_2",), ("x",)]


def test_solids_and_loose_faces_belong_to_their_product() -> None:
    writer = Writer()
    loose = writer.add("ADVANCED_FACE('beside it',(),$,.T.)")
    shell = writer.add(f"OPEN_SHELL('',(#{loose},#6))")
    surface = writer.add(f"SHELL_BASED_SURFACE_MODEL('',(#{shell}))")
    definition, representation = writer.product("bolt", "#8")
    beside = writer.add(f"MANIFOLD_SURFACE_SHAPE_REPRESENTATION('',(#{surface}),#4)")
    writer.add(f"SHAPE_REPRESENTATION_RELATIONSHIP('','',#{beside},#{representation})")
    read = writer.read()
    product = read.structure.products[definition]
    assert [(each.name, each.kind, each.faces) for each in product.solids] == [("bolt", "MANIFOLD_SOLID_BREP", (6,))]
    assert product.loose_faces == (loose,)  # the other one repeats a face of the solid
    assert read.structure.product_of_face == {6: definition, loose: definition}
    assert [each.path for each in read.structure.leaves] == [("bolt",)]


def test_a_product_without_a_shape_is_remarked_upon() -> None:
    writer = Writer()
    bolt, empty, top = writer.product("bolt", "#8"), writer.product("empty", ""), writer.product("top", "")
    writer.use("", top, bolt, PLAIN)
    writer.use("", top, empty, PLAIN)
    read = writer.read()
    assert [each.path for each in read.structure.leaves] == [("bolt",)]
    assert [(each.id, each.why) for each in read.remarks] == [(empty[0], "has neither solids nor faces")]


def test_an_assembly_that_holds_itself_is_refused() -> None:
    writer = Writer()
    top, inner = writer.product("top", "#8"), writer.product("inner", "")
    outer = writer.product("outer", "")
    writer.use("", outer, top, PLAIN)
    writer.use("", top, inner, PLAIN)
    writer.use("", inner, top, PLAIN)
    with pytest.raises(StepError, match="the assembly 'top' holds itself"):
        writer.read().structure.leaves  # noqa: B018


def test_assemblies_that_multiply_are_refused() -> None:
    writer = Writer()
    level = writer.product("bolt", "#8")
    for depth in range(40):
        upper = writer.product(f"level {depth}", "")
        writer.use("a", upper, level, PLAIN)
        writer.use("b", upper, level, PLAIN)
        level = upper
    with pytest.raises(StepError, match="expected at most 10000 parts"):
        writer.read().structure.leaves  # noqa: B018


def test_a_part_in_another_file_is_refused_by_its_name() -> None:
    writer = Writer()
    bolt, top = writer.product("bolt", ""), writer.product("top", "")
    writer.use("", top, bolt, PLAIN)
    file = writer.add("DOCUMENT_FILE('bolt.stp','','',$,'','')")
    writer.add(f"APPLIED_EXTERNAL_IDENTIFICATION_ASSIGNMENT('bolt.stp',$,$,(#{file}))")
    with pytest.raises(StepError, match=r"^assembly.stp: the shape of 'bolt' stands in another file \('bolt.stp'\)"):
        writer.read()


def test_a_use_without_a_placement_is_refused() -> None:
    writer = Writer()
    bolt, top = writer.product("bolt", "#8"), writer.product("top", "")
    writer.add(f"NEXT_ASSEMBLY_USAGE_OCCURRENCE('1','b','',#{top[0]},#{bolt[0]},$)")
    with pytest.raises(StepError, match="does not say where 'b' stands in its assembly"):
        writer.read()


def test_axes_without_a_direction_are_refused() -> None:
    writer = Writer()
    bolt, top = writer.product("bolt", "#8"), writer.product("top", "")
    writer.use("", top, bolt, ((0.0, 0.0, 0.0), (0.0, 0.0, 1.0), (0.0, 0.0, 1.0)))
    with pytest.raises(StepError, match="expected a direction, got one of length 0"):
        writer.read()


@pytest.mark.slow
def test_an_assembly_of_cadquery_stands_where_it_was_put(tmp_path: Path) -> None:
    cadquery = pytest.importorskip("cadquery")
    bolt = cadquery.Workplane().circle(4).extrude(20)
    pair = cadquery.Assembly(name="pair")
    top = cadquery.Assembly(name="top")
    in_pair = [cadquery.Location((10, 0, 0), (0, 0, 1), 30), cadquery.Location((-10, 0, 0), (1, 0, 0), 90)]
    in_top = [cadquery.Location((-30, 5, 10), (0, 1, 0), 45), cadquery.Location((30, -5, 10), (0, 0, 1), 180)]
    for name, at in zip("ab", in_pair, strict=True):
        pair.add(bolt, name=name, loc=at)
    for name, at in zip(("left", "right"), in_top, strict=True):
        top.add(pair, name=name, loc=at)
    path = tmp_path / "assembly.step"
    top.export(str(path))
    leaves = read_step_text(path).structure.leaves
    expected = [outer * inner for outer in in_top for inner in in_pair]
    assert len(leaves) == 4
    for leaf, location in zip(leaves, expected, strict=True):
        moved = location.wrapped.Transformation()
        rows = [[moved.Value(row, column) for column in range(1, 5)] for row in range(1, 4)]
        assert placed(leaf)[:3] == pytest.approx(np.array(rows), abs=1e-6 * math.sqrt(3))  # the file has 1e-7 mm
