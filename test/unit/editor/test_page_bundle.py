"""The built modules of the page: used while they fit to the sources."""
from __future__ import annotations

import json
import os
import re
import shutil
import subprocess
from pathlib import Path

import pytest
from editor_case import cases
from test_editor_http import request

from my_simulations.editor.transport.page_bundle import FOLDER, PageBundle, sources_of
from my_simulations.editor.transport.page_files import PageFiles

REPOSITORY = Path(__file__).resolve().parents[3]
HTML = """<link rel="stylesheet" href="/css/theme.css">
  <link rel="modulepreload" href="/js/view/view.js">
  <script type="module" src="/js/main.js"></script>
"""
META = {"outputs": {
    "bundle/main.js": {"entryPoint": "../clone/web/js/main.ts", "imports": [
        {"path": "bundle/chunk-A.js", "kind": "import-statement"},
        {"path": "bundle/view-B.js", "kind": "dynamic-import"}]},
    "bundle/chunk-A.js": {"imports": []},
    "bundle/view-B.js": {"entryPoint": "../clone/web/js/view/view.ts", "imports": [
        {"path": "bundle/chunk-A.js", "kind": "import-statement"},
        {"path": "bundle/chunk-C.js", "kind": "import-statement"}]},
    "bundle/chunk-C.js": {"imports": []},
    "bundle/later-D.js": {"entryPoint": "../clone/web/js/later.ts", "imports": []}}}

case = pytest.fixture(cases)


@pytest.fixture
def page(tmp_path):
    """A page of two modules, packed."""
    folder, modules = tmp_path / "web", tmp_path / "node_modules"
    (folder / "js" / "view").mkdir(parents=True)
    (folder / "js" / "main.ts").write_text("one();")
    (folder / "js" / "view" / "view.ts").write_text("two();")
    (folder / "index.html").write_text(HTML)
    shutil.copy(os.path.join(PageFiles.own_folder(), "protocol.json"), folder)
    (modules / "three" / "build").mkdir(parents=True)
    (modules / "three" / "package.json").write_text('{"version": "0"}')
    made = modules / FOLDER
    (made / "bundle").mkdir(parents=True)
    (made / "bundle" / "main.js").write_text("both();")
    (made / "js").mkdir()
    (made / "js" / "main.js").write_text("one();")
    (made / "meta.json").write_text(json.dumps(META))
    (made / "sources").write_text(sources_of(str(folder), str(modules)) + "\n")
    return folder


def modules_of(page):
    return page.parent / "node_modules"


def served(page):
    return PageBundle(str(page), str(modules_of(page))).html(HTML)


def test_packed_modules_are_named_in_place_of_the_modules(page):
    text = served(page)
    assert re.findall('src="([^"]*)"', text) == ["/js/bundle/main.js"]
    assert re.findall('modulepreload" href="([^"]*)"', text) == [
        "/js/bundle/chunk-A.js", "/js/bundle/view-B.js", "/js/bundle/chunk-C.js"]
    assert '<link rel="stylesheet" href="/css/theme.css">' in text


def edit(page):
    (page / "js" / "view" / "view.ts").write_text("other();")


def add(page):
    (page / "js" / "new.ts").write_text("")


def remove(page):
    (page / "js" / "view" / "view.ts").unlink()


def another_three(page):
    (modules_of(page) / "three" / "package.json").write_text('{"version": "1"}')


def no_three(page):
    shutil.rmtree(modules_of(page) / "three")


def damage(page):
    (modules_of(page) / FOLDER / "meta.json").write_text('{"outputs": []}')


def cut(page):
    (modules_of(page) / FOLDER / "meta.json").write_text('{"outputs": {')


def without_entry(page):
    (modules_of(page) / FOLDER / "meta.json").write_text('{"outputs": {}}')


@pytest.mark.parametrize("change", [edit, add, remove, another_three, no_three, damage, cut,
                                    without_entry])
def test_a_page_that_was_not_built_as_it_is_now_is_not_served(page, change):
    change(page)
    assert served(page) is None


def test_a_page_without_npm_packages_is_not_served(page):
    assert PageBundle(str(page), "").html(HTML) is None


def test_a_page_without_typescript_is_served_as_it_is(page):
    (page / "js" / "main.ts").unlink()
    assert PageBundle(str(page), "").html(HTML) == HTML


def test_built_modules_beside_the_page_are_served_until_a_module_is_edited(
        case, page, monkeypatch):
    monkeypatch.delenv("MY_SIMULATIONS_NODE_MODULES", raising=False)
    monkeypatch.setenv("CMAKE_PREFIX_PATH", "")
    made = case(web=str(page))
    _, _, html = request(made.url)
    address = re.search(rb'src="/(.*?)"', html)[1].decode()
    assert address.endswith("/js/bundle/main.js")
    status, headers, body = request(made.url + address)
    assert status == 200 and body == b"both();" and "immutable" in headers["Cache-Control"]
    assert headers["Content-Type"].startswith("text/javascript")
    status, _, body = request(made.url + "js/main.js")
    assert status == 200 and body == b"one();"
    edit(page)
    status, _, html = request(made.url)
    assert status == 503 and b"run tools/run" in html
    for outside in ("js/../sources", "js/sources", "js/meta.json", "js/bundle/../meta.json",
                    "js/bundle/..%2fmeta.json", "js/bundle/", "js/bundle/x.js"):
        assert request(made.url + outside)[0] == 404


def test_the_set_up_hashes_the_modules_as_the_editor_does(page):
    (page / "js" / "Zoë.ts").write_text("")
    (page / "js" / "view-2").mkdir()
    (page / "js" / "view-2" / "a_b.ts").write_text("x")
    workspace = page.parent / "ws" / ".my_simulations"
    workspace.mkdir(parents=True)
    (workspace / "node_modules").symlink_to(modules_of(page))
    done = subprocess.run(
        ["bash", "-euc", ". tools/lib/page.sh; page_sources"], cwd=REPOSITORY, text=True,
        env={**os.environ, "CLONE": str(page.parent), "WORKSPACE": str(workspace.parent)},
        capture_output=True, check=True)
    assert done.stdout.strip() == sources_of(str(page), str(modules_of(page)))
