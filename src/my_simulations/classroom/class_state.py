"""What a class keeps in its folder: tokens, and the address of the running manager."""
from __future__ import annotations

import fcntl
import json
import os
import secrets
from typing import Any, Dict, Optional

from ..errors import CommandError
from .class_plan import ClassPlan

_TOKENS, _MANAGER, _LOCK = "tokens.json", "manager.json", "lock"
TUTOR = ""
"""Key of the tutor's token; no student has this name."""


class ClassState:
    """Files in the folder `class`, which only its owner can enter.

    Args:
        plan: the class.

    Raises:
        CommandError: the folder cannot be made.
    """

    def __init__(self, plan: ClassPlan) -> None:
        self._folder = plan.state
        self._lock: Optional[int] = None
        try:
            os.makedirs(plan.folder, exist_ok=True)
            os.makedirs(self._folder, 0o700, exist_ok=True)
            os.chmod(self._folder, 0o700)
        except OSError as fault:
            raise CommandError(f"{self._folder} cannot be made: {fault.strerror}") from None

    def acquire_lock(self) -> None:
        """Lock the class for this process. Raises CommandError: another manager runs."""
        self._lock = os.open(self._path(_LOCK), os.O_RDWR | os.O_CREAT, 0o600)
        try:
            fcntl.flock(self._lock, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except OSError:
            os.close(self._lock)
            self._lock = None
            raise CommandError("the class runs already") from None

    def tokens(self, plan: ClassPlan) -> Dict[str, str]:
        """Return the tokens of tutor and students by name; create and store missing ones."""
        known = self._read(_TOKENS)
        names = (TUTOR, *(student.name for student in plan.students))
        found = {name: str(known.get(name) or secrets.token_urlsafe(24)) for name in names}
        self._write(_TOKENS, found)
        return found

    def store_address(self, address: str) -> None:
        """Store the address of the tutor's page, and the id of this process."""
        self._write(_MANAGER, {"pid": os.getpid(), "address": address})

    def manager(self) -> Dict[str, Any]:
        """Process id and address of the running manager. Raises CommandError: none runs."""
        try:
            lock = os.open(self._path(_LOCK), os.O_RDWR)
        except OSError:
            raise CommandError("the class does not run") from None
        try:
            fcntl.flock(lock, fcntl.LOCK_SH | fcntl.LOCK_NB)
        except OSError:
            return self._read(_MANAGER)
        finally:
            os.close(lock)
        raise CommandError("the class does not run")

    def _path(self, name: str) -> str:
        return os.path.join(self._folder, name)

    def _read(self, name: str) -> Dict[str, Any]:
        try:
            with open(self._path(name), encoding="utf-8") as stream:
                found: Dict[str, Any] = json.load(stream)
                return found
        except FileNotFoundError:
            return {}

    def _write(self, name: str, content: Dict[str, Any]) -> None:
        temporary = self._path(f"{name}.new")
        with open(os.open(temporary, os.O_WRONLY | os.O_CREAT | os.O_TRUNC, 0o600), "w",
                  encoding="utf-8") as stream:
            json.dump(content, stream)
        os.replace(temporary, self._path(name))
