"""Contacts: motions that keep places open and go as far as a goal, without a scene, part, tolerance or gear.

`seat.py` is asked by moves of assemblies and gauges: poses of a part and its bolts within clearances, centred or
pushed. It follows `programme.py`, the convex programme of one pose, solved for many trials by the kernels of `rooms.py`
and `cones.py`, and proved by `certify.py`. `openings.py` is the largest circle within several discs. Read `seat.py`
first. Contact of teeth is in `tol3d.gearing.engines`.
"""
