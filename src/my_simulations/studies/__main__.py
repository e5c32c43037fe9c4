"""`python -m my_simulations.studies` is the command `study`."""
import sys

from ..program_end import program
from .command import main

sys.exit(program(main)())
