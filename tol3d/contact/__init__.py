"""Contacts: motions that keep places open and go as far as a goal, without a scene, part, tolerance or gear."""
