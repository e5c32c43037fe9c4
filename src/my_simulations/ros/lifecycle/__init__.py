"""From the command line to a running node, and to its end."""
