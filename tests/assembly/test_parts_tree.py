"""The tree of who locates whom, against trees that were drawn by hand."""

from collections.abc import Iterator, Sequence

import numpy as np

from tol3d.assembly.model import Assembly
from tol3d.assembly.model.assembly import Part
from tol3d.assembly.presenting.parts_tree import DEEPEST, Laid, parts_tree
from tol3d.kinds import all_kinds
from tol3d.report.check import parts_report
from tol3d.report.page import Branch
from tol3d.scene import read_scene
from tol3d.scene.bundled import scene_path
from tol3d.study.trials.overrides import AS_WRITTEN, simulation_of


def lines_of(branches: Sequence[Branch], depth: int = 0) -> Iterator[str]:
    for own in branches:
        yield "  " * depth + own.text
        yield from lines_of(own.branches, depth + 1)


def tree_of(*laid: Laid) -> list[str]:
    """Lines of the tree of parts without features, laid as is said."""
    parts = tuple(Part(own.part, np.eye(4), (), ()) for own in laid)
    return list(lines_of(parts_tree(Assembly(parts, (), {}, 0), laid)))


def shown(scene: str) -> list[str]:
    simulation = simulation_of(read_scene(scene_path(scene), all_kinds()), AS_WRITTEN)
    blocks = parts_report(simulation).blocks[1:]
    trees = [own for own in blocks if isinstance(own, Branch)]
    return [*map(str, blocks)] if not trees else list(lines_of(trees))


def test_a_part_stands_below_the_first_part_that_its_move_lays_it_on() -> None:
    assert shown("box_with_discs") == [
        "box: fixed (move on the table)",
        "  lower disc: touch on box (move first)",
        "    upper disc: touch on lower disc, box (move second)",
        "  ball: touch on box (move third)",
        "    cap: touch on ball (move fourth)",
    ]


def test_a_body_that_is_moved_again_takes_along_what_is_welded_to_it() -> None:
    assert shown("every_assembly_field") == [
        "table: fixed (move machine)",
        "  base: fixed (move on the bench), then six contacts on table (move on the table)",
        "    cover: six contacts on base (move cover on the base), then welded to base (move assembly)",
        "    spindle: mate on base (move spindle in the bore), then welded to base (move assembly)",
        "    sensor: six contacts on cover (move sensor on the cover), then welded to base (move assembly)",
        "gauge: fixed (move gauge set up)",
        "  second cover: best fit on gauge (move second cover on the gauge)",
    ]


def test_shafts_stand_below_the_part_with_their_first_bore() -> None:
    lines = shown("gearbox_in_housing")
    assert lines[0] == "housing: fixed (move base)"
    assert lines[2] == "  input: shaft in bores of housing, cover (move input in its bores)"


def test_of_gears_without_moves_of_parts_a_line_says_so() -> None:
    assert shown("spur_pair") == ["no part is placed on another by a move of its own here; check shows what there is"]


def test_a_chain_of_three_hundred_parts_is_two_lines() -> None:
    chain = [Laid("b0", "fixed", "base")]
    chain += [Laid(f"b{k}", "six contacts on", f"move {k}", (f"b{k - 1}",)) for k in range(1, 300)]
    names = " → ".join(f"b{k}" for k in range(1, 300))
    assert tree_of(*chain) == ["b0: fixed (move base)", f"{names}: each six contacts on the one before"]


def test_a_deep_tree_is_set_in_at_its_side_branches_alone() -> None:
    """A tower of twelve floors, each with a window; the fourth also leans on the ground."""
    tower = [Laid("ground", "fixed", "")]
    for k in range(12):
        below = "ground" if k == 0 else f"floor {k - 1}"
        on = (below, "ground") if k == 4 else (below,)
        tower += [Laid(f"floor {k}", "mate on", "", on), Laid(f"window {k}", "touch on", "", (f"floor {k}",))]
    expected = ["ground: fixed"]
    for k in range(12):
        below = "ground" if k == 0 else f"floor {k - 1}"
        floor = f"floor {k}: mate on {below}{', ground' if k == 4 else ''}"
        expected += (
            [floor, f"  window {k}: touch on floor {k}"] if k < 11 else [floor, f"window {k}: touch on floor {k}"]
        )
    assert tree_of(*tower) == expected


def test_a_tree_of_few_levels_is_set_in_at_each() -> None:
    chain = [Laid("0", "fixed", "")] + [Laid(f"{k}", "mate on", "", (f"{k - 1}",)) for k in range(1, DEEPEST)]
    assert tree_of(*chain) == ["0: fixed"] + [f"{'  ' * k}{k}: mate on {k - 1}" for k in range(1, DEEPEST)]


def test_parts_that_are_laid_alike_share_a_line_but_those_that_carry_others() -> None:
    bolts = [Laid(f"bolt {k}", "play on", f"move {k}", ("lid", "box")) for k in range(6)]
    washer = Laid("washer", "mate on", "", ("bolt 5",))
    assert tree_of(Laid("box", "fixed", ""), Laid("lid", "mate on", "", ("box",)), *bolts, washer) == [
        "box: fixed",
        "  lid: mate on box",
        "    bolt 0, bolt 1, bolt 2, bolt 3, bolt 4: each play on lid, box",
        "    bolt 5: play on lid, box (move move 5)",
        "      washer: mate on bolt 5",
    ]


def test_a_part_moved_again_onto_one_that_lies_on_it_ends_the_tree_there() -> None:
    again = Laid("a", "mate on", "back", ("b",), Laid("a", "fixed", "first"))
    assert tree_of(Laid("b", "mate on", "", ("a",)), again) == [
        "a: fixed (move first), then mate on b (move back)",
        "  b: mate on a",
    ]
