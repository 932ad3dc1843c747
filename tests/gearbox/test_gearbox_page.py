"""The page about gears in a housing says what its scene and the grammar say."""

from places import ROOT, SCENES

from tol3d.gearbox.grammar.shaft_in_bores import ShaftInBoresSpec

PAGE = (ROOT / "docs" / "gearboxes.md").read_text("utf-8")


def test_the_page_quotes_its_scene() -> None:
    (quoted,) = (block.partition("```")[0] for block in PAGE.split("```yaml\n")[1:])
    assert quoted in (SCENES / "housed_gears.yaml").read_text("utf-8")


def test_the_page_has_a_row_for_every_key_of_the_move() -> None:
    table = PAGE.partition("## What `shaft_in_bores` says")[2].partition("\n- ")[0]
    rows = {line.split("`")[1] for line in table.splitlines() if line.startswith("| `")}
    assert rows == {field.alias or name for name, field in ShaftInBoresSpec.model_fields.items()} - {"kind"}
