"""Machines: gears and parts with drawings in one world, joined at bores, at pins and at joints.

The parts are an assembly, placed and measured as any; the gears, planetary sets and reducers are those of any train.
Between both stand moves: the axis of a shaft is the line through its bores in the trial, planets turn about pins of a
plate, and a train turns the links of an arm by its play. Each hands on its readings as deviations that
nobody draws, so that either side sees no more than its own kind.

grammar/     the moves, worst errors over poses, and consistency checks
nominal      where shafts lie in their bores, and the centre distances and azimuths that follow
bores, pins  lines through bores, and pins of plates with what they move on a carrier, by either method of the assembly
chain        links, joints and poses on both methods; open_chains makes them of a scene, with the flanks that are loaded
             and the trains that turn its joints
from_scene   all of it, from one scene; refuses deviations that would be counted twice
joined       all together: whose columns are whose, how bores and joints follow from deviations
turned_joints  play of trains, each build and position once
methods        placed, meshed, turned
closed_form  moments of a backlash, and of a part that trains turn
system       all of it as one system
presenting/  gears, housing and arms in one picture
"""
