"""The methods of gears in mesh: the stack-up, and the geometry by an engine."""
