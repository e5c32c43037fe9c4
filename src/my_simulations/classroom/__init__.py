"""A class on one server: a world, a home folder and an editor for each student."""
