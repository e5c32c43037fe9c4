"""The table of what is read, made from the readers' own tables."""
from my_simulations.formats.sdf.model_tables import GEOMETRIES, LINK, WORLD
from my_simulations.formats.support_table import markdown, supported
from my_simulations.formats.xml.tables import Use


def uses(table):
    return {row.path: row.use for row in supported(table)}


def test_every_element_has_a_use():
    assert uses(LINK)["gravity"] is Use.SIMULATED and uses(LINK)["sensor"] is Use.KEPT
    assert uses(LINK)["velocity_decay/linear"] is Use.SIMULATED
    assert uses(WORLD)["scene"] is Use.SHOWN and uses(WORLD)["wind"] is Use.KEPT


def test_the_text_is_a_table_with_a_row_for_each_element():
    lines = markdown().splitlines()
    assert lines[0] == "| SDF element | simulated | shown | kept | ignored |"
    for name in (*GEOMETRIES, "world", "state", "robot"):
        assert sum(line.startswith(f"| `{name}` |") for line in lines) >= 1, name
    assert all(line.count("|") == 6 for line in lines if line)


def test_what_newer_versions_brought_says_since_when():
    assert "`screw_thread_pitch` (SDF 1.10)" in markdown()
