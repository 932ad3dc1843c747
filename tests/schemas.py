"""Data held against a JSON Schema, without holding the schema itself against its own, which takes half a second."""

from collections.abc import Mapping
from typing import Any

import jsonschema


def validate(data: Any, schema: Mapping[str, Any]) -> None:
    """Hold data against a schema; tests/cli/test_cli.py and others hold the schemas themselves.

    Raises:
        ValidationError: jsonschema's, where the schema refuses it.
    """
    jsonschema.validators.validator_for(schema)(schema).validate(data)
