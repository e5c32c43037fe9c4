"""XML to dataclasses by tables: parsing, repair, values, and the source of each element."""
