"""Kinds of part, one file each."""

from tol3d.assembly.grammar.parts.solid import SolidSpec, likes

__all__ = ["SolidSpec", "likes"]
