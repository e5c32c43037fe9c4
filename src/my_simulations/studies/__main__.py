"""`python -m my_simulations.studies` is the command `study`."""
import sys

from .command import main

sys.exit(main())
