"""The exact road of planetary sets: placed gears."""
