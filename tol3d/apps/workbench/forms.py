"""Forms of analyses on the page: a field for each argument of `words.WORDS`, in plain words, with its default."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Final

from tol3d.analyses.response import Response
from tol3d.analyses.stated_changes import told
from tol3d.apps.workbench.session import LIMITS
from tol3d.apps.workbench.words import TEXTS, VALUES, VARIED, WORDS, YES_NO, Argument
from tol3d.report.html.blocks import Markup, tag, together

ANALYSES: Final[Mapping[str, tuple[str, str]]] = {
    "effects": (
        "effects",
        "Effect of each contributor on each measure: per unit, over its tolerance, on the variance and on failures.",
    ),
    "what_if": (
        "what if",
        "Other tolerances: sigma and builds out of limits before and after, rare ones too.",
    ),
    "changes": ("what to change", "Measures that are NOT OK: which nominal to move, which tolerance to halve."),
    "allocate": ("allocate", "Tolerances of least cost for a fraction out of limits, confirmed by simulation."),
    "rare": ("rare events", "Builds out of limits that are too rare for trials, and the most likely one of them."),
    "methods": ("methods side by side", "Worst case, RSS, modified RSS and simulation of each measure side by side."),
    "sweep": (
        "variants",
        "Numbers of the scene that take several values; each variant is simulated with the same draws.",
    ),
}
"""Titles and subjects by kind, in the order in which the page offers them."""
BY_LINE: Final[Mapping[str, tuple[str, ...]]] = {"what_if": ("set",), "allocate": ("freeze", "bound", "stays")}
"""Arguments with a value for each tolerance: columns of a table."""
BY_MEASURE: Final[Mapping[str, tuple[str, ...]]] = {"what_if": ("limits",)}
"""Arguments with a value for each measure."""
SIDES: Final = ("low", "high")
VARIED_EXAMPLES: Final = ("choose a number, then its values", "another one", "another one")
PLACEHOLDERS: Final = {"set": "±33 µm, H7 or x1.5", "bound": "0.8..1.2", "limits": "10 µm..40 µm"}


@dataclass(frozen=True)
class FormScene:
    """A scene, as far as forms ask for its parts.

    Args:
        measures: their names.
        lines: of its tolerances, with their words.
        moved: tolerances and limits that are moved on the page, as `--set` and `--limits` take them, by their keys.
        numbers: of the scene by their fields, which a sweep can vary.
    """

    measures: Sequence[str]
    lines: Mapping[str, str]
    moved: Mapping[str, str]
    numbers: Mapping[str, str]


def line_words(response: Response, line: str) -> str:
    """A tolerance in words and numbers, such as `normal -20 … 20 um`."""
    names = response.lines[line]
    contributor = next(own for own in response.contributors if own.name == names[0])
    return told(contributor, response.drawn_by(names[0])) + (f" · each of {len(names)}" if len(names) > 1 else "")


def form(kind: str, scene: FormScene) -> Markup:
    """Fields of an analysis."""
    _, subject = ANALYSES[kind]
    tabled = (*BY_LINE.get(kind, ()), *BY_MEASURE.get(kind, ()), "factor")
    fields = [_field(name, own, scene) for name, own in WORDS[kind].items() if name not in tabled]
    by_line, by_measure = ({name: WORDS[kind][name] for name in names.get(kind, ())} for names in (BY_LINE, BY_MEASURE))
    if kind == "what_if":
        limits = {key.removeprefix(LIMITS): own for key, own in scene.moved.items() if key.startswith(LIMITS)}
        fields.insert(0, _table("tolerance", scene.lines, by_line, scene.moved))
        fields.insert(1, _table("measure", dict.fromkeys(scene.measures, ""), by_measure, limits))
    elif by_line:
        table = _table("tolerance", scene.lines, by_line, {})
        fields.append(tag("details", tag("summary", "single tolerances"), table))
    return together(tag("p", subject), *fields)


def _field(name: str, argument: Argument, scene: FormScene) -> Markup:
    """A control with its label; what is left empty has the argument's default."""
    label, default, word = argument.label, argument.default, argument.word
    about: Mapping[str, object] = {"data_argument": name}
    if name == "measure" and word is TEXTS:
        boxes = (_box(f"{measure}", {**about, "data_item": measure}) for measure in scene.measures)
        return tag("fieldset", tag("legend", f"{label}: {default}, or"), *boxes, data_field=name)
    if name == "measure":
        every = (tag("option", own, value=own) for own in scene.measures)
        control = tag("select", tag("option", default, value=""), *every, **about)
    elif word is VARIED:
        return _varied(label, about, scene.numbers)
    elif word is YES_NO:
        return tag("div", _box(label, about), data_field=name)
    elif word.choices:
        control = tag("select", *_choices(word.choices, default), **about)
    else:
        control = tag("input", type="text", placeholder=default, **about)
    return tag("div", tag("label", label, " ", control), data_field=name)


def _varied(label: str, about: Mapping[str, object], numbers: Mapping[str, str]) -> Markup:
    """Fields FIELD=VALUES, with the scene's numbers to choose from."""
    offered = (tag("option", f"now {now}", value=f"{field}=") for field, now in numbers.items())
    about = {**about, "type": "text", "list": "numbers", "data_each": "", "class_": "long"}
    texts = (
        tag("input", placeholder=own, aria_label=f"{label}, {k}", **about) for k, own in enumerate(VARIED_EXAMPLES, 1)
    )
    words = tag(
        "p", "values: 10um,20um · from 17 to 25 in twos: 17..25:2 · a range to draw from: 10um..30um", class_="note"
    )
    return tag(
        "fieldset", tag("legend", label), *texts, tag("datalist", *offered, id="numbers"), words, data_field="vary"
    )


def _choices(choices: Sequence[str], default: str) -> Iterator[Markup]:
    for own in choices:
        yield tag("option", own, value="" if own == default else own)


def _box(label: str, about: Mapping[str, object]) -> Markup:
    return tag("label", tag("input", type="checkbox", **about), f" {label}")


def _table(of: str, rows: Mapping[str, str], arguments: Mapping[str, Argument], moved: Mapping[str, str]) -> Markup:
    """A column for each argument, and a row for each tolerance or measure, with what is moved of it."""
    heads = (tag("th", own.label, scope="col") for own in arguments.values())
    head = tag("tr", tag("th", of, scope="col"), *heads)
    body = (_row(name, words, arguments, moved) for name, words in rows.items())
    return tag("div", tag("table", tag("thead", head), tag("tbody", *body)), class_="wide")


def _row(line: str, words: str, arguments: Mapping[str, Argument], moved: Mapping[str, str]) -> Markup:
    cells = (tag("td", _cell(name, own, line, moved)) for name, own in arguments.items())
    about = [tag("br"), tag("span", words, class_="dim")] if words else []
    head = tag("th", line, *about, scope="row")
    return tag("tr", head, *cells)


def _cell(name: str, argument: Argument, line: str, moved: Mapping[str, str]) -> Markup:
    about: dict[str, object] = {"data_argument": name, "aria_label": f"{line}: {argument.label}"}
    if argument.word is TEXTS:
        return tag("input", type="checkbox", data_item=line, **about)
    about["data_of"] = line
    if name == "stays":
        return tag("select", tag("option", "middle", value=""), *(tag("option", own) for own in SIDES), **about)
    assert argument.word is VALUES
    return tag("input", type="text", value=moved.get(line), placeholder=PLACEHOLDERS[name], **about)
