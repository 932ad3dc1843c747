"""Gears in a machined housing: shafts lie in bores that deviate as the drawing of their parts says.

The parts are an assembly, placed and measured as any; the meshes are those of any train. Between the two stands one
move, `shaft_in_bores`: the axis of a shaft is the line through its bores in the trial, and how far it lies off its
nominal place is what both gear roads get, beside the tolerances of the gears.

grammar/     the move, and what must not be counted twice
nominal      where shafts lie in their bores, and the centre distances and azimuths that follow
bores        the lines through bores, trial by trial, by either road of the assembly
from_scene   the gears, the assembly and the bores between them, from one scene
joined       both together: whose columns are whose, how bores follow from deviations
roads        placed, then meshed
counted      what would be counted twice
closed_form  moments of a backlash by the tolerances of the bores too
system       all of it as one system
presenting/  gears and housing in one picture
"""
