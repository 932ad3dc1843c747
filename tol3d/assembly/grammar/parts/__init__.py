"""Kinds of part, one file each."""

from tol3d.assembly.grammar.parts.solid import SolidSpec

__all__ = ["SolidSpec"]
