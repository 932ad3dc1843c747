"""Gears in mesh and their trains: builds, contact, measures, and the stack-up."""
