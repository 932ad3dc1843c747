"""Gears brought to contact on the gaps that an engine measures, and their backlashes read."""
