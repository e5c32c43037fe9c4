"""A process that reads files one by one, and is replaced when one of them ends or stops it."""
from __future__ import annotations

import json
import os
import select
import subprocess
import sys
from typing import Any, Dict, Mapping, Optional

_HERE = os.path.abspath(__file__)
_SOURCES = os.path.join(os.path.dirname(_HERE), "..", "..", "src")


class Worker:
    """Asks a child process to read files.

    Args:
        environment: of the child.
        seconds: after which a file counts as hanging.
    """

    def __init__(self, environment: Mapping[str, str], seconds: float) -> None:
        self._environment = environment
        self._seconds = seconds
        self._child: Optional["subprocess.Popen[bytes]"] = None

    def read(self, path: str) -> Dict[str, Any]:
        """`issues` of a file, or `end`: "crash" or "hang"."""
        child = self._child or self._start()
        assert child.stdin is not None and child.stdout is not None
        child.stdin.write(json.dumps(path).encode() + b"\n")
        child.stdin.flush()
        if not select.select([child.stdout], [], [], self._seconds)[0]:
            self.close()
            return {"end": "hang"}
        line = child.stdout.readline()
        if not line:
            self.close()
            return {"end": "crash"}
        answer: Dict[str, Any] = json.loads(line)
        return answer

    def _start(self) -> "subprocess.Popen[bytes]":
        path = os.pathsep.join(filter(None, [_SOURCES, self._environment.get("PYTHONPATH")]))
        self._child = subprocess.Popen(
            [sys.executable, _HERE], stdin=subprocess.PIPE, stdout=subprocess.PIPE,
            env={**self._environment, "PYTHONPATH": path})
        return self._child

    def close(self) -> None:
        """End the child."""
        if self._child is not None:
            self._child.kill()
            self._child.communicate()
            self._child = None


def _serve() -> None:
    """The child: a path a line comes in, what was found goes out."""
    from my_simulations.cli.check_model_command import check
    from my_simulations.resources.resolver import Resolver

    answers = os.fdopen(os.dup(1), "w")
    os.dup2(2, 1)  # whatever a library prints does not belong among the answers
    resolver = Resolver.from_environment()
    for line in sys.stdin:
        path = json.loads(line)
        _, issues = check(path, resolver, any_xacro=True)
        print(json.dumps({"issues": [
            {"severity": issue.severity.value, "code": issue.code, "message": issue.message,
             "file": issue.file, "line": issue.line, "tolerated": issue.tolerated}
            for issue in issues]}), file=answers, flush=True)


if __name__ == "__main__":
    _serve()
