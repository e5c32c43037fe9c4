"""Generates the tables of supported elements from the readers' tables, for the documentation."""
from __future__ import annotations

from typing import Iterator, List, Mapping, NamedTuple, Optional, Tuple

from .sdf import model_tables, sensor_tables, world_tables
from .urdf import transmission, urdf_tables
from .xml.tables import Entry, Group, Kept, Nested, Part, Table, Use, Value


class Supported(NamedTuple):
    """One element or attribute (as `@name`) of a format."""

    path: str
    use: Use
    since: str


_SDF: Tuple[Table, ...] = (
    model_tables.WORLD,
    model_tables.PHYSICS,
    model_tables.LIGHT,
    world_tables.SCENE,
    world_tables.SKY,
    world_tables.FOG,
    world_tables.GUI_CAMERA,
    world_tables.ROAD,
    world_tables.ACTOR,
    world_tables.POPULATION,
    world_tables.STATE,
    model_tables.INCLUDE,
    model_tables.MODEL,
    model_tables.FRAME,
    model_tables.LINK,
    model_tables.INERTIAL,
    model_tables.COLLISION,
    model_tables.VISUAL,
    model_tables.MATERIAL,
    *model_tables.GEOMETRIES.values(),
    model_tables.JOINT,
    model_tables.AXIS,
    sensor_tables.SENSOR,
    sensor_tables.CAMERA,
    *{table.name: table for table in sensor_tables.BLOCKS.values()}.values(),
)
_URDF: Tuple[Table, ...] = (
    urdf_tables.ROBOT, urdf_tables.LINK, urdf_tables.INERTIAL, urdf_tables.COLLISION,
    urdf_tables.VISUAL, urdf_tables.MATERIAL, *(t[0] for t in urdf_tables.GEOMETRIES.values()),
    urdf_tables.JOINT, urdf_tables.GAZEBO_MODEL,
    transmission.TRANSMISSION,
)


def supported_rows(table: Table) -> Iterator[Supported]:
    """Yield the rows of one table; groups are replaced by their children and attributes."""
    for name in table.attributes:
        yield Supported(f"@{name}", table.attributes[name].use or table.use,
                        table.attributes[name].since)
    yield from _rows(table.children, table.use, "", "")


def _rows(children: Mapping[str, Entry], usual: Use, path: str, since: str) -> Iterator[Supported]:
    for name, entry in children.items():
        here = f"{path}{name}"
        if isinstance(entry, Group) and name == "noise":  # one row for the model of a noise
            yield Supported(here, usual, entry.since or since)
        elif isinstance(entry, Group):
            for attribute, value in entry.attributes.items():
                yield Supported(f"{here}@{attribute}", value.use or usual, value.since)
            yield from _rows(entry.children, usual, f"{here}/", entry.since or since)
        else:
            yield Supported(here, _use(entry, usual), entry.since or since)


def _use(entry: Entry, usual: Use) -> Use:
    if isinstance(entry, Kept):
        return entry.use
    assert isinstance(entry, (Value, Part, Nested))
    return entry.use or usual


def support_tables() -> str:
    """Return two Markdown tables, SDF and URDF; each element with a table of its own has a row."""
    lines: List[str] = []
    for title, tables in (("SDF", _SDF), ("URDF", _URDF)):
        lines += [f"| {title} element | {' | '.join(use.value for use in Use)} |",
                  "|---|" + "---|" * len(Use)]
        lines += [_row(table) for table in tables]
        lines.append("")
    return "\n".join(lines)


def _row(table: Table) -> str:
    rows = list(supported_rows(table))
    cells = [", ".join(_format_status(row) for row in rows if row.use is use) for use in Use]
    if not rows:
        cells[list(Use).index(table.use)] = "yes"
    return f"| `{table.name}` | " + " | ".join(cells) + " |"


def _format_status(row: Supported) -> str:
    since: Optional[str] = row.since if row.since > "1.7" or len(row.since) > 3 else ""
    return f"`{row.path}`" + (f" (SDF {since})" if since else "")


__all__ = ["Supported", "support_tables", "supported_rows"]
