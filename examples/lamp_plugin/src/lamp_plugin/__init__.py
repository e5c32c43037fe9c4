"""A plugin for my_simulations."""
