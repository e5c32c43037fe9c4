"""The tables themselves: every target exists, every default can be written and read again."""
import inspect

import pytest

from my_simulations.formats.sdf import model_tables
from my_simulations.formats.urdf import urdf_tables
from my_simulations.formats.xml.tables import Table


def tables_of(module):
    found = [value for value in vars(module).values() if isinstance(value, Table)]
    found += [t[0] if isinstance(t, tuple) else t for t in module.GEOMETRIES.values()]
    return found


ALL = [pytest.param(table, id=f"{module.__name__.rsplit('.')[-1]}-{table.name}")
       for module in (model_tables, urdf_tables) for table in tables_of(module)]


@pytest.mark.parametrize("table", ALL)
def test_every_default_of_a_table_survives_writing_and_reading(table):
    for path, value, default in table.values():
        assert inspect.isclass(table.of)
        if default is None or isinstance(default, list) or default == "":
            continue
        assert value.kind.parse(value.kind.format(default)) == default, path


def test_a_misnamed_field_would_be_noticed():
    from my_simulations.description.shapes import Box
    from my_simulations.formats.xml.tables import Value
    from my_simulations.formats.xml.values import FLOAT

    with pytest.raises(AttributeError):
        list(Table("box", Box, {"size": Value("sise", FLOAT)}).values())


@pytest.mark.parametrize("kind, text, value", [
    ("BOOL", " TRUE ", True), ("BOOL", "0", False), ("NEGATED", "true", False),
    ("FLOAT", " +1.5e-3\n", 0.0015), ("INT", "10.0", 10), ("INT", "0x10", 16),
    ("LIMIT", "-inf", float("-inf")), ("SCALE", "2", (2, 2, 2)), ("VECTOR3", "1\t2\n3", (1, 2, 3)),
    ("COLOR", "1 0 0", (1, 0, 0, 1)), ("SECONDS", "2 500000000", 2.5),
    ("COLOR", "51 -1 1 0.5", (0.2, 0, 1, 0.5)), ("COLOR", "300 0 0", (1, 0, 0, 1)),
    ("FRICTION", "-1", 1e6), ("FRICTION", "0", 0), ("FRICTION", "0.5", 0.5),
    ("SECONDS", "2.5", 2.5),
    ("TEXT", " a b ", "a b"),
])
def test_values_are_read(kind, text, value):
    from my_simulations.formats.xml import values

    assert getattr(values, kind).parse(text) == value


@pytest.mark.parametrize("kind, text", [
    ("BOOL", "maybe"), ("FLOAT", "1,5"), ("FLOAT", "nan"), ("FLOAT", "inf"), ("FLOAT", "1_000"),
    ("INT", "1.5"), ("INT", "0xzz"), ("LIMIT", "nan"), ("VECTOR3", "1 2"), ("COLOR", "1 2"),
    ("POSE", "1 2 3"), ("POSE", "1 2 3 4 5 6 7"), ("SCALE", "1 2"), ("RPY", "0 0 x"),
])
def test_values_that_are_none_are_refused_with_what_was_found(kind, text):
    from my_simulations.formats.xml import values

    with pytest.raises(ValueError, match="expected"):
        getattr(values, kind).parse(text)
