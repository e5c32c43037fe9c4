"""Writes the project's own Collada meshes and textures into Media/models.

    python3 tools/generate/make_meshes.py [FOLDER]

A test compares the committed files with what this writes, so a mesh is changed here.
"""
from __future__ import annotations

import os
import struct
import sys
import zlib
from typing import Dict, Iterable, List, Sequence, Tuple

Vec = Tuple[float, float, float]
Face = Sequence[Vec]

MEDIA = os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "..", "Media", "models")


def box(centre: Vec, size: Vec) -> List[Face]:
    """Six quads, wound outwards."""
    (x, y, z), (a, b, c) = centre, (size[0] / 2, size[1] / 2, size[2] / 2)
    p = [(x + i * a, y + j * b, z + k * c) for k in (-1, 1) for j in (-1, 1) for i in (-1, 1)]
    quads = [(0, 2, 3, 1), (4, 5, 7, 6), (0, 1, 5, 4), (2, 6, 7, 3), (0, 4, 6, 2), (1, 3, 7, 5)]
    return [[p[n] for n in quad] for quad in quads]


def carton() -> List[Face]:
    """A drink carton in inches: an upright box with a gable roof, standing on z = 0."""
    w, wall, top = 1.5, 6.0, 7.5
    a, b, c, d = (-w, -w, 0.0), (w, -w, 0.0), (w, w, 0.0), (-w, w, 0.0)
    e, f, g, h = (-w, -w, wall), (w, -w, wall), (w, w, wall), (-w, w, wall)
    r, s = (-w, 0.0, top), (w, 0.0, top)
    return [[a, d, c, b], [a, b, f, e], [c, d, h, g], [b, c, g, s, f], [d, a, e, r, h],
            [e, f, s, r], [g, h, r, s]]


def table() -> List[Face]:
    """A lab table in metres: a top of 1.4 x 0.7 x 0.04 at 0.75 on four legs of 0.06."""
    faces = box((0.0, 0.0, 0.73), (1.4, 0.7, 0.04))
    for x in (-0.65, 0.65):
        for y in (-0.3, 0.3):
            faces += box((x, y, 0.355), (0.06, 0.06, 0.71))
    return faces


def normal(face: Face) -> Vec:
    """The unit normal of a plane convex face."""
    (ax, ay, az), (bx, by, bz), (cx, cy, cz) = face[0], face[1], face[2]
    u, v = (bx - ax, by - ay, bz - az), (cx - bx, cy - by, cz - bz)
    n = (u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0])
    size = (n[0] ** 2 + n[1] ** 2 + n[2] ** 2) ** 0.5
    return (n[0] / size, n[1] / size, n[2] / size)


def texture_place(point: Vec, along: Vec) -> Tuple[float, float]:
    """A point's place on the texture, per inch of the face it lies on."""
    if abs(along[2]) > 0.9:
        return (point[0] / 3.0 + 0.5, point[1] / 3.0 + 0.5)
    side = point[0] if abs(along[1]) > abs(along[0]) else point[1]
    return (side / 3.0 + 0.5, point[2] / 7.5)


def numbers(values: Iterable[float]) -> str:
    """Short decimal text; -0 is 0."""
    return " ".join(f"{value + 0.0:.6g}" for value in values)


def source(name: str, rows: Sequence[Sequence[float]], axes: str) -> str:
    """One `<source>` of floats."""
    params = "".join(f'<param name="{axis}" type="float"/>' for axis in axes)
    count = len(rows) * len(axes)
    return (f'        <source id="{name}">\n'
            f'          <float_array id="{name}-array" count="{count}">'
            f'{numbers(v for row in rows for v in row)}</float_array>\n'
            f'          <technique_common><accessor source="#{name}-array" count="{len(rows)}" '
            f'stride="{len(axes)}">{params}</accessor></technique_common>\n'
            f'        </source>\n')


