"""Kinds of tolerance."""
