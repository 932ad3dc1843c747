"""The RV reducer: its first stage before its cycloid stage, and what is read of it."""
