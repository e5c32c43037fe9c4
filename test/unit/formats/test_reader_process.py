"""Files that could use up memory and time are read by another process, under limits."""
from __future__ import annotations

import io
import os
import signal
import struct
import subprocess
import sys
import time
import zlib

import numpy as np
import pytest
from PIL import Image
from reading import VALID

from my_simulations.building.building_folder import image_kind
from my_simulations.description.shapes import Heightmap, Mesh
from my_simulations.errors import InputError
from my_simulations.formats import reader_process
from my_simulations.formats.image.levels import grey_levels, levels_of, read_elevations
from my_simulations.formats.image.pixels import pixels_of, read_picture, verify_format
from my_simulations.formats.mesh import loading
from my_simulations.formats.mesh.loading import load_mesh, load_solid

WIDE = 2600
"""Pixels along a side of images that are not read in this process."""


@pytest.fixture(autouse=True)
def kept():
    """The process of this test, which ends with it."""
    process = reader_process.kept()
    process.close()
    yield process
    process.close()


def blank_png(path, side):
    """A black picture of a few kB."""
    def chunk(kind, data):
        return (struct.pack(">I", len(data)) + kind + data
                + struct.pack(">I", zlib.crc32(kind + data)))

    rows = zlib.compress(bytes(side * (side + 1)), 9)
    path.write_bytes(b"\x89PNG\r\n\x1a\n" + chunk(
        b"IHDR", struct.pack(">IIBBBBB", side, side, 8, 0, 0, 0, 0)) + chunk(b"IDAT", rows)
        + chunk(b"IEND", b""))
    return str(path)


def doubling(path, levels, sets=1):
    """COLLADA of some kB with 2 ** `levels` instances of so many sets of one triangle."""
    with open(os.path.join(VALID, "inch_y_up.dae"), encoding="utf-8") as stream:
        text = stream.read()
    triangles = text[text.index("<triangles"):text.index("</mesh>")]
    text = text.replace(triangles, triangles * sets)
    head, tail = text.split("<library_visual_scenes>")
    nodes = '<node id="n0"><instance_geometry url="#g"/></node>' + "".join(
        f'<node id="n{n}">' + f'<instance_node url="#n{n - 1}"/>' * 2 + "</node>"
        for n in range(1, levels + 1))
    geometry = text.split('<geometry id="')[1].split('"')[0]
    scene = text.split('<visual_scene id="')[1].split('"')[0]
    path.write_text(
        f"{head}<library_nodes>{nodes.replace('#g', '#' + geometry)}</library_nodes>"
        f'<library_visual_scenes><visual_scene id="{scene}"><node><instance_node '
        f'url="#n{levels}"/></node></visual_scene></library_visual_scenes>'
        f"{tail.split('</library_visual_scenes>')[1]}", encoding="utf-8")
    return Mesh(path.name, str(path))


def triangle(path):
    """PLY of one triangle: another process reads it, as it does all files of rare formats."""
    path.write_text("ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\n"
                    "property float z\nelement face 1\nproperty list uchar int vertex_indices\n"
                    "end_header\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n", encoding="utf-8")
    return Mesh(path.name, str(path))


def test_plain_files_are_read_without_another_process(kept, tmp_path):
    for name in ("inch_y_up.dae", "cube.stl", "two_parts.obj"):
        load_mesh(Mesh(name, os.path.join(VALID, name)))
    load_solid(Heightmap(uri="m", path=blank_png(tmp_path / "small.png", 64)))
    assert kept.pid == 0


