"""How far the two methods lie apart, and what explains it."""
