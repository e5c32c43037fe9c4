"""Prints the URL of the editor, and opens it in a browser if there is a display."""
from __future__ import annotations

import os
import sys
from typing import Mapping

NO_BROWSER = "MY_SIMULATIONS_NO_BROWSER"
"""Environment variable; if set, no browser is started."""


def has_display(environment: Mapping[str, str] = os.environ) -> bool:
    """Whether a browser window can be opened."""
    if environment.get(NO_BROWSER):
        return False
    return bool(environment.get("DISPLAY") or environment.get("WAYLAND_DISPLAY"))


def show(url: str, program: str) -> None:
    """Print the URL, and open it if there is a display."""
    print(f"{program}: the world editor is at {url}", flush=True)
    if not has_display():
        return
    import webbrowser

    try:
        opened = webbrowser.open(url)
    except webbrowser.Error:
        opened = False
    if not opened:
        print(f"{program}: cannot start a browser; open the URL yourself",
              file=sys.stderr, flush=True)
