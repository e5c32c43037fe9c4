"""Elevation models of 64-bit numbers, as GDAL writes them."""
import struct
import zlib

import numpy as np
import pytest
from PIL import Image, UnidentifiedImageError

from my_simulations.description.shapes import Heightmap
from my_simulations.errors import InputError
from my_simulations.formats.image import float64_tiff, pixels
from my_simulations.formats.image.levels import read_elevations
from my_simulations.formats.mesh.terrain import solid_mesh

NO_DATA = "-99999.99"
HEIGHTS = np.array([[1.5, 2.25, -3.0, 0.0, 7.0], [float(NO_DATA), 5.0, 6.0, 8.0, 9.0],
                    [10.0, 11.0, 12.0, 13.0, 4000.125]])
SHOWN = np.where(float(NO_DATA) == HEIGHTS, -3.0, HEIGHTS)


def predicted(block):
    """The floating-point predictor: the bytes of each rank together, and then differences."""
    rows, columns = block.shape
    planes = block.astype(">f8").view(np.uint8).reshape(rows, columns, 8).transpose(0, 2, 1)
    flat = planes.reshape(rows, columns * 8)
    return np.diff(flat, axis=1, prepend=np.zeros((rows, 1), np.uint8)).astype(np.uint8).tobytes()


def tiff(heights, order="<", compression=1, predictor=1, tile=0, strip=2):
    """A GeoTIFF whose pixels are half a metre wide."""
    height, width = heights.shape
    blocks = []
    for top in range(0, height, tile or strip):
        for left in range(0, width, tile or width):
            block = heights[top:top + (tile or strip), left:left + (tile or width)]
            if tile:
                block = np.pad(block, ((0, tile - block.shape[0]), (0, tile - block.shape[1])))
            data = predicted(block) if predictor == 3 else block.astype(f"{order}f8").tobytes()
            blocks.append(zlib.compress(data) if compression != 1 else data)
    tags = {256: ("H", [width]), 257: ("H", [height]), 258: ("H", [64]), 259: ("H", [compression]),
            262: ("H", [1]), 277: ("H", [1]), 317: ("H", [predictor]), 339: ("H", [3]),
            33550: ("d", [0.5, 0.5, 0.0]), 33922: ("d", [0.0] * 6),
            34735: ("H", [1, 1, 0, 1, 1024, 0, 1, 1]), 42113: ("s", NO_DATA.encode() + b"\0")}
    tags.update({322: ("H", [tile]), 323: ("H", [tile])} if tile else {278: ("H", [strip])})
    kinds = {"H": (3, 2), "I": (4, 4), "d": (12, 8), "s": (2, 1)}
    places, at = [], 8
    for block in blocks:
        places.append(at)
        at += len(block)
    tags[324 if tile else 273] = ("I", places)
    tags[325 if tile else 279] = ("I", [len(block) for block in blocks])
    rows, behind, start = b"", b"", at + 2 + 12 * len(tags) + 4
    for tag, (kind, values) in sorted(tags.items()):
        packed = values if kind == "s" else struct.pack(f"{order}{len(values)}{kind}", *values)
        number, size = kinds[kind]
        if len(packed) <= 4:
            value = packed.ljust(4, b"\0")
        else:
            value = struct.pack(f"{order}I", start + len(behind))
            behind += packed
        rows += struct.pack(f"{order}HHI", tag, number, len(packed) // size) + value
    head = b"II*\0" if order == "<" else b"MM\0*"
    return (head + struct.pack(f"{order}I", at) + b"".join(blocks)
            + struct.pack(f"{order}H", len(tags)) + rows + bytes(4) + behind)


def written(tmp_path, *arguments, **options):
    path = tmp_path / "dem.tif"
    path.write_bytes(tiff(*arguments, **options))
    return str(path)


@pytest.mark.parametrize("options", [
    {}, {"order": ">"}, {"strip": 1}, {"strip": 3}, {"compression": 8}, {"compression": 32946},
    {"compression": 8, "predictor": 3}, {"compression": 8, "predictor": 3, "order": ">"},
    {"tile": 2}, {"tile": 4, "compression": 8, "predictor": 3}], ids=str)
def test_heights_of_64_bits_are_read(tmp_path, options):
    path = written(tmp_path, HEIGHTS, **options)
    with pytest.raises(UnidentifiedImageError):
        Image.open(path)
    found = read_elevations(path, 0)
    assert found.heights.tolist() == SHOWN.tolist()
    assert (found.lowest, found.highest, found.extent) == (-3.0, 4000.125, (2.5, 1.5))


def test_they_make_a_terrain(tmp_path):
    path = written(tmp_path, HEIGHTS)
    mesh = solid_mesh(Heightmap(path, path, (50.0, 30.0, 10.0), (0, 0, 0), 1))
    spread = mesh.vertices.max(axis=0) - mesh.vertices.min(axis=0)
    assert spread == pytest.approx((50.0, 30.0, 10.0))


@pytest.mark.parametrize("options, said", [
    ({"compression": 5}, "gdal_translate -ot Float32"),
    ({"compression": 8, "predictor": 2}, "predictor 2")], ids=str)
def test_what_cannot_be_read_is_named(tmp_path, options, said):
    with pytest.raises(InputError, match=said):
        read_elevations(written(tmp_path, HEIGHTS, **options), 0)


@pytest.mark.filterwarnings("ignore:Corrupt EXIF data", "ignore:Truncated File")
def test_damaged_files_are_refused(tmp_path):
    whole = tiff(HEIGHTS, compression=8)
    path = tmp_path / "dem.tif"
    for changed in (whole[:8] + bytes(20) + whole[28:],
                    tiff(HEIGHTS).replace(struct.pack("<HHIH", 257, 3, 1, 3),
                                          struct.pack("<HHIH", 257, 3, 1, 300)),
                    *(whole[:length] for length in range(0, len(whole) // 2, 5))):
        path.write_bytes(changed)
        with pytest.raises(InputError):
            read_elevations(str(path), 0)


def test_large_ones_are_read_in_another_process_and_too_large_ones_are_refused(
        tmp_path, monkeypatch):
    monkeypatch.setattr(pixels, "_PLAIN_PIXELS", 10)
    path = written(tmp_path, HEIGHTS)
    assert float64_tiff.pixels_in(tiff(HEIGHTS)) == 15 and pixels.is_costly(path)
    assert read_elevations(path, 0).heights.tolist() == SHOWN.tolist()
    monkeypatch.setattr(pixels, "MOST_PIXELS", 14)
    with pytest.raises(ValueError, match="5 x 3 pixels"):
        pixels.open_image(path)
