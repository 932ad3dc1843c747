"""CAD: solids of parts as strips, meshes and STEP (`solids`), and foreign STEP files as records (`step`).

Solids are made of numbers and know no tolerance; what a file states of tolerances is read as records. Neither knows a
move, a measure or a trial. Open CASCADE and CadQuery are loaded only where a solid must be built; what was read off it
is kept on disk. Read `solids/cad.py` and `step/reading.py` first.
"""
