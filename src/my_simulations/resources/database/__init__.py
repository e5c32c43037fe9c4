"""Downloads from model databases, with limits and checks."""
