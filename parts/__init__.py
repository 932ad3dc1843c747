"""CadQuery builders, one a file; installed as `tol3d.parts`. Importing the package loads no CAD."""
