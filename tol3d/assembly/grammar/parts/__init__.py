"""Kinds of part, one file each."""

from tol3d.assembly.grammar.parts.solid import SolidSpec, likes
from tol3d.assembly.grammar.parts.step import StepSpec

__all__ = ["SolidSpec", "StepSpec", "likes"]
