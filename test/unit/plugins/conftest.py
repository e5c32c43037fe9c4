"""Message packages that a system with ROS may lack."""
from __future__ import annotations

from pathlib import Path

import pytest

PACKAGES = Path(__file__).resolve().parents[2] / "data" / "message_packages"


@pytest.fixture(autouse=True)
def message_packages(monkeypatch):
    monkeypatch.setenv("ROS_PACKAGE_PATH", str(PACKAGES), prepend=":")
