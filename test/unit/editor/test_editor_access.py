"""Who may use the editor on a machine with several users: who has its token."""
from __future__ import annotations

import asyncio
import io
import os
import stat

import aiohttp
import pytest
from editor_case import Browser, box, cases

from my_simulations.editor import web_browser
from my_simulations.editor.editor_options import TOKEN_VARIABLE
from my_simulations.editor.transport import access_guard, address_file

case = pytest.fixture(cases)

ROUTES = ["", "protocol.json", "js/main.js", "css/main.css", "three/build/three.module.js",
          "resource/x/y.png", "solid/x.stl", "solid/x.ply", "thumb/x.png", "export/x.world", "ws",
          "nix"]


def request(url, method="GET", **more):
    """Status and headers of one request."""
    async def run():
        async with aiohttp.ClientSession() as session:
            async with session.request(method, url, **more) as response:
                await response.read()
                return response.status, response.headers

    return asyncio.run(run())


@pytest.fixture
def guarded(case, monkeypatch):
    """A server as users start it, its address in parts: (case, base, token)."""
    monkeypatch.delenv(TOKEN_VARIABLE, raising=False)
    made = case(box("a"), token=None)
    base, _, token = made.url.partition("?token=")
    return made, base, token


def test_a_token_is_asked_for_on_this_machine_too(guarded):
    made, base, token = guarded
    assert len(token) >= 20 and made.server.public_url == base
    for route in ROUTES:
        for shown in ("", "?token=", "?token=wrong", f"?token={token[:-1]}", "?token=%ff%00"):
            assert request(base + route + shown)[0] == 403, route + shown
        assert request(base + route, headers={"Cookie": "my_simulations_editor=x"})[0] == 403
        assert request(f"{base}{route}?token={token}")[0] != 403
    for path in ("thumb/ab.png", "upload/a.stl"):
        assert request(base + path, "PUT", data=b"x")[0] == 403


def test_the_cookie_is_for_this_server_alone_and_out_of_reach_of_scripts(guarded):
    made, base, token = guarded
    status, headers = request(f"{base}?token={token}")
    name, _, rest = headers["Set-Cookie"].partition("=")
    port = base.rstrip("/").rpartition(":")[2]
    assert status == 200 and name.endswith(f"_{port}")
    assert "HttpOnly" in rest and "SameSite=Strict" in rest
    cookie = headers["Set-Cookie"].partition(";")[0]
    assert request(base + "protocol.json", headers={"Cookie": cookie})[0] == 200
    # An old address in a bookmark does no harm to who has the cookie.
    assert request(base + "?token=old", headers={"Cookie": cookie})[0] == 200

    async def socket():
        async with aiohttp.ClientSession() as session:
            with pytest.raises(aiohttp.WSServerHandshakeError) as refused:
                await session.ws_connect(base + "ws")
            assert refused.value.status == 403
            browser = await Browser.open(session, base, Cookie=cookie)
            assert browser.model("a")

    asyncio.run(socket())


@pytest.mark.parametrize("host, variable, given, asked", [
    ("127.0.0.1", "", "", False), ("127.0.0.1", "off", None, False),
    ("127.0.0.1", "", None, True), ("127.0.0.1", "a-long-secret-of-mine", None, True),
    ("0.0.0.0", "off", None, True), ("0.0.0.0", "", "", True)])
def test_the_token_can_be_turned_off_where_only_this_machine_listens(
        case, monkeypatch, host, variable, given, asked):
    monkeypatch.setenv(TOKEN_VARIABLE, variable)
    made = case(host=host, token=given)
    assert ("?token=" in made.url) == asked
    assert variable in ("", "off") or made.url.endswith(f"?token={variable}")


def test_the_address_with_the_token_is_in_a_file_for_its_user_alone(guarded):
    made, base, token = guarded
    cache = made.options.cache_dir
    assert address_file.with_token(base, cache) == made.url
    folder = os.path.join(cache, "editor")
    assert stat.S_IMODE(os.stat(folder).st_mode) == 0o700
    files = [os.path.join(folder, name) for name in os.listdir(folder)]
    assert len(files) == 3    # for programs, for browsers, and the key of the page's addresses
    assert all(stat.S_IMODE(os.stat(path).st_mode) == 0o600 for path in files)
    page = address_file.local_page(base, cache)
    with open(page[len("file://"):], encoding="utf-8") as stream:
        assert f'content="0;url={made.url}"' in stream.read()
    made.server.stop()
    assert os.listdir(folder) == ["page_key"] and address_file.with_token(base, cache) == base


