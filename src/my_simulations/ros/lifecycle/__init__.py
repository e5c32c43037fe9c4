"""Start and shutdown of the server process."""
