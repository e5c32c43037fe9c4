"""SDF worlds and models, read and written. Source: SDF specification 1.0 to 1.11."""
