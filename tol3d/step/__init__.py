"""Foreign STEP files: their text (ISO 10303-21) read as records of parts, datums, tolerances and dimensions."""
