#!/usr/bin/env python3
"""Removes objects from the running world."""
import sys

from my_simulations.cli.remove_object import main

sys.exit(main())
