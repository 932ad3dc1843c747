"""CAD: solids of parts as strips, meshes and STEP (`solids`), and foreign STEP files as records (`step`).

Both know scenes and shapes by their numbers, and no tolerance, move, measure or trial. Open CASCADE and CadQuery are
loaded only where a solid must be built; what was read off it is kept on disk. Read `solids/cad.py` and
`step/reading.py` first.
"""
