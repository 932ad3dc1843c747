"""A rigid carrier of planets."""

from typing import Literal

from tol3d.planetary.grammar.parts.carrier import CarrierSpec


class PlanetCarrierSpec(CarrierSpec):
    """A rigid carrier."""

    kind: Literal["planet_carrier"]