def test_another_process_reads_the_same(kept, tmp_path, monkeypatch):
    monkeypatch.setattr(reader_process, "_KEPT_S", 600.0)  # the expected result may take 20 s
    mesh = doubling(tmp_path / "many.dae", 14)
    data = load_mesh(mesh)
    pid = kept.pid
    assert pid > 0
    vertices, triangles = loading.triangles_of(mesh.path, "")
    assert np.array_equal(data.vertices, vertices)
    assert np.array_equal(data.triangles, triangles)
    rows = np.arange(WIDE * WIDE, dtype=np.uint32).reshape(WIDE, WIDE)
    for form, values in (("png", (rows % 251).astype(np.uint8)),
                         ("png", (rows % 65521).astype(np.uint16))):
        path = str(tmp_path / f"{values.dtype}.{form}")
        Image.fromarray(values).save(path)
        found, expected = grey_levels(path, 1025), levels_of(path, 1025, 1)
        assert found.white == expected.white and np.array_equal(found.values, expected.values)
    path = str(tmp_path / "heights.tif")
    Image.fromarray(rows.astype(np.float32) / WIDE).save(path)
    heights = read_elevations(path, 65)
    assert heights is not None and heights.shape == (WIDE, WIDE) and heights.extent is None
    assert heights.highest == pytest.approx(WIDE, rel=1e-3)
    coloured = str(tmp_path / "coloured.png")
    Image.fromarray(np.stack([rows % 256] * 3, axis=2).astype(np.uint8)).save(coloured)
    assert np.array_equal(read_picture(coloured, 1024), pixels_of(coloured, 1024))
    assert kept.pid == pid  # one process for all


def test_memory_is_limited_and_the_next_file_is_read(kept, tmp_path, monkeypatch):
    path = blank_png(tmp_path / "bomb.png", 7000)
    monkeypatch.setattr(reader_process, "MEMORY", 2 << 20)
    with pytest.raises(InputError, match="MB of memory|cannot be read") as refused:
        grey_levels(path, 1025)
    assert refused.value.first.code == "image-unreadable" and refused.value.first.file == path
    monkeypatch.undo()
    assert grey_levels(path, 1025).values.shape == (1000, 1000)


def test_the_limit_of_processor_time_grows_with_the_file(kept, tmp_path, monkeypatch):
    asked = []
    monkeypatch.setattr(kept, "send_request",
                        lambda request, *_: asked.append(request) or ({"value": 0}, []))
    for megabytes in (0, 10, 50):
        with open(tmp_path / "mesh.ply", "wb") as stream:
            stream.truncate(megabytes * 1_000_000)
        reader_process.read_elsewhere("mesh", stream.name, "mesh-unreadable")
    assert [request["seconds"] for request in asked] == [4, 6, 14]


def test_an_obj_file_of_many_groups_is_read_by_another_process(kept, tmp_path):
    corners = "v 0 0 0\nv 1 0 0\nv 0 1 0\n"
    for count, reads_elsewhere in ((2000, False), (2001, True)):
        path = tmp_path / f"{count}.obj"
        path.write_text(corners + "".join(f"g {n}\nf 1 2 3\n" for n in range(count)))
        assert len(load_mesh(Mesh(path.name, str(path))).triangles) == count
        assert bool(kept.pid) is reads_elsewhere


def test_processor_time_is_limited(kept, tmp_path, monkeypatch):
    mesh = doubling(tmp_path / "million.dae", 40, sets=20)
    monkeypatch.setattr(reader_process, "SECONDS", 0)
    with pytest.raises(InputError, match="processor time") as refused:
        load_mesh(mesh)
    assert refused.value.first.code == "mesh-unreadable"
    monkeypatch.undo()
    assert len(load_mesh(triangle(tmp_path / "next.ply")).triangles) == 1


def test_a_process_that_was_killed_is_replaced(kept, tmp_path):
    load_mesh(triangle(tmp_path / "first.ply"))
    first = kept.pid
    assert first > 0
    os.kill(first, signal.SIGKILL)
    os.waitid(os.P_PID, first, os.WEXITED | os.WNOWAIT)
    assert len(load_mesh(triangle(tmp_path / "next.ply")).triangles) == 1
    assert kept.pid not in (0, first)


