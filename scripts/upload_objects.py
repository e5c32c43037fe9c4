#!/usr/bin/env python3
"""Loads a world's object list to the parameter server."""
import sys

from my_simulations.cli.upload_objects import main

sys.exit(main())
