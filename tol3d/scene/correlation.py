"""The section `correlations` of a scene: contributors that do not vary independently, such as sizes of one setting."""

from typing import Annotated, Final, Self

import numpy as np
from pydantic import Field, model_validator

from tol3d.scene.listed import listed
from tol3d.scene.name import Name
from tol3d.strict import Strict, refused

CORRELATIONS: Final = "correlations"
LEAST_EIGENVALUE: Final = 1e-9
"""Least eigenvalue of a positive definite matrix of correlations; below it rounding decides."""

Correlation = Annotated[float, Field(gt=-1.0, lt=1.0)]
Row = Annotated[tuple[float, ...], listed("numbers", 2)]


class CorrelationSpec(Strict):
    """Contributors that are correlated, in the standard normals of their laws: a Gaussian copula."""

    between: Annotated[tuple[Name, ...], listed("names", 2)] = Field(
        description="contributors of one number each: tolerances without a direction or a zone"
    )
    rho: Correlation | None = Field(default=None, description="correlation of each two of them")
    matrix: Annotated[tuple[Row, ...], listed("rows", 2)] | None = Field(
        default=None, description="instead of rho: their correlations, a row each, with 1 on the diagonal"
    )

    @property
    def correlation(self) -> np.ndarray:
        """The matrix (names, names)."""
        if self.matrix is not None:
            return np.array(self.matrix)
        found = np.full((len(self.between),) * 2, self.rho, dtype=np.float64)
        np.fill_diagonal(found, 1.0)
        return found

    @model_validator(mode="after")
    def _refuse_contradictions(self) -> Self:
        names = self.between
        if repeated := [name for k, name in enumerate(names) if name in names[:k]]:
            raise refused("between", "each name once", f"{repeated[0]!r} twice")
        if (self.rho is None) == (self.matrix is None):
            raise refused("", "rho or matrix", "both" if self.rho is not None else "neither")
        if self.matrix is not None:
            self._refuse_no_correlations()
        if (least := least_eigenvalue(self.correlation)) < LEAST_EIGENVALUE:
            field = "rho" if self.matrix is None else "matrix"
            raise refused(field, "correlations that are consistent, a positive definite matrix", eigenvalue(least))
        return self

    def _refuse_no_correlations(self) -> None:
        size = len(self.between)
        rows = self.matrix or ()
        for k, row in enumerate(rows):
            if len(rows) != size or len(row) != size:
                raise refused("matrix", f"{size} rows of {size} numbers", f"{len(rows)}, one of {len(row)}")
            if row[k] != 1.0:
                raise refused("matrix", f"1 on the diagonal, for {self.between[k]!r}", f"{row[k]:g}")
            for j, own in enumerate(row):
                if own != rows[j][k]:
                    pair = f"{self.between[k]!r} and {self.between[j]!r}"
                    raise refused("matrix", f"one correlation of {pair}", f"{own:g} and {rows[j][k]:g}")


def least_eigenvalue(matrix: np.ndarray) -> float:
    """The least one of a symmetric matrix."""
    return float(np.linalg.eigvalsh(matrix)[0])


def eigenvalue(least: float) -> str:
    """Message on a matrix that is not positive definite."""
    return f"one with the eigenvalue {least:.3g}"
