"""Presentation of closed loops: tables of their inputs, freedoms and poses; their workspace as a picture."""
