"""How closed loops are shown: tables of their inputs, freedoms and poses; their workspace as a picture."""
