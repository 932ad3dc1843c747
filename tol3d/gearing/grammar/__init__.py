"""What scenes write of gears: kinds of part, tolerance, move and measure, one file each."""
