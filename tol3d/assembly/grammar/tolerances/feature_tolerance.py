"""Common base of all tolerances of a feature."""

from collections.abc import Iterator
from typing import ClassVar

from pydantic import Field

from tol3d.assembly.grammar.datums import DatumSpec
from tol3d.assembly.grammar.feature_name import FeatureName, Use, part_of
from tol3d.assembly.grammar.features.feature_spec import AXES
from tol3d.assembly.grammar.parts import SolidSpec
from tol3d.assembly.grammar.zone import laws_lacking
from tol3d.assembly.model.datum_frame import Modifier
from tol3d.scene.bases import ToleranceEntry
from tol3d.scene.entry import Reference
from tol3d.scene.place import KeyPath
from tol3d.strict import Strict


class FeatureTolerance(ToleranceEntry):
    """A tolerance of one feature."""

    applies_to: ClassVar[tuple[str, ...]] = ("point", "sphere", "plane", "slot", *AXES)

    of: FeatureName = Field(description="the feature, with its part")

    @classmethod
    def lacking(cls) -> Iterator[str]:
        """See Entry: how its laws are drawn."""
        if "law" in cls.model_fields:
            yield from laws_lacking(cls.model_fields["law"].annotation)

    def references(self) -> tuple[Reference, ...]:
        """The part."""
        return (Reference(("of",), part_of(self.of), (SolidSpec,)),)

    @property
    def all_of(self) -> tuple[str, ...]:
        """The features, with their part; a pattern by its name."""
        return (self.of,)

    @property
    def named_datums(self) -> tuple[DatumSpec, ...]:
        """The datums to which it holds."""
        return ()

    def uses(self) -> Iterator[Use]:
        """The feature, and the datums."""
        yield Use(("of",), self.of, self.applies_to)
        for k, datum in enumerate(self.named_datums):
            for name in datum.features:
                path: KeyPath = ("datums", k)
                yield Use(path, f"{part_of(self.of)}.{name}", datum.kinds)


class Modified(Strict):
    """A tolerance that a bonus may widen."""

    modifier: Modifier | None = Field(
        default=None, description="mmc or lmc: the size of the feature widens the zone; none, regardless of size"
    )
