"""The RV reducer: its first stage before its cycloid stage, and its measures."""
