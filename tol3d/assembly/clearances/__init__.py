"""Least distances of whole parts, as meshes of their solids stand to each other.

meshes      of solids, to a chord error
faces       triangles that can be nearest to another part at all
pair        two parts as they stand nominally: what travels to workers
distances   trial by trial, by FCL; made in the worker
nearest     where two parts may be nearest, for the analytic method
prepared    both for an assembly; loads FCL only where there is a clearance
"""
