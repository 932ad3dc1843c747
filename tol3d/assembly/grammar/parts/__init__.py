"""Kinds of part, one file each."""

from tol3d.assembly.grammar.parts.solid import SolidSpec, StepSpec, likes

__all__ = ["SolidSpec", "StepSpec", "likes"]
