"""Builds with their gears where they came to rest, for pictures and files."""
