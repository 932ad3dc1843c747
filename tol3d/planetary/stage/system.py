"""A train with planetary sets in it as a study sees it."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from tol3d.gearing.system import GearSystem
from tol3d.planetary.sections import set_sections
from tol3d.planetary.stage.set_link import SetLink
from tol3d.system.pooled import PooledTerms
from tol3d.system.system import Published


@dataclass(frozen=True)
class SetTrain(GearSystem):
    """Implements System: a system of gears, some of whose links are sets."""

    @property
    def sets(self) -> tuple[SetLink, ...]:
        """Its links that are sets."""
        return tuple(link for link in self.model.links if isinstance(link, SetLink))

    def sections(self, terms: Mapping[str, Mapping[str, PooledTerms]], published: Published) -> Mapping[str, Any]:
        """Trains with their stages, and efficiencies of sets where the friction of their teeth is given; see System."""
        found = {name: own for link in self.sets for name, own in set_sections(link.own, link.friction).items()}
        return {**super().sections(terms, published), **({"planetary_sets": found} if found else {})}
