"""Finds out whether this system permits boxes with namespaces."""
from __future__ import annotations

import json
import os
import subprocess
import sys
import tempfile

from . import box

_SECONDS = 60.0
_WANTED = {"processes", "network", "files", "loopback"}


def isolation_fault() -> str:
    """Return why namespaces cannot isolate submissions; "" if they can."""
    with tempfile.TemporaryDirectory(prefix="my_simulations_grade_") as scratch:
        spec = {"parent": os.getpid(), "seconds": _SECONDS, "environment": dict(os.environ),
                "command": ["sh", "-c", "echo \"$BOX_ISOLATION\""], "scratch": scratch,
                "bytes": 1 << 20, "copy": [], "hidden": [], "kept": [], "descriptors": [],
                "namespaces": True}
        done = subprocess.run([sys.executable, "-I", box.__file__], input=json.dumps(spec),
                              capture_output=True, text=True, timeout=2 * _SECONDS)
    missing = _WANTED - set(done.stdout.strip().split(","))
    if not missing:
        return ""
    return f"this system does not permit namespaces for {', '.join(sorted(missing))}"
