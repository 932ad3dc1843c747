"""Published keys against those of a summary: by both JSON Schemas, every number of the one is in the other."""

from collections.abc import Iterator, Mapping
from fnmatch import fnmatchcase
from typing import Any, Final

from tol3d.gearing.cycloid.mechanism import CYCLOID
from tol3d.gearing.mechanism import GEARING
from tol3d.gearing.planetary.mechanism import PLANETARY
from tol3d.kinds import summary_kinds
from tol3d.scene import Grammar

Schema = Mapping[str, Any]

METHODS: Final = ("analytic.", "geometric.", "methods.")
STATED: Final = {
    "blocks.*": "how the run lies on disk",
    "witness.*": "what our own engines find of each other",
    "measures.*.agreement.explanation.*": "what our own methods leave out",
    "study.until": "at which errors it was to stop",
    "study.accept_ppk": "what it was asked to reach",
    "study.profile_steps": "how finely our own witness measures",
    "measures.*.chord_error_um": "how finely our own meshes measure",
    "measures.*.mesh_error_um": "how finely our own meshes measure",
    "measures.*.lower_limit": "the scene states it",
    "measures.*.upper_limit": "the scene states it",
    "measures.*.load_changes_deg": "the scene states it",
    "measures.*.shares_by.*": "what our own regression explains",
    "measures.*.order": "the scene states it",
    "measures.*.deflection_um": "the scene states it",
    "planetary_sets.*.spring.*": "what follows of the scene's own spring",
    "measures.*.lever_mm": "the scene states it",
    "measures.*.law_sigmas_um.*": "what follows of the scene's own zones and laws",
    "measures.*.lost_motion.arcmin_per_um": "the scene states it",
    "measures.*.reasons.*": "counts of words of this program: which pair decided what failed",
    "backlash.*": "what follows of the scene's own tolerances",
    "trains.*.stages.*.teeth": "the scene states it",
    "trains.*.stages.*.ways": "the scene states it",
    "joint.correlations.*": "matrices; published by both names",
    "joint.correlated_of": "how many our own matrices are of",
    "timing.findings_s": "how long our own statistics took",
    "timing.pictures_s": "how long our own pictures took",
    "published.*": "what others found",
    "*.published.*": "what others found",
}
"""Numbers of a summary that nobody publishes, with the reason."""
RENAMED: Final = {
    "measures.*.contributors.*.analytic_percent": "measures.*.contributors.*.percent",
    "measures.*.contributors.*.geometric_percent": "measures.*.contributors.*.percent",
    "measures.*.contributors.*.geometric_percent_se": "measures.*.contributors.*.percent_se",
}
"""Shares whose keys have the method's name."""


def numbers(node: Any, whole: Schema, place: str = "") -> Iterator[str]:
    """Places of all numbers and lists of numbers; `*` for any name, and for an entry of a list of named things."""
    if "$ref" in node:
        yield from numbers(whole["$defs"][node["$ref"].rpartition("/")[2]], whole, place)
    for each in (*node.get("anyOf", ()), *node.get("oneOf", ())):
        yield from numbers(each, whole, place)
    if node.get("type") in ("number", "integer"):
        yield place.rstrip(".")
    for key, own in node.get("properties", {}).items():
        yield from numbers(own, whole, f"{place}{key}.")
    if isinstance(others := node.get("additionalProperties"), dict):
        of_methods = set(node.get("propertyNames", {}).get("enum", ())) == {"analytic", "geometric"}
        yield from numbers(others, whole, place if of_methods else f"{place}*.")
    if items := node.get("items"):
        yield from numbers(items, whole, f"{place}*." if "$ref" in items else place)


def without_methods(place: str) -> str:
    """A number's place as published keys have it."""
    found = f"{place}."
    for method in ("analytic_closed_form.", *METHODS):
        found = found.replace(f".{method}", ".")
    bare = found.removesuffix(".")
    return RENAMED.get(bare, bare)


def column_numbers() -> set[str]:
    schema = Grammar((GEARING, PLANETARY, CYCLOID)).scene.model_json_schema()
    column = schema["$defs"]["PublishedColumn"]
    whole = {**column, "additionalProperties": False}
    for own in whole["properties"].values():  # a measure of the name of a key
        own["anyOf"] = [each for each in own["anyOf"] if each != column["additionalProperties"]]
    measures = numbers(column["additionalProperties"], schema, "measures.*.")
    lengths = set(quantities(column["additionalProperties"], schema, "measures.*."))
    lengths |= set(quantities(whole, schema, ""))
    return {*numbers(whole, schema), *measures, *lengths}


def quantities(node: Any, whole: Schema, place: str) -> Iterator[str]:
    """Places of numbers that are written with their unit."""
    as_numbers = _quantities_as_numbers(whole)
    yield from numbers(_quantities_as_numbers(node), as_numbers, place)


def _quantities_as_numbers(node: Any) -> Any:
    if isinstance(node, list):
        return [_quantities_as_numbers(each) for each in node]
    if not isinstance(node, Mapping):
        return node
    if node.get("type") == "string" and "pattern" in node and "examples" in node:
        return {"type": "number"}
    return {key: _quantities_as_numbers(own) for key, own in node.items()}


def test_every_number_of_a_summary_may_be_published_or_is_named_here_with_the_reason() -> None:
    schema = summary_kinds().run.model_json_schema()
    ours = {without_methods(place) for place in numbers(schema, schema)}
    allowed = {place for place in ours if any(fnmatchcase(place, own) for own in STATED)}
    assert ours - allowed - column_numbers() == set()
    assert {own for own in STATED if not any(fnmatchcase(place, own) for place in ours)} == set()


def test_nothing_else_may_be_published() -> None:
    """But the short forms of a share and of a correlation, which is by both names."""
    schema = summary_kinds().run.model_json_schema()
    ours = {without_methods(place) for place in numbers(schema, schema)}
    pair = "joint.correlations.*.*"
    short = {"measures.*.contributors.*", pair}
    short |= {f"{pair}.{key}" for key in ("r", "r_low_95", "r_high_95", "trials")}
    assert column_numbers() - ours == short
