"""Nodes and browsers for the tests of this folder."""
from __future__ import annotations

import pytest
from support import Browser, Node


@pytest.fixture(scope="session")
def browser():
    """One Chromium for all tests; each opens pages of its own."""
    running = Browser()
    yield running
    running.close()


@pytest.fixture
def launch(tmp_path):
    """Starts nodes that end with the test; each call is a fresh one in the same home folder."""
    nodes = []

    def start(world, *arguments):
        nodes.append(Node(tmp_path, world, *arguments))
        return nodes[-1]

    yield start
    for node in nodes:
        node.close()
