"""Object lists written to do harm, or by accident: every fault has a file, a line and a key."""
from __future__ import annotations

import pytest

from my_simulations.errors import InputError
from my_simulations.objects.guarded_yaml import DEEPEST, LARGEST
from my_simulations.objects.yaml_source import read_yaml

LAUGHS = "a0: &a0 [1, 1, 1, 1, 1, 1, 1, 1, 1, 1]\n" + "".join(
    f"a{n}: &a{n} [{', '.join([f'*a{n - 1}'] * 10)}]\n" for n in range(1, 12))
MERGES = "a0: &a0 {x: 1}\n" + "".join(
    f"a{n}: &a{n} {{<<: [{', '.join([f'*a{n - 1}'] * 10)}], k{n}: 1}}\n" for n in range(1, 12))

FAULTS = {
    "control": (b"lamp:\n  model: a\n  name: \x01\n", 3, "", "special characters"),
    "escaped-control": (b'lamp:\n  model: "a\\x01b"\n', 2, "/lamp/model", "U+0001 at position 2"),
    "escaped-surrogate": (b'lamp:\n  model: "\\uD800"\n', 2, "/lamp/model", "U+D800"),
    "escaped-nul": (b'lamp:\n  model: "\\0"\n', 2, "/lamp/model", "U+0000"),
    "not-utf8": (b"lamp:\n  model: \xff\n", 2, None, "UTF-8"),
    "python-tag": (b"lamp:\n  model: !!python/object/apply:os.system [ls]\n", 2, "/lamp/model",
                   "could not determine a constructor"),
    "other-tag": (b"lamp:\n  model: !thing x\n", 2, "/lamp/model", "constructor"),
    "bad-date": (b"lamp:\n  model: !!timestamp 2020-13-45\n", 2, "/lamp/model", "invalid"),
    "bad-timestamp": (b"lamp:\n  model: !!timestamp x\n", 2, "/lamp/model", "invalid timestamp"),
    "bad-number": (b"lamp:\n  position: [!!int abc, 0, 0]\n", 2, "/lamp/position", "invalid int"),
    "endless-hex": (b"lamp:\n  model: 0x" + b"f" * 5000, 2, "/lamp/model", "more than 1000"),
    "endless-number": (b"lamp:\n  model: " + b"9" * 5000, 2, "/lamp/model", "more than 1000"),
    "bad-bool": (b"lamp:\n  model: !!bool maybe\n", 2, "/lamp/model", "invalid bool"),
    "bad-binary": (b"lamp:\n  model: !!binary \xc3\xa4\n", 2, "/lamp/model", "base64"),
    "list-as-key": (b"lamp:\n  ? [a]\n  : 1\n", 2, "/lamp", "unhashable"),
    "deep-flow": (b"lamp:\n  model: " + b"[" * 5000 + b"]" * 5000, 2, "/lamp/model",
                  "nested deeper"),
    "deep-block": (b"".join(b" " * n + b"a:\n" for n in range(3000)), DEEPEST, "/a" * (DEEPEST - 1),
                   "deeper"),
    "laughs": (LAUGHS.encode(), 5, "/a4", "more than 100000 values"),
    "merges": (MERGES.encode(), 6, "/a5/<<", "more than 100000 values"),
    "own-part": (b"lamp: &lamp\n  children: *lamp\n", 2, "/lamp/children",
                 "alias refers to itself"),
    "nothing-named": (b"lamp: *nowhere\n", 1, "/lamp", "undefined alias"),
    "two-documents": (b"a: 1\n---\nb: 2\n", 2, "", "another document"),
}


@pytest.mark.parametrize("name", FAULTS)
def test_a_fault_is_told_with_file_line_and_key(name, tmp_path):
    data, line, key, words = FAULTS[name]
    path = tmp_path / "list.yaml"
    path.write_bytes(data)
    with pytest.raises(InputError) as raised:
        read_yaml(str(path), "/objects")
    [issue] = raised.value.issues
    assert (issue.file, issue.line) == (str(path), line)
    assert words in issue.message
    assert key is None or issue.xpath == "/objects" + key


def test_a_file_that_is_far_too_large_is_not_read(tmp_path):
    path = tmp_path / "list.yaml"
    path.write_bytes(b"# " + b"x" * LARGEST)
    with pytest.raises(InputError, match="bytes"):
        read_yaml(str(path), "/objects")


def test_names_and_paths_that_look_like_dates_stay_texts(tmp_path):
    path = tmp_path / "list.yaml"
    path.write_text("2020-01-02:\n  model: 2020-13-45\n  at: 2001-12-14t21:59:43.10-05:00\n")
    data, _, _ = read_yaml(str(path), "/objects")
    assert data == {"2020-01-02": {"model": "2020-13-45", "at": "2001-12-14t21:59:43.10-05:00"}}


def test_aliases_and_merges_of_usual_size_work(tmp_path):
    path = tmp_path / "list.yaml"
    path.write_text("base: &base {model: a, position: [0, 0, 0]}\nlamp:\n  <<: *base\n  model: b\n"
                    "again: *base\n")
    data, source, issues = read_yaml(str(path), "/objects")
    assert data["lamp"] == {"model": "b", "position": [0, 0, 0]} and data["again"] == data["base"]
    assert source.where(("lamp", "model"))["line"] == 4 and issues == []
