"""Limits that standards of drawings give to sizes: letters and numbers in, micrometres or millimetres out."""
