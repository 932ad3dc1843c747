"""Planetary sets as stages of trains: links between shafts, whose play is the set's lost motion at its output.

set_link    such a link: both roads' laws of its play
from_scene  sets and the train around them, from one scene
refusals    what such a train cannot have
"""
