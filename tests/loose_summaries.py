"""Summaries of which a test states only what it needs: typed, the rest filled in, and not validated."""

from collections.abc import Mapping
from types import NoneType, UnionType
from typing import Annotated, Any, Literal, Union, get_args, get_origin

from tol3d.study.runs.summary.kinds import default_kinds
from tol3d.study.runs.summary.measure import MeasureSummary
from tol3d.study.runs.summary.run import RunSummary
from tol3d.study.runs.summary.values import Section

Json = Mapping[str, Any]

DIFFERENCES = ("max_abs_difference", "rms_difference", "mean_difference")


def typed_run(stated: Any) -> RunSummary:
    """A whole summary of some of its keys; what is typed in it stays as it is."""
    if isinstance(stated, RunSummary):
        return stated
    measures = {name: typed_measure(own) for name, own in stated.get("measures", {}).items()}
    found = _typed(default_kinds().run, {**stated, "measures": measures})
    assert isinstance(found, RunSummary)
    return found


def typed_measure(stated: Any) -> MeasureSummary:
    """A measure of some of its keys; one without a kind is a normal backlash."""
    if isinstance(stated, MeasureSummary):
        return stated
    kinds = default_kinds().measures
    chosen = next((kind for kind in kinds if stated.get("kind") in _literals(kind)), kinds[0])
    found = _typed(chosen, {"kind": "normal_backlash", "of": "pair", "gear": None, "over": "random", **stated})
    assert isinstance(found, MeasureSummary)
    return found


def valid(stated: Json) -> dict[str, Any]:
    """The JSON of a whole summary that is valid, of some of its keys and measures with both methods."""
    engine, trials, seed = stated.get("engine", "exact"), stated["trials"], stated["seed"]
    study = {"trials": trials, "seed": seed, "engine": engine, "replicates": 1, "profile_steps": 8}
    known = {"study": study, "files": {"scene.yaml": "0" * 64}, "blocks": {"trials": 1}, "engine": engine}
    whole: dict[str, Any] = filled(default_kinds().run, {**known, **stated, "study": study})
    for measure in whole["measures"].values():
        if "geometric" in measure:
            measure.setdefault("agreement", dict.fromkeys(DIFFERENCES) | {"compared": 0})
    return whole


def filled(kind: Any, stated: Any) -> Any:
    """JSON of a kind with every required key that is not stated: null where it may be, else nothing much."""
    kind = _bare(kind, stated)
    if isinstance(kind, type) and issubclass(kind, Section) and isinstance(stated, Mapping):
        keys = {str(field.validation_alias or name): field for name, field in kind.model_fields.items()}
        lacking = {key: _nothing(field.annotation) for key, field in keys.items() if field.is_required()}
        whole = {**lacking, **stated}
        return {key: filled(keys[key].annotation, value) if key in keys else value for key, value in whole.items()}
    if isinstance(stated, Mapping) and get_args(kind):
        return {key: filled(get_args(kind)[1], value) for key, value in stated.items()}
    if isinstance(stated, list) and get_args(kind):
        return [filled(get_args(kind)[0], value) for value in stated]
    return stated


def _typed(kind: Any, stated: Any) -> Any:
    kind = _bare(kind, stated)
    if isinstance(kind, type) and issubclass(kind, Section) and isinstance(stated, Mapping):
        keys = {str(field.validation_alias or name): (name, field) for name, field in kind.model_fields.items()}
        values = {keys[key][0]: _typed(keys[key][1].annotation, value) for key, value in stated.items() if key in keys}
        said = set(values)
        for name, field in kind.model_fields.items():
            if name not in values and field.is_required():
                values[name] = _typed(field.annotation, _nothing(field.annotation))
        return kind.model_construct(said, **_by_alias(kind, values))
    if isinstance(stated, Mapping) and get_args(kind):
        return {key: _typed(get_args(kind)[1], value) for key, value in stated.items()}
    if isinstance(stated, list | tuple) and get_args(kind):
        return [_typed(get_args(kind)[0], value) for value in stated]
    return stated


def _by_alias(kind: type[Section], values: Json) -> dict[str, Any]:
    return {str(kind.model_fields[name].validation_alias or name): value for name, value in values.items()}


def _bare(kind: Any, stated: Any) -> Any:
    """A type without its annotations; of several the one that fits what is stated."""
    while get_origin(kind) is Annotated:
        kind = get_args(kind)[0]
    if get_origin(kind) not in (Union, UnionType):
        return kind
    options = [_bare(option, stated) for option in get_args(kind) if option is not NoneType]
    named = stated.get("kind") if isinstance(stated, Mapping) else None
    return next((option for option in options if named in _literals(option)), options[0])


def _literals(kind: Any) -> tuple[Any, ...]:
    fields = getattr(kind, "model_fields", {})
    return get_args(fields["kind"].annotation) if "kind" in fields else ()


def _nothing(kind: Any) -> Any:
    """A value of a type that says nothing."""
    while get_origin(kind) is Annotated:
        kind = get_args(kind)[0]
    if kind is NoneType or NoneType in get_args(kind):
        return None
    if get_origin(kind) is Literal:
        return get_args(kind)[0]
    if isinstance(kind, type) and issubclass(kind, Section):
        return {}
    origin = get_origin(kind) or kind
    return {int: 0, float: 0.0, str: "", bool: False, list: []}.get(origin, {})
