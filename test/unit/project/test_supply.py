"""What the set-up brings along: pinned, hashed and listed; and the oldest Python that reads it."""
from __future__ import annotations

import ast
import importlib.util
import json
import subprocess
import sys
from pathlib import Path

import pytest

REPOSITORY = Path(__file__).resolve().parents[3]


@pytest.mark.parametrize("lock", ["web/package-lock.json", "tools/page_bundler/package-lock.json",
                                  "test/page/package-lock.json"])
def test_every_package_of_the_page_is_pinned_by_its_hash(lock):
    packages = json.loads((REPOSITORY / lock).read_text())["packages"]
    assert [path for path, entry in packages.items()
            if path and not entry.get("integrity", "").startswith("sha512-")] == []


def test_what_the_set_up_installs_can_be_listed():
    program = REPOSITORY / "tools" / "generate" / "sbom.py"
    done = subprocess.run([sys.executable, str(program)], check=True, capture_output=True,
                          text=True)
    listed = json.loads(done.stdout)["components"]
    kinds = {entry["purl"].partition("/")[0] for entry in listed}
    assert kinds == {"pkg:pypi", "pkg:npm", "pkg:deb"}
    names = {entry["name"].lower() for entry in listed}
    assert {"pybullet", "lxml", "three", "esbuild", "python3-venv"} <= names


PYTHON = [path for folder in ("src", "compat", "scripts", "tools", "test")
          for path in sorted((REPOSITORY / folder).rglob("*.py"))
          if "node_modules" not in path.parts]


def test_the_oldest_python_can_read_every_file():
    assert len(PYTHON) > 400
    for path in PYTHON:
        ast.parse(path.read_text(encoding="utf-8"), str(path), feature_version=(3, 8))


def test_the_figures_of_proofs_become_a_table():
    spec = importlib.util.spec_from_file_location(
        "reliability_table", REPOSITORY / "tools" / "generate" / "reliability_table.py")
    table = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(table)
    record = {"proof": "soak", "test": "test/reliability/test_soak.py::test_x", "long": False,
              "seconds": 21, "figures": {"models": 53}}
    text = table.rows([{**record, "seconds": 1}, record])
    assert text.splitlines()[2:] == ["| soak | models 53 | 21 s | `test_soak.py::test_x` |"]
    fuzzed = [{**record, "proof": name, "figures": {"inputs": 500, "slowest_ms": 3}}
              for name in ("one", "other")]
    assert table.rows(fuzzed).endswith("|\n\nInputs in all: 1000, of 2 proofs.")
    page = (REPOSITORY / "doc" / "dev" / "reliability.md").read_text(encoding="utf-8")
    assert text in table.with_table(page, "short runs", text)
    before = table.table_of(page, "short runs")
    kept = table.rows([record], before).splitlines()
    assert set(before.splitlines()) - set(kept) == {
        line for line in before.splitlines() if line.startswith("| soak |")}
    gone = "\n".join([*text.splitlines()[:2], "| old | x 1 | 1 s | `test_soak.py::test_gone` |"])
    assert table.rows([], gone).splitlines() == text.splitlines()[:2]
