"""Applications: each a package on the public API alone, as one of a stranger would be; see docs/api.md.

    adjustment   shims of bevel pairs, the correction of a motor
    design       planetary sets of a ratio, 3K sets among them
    drafting     scenes to start from: of a kind of system, or of STEP files
    records      measured transmission errors, and the rig that measures them

`commands.py` of each has its commands, which the command line names by import paths.
"""