def collada(name: str, faces: Sequence[Face], unit: Tuple[str, str], up_axis: str,
            colour: str, texture: str = "") -> str:
    """A Collada 1.4.1 document with one node, one geometry and one material."""
    points = list(dict.fromkeys(point for face in faces for point in face))
    normals = list(dict.fromkeys(normal(face) for face in faces))
    places = list(dict.fromkeys(
        texture_place(point, normal(face)) for face in faces for point in face)) if texture else []
    corners, counts = [], []
    for face in faces:
        counts.append(len(face))
        for point in face:
            corners += [points.index(point), normals.index(normal(face))]
            if texture:
                corners.append(places.index(texture_place(point, normal(face))))
    images = surface = ""
    diffuse = f"<color>{colour}</color>"
    places_source = places_input = bind = ""
    if texture:
        images = (f'  <library_images><image id="{name}-image"><init_from>{texture}</init_from>'
                  '</image></library_images>\n')
        surface = (f'      <newparam sid="surface"><surface type="2D"><init_from>{name}-image'
                   '</init_from></surface></newparam>\n'
                   '      <newparam sid="sampler"><sampler2D><source>surface</source></sampler2D>'
                   '</newparam>\n')
        diffuse = '<texture texture="sampler" texcoord="UV"/>'
        places_source = source(f"{name}-uv", places, "ST")
        places_input = f'<input semantic="TEXCOORD" source="#{name}-uv" offset="2" set="0"/>'
        bind = '<bind_vertex_input semantic="UV" input_semantic="TEXCOORD" input_set="0"/>'
    return f"""<?xml version="1.0" encoding="utf-8"?>
<COLLADA xmlns="http://www.collada.org/2005/11/COLLADASchema" version="1.4.1">
  <asset>
    <created>2026-11-21T00:00:00Z</created>
    <modified>2026-11-21T00:00:00Z</modified>
    <unit name="{unit[0]}" meter="{unit[1]}"/>
    <up_axis>{up_axis}</up_axis>
  </asset>
{images}  <library_effects>
    <effect id="{name}-effect"><profile_COMMON>
{surface}      <technique sid="common"><lambert><diffuse>{diffuse}</diffuse></lambert></technique>
    </profile_COMMON></effect>
  </library_effects>
  <library_materials>
    <material id="{name}-material"><instance_effect url="#{name}-effect"/></material>
  </library_materials>
  <library_geometries>
    <geometry id="{name}-geometry" name="{name}">
      <mesh>
{source(f"{name}-positions", points, "XYZ")}{source(f"{name}-normals", normals, "XYZ")}\
{places_source}        <vertices id="{name}-vertices">\
<input semantic="POSITION" source="#{name}-positions"/></vertices>
        <polylist material="skin" count="{len(faces)}">
          <input semantic="VERTEX" source="#{name}-vertices" offset="0"/>
          <input semantic="NORMAL" source="#{name}-normals" offset="1"/>{places_input}
          <vcount>{" ".join(map(str, counts))}</vcount>
          <p>{" ".join(map(str, corners))}</p>
        </polylist>
      </mesh>
    </geometry>
  </library_geometries>
  <library_visual_scenes>
    <visual_scene id="scene">
      <node id="{name}" name="{name}"><instance_geometry url="#{name}-geometry">
        <bind_material><technique_common>
          <instance_material symbol="skin" target="#{name}-material">{bind}</instance_material>
        </technique_common></bind_material>
      </instance_geometry></node>
    </visual_scene>
  </library_visual_scenes>
  <scene><instance_visual_scene url="#scene"/></scene>
</COLLADA>
"""


def png(width: int, height: int, rows: Iterable[bytes]) -> bytes:
    """An 8-bit RGB PNG."""
    def chunk(kind: bytes, data: bytes) -> bytes:
        return (struct.pack(">I", len(data)) + kind + data
                + struct.pack(">I", zlib.crc32(kind + data)))
    header = struct.pack(">IIBBBBB", width, height, 8, 2, 0, 0, 0)
    body = zlib.compress(b"".join(b"\0" + row for row in rows), 9)
    return (b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", header) + chunk(b"IDAT", body)
            + chunk(b"IEND", b""))


def carton_texture(size: int = 64) -> bytes:
    """Cream paper with a blue band and a round label."""
    def pixel(x: int, y: int) -> bytes:
        if (x - size // 2) ** 2 + (y - size * 5 // 8) ** 2 < (size // 5) ** 2:
            return bytes((226, 80, 60))
        if size // 2 < y < size * 3 // 4:
            return bytes((60, 110, 190))
        return bytes((244, 238, 220))
    return png(size, size, (b"".join(pixel(x, y) for x in range(size)) for y in range(size)))


def files() -> Dict[str, bytes]:
    """Content by path below Media/models."""
    return {
        "my_object.dae": collada("my_object", carton(), ("inch", "0.0254"), "Y_UP",
                                 "1 1 1 1", "my_object/carton.png").encode(),
        "my_object/carton.png": carton_texture(),
        "lab_table.dae": collada("lab_table", table(), ("meter", "1"), "Z_UP",
                                 "0.72 0.60 0.42 1").encode(),
    }


def main(argv: Sequence[str]) -> int:
    """Writes all files."""
    folder = argv[1] if len(argv) > 1 else MEDIA
    for path, content in files().items():
        full = os.path.join(folder, path)
        os.makedirs(os.path.dirname(full), exist_ok=True)
        with open(full, "wb") as stream:
            stream.write(content)
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv))
