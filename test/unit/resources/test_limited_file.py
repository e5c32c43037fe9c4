"""Limited reading of files: small files whole, the beginning of large ones, bounded memory."""
import os
import threading
import tracemalloc

import pytest

from my_simulations.formats.image.pixels import is_costly
from my_simulations.formats.xml.parsing import read_content
from my_simulations.objects.yaml_source import read_yaml
from my_simulations.resources.limited_file import at_most

PIXEL = bytes.fromhex("89504e470d0a1a0a0000000d4948445200000001000000010806000000"
                      "1f15c4890000000b49444154789c6360000200000500017a5eab3f0000000049454e44ae426082")
READERS = {"list": (lambda path: read_yaml(path, "/objects"), b"a: {model: box}"),
           "document": (read_content, b"<sdf version='1.6'/>"), "image": (is_costly, PIXEL)}


@pytest.mark.parametrize("size", [0, 1, 99, 100])
def test_a_file_that_is_not_too_large_is_read_whole(tmp_path, size):
    path = tmp_path / "file"
    path.write_bytes(b"x" * size)
    with open(path, "rb") as stream:
        assert at_most(stream, 100) == b"x" * size


def test_of_a_larger_file_one_byte_more_than_the_limit_is_read(tmp_path):
    path = tmp_path / "file"
    path.write_bytes(b"x" * 1000)
    with open(path, "rb") as stream:
        assert at_most(stream, 100) == b"x" * 101


def test_a_pipe_is_read_as_far_as_a_file(tmp_path):
    path = tmp_path / "pipe"
    os.mkfifo(path)
    writer = threading.Thread(target=lambda: path.write_bytes(b"x" * 1000))
    writer.start()
    with open(path, "rb") as stream:
        assert at_most(stream, 2000) == b"x" * 1000
    writer.join()


@pytest.mark.parametrize("kind", READERS)
def test_a_small_file_takes_no_room_for_the_largest(tmp_path, kind):
    read, text = READERS[kind]
    path = str(tmp_path / "file")
    with open(path, "wb") as stream:
        stream.write(text)
    read(path)  # its modules are loaded
    tracemalloc.start()
    try:
        read(path)
        assert tracemalloc.get_traced_memory()[1] < 500_000
    finally:
        tracemalloc.stop()
