"""Numbers, names and sentences as a summary may hold them, and the base of its classes."""

import unicodedata
from collections.abc import Callable, Mapping
from functools import cache
from types import NoneType
from typing import TYPE_CHECKING, Annotated, Any, Literal, Optional, ParamSpec, TypeVar, get_args

from pydantic import AfterValidator, Field, model_validator

from tol3d.strict import Strict, refused
from tol3d.units import shown

LARGEST = 1e15  # of any unit; keeps arithmetic and pictures finite, and a nanometre at 1e9 m is no reading
MOST_TRIALS = 10**10  # as in scenes
MOST_SEED = 2**63 - 1
MOST_ENTRIES = 100_000  # measures, contributors, positions of a curve, warnings ... of one kind
LONGEST_LABEL = 10_000  # characters; a link of parallel load paths names all that is in it
LONGEST_SENTENCE = 100_000
UNSAFE = frozenset(("Cc", "Cf", "Cs", "Zl", "Zp"))  # Unicode categories that move a terminal's cursor or hide text
LEFT_OUT: Any = None  # default of a key that is not in every summary


def _plain(text: str) -> str:
    if any(unicodedata.category(sign) in UNSAFE for sign in text):
        raise refused("", "text without control or invisible characters", shown(text))
    return text


Label = Annotated[str, Field(min_length=1, max_length=LONGEST_LABEL), AfterValidator(_plain)]
Sentence = Annotated[str, Field(max_length=LONGEST_SENTENCE), AfterValidator(_plain)]
Sha256 = Annotated[str, Field(pattern=r"^[0-9a-f]{64}$")]
Number = Annotated[float, Field(ge=-LARGEST, le=LARGEST)]
Known = Number | None  # null where a study cannot say, such as the sigma of one trial
NotNegative = Annotated[float, Field(ge=0.0, le=LARGEST)]
Count = Annotated[int, Field(ge=0, le=MOST_TRIALS)]
Positive = Annotated[int, Field(ge=1, le=MOST_TRIALS)]
Ppm = Annotated[float, Field(ge=0.0, le=1e6 * (1 + 1e-9))]
PpmRange = Annotated[list[Ppm], Field(min_length=2, max_length=2)]
Numbers = Annotated[list[Number], Field(max_length=MOST_ENTRIES)]
KnownNumbers = Annotated[list[Known], Field(max_length=MOST_ENTRIES)]
KnownRange = Annotated[list[Known], Field(min_length=2, max_length=2)]
Unit = Literal["um", "mm", "arcmin", "pins"]
Method = Literal["analytic", "geometric"]

T = TypeVar("T")
Keys = ParamSpec("Keys")

if TYPE_CHECKING:
    Maybe = Optional[T]  # noqa: UP045 - a generic alias
else:

    class Maybe:
        """A key that is not in every summary: None in Python if it is missing, and never null in the file."""

        def __class_getitem__(cls, kind: Any) -> Any:
            return kind


class Section(Strict):
    """A part of a summary. Attributes have the names of the file's keys (`p0.135` is `p0_135`)."""

    def value(self, key: str) -> float | None:
        """A number by its key in the file; None where this part has none."""
        found = getattr(self, key.replace(".", "_"), None)
        return None if found is None or isinstance(found, str) else float(found)

    # Reading by the file's keys, as of a mapping: for what still reads summaries so.

    def __getitem__(self, key: str) -> Any:
        name = key.replace(".", "_")
        if name not in self.model_fields_set:
            raise KeyError(key)
        return getattr(self, name)

    def __contains__(self, key: object) -> bool:
        return isinstance(key, str) and key.replace(".", "_") in self.model_fields_set

    def __len__(self) -> int:
        return len(self.model_fields_set)

    def get(self, key: str, default: Any = None) -> Any:
        """The value of a key, or else another."""
        return getattr(self, key.replace(".", "_")) if key in self else default

    def keys(self) -> list[str]:
        """The keys that it has."""
        return [key_of(type(self), name) for name in vars(self) if name in self.model_fields_set]

    def items(self) -> list[tuple[str, Any]]:
        """Keys and values."""
        return [(key, self[key]) for key in self.keys()]


class MethodSection(Section):
    """A section computed by one of the two methods."""

    method: Label

    @model_validator(mode="before")
    @classmethod
    def _named_as_before(cls, data: Any) -> Any:
        """Reads the key `road`, as the method was called until November 2026."""
        if isinstance(data, dict) and "road" in data and "method" not in data:
            return {"method" if key == "road" else key: value for key, value in data.items()}
        return data


def key_of(kind: type[Section], name: str) -> str:
    """The file's key of an attribute."""
    return str(kind.model_fields[name].validation_alias or name)


# writing ------------------------------------------------------------------------------------------


def made(section: Callable[Keys, T], /, *none: Keys.args, **keys: Keys.kwargs) -> T:
    """A section of a new summary, its keys in the order in which they are given.

    mypy holds keys and types; bounds are held once the whole is written, where a fault is warned of and no run is lost.
    None for a key that may be missing, and not be null, leaves it out.
    """
    kind: Any = section
    given = {name: value for name, value in keys.items() if value is not None or name not in _missing_not_null(kind)}
    found: T = kind.model_construct(set(given), **given)
    object.__setattr__(found, "__dict__", {name: vars(found)[name] for name in given} | vars(found))
    return found


@cache
def _missing_not_null(kind: type[Section]) -> frozenset[str]:
    fields = kind.model_fields.items()
    return frozenset(n for n, field in fields if not field.is_required() and NoneType not in get_args(field.annotation))


def as_json(value: Any) -> Any:
    """JSON value of sections, as it is written: by the file's keys."""
    if isinstance(value, Section | Mapping):
        return {key: as_json(own) for key, own in value.items()}
    return [as_json(own) for own in value] if isinstance(value, list | tuple) else value
