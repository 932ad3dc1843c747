"""What a vocabulary adds to a scene's study."""

from collections.abc import Mapping

from tol3d.strict import Strict

Option = bool | int | float | str


class StudyOptions(Strict):
    """Keys of `study` that one vocabulary understands: fields of plain values, each with a default."""


def options_of(stated: StudyOptions, kind: type[StudyOptions]) -> Mapping[str, Option]:
    """The values of a kind's options."""
    return {name: getattr(stated, name) for name in kind.model_fields}
