"""State logs: recorded and played back."""
