"""Writes coloured meshes as Collada 1.4.1, which Gazebo reads, too."""

from __future__ import annotations

from typing import Dict, Iterable, List, Sequence, Tuple

import numpy as np

from .meshes import Mesh, corner_normals

Color = Tuple[float, float, float]


def collada(name: str, parts: Sequence[Tuple[str, Color, Mesh]]) -> str:
    """A document with one geometry.

    Args:
        name: of the geometry and its node.
        parts: name of a material, its colour (red, green, blue; 0 to 1) and what has it.
    """
    rows: Dict[Tuple[float, ...], int] = {}
    faces: Dict[str, List[int]] = {}
    colors: Dict[str, Color] = {}
    for material, color, mesh in parts:
        colors[material] = color
        points = np.round(mesh.vertices, 4)[mesh.triangles]
        corners = np.concatenate([points, np.round(corner_normals(mesh), 2)], axis=2) + 0.0
        faces.setdefault(material, []).extend(
            rows.setdefault(tuple(corner), len(rows)) for corner in corners.reshape(-1, 6).tolist()
        )
    table = np.array(list(rows)).reshape(-1, 6)
    effects = "".join(_effect(material, color) for material, color in colors.items())
    materials = "".join(
        f'    <material id="{m}"><instance_effect url="#{m}-effect"/></material>\n' for m in colors
    )
    triangles = "".join(_triangles(name, material, index) for material, index in faces.items())
    bound = "".join(f'<instance_material symbol="{m}" target="#{m}"/>' for m in colors)
    return f"""<?xml version="1.0" encoding="utf-8"?>
<COLLADA xmlns="http://www.collada.org/2005/11/COLLADASchema" version="1.4.1">
  <asset><created>2026-11-25T00:00:00Z</created><modified>2026-11-25T00:00:00Z</modified>
    <unit name="meter" meter="1"/><up_axis>Z_UP</up_axis></asset>
  <library_effects>
{effects}  </library_effects>
  <library_materials>
{materials}  </library_materials>
  <library_geometries><geometry id="{name}-geometry" name="{name}"><mesh>
{_source(f"{name}-positions", table[:, :3])}{_source(f"{name}-normals", table[:, 3:])}\
    <vertices id="{name}-vertices"><input semantic="POSITION" source="#{name}-positions"/>\
<input semantic="NORMAL" source="#{name}-normals"/></vertices>
{triangles}  </mesh></geometry></library_geometries>
  <library_visual_scenes><visual_scene id="scene"><node id="{name}" name="{name}">
    <instance_geometry url="#{name}-geometry"><bind_material><technique_common>{bound}\
</technique_common></bind_material></instance_geometry>
  </node></visual_scene></library_visual_scenes>
  <scene><instance_visual_scene url="#scene"/></scene>
</COLLADA>
"""


def _effect(material: str, color: Color) -> str:
    return (
        f'    <effect id="{material}-effect"><profile_COMMON><technique sid="common"><lambert>'
        f"<diffuse><color>{_text(color)} 1</color></diffuse>"
        "</lambert></technique></profile_COMMON></effect>\n"
    )


def _source(name: str, table: np.ndarray) -> str:
    return (
        f'    <source id="{name}"><float_array id="{name}-array" count="{table.size}">'
        f"{_text(table.ravel())}</float_array><technique_common><accessor "
        f'source="#{name}-array" count="{len(table)}" stride="3"><param name="X" type="float"/>'
        '<param name="Y" type="float"/><param name="Z" type="float"/></accessor>'
        "</technique_common></source>\n"
    )


def _triangles(name: str, material: str, index: Sequence[int]) -> str:
    return (
        f'    <triangles material="{material}" count="{len(index) // 3}"><input '
        f'semantic="VERTEX" source="#{name}-vertices" offset="0"/>'
        f"<p>{' '.join(map(str, index))}</p></triangles>\n"
    )


def _text(values: Iterable[float]) -> str:
    return " ".join(f"{value:.6g}" for value in values)
