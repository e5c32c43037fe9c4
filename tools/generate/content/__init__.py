"""Descriptions of the shipped models, from which `make_models.py` writes models/."""
