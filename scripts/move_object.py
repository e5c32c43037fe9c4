#!/usr/bin/env python3
"""Moves a model of the running world."""
import sys

from my_simulations.cli.move_object import main

sys.exit(main())
