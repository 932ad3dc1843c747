"""`python -m tol3d.cli`."""

from tol3d.cli import main

main()
