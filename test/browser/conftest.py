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


@pytest.fixture(scope="session")
def node(tmp_path_factory):
    """One node for all tests that start with a new world."""
    running = Node(tmp_path_factory.mktemp("node"), "worlds/empty.world")
    yield running
    running.close()


@pytest.fixture(scope="module")
def visit(browser):
    """Opens a page for a test, in place of that of the test before it: in half of the time."""
    pages = []

    def open_anew(url):
        if pages and pages[0].page.is_closed():
            pages.pop().close()
        if pages:
            pages[0].load_anew()
        else:
            pages.append(browser.open(url))
        return pages[0]

    yield open_anew
    for page in pages:
        page.close()


@pytest.fixture
def editor(node, visit):
    """A page on an empty world that stands still."""
    opened = visit(node.url)
    for request, fields in (("pause", {}), ("new", {"discard": True})):
        opened.page.evaluate("([type, fields]) => editor.request(type, fields)", [request, fields])
    opened.until("editor.store.document.models.length === 1 && editor.store.stats.paused",
                 "an empty world that stands")
    yield opened
    assert opened.faults == []


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
