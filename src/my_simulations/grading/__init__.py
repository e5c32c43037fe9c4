"""Grading: an assignment file, submissions in isolated processes, marks and pages."""
