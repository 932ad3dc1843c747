"""Closed loops of bodies: linkages that joints hold together, placed at once in an assembly."""
