"""What a run looks like: tables, pictures, meshes and 3D views, from its summary and from replayed trials.

    table, check    rich tables of a run and of a model
    histogram       the picture of a run
    compare         runs and roads laid over each other
    meshes          the parts of one trial as STL, PLY, GLB or STEP
    view            the same in 3D, contact and gap marked

Import the module that is wanted: matplotlib, trimesh, cadquery and pyvista load with theirs only.
"""