def test_an_address_is_read_for_the_very_server_only(tmp_path):
    address_file.write("http://127.0.0.1:1/?token=secret", str(tmp_path))
    assert address_file.with_token("http://127.0.0.1:2/", str(tmp_path)) == "http://127.0.0.1:2/"
    os.rename(tmp_path / "editor" / "127.0.0.1_1.json", tmp_path / "editor" / "127.0.0.1_2.json")
    assert address_file.with_token("http://127.0.0.1:2/", str(tmp_path)) == "http://127.0.0.1:2/"
    (tmp_path / "editor" / "127.0.0.1_3.json").write_text("[]")
    assert address_file.with_token("http://127.0.0.1:3/", str(tmp_path)) == "http://127.0.0.1:3/"


def test_a_server_whose_folder_cannot_be_written_runs_and_says_so(case, monkeypatch, tmp_path):
    (tmp_path / "cache").write_text("no folder")
    made = case(box("a"), token=None)
    assert any(issue.code == "editor-address" for issue in made.issues)
    made.browse(lambda browser: asyncio.sleep(0))


@pytest.mark.parametrize("mode, told", [(0o600, True), (0o644, False), (0o640, False)])
def test_output_that_others_can_read_gets_no_token(monkeypatch, tmp_path, mode, told):
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path))
    monkeypatch.setenv(web_browser.NO_BROWSER, "1")
    address_file.write("http://127.0.0.1:1/?token=secret")
    path = tmp_path / "log"
    path.touch()
    path.chmod(mode)
    with open(path, "w", encoding="utf-8") as stream:
        monkeypatch.setattr("sys.stdout", stream)
        web_browser.show("http://127.0.0.1:1/", "gzclient")
    assert ("secret" in path.read_text()) == told
    assert "gzclient: the world editor is at http://127.0.0.1:1/" in path.read_text()
    assert (f"open {address_file.local_page('http://127.0.0.1:1/')}," in path.read_text()) != told


def test_a_browser_is_started_without_the_token_in_its_command_line(monkeypatch, tmp_path):
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path))
    monkeypatch.delenv(web_browser.NO_BROWSER, raising=False)
    monkeypatch.setattr(web_browser, "has_display", lambda: True)
    monkeypatch.setattr("sys.stdout", io.StringIO())
    opened = []
    monkeypatch.setattr("webbrowser.open", lambda url: opened.append(url) or True)
    address_file.write("http://127.0.0.1:1/?token=secret")
    web_browser.show("http://127.0.0.1:1/", "gzclient")
    web_browser.show("http://127.0.0.1:2/", "gzclient")
    web_browser.show("http://127.0.0.1:3/?token=lost", "gzclient")
    assert opened == [address_file.local_page("http://127.0.0.1:1/"), "http://127.0.0.1:2/"]
    assert opened[0].startswith("file:///")


@pytest.mark.parametrize("sent", [b"", b"GET / HT", b"GET / HTTP/1.1\r\nHost: 127.0.0.1\r\n"],
                         ids=["nothing", "half a line", "half a header"])
def test_half_open_connections_end(guarded, monkeypatch, sent):
    monkeypatch.setattr(access_guard, "SILENCE_S", 1.0)
    made, base, token = guarded
    port = int(base.rstrip("/").rpartition(":")[2])

    async def run():
        reader, writer = await asyncio.open_connection("127.0.0.1", port)
        writer.write(sent)
        try:
            assert await asyncio.wait_for(reader.read(), 60) == b""
        except ConnectionResetError:
            pass
        writer.close()
        async with aiohttp.ClientSession() as session:
            browser = await Browser.open(session, made.url)
            await asyncio.sleep(1.5)  # longer than silent connections may be
            await browser.edit("insert", shape="box")

    asyncio.run(run())


def test_hundreds_of_half_open_connections_do_not_use_up_the_descriptors(guarded):
    made, base, _ = guarded
    port = int(base.rstrip("/").rpartition(":")[2])

    async def run():
        opened = [await asyncio.open_connection("127.0.0.1", port) for _ in range(300)]
        # The server closes all but the newest MOST_SILENT connections.
        ended = [reader for reader, _ in opened[:-access_guard.MOST_SILENT]]
        for reader in ended:
            try:
                assert await asyncio.wait_for(reader.read(), 60) == b""
            except ConnectionResetError:
                pass
        async with aiohttp.ClientSession() as session:
            browser = await Browser.open(session, made.url)
            assert browser.model("a")
        for _, writer in opened:
            writer.close()

    asyncio.run(run())


def test_a_refused_connection_is_not_kept(guarded):
    _, base, _ = guarded
    assert request(base)[1]["Connection"] == "close"
