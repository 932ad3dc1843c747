"""How far the two roads lie apart, and what explains it."""
