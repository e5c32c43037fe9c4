"""Images as height maps."""
