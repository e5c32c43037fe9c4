"""`python -m my_simulations.studies` is the command `study`."""
import sys

from ..program_end import exit_cleanly
from .command import main

sys.exit(exit_cleanly(main)())
