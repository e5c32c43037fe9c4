"""Models that the checks of an assignment name, and that its world does not have."""
from __future__ import annotations

from typing import Iterable, List, Set

from .assignment import Timed, signals_of

_WITHOUT_MODELS = ("time", "vary")


def unknown_models(check: Timed, known: Iterable[str]) -> List[str]:
    """The names of models that a check reads and that are not among the known ones."""
    named: Set[str] = set()
    for signal in signals_of(check):
        if signal.kind not in _WITHOUT_MODELS:
            named.update(name.partition("::")[0] for name in signal.names)
    return sorted(named - set(known))
