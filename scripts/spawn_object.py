#!/usr/bin/env python3
"""Spawns objects of the list into the running world."""
import sys

from my_simulations.cli.spawn_object import main

sys.exit(main())
