"""What is asked of a system, drawn, tallied, stopped and found."""
