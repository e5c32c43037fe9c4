"""The page before there is a world: its address, its progress, and the editor that follows."""
from __future__ import annotations

import asyncio
import json

import aiohttp
import pytest
from editor_case import DEADLINE, Browser, box, cases

from my_simulations.editor import EditorOptions, start, start_loading

case = pytest.fixture(cases)


@pytest.fixture
def options(tmp_path):
    return EditorOptions(port=0, cache_dir=str(tmp_path / "cache"),
                         config_dir=str(tmp_path / "config"), data_dir=str(tmp_path / "data"))


def address(server, path):
    base, mark, query = server.url.partition("?")
    return base + path + mark + query


async def told(socket):
    return json.loads((await asyncio.wait_for(socket.receive(), DEADLINE)).data)


def test_the_page_tells_what_is_under_way_and_goes_on_with_the_editor(case, options):
    made = case(box("a"))
    loading = start_loading(options)

    async def wait():
        async with aiohttp.ClientSession(cookie_jar=aiohttp.CookieJar(unsafe=True)) as session:
            async with session.get(loading.url) as page:
                assert "World editor" in await page.text()
            async with session.get(address(loading, "js/main.js")) as module:
                assert module.status == 200
            socket = await session.ws_connect(address(loading, "ws"))
            assert (await told(socket))["type"] == "loading"
            loading.show("Reading a.world", "meshes of husky", 2, 12)
            assert await told(socket) == {"type": "loading", "title": "Reading a.world",
                                          "text": "meshes of husky", "done": 2, "of": 12}
            loading.show_line("dividing mesh 3 of 12")
            assert (await told(socket))["text"] == "dividing mesh 3 of 12"
            loop = asyncio.get_running_loop()
            editor = await loop.run_in_executor(
                None, lambda: start(made.sim, made.resolver, options, loading))
            assert (await asyncio.wait_for(socket.receive(), DEADLINE)).type in (
                aiohttp.WSMsgType.CLOSE, aiohttp.WSMsgType.CLOSED)
            assert editor.url == loading.url
            browser = await Browser.open(session, editor.url)
            assert browser.model("a")
            await loop.run_in_executor(None, editor.stop)

    asyncio.run(wait())


def test_strangers_get_nothing(options):
    loading = start_loading(options)

    async def ask():
        async with aiohttp.ClientSession() as session:
            async with session.get(loading.public_url) as page:
                assert page.status == 403

    asyncio.run(ask())
    loading.stop()
