"""Showing an address: in a browser where there is a display, in words everywhere."""
from __future__ import annotations

import os
import sys
from typing import Mapping

NO_BROWSER = "MY_SIMULATIONS_NO_BROWSER"
"""Variable: set to anything, no browser is started."""


def has_display(environment: Mapping[str, str] = os.environ) -> bool:
    """Whether a window could be shown."""
    if environment.get(NO_BROWSER):
        return False
    return bool(environment.get("DISPLAY") or environment.get("WAYLAND_DISPLAY"))


def show(url: str, program: str) -> None:
    """Print where the editor is, and open it where there is a display."""
    print(f"{program}: the world editor is at {url}", flush=True)
    if not has_display():
        return
    import webbrowser

    try:
        opened = webbrowser.open(url)
    except webbrowser.Error:
        opened = False
    if not opened:
        print(f"{program}: no browser could be started; open the address yourself",
              file=sys.stderr, flush=True)
