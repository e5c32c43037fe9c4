"""Studies: many runs of worlds that differ in what was varied, measured and kept in one table.

See doc/studies.md. The command is `study`; `python -m my_simulations.studies` is the same.
"""
