"""General assemblies: features of parts, datum frames, tolerance zones, moves and measures, in one world."""
