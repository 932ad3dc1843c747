"""Grammar of gears in scenes: kinds of part, tolerance, move and measure, one file each."""
