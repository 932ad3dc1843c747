"""The gears' part of summary.json: its types, words and sections."""
