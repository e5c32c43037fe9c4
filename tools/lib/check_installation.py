"""Checks an installation by pip, with its Python: opens a world, and serves the editor of it."""
from __future__ import annotations

import re
import tempfile
import urllib.request
from http.cookiejar import CookieJar
from urllib.parse import urljoin

import my_simulations
from my_simulations.editor import EditorOptions, start
from my_simulations.errors import Severity
from my_simulations.resources.resolver import Resolver

_ADDRESS = re.compile(r'(?:src|href)="(/[^"]*\.(?:js|css))"')


def check_world(world: my_simulations.OpenWorld) -> str:
    """Step a world that has MY_OBJECT; returns what was seen."""
    world.step(100)
    faults = [issue for issue in world.issues if issue.severity is not Severity.NOTE]
    assert not faults, faults  # a mesh that cannot be read is a warning
    assert "MY_OBJECT" in world.names, world.names
    return f"{len(world.names)} models after {world.time:.2f} s"


def check_page(world: my_simulations.OpenWorld) -> str:
    """Fetch the editor's page with its packed modules; returns what was seen."""
    with tempfile.TemporaryDirectory() as folder:
        editor = start(world.simulator, Resolver.from_environment(),
                       EditorOptions(port=0, config_dir=folder, cache_dir=folder, data_dir=folder))
        try:
            opener = urllib.request.build_opener(
                urllib.request.ProxyHandler({}),
                urllib.request.HTTPCookieProcessor(CookieJar()))
            with opener.open(editor.url, timeout=30) as answer:
                page = answer.read().decode()
            addresses = _ADDRESS.findall(page)
            assert any("/js/bundle/" in one for one in addresses), addresses
            size = len(page)
            for address in addresses:
                with opener.open(urljoin(editor.url, address), timeout=30) as answer:
                    size += len(answer.read())
        finally:
            editor.stop()
    return f"editor page with {len(addresses)} files, {size // 1000} kB"


def main() -> None:
    """Check all, and print what was seen."""
    with my_simulations.open_world("lab_room.world", objects=["MY_OBJECT"]) as world:
        print(f"{my_simulations.__file__}: {check_world(world)}; {check_page(world)}")


if __name__ == "__main__":
    main()
