"""From deviations to builds: displacements by effects, resulting poses of gears, and their rates."""