def test_what_the_readers_raise_is_told_with_the_file(kept, tmp_path):
    path = tmp_path / "broken.ply"
    path.write_text("ply\nformat ascii 1.0\nelement vertex x\n", encoding="utf-8")
    with pytest.raises(InputError) as refused:
        load_mesh(Mesh("broken.ply", str(path)))
    assert refused.value.first.code == "mesh-unreadable" and refused.value.first.file == str(path)
    assert kept.pid > 0


def test_no_other_program_is_started_for_a_picture(tmp_path, monkeypatch):
    ran = tmp_path / "ran"
    program = tmp_path / "gs"
    program.write_text(f"#!/bin/sh\ntouch {ran}\n", encoding="utf-8")
    program.chmod(0o755)
    monkeypatch.setenv("PATH", f"{tmp_path}:{os.environ['PATH']}")
    path = tmp_path / "terrain.png"
    path.write_text("%!PS-Adobe-3.0 EPSF-3.0\n%%BoundingBox: 0 0 9 9\n%%EndComments\n",
                    encoding="ascii")
    with pytest.raises(InputError, match="no known format"):
        load_solid(Heightmap(uri="m", path=str(path)))
    assert read_picture(str(path), 64) is None and not ran.exists()



def many_scans(side, scans):
    """A progressive JPEG whose last scan stands there again and again."""
    written = io.BytesIO()
    Image.new("L", (side, side), 128).save(written, "JPEG", progressive=True)
    data = written.getvalue()
    last = data.rindex(b"\xff\xda")
    header = data.rindex(b"\xff\xc4", 0, last) if b"\xff\xc4" in data[:last] else last
    scan = data[header:-2]
    return data[:-2] + scan * scans + data[-2:]


def test_a_picture_of_many_scans_or_pixels_is_checked_by_another_process(kept, tmp_path):
    assert verify_format(many_scans(64, 10)) == "JPEG" and kept.pid == 0
    assert verify_format(many_scans(64, 2000)) == "JPEG"
    pid = kept.pid
    assert pid > 0
    with open(blank_png(tmp_path / "wide.png", WIDE), "rb") as stream:
        content = stream.read()
    assert verify_format(content) == "PNG" and kept.pid == pid
    with pytest.raises(InputError, match="truncated") as refused:
        verify_format(content[:-40])
    assert refused.value.first.code == "image-unreadable"


FROM_A_LARGE_PROCESS = """
import sys
from my_simulations.formats.reader_process import kept, read_elsewhere
content = b"x" * (600 << 20)
del content
pids = set()
for _ in range(2):
    read_elsewhere("format", sys.argv[1], "image-unreadable")
    pids.add(kept().pid)
kept().close()
print(len(pids))
"""


def test_the_reader_of_a_process_that_was_large_serves_more_than_one_file(tmp_path):
    path = blank_png(tmp_path / "small.png", 8)
    done = subprocess.run([sys.executable, "-c", FROM_A_LARGE_PROCESS, str(path)], check=True,
                          stdout=subprocess.PIPE, timeout=120)
    assert done.stdout.split() == [b"1"]


def test_a_floor_plan_that_takes_too_long_to_decode_is_refused(kept, monkeypatch):
    monkeypatch.setattr(reader_process, "SECONDS", 0)
    began = time.process_time()
    with pytest.raises(InputError, match="'plan.jpg' cannot be used: .* processor time") as refused:
        image_kind(many_scans(1900, 20_000), "plan.jpg")
    assert refused.value.first.code == "image-unreadable"
    assert time.process_time() - began < 2.0  # it decoded nothing here


def test_a_texture_of_many_scans_is_read_by_another_process(kept, tmp_path):
    path = tmp_path / "texture.jpg"
    path.write_bytes(many_scans(64, 2000))
    assert read_picture(str(path), 64).shape == (64, 64, 4) and kept.pid > 0
