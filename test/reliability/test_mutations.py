"""Files of the project with damaged bytes are read or refused."""
from __future__ import annotations

import os
import random
from collections import Counter
from pathlib import Path
from typing import List, Tuple

import pytest
from mutant_readers import read_document
from mutant_run import Target, prove
from proofs import scaled

from my_simulations.errors import InputError
from my_simulations.formats.mesh.loading import triangles_of
from my_simulations.objects.object_list import parse_objects
from my_simulations.objects.yaml_source import read_yaml
from my_simulations.resources.resolver import Resolver

INPUTS = int(os.environ.get("MY_SIMULATIONS_MUTATIONS") or scaled(600, 10_000_000))
ROOT = Path(__file__).resolve().parents[2]
NAMES_KEPT = 120.0
"""Bytes of a file: libxml2 keeps names that it had not met, 48 to 78 bytes each."""

SMALL = 6000
"""Bytes of a file that is damaged; small ones are read fast, and have most elements too."""

DOCUMENTS, MESHES, LISTS = (".sdf", ".world", ".urdf"), (".dae", ".stl", ".obj"), (".yaml",)
PIECES = (b"", b"\0", b"nan", b"1e999", b"-1", b"99999999999", b"<a>", b"</", b"&#0;", b"\xff\xfe",
          b"\xed\xa0\x80", b"]]>", b"- ", b"*a", b"&a ", b"../", b"2147483648", b" ", b"'")


def corpus() -> List[Path]:
    """Small files of all kinds that are read."""
    found = [path for folder in ("test/data", "models", "world", "config", "examples", "objects")
             for path in sorted((ROOT / folder).rglob("*"))
             if path.suffix in DOCUMENTS + MESHES + LISTS and path.stat().st_size <= SMALL]
    assert {path.suffix for path in found} >= {".sdf", ".world", ".urdf", ".dae", ".yaml"}
    return found


def damaged(data: bytes, others: List[bytes], chance: random.Random) -> bytes:
    """The bytes with up to four slices replaced, by others of the file or of another one."""
    for _ in range(chance.randint(1, 4)):
        start = chance.randint(0, len(data))
        end = min(len(data), start + int(chance.expovariate(0.1)))
        kind = chance.randrange(4)
        if kind == 0:
            put = chance.choice(PIECES)
        elif kind == 1:
            put = data[start:end] * chance.choice((0, 2, 2, 3))
        elif kind == 2:
            other = chance.choice(others)
            at = chance.randint(0, len(other))
            put = other[at:at + int(chance.expovariate(0.02))]
        else:
            put = bytes(chance.randrange(256) for _ in range(end - start))
        data = data[:start] + put + data[end:]
    return data


@pytest.mark.usefixtures("silent")
def test_damaged_files_are_read_or_refused(record, tmp_path):
    outcomes: Counter = Counter()
    resolver = Resolver()
    files = corpus()
    contents = [path.read_bytes() for path in files]

    def feed(made: Tuple[str, bytes]) -> Tuple[()]:
        suffix, data = made
        refused = False
        path = tmp_path / f"damaged{suffix}"
        if suffix in MESHES + LISTS:
            path.write_bytes(data)
        try:
            if suffix in MESHES:
                triangles_of(str(path), "")
            elif suffix in LISTS:
                tree, source, _ = read_yaml(str(path), "/objects")
                parse_objects(tree, source)
            else:
                refused = read_document(data, resolver)[0] == "refused"
            outcomes["refused" if refused else "read"] += 1
        except InputError as fault:
            assert fault.issues
            outcomes["refused"] += 1
        return ()

    def damage(at: int, chance: random.Random) -> Tuple[str, bytes]:
        return files[at].suffix, damaged(contents[at], contents, chance)

    prove(Target("damaged files", list(range(len(files))), damage, lambda made, chance: made, feed,
                 made="", kept_bytes=NAMES_KEPT),
          INPUTS, record, tmp_path / "found", files=lambda: len(files),
          read=lambda: outcomes["read"], refused=lambda: outcomes["refused"])
