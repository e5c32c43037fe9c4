"""What went wrong, as the page is told."""
from __future__ import annotations

from typing import Any, Dict, List

from ...errors import CommandError, InputError, Issue, Severity


class EditRefusedError(CommandError):
    """A request that is refused for a reason the page can act on.

    Attributes:
        code: stable identifier, e.g. `exists`.
        hint: what to do.
    """

    def __init__(self, code: str, message: str, hint: str = "") -> None:
        super().__init__(message)
        self.code = code
        self.hint = hint


def issues_of(fault: Exception) -> List[Issue]:
    """The issues of what a handler raised."""
    if isinstance(fault, InputError):
        return fault.issues or [Issue(Severity.ERROR, "unusable", str(fault))]
    return [Issue(Severity.ERROR, getattr(fault, "code", "refused"), str(fault),
                  hint=getattr(fault, "hint", ""))]


def issue_document(issue: Issue) -> Dict[str, Any]:
    """The protocol's `Issue`."""
    return {"severity": issue.severity.value, "code": issue.code, "message": issue.message,
            "file": issue.file, "line": issue.line, "xpath": issue.xpath, "hint": issue.hint}
