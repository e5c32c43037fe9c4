#!/usr/bin/env python3
"""Write the table of supported elements into doc/sdf_support.md, from the readers' own tables."""
from __future__ import annotations

from marked_section import REPOSITORY, replaced, write

PAGE = REPOSITORY / "doc" / "sdf_support.md"


def with_table(page: str) -> str:
    """The page's text with the present table."""
    from my_simulations.formats.support_table import support_tables

    return replaced(page, "supported", f"{support_tables().strip()}\n")


if __name__ == "__main__":
    write(PAGE, with_table)
