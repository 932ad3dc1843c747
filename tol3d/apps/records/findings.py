"""Findings for a measured pair, and settings for reading its measurement."""

import math
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from typing import Final

from tol3d.apps.records.alignment import Aligned, HiddenShift
from tol3d.apps.records.closure import Closing, closures
from tol3d.apps.records.fit import Fit
from tol3d.apps.records.pair import ARCSEC, RigPair, Side, Specimen
from tol3d.apps.records.prediction import BacklashModel, Extreme, Figure, OneSided, length_and_phase
from tol3d.apps.records.reading import Pass, Senses
from tol3d.apps.records.spectrum import Spectrum
from tol3d.apps.records.terms import ECCENTRIC, encoder_names
from tol3d.apps.records.whole_backlash import ToothPart, WholeBacklash

ENCODER_ERROR: Final = 20 * ARCSEC  # once per turn, that a rig's encoders and couplings may have


@dataclass(frozen=True)
class Settings:
    """Settings for reading a measurement.

    Args:
        unit: of angles whose column has none.
        j0: backlash at phi1 = 0 [rad], where encoders were set to zero between the sides.
        j0_half_width: of its 95 % interval [rad].
        encoder_error: assumed error of either encoder once per turn [rad].
        drift: fit a linear drift of each side as well.
    """

    unit: str | None = None
    j0: float | None = None
    j0_half_width: float = 0.0
    encoder_error: float = ENCODER_ERROR
    drift: bool = False


@dataclass(frozen=True, eq=False)
class Identified:
    """Results of an identification.

    Args:
        pair: nominal numbers.
        senses: of the encoders.
        passes: as aligned, by side.
        read: the same as read, by side.
        fit: of both sides together.
        model: the backlash of the eccentricities.
        teeth: contribution of deviating teeth to it.
        whole: the backlash with both.
        alone: of each side.
        shift: alternative position of the back side.
        spectrum: of the residual.
        warnings: conditions that may spoil it.
    """

    pair: RigPair
    senses: Senses
    passes: Mapping[Side, tuple[Aligned, ...]]
    read: Mapping[Side, tuple[Pass, ...]]
    fit: Fit
    model: BacklashModel
    teeth: ToothPart
    whole: WholeBacklash
    alone: Mapping[Side, OneSided]
    shift: HiddenShift | None
    spectrum: Spectrum
    warnings: tuple[str, ...] = ()

    @property
    def specimen(self) -> Specimen:
        """The pair that was found, theta2 counted as the exact geometry counts it."""
        return self.fit.specimen(self.model.constant_part)

    @cached_property
    def figures(self) -> Mapping[str, Figure]:
        """e1, theta1, e2, theta2 [mm, rad]; jc, j0 and the backlash's ends jmin, jmax with their places [rad].

        The ends are those of the whole backlash; beside them stand those of the eccentricities alone.
        """
        vector, covariance = self.fit.of(ECCENTRIC)
        quantile = self.model.quantile
        found = dict(zip(("e1", "theta1"), length_and_phase(vector[:2], covariance[:2, :2], quantile), strict=True))
        found |= zip(("e2", "theta2"), length_and_phase(vector[2:], covariance[2:, 2:], quantile), strict=True)
        found["jc"] = Figure(self.model.constant_part, self.model.constant_half_width)
        found["j0"] = self.whole.start
        for name, own in (("jmin", self.whole.least), ("jmax", self.whole.largest)):
            found[name], found[f"{name} at"] = own.backlash, own.place
        for name, own in (("jmin", self.least), ("jmax", self.largest)):
            found[f"{name} eccentric"], found[f"{name} eccentric at"] = own.backlash, own.place
        return found

    @cached_property
    def least(self) -> Extreme:
        """The smallest backlash over the long period, of the eccentricities alone."""
        return self.model.extreme(-1)

    @cached_property
    def largest(self) -> Extreme:
        """The largest, in the same way."""
        return self.model.extreme(+1)

    @cached_property
    def encoders(self) -> Mapping[str, Figure]:
        """Parts common to both sides, once per turn [rad]: of encoder 1 in its own angle, of encoder 2."""
        return {f"encoder {encoder}": self._encoder(encoder, 1) for encoder in (1, 2)}

    @cached_property
    def encoders_twice(self) -> Mapping[str, Figure]:
        """The same twice per turn, for encoders whose rows determine it."""
        return {f"encoder {encoder}": self._encoder(encoder, 2) for encoder in self.fit.terms.twice}

    def _encoder(self, encoder: int, order: int) -> Figure:
        vector, covariance = self.fit.of(encoder_names(encoder, order))
        own, _ = length_and_phase(vector, covariance, self.model.quantile)
        gain = 1 / self.pair.rate if encoder == 1 else 1.0
        return Figure(gain * own.value, gain * own.half_width)

    @cached_property
    def closure(self) -> Mapping[Closing, Figure]:
        """Change of transmission errors and of the backlash over the long period [rad], where one is reached."""
        return closures(self.fit, self.specimen, self.passes)

    @property
    def winding(self) -> Figure | None:
        """1/k of B_0(T) = j_0 + T/k [rad/(N m)]; None if torques do not determine it."""
        if not self.fit.terms.winding:
            return None
        value, covariance = self.fit.of(("winding",))
        return Figure(2 * float(value[0]), 2 * self.model.quantile * math.sqrt(float(covariance[0, 0])))
