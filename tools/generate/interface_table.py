#!/usr/bin/env python3
"""Write the topics and services into doc/ros_api.md, from the table that registers them."""
from __future__ import annotations

from marked_section import REPOSITORY, replaced, write

PAGE = REPOSITORY / "doc" / "ros_api.md"


def with_interface(page: str) -> str:
    """The page's text with the present tables."""
    from my_simulations.ros.interface import interface_tables

    return replaced(page, "interface", interface_tables())


if __name__ == "__main__":
    write(PAGE, with_interface)
