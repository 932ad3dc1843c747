"""Plans of measurements."""
