"""The exact method of planetary sets: placed gears."""
