"""Published topics and their threads."""
