#!/usr/bin/env python3
"""Prints what the set-up installs, with versions and licences, as a CycloneDX 1.5 document.

usage: sbom.py [PYTHON]   PYTHON: the interpreter of the workspace's environment (default: this one)

Python packages are those of the environment, system packages those of tools/apt-packages*.txt,
packages of the page those of web/package-lock.json.
"""
from __future__ import annotations

import json
import subprocess
import sys
from pathlib import Path
from typing import Any, Dict, Iterator, List

REPOSITORY = Path(__file__).resolve().parents[2]

LIST = """
import importlib.metadata as found, json
print(json.dumps([[one.metadata["Name"], one.version, one.metadata["License-Expression"]
                   or (one.metadata["License"] or "").strip().split("\\n")[0][:80]]
                  for one in found.distributions()]))
"""


def component(kind: str, name: str, version: str, licence: str = "") -> Dict[str, Any]:
    """One entry, with its package URL."""
    made: Dict[str, Any] = {"type": "library", "name": name, "version": version,
                            "purl": f"pkg:{kind}/{name}@{version}"}
    if licence:
        made["licenses"] = [{"license": {"name": licence}}]
    return made


def python_packages(python: str) -> Iterator[Dict[str, Any]]:
    done = subprocess.run([python, "-c", LIST], check=True, capture_output=True, text=True)
    unique = {name.lower(): (name, version, licence)
              for name, version, licence in json.loads(done.stdout) if name}
    for _, entry in sorted(unique.items()):
        yield component("pypi", *entry)


def system_packages() -> Iterator[Dict[str, Any]]:
    """Those that are named for the set-up; without a version where they are not installed."""
    names: List[str] = []
    for path in sorted((REPOSITORY / "tools").glob("apt-packages*.txt")):
        lines = (line.partition("#")[0].split() for line in path.read_text().splitlines())
        names += [words[0] for words in lines if words]
    for name in sorted(set(names)):
        done = subprocess.run(["dpkg-query", "-W", "-f", "${Version}", name], check=False,
                              capture_output=True, text=True)
        yield component("deb/debian", name, done.stdout.strip())


def page_packages() -> Iterator[Dict[str, Any]]:
    """Of the editor's page, with the hash that npm checks."""
    packages: Dict[str, Any] = {}
    for folder in ("web", "tools/page_bundler"):
        packages.update(json.loads(
            (REPOSITORY / folder / "package-lock.json").read_text())["packages"])
    for path, entry in sorted(packages.items()):
        if path:
            made = component("npm", path.rpartition("node_modules/")[2], entry["version"],
                             entry.get("license", ""))
            made["properties"] = [{"name": "integrity", "value": entry.get("integrity", "")}]
            yield made


def document(python: str) -> Dict[str, Any]:
    return {"bomFormat": "CycloneDX", "specVersion": "1.5", "version": 1, "components": [
        *python_packages(python), *page_packages(), *system_packages()]}


if __name__ == "__main__":
    print(json.dumps(document(sys.argv[1] if len(sys.argv) > 1 else sys.executable), indent=1))
