"""The JSON Schema of scenes, made and checked once for all that it judges."""

from functools import cache

from jsonschema import Draft202012Validator
from ruamel.yaml import YAML

from tol3d import Scene


@cache
def _validator() -> Draft202012Validator:
    schema = Scene.model_json_schema()
    Draft202012Validator.check_schema(schema)
    return Draft202012Validator(schema)


def judged(text: str) -> None:
    """Judge a scene.

    Raises:
        ValidationError: jsonschema's, where the schema refuses it.
    """
    _validator().validate(YAML(typ="safe", pure=True).load(text))
