"""Slots of the sums of a seat: shift and turn of its axis, its gear's centre, its flanks.

Nothing is imported here: kernels are recompiled if a module that they import changes.
"""

OFFSET = 0  # x, y, z of the axis [mm], in the seat's frame at rest
TURN = 3  # rotation vector of the axis [rad], in the same frame
CENTRE = 6  # x, y of the gear's centre off its axis [mm], in the gear's frame
FLANK_TURN = 8  # by which each flank is turned out of its tooth [rad]
FLANK_OFFSET = 9  # by which each flank lies outside that, along its normal [mm]
SLOTS = 10
