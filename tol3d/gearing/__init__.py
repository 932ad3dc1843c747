"""Gears in mesh and the trains that they make: builds, contact, measures, and the stack-up beside them."""
