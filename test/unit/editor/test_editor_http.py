"""Files that the editor's server sends by HTTP, and the clients that may read them."""
from __future__ import annotations

import asyncio
import os
import re
import shutil
import stat

import aiohttp
import numpy as np
import pytest
from editor_case import Browser, box, cases

from my_simulations.description.shapes import Mesh
from my_simulations.editor.editor_options import is_loopback
from my_simulations.editor.transport.http_pages import Pages
from my_simulations.editor.transport.page_bundle import FOLDER
from my_simulations.editor.transport.page_files import PageFiles, node_modules
from my_simulations.resources.resolver import Resolver

PNG = b"\x89PNG\r\n\x1a\n" + b"\0" * 32


case = pytest.fixture(cases)


def request(url, method="GET", **more):
    """Status, headers and body of one request."""
    async def run():
        async with aiohttp.ClientSession() as session:
            async with session.request(method, url, allow_redirects=False, **more) as response:
                return response.status, response.headers, await response.read()

    return asyncio.run(run())


def raw(url, path):
    """Status of a request whose path no client would send."""
    async def run():
        port = int(url.split(":")[2].split("/")[0])
        reader, writer = await asyncio.open_connection("127.0.0.1", port)
        writer.write(f"GET {path} HTTP/1.1\r\nHost: 127.0.0.1:{port}\r\n\r\n".encode())
        line = await reader.readline()
        writer.close()
        return int(line.split()[1])

    return asyncio.run(run())


def test_the_page_comes_with_careful_headers(case):
    status, headers, body = request(case().url)
    assert status == 200 and b"<script" in body
    policy = headers["Content-Security-Policy"]
    assert "default-src 'self'" in policy and "'unsafe-eval'" not in policy
    assert "script-src 'self' 'unsafe-inline'" not in policy
    assert headers["X-Content-Type-Options"] == "nosniff"


def page_folder(tmp_path):
    folder = tmp_path / "page"
    (folder / "js").mkdir(parents=True)
    (folder / "js" / "main.js").write_text("one();")
    shutil.copy(os.path.join(Pages.own_folder(), "protocol.json"), folder)
    (folder / "index.html").write_text('<script type="module" src="/js/main.js"></script>')
    return folder


def main_script(url):
    """The address that the page gives to its script."""
    return url + re.search('src="/(.*?)"', request(url)[2].decode())[1]


def test_files_of_the_page_are_kept_by_browsers_until_one_has_changed(case, tmp_path):
    folder = page_folder(tmp_path)
    url = case(web=str(folder)).url
    first = main_script(url)
    _, headers, body = request(first)
    assert "immutable" in headers["Cache-Control"] and body == b"one();"
    assert main_script(url) == first
    (folder / "js" / "main.js").write_text("other();")
    second = main_script(url)
    assert second != first and request(second)[2] == b"other();"


def test_modules_of_the_page_are_sent_compressed_until_they_change(case, tmp_path):
    folder = page_folder(tmp_path)
    script = folder / "js" / "main.js"
    script.write_text("one();" * 1000)
    url = case(web=str(folder)).url
    _, headers, body = request(main_script(url))
    assert headers["Content-Encoding"] == "gzip" and int(headers["Content-Length"]) < 600
    assert "immutable" in headers["Cache-Control"] and headers["Vary"] == "Accept-Encoding"
    assert body == script.read_bytes()
    script.write_text("other();" * 1000)
    assert request(main_script(url))[2] == script.read_bytes()
    for asked in ({"Accept-Encoding": "identity"}, {"Accept-Encoding": "gzip;q=0, br"}):
        _, headers, body = request(url + "js/main.js", headers=asked)
        assert "Content-Encoding" not in headers and body == script.read_bytes()
    changed = request(url + "js/main.js")[1]["Last-Modified"]
    assert request(url + "js/main.js", headers={"If-Modified-Since": changed})[0] == 304
    script.write_text("short();")
    assert "Content-Encoding" not in request(url + "js/main.js")[1]


def test_the_page_of_the_package_is_sent_in_less_than_half_of_its_bytes(case):
    url = case().url
    folder = os.path.join(node_modules(Pages.own_folder()), FOLDER, "js")
    plain = sent = 0
    for name in os.listdir(folder):
        if name.endswith(".js"):
            plain += os.path.getsize(os.path.join(folder, name))
            sent += int(request(f"{url}js/{name}")[1]["Content-Length"])
    assert 0 < sent < 0.5 * plain


def test_addresses_of_the_page_are_the_same_after_a_start_and_another_users_are_others(tmp_path):
    folder = str(page_folder(tmp_path))
    stamps = [PageFiles(folder, str(tmp_path / home)).stamp() for home in ("a", "a", "b")]
    assert stamps[0] == stamps[1] != stamps[2]
    key, = (tmp_path / "a").rglob("page_key")
    assert stat.S_IMODE(key.stat().st_mode) == 0o600


@pytest.mark.parametrize("address", ["js/main.js", "v/0123456789abcdef/js/main.js"])
def test_files_of_the_page_at_other_addresses_are_asked_for_again(case, tmp_path, address):
    status, headers, _ = request(case(web=str(page_folder(tmp_path))).url + address)
    assert status == 200 and headers["Cache-Control"] == "no-cache"


def test_the_protocol_comes_with_the_page(case):
    status, _, body = request(case().url + "protocol.json")
    assert status == 200 and b'"requests"' in body


@pytest.mark.parametrize("headers", [
    {"Host": "evil.example"}, {"Host": "127.0.0.1.evil.example"}, {"Host": ""},
    {"Origin": "http://evil.example"}, {"Origin": "null"}, {"Origin": "http://127.0.0.1:1"},
    {"Origin": "http://["}, {"Host": "["}, {"Sec-Fetch-Site": "cross-site"},
    {"Sec-Fetch-Site": "same-site"}], ids=str)
def test_foreign_pages_and_names_are_refused(case, headers):
    made = case()
    assert request(made.url + "protocol.json", headers=headers)[0] == 403

    async def socket():
        async with aiohttp.ClientSession() as session:
            with pytest.raises(aiohttp.WSServerHandshakeError) as refused:
                await session.ws_connect(made.url + "ws", headers=headers)
            assert refused.value.status == 403

    asyncio.run(socket())


def test_our_own_page_may_come_by_any_name_of_this_machine(case):
    made = case()
    port = made.url.split(":")[2].strip("/")
    for name in ("localhost", "127.0.0.1", "[::1]"):
        headers = {"Host": f"{name}:{port}", "Origin": f"http://{name}:{port}"}
        assert request(made.url + "protocol.json", headers=headers)[0] == 200


def test_other_addresses_need_the_token(case):
    made = case(host="0.0.0.0", token="secret-token")
    assert made.url.endswith("/?token=secret-token")
    base = "http://127.0.0.1:" + made.url.split(":")[2].split("/")[0] + "/"
    assert request(base)[0] == 403
    assert request(base + "?token=wrong")[0] == 403
    status, headers, _ = request(base + "?token=secret-token")
    assert status == 200 and "HttpOnly" in headers["Set-Cookie"]
    cookie = headers["Set-Cookie"].split(";")[0]
    assert request(base + "protocol.json", headers={"Cookie": cookie})[0] == 200

    async def socket():
        async with aiohttp.ClientSession() as session:
            with pytest.raises(aiohttp.WSServerHandshakeError):
                await session.ws_connect(base + "ws")
            browser = await Browser.open(session, base, Cookie=cookie)
            assert browser.document

    asyncio.run(socket())


def test_a_token_is_made_up_where_none_is_given(case):
    made = case(host="0.0.0.0")
    assert len(made.url.partition("token=")[2]) >= 20


def test_loopback_addresses_are_known():
    assert all(map(is_loopback, ("127.0.0.1", "localhost", "::1", "[::1]", "127.9.9.9")))
    assert not any(map(is_loopback, ("0.0.0.0", "::", "192.168.1.2", "example.org", "")))


@pytest.mark.parametrize("path", [
    "/js/../../package.xml", "/js/..%2f..%2fpackage.xml", "/js/%2e%2e/%2e%2e/package.xml",
    "/css//etc/passwd", "/v/x/js/../../../package.xml", "/v/x/js/%2e%2e/%2e%2e/package.xml",
    "/three/../../../package.xml", "/v/x/three/../../x.js", "/resource/x/../../etc/passwd",
    "/resource//etc/passwd", "/solid/../x.stl", "/thumb/../../x.png", "/export/..%2fx.world",
    "/js/%00", "/js/x%00.js", "/three/%00", "/css/a%00b.css", "/resource/x/%00.png",
    "/solid/%00.stl", "/thumb/%00.png", "/export/%00", "/%00",
    "/js/main.py", "/export/../../x.log", "/ws/x", "/nix"])
def test_no_path_leads_out(case, path):
    made = case()
    assert raw(made.url, path) in (400, 403, 404)


SANDBOX = "sandbox; default-src 'none'"


@pytest.mark.parametrize("path", [
    "protocol.json", "js/main.js", "css/nix.css", "nix", "resource/x/y.png", "solid/x.stl",
    "solid/x.ply", "thumb/x.png", "export/x.world"])
def test_whatever_is_not_the_page_may_do_nothing_by_itself(case, path):
    for headers in ({}, {"Origin": "http://evil.example"}):
        _, found, _ = request(case().url + path, headers=headers)
        assert found["Content-Security-Policy"].startswith(SANDBOX)
        assert found["X-Content-Type-Options"] == "nosniff"


def test_the_page_may_open_its_own_socket_only(case):
    made = case()
    host = made.url.split("/")[2]
    policy = request(made.url)[1]["Content-Security-Policy"]
    assert f"connect-src 'self' data: blob: ws://{host} wss://{host};" in policy


def test_scripts_of_the_page_keep_their_type(case):
    headers = request(case().url + "js/main.js")[1]
    assert headers["Content-Type"].startswith("text/javascript")


ACTIVE = "<svg xmlns='http://www.w3.org/2000/svg'><script>alert(document.domain)</script></svg>"


@pytest.mark.parametrize("name, link", [("a.svg", ""), ("a.html", "a.png"), ("a.svg", "a.jpg"),
                                        ("a.xml", "a.dae"), ("a.js", "a.stl")])
def test_a_file_that_may_hold_a_script_is_not_served_by_any_name(case, tmp_path, name, link):
    models = tmp_path / "models" / "m"
    models.mkdir(parents=True)
    (models / name).write_text(ACTIVE)
    if link:
        os.symlink(models / name, models / link)
    (models / "good.stl").write_text("solid a\nendsolid a\n")
    made = case(mesh_model(models / "good.stl"), resolver=Resolver([str(tmp_path / "models")]))

    async def url(browser):
        return browser.model("m")["links"][0]["visuals"][0]["geometry"]["url"]

    good = made.browse(url)
    base = made.url.rstrip("/") + good
    assert request(base)[1]["Content-Type"] == "application/octet-stream"
    assert request(base.replace("good.stl", link or name))[0] == 404


def mesh_model(path, name="m"):
    model = box(name)
    model.links[0].visuals[0].geometry = Mesh(f"file://{path}", str(path))
    return model


def test_meshes_and_textures_come_from_below_known_folders_only(case, tmp_path):
    models, secret = tmp_path / "models", tmp_path / "secret"
    meshes, textures = models / "m 1" / "meshes", models / "m 1" / "materials" / "textures"
    for folder in (meshes, textures, secret):
        folder.mkdir(parents=True)
    for path in (meshes / "a b.dae", secret / "b.dae"):
        path.write_text("<COLLADA/>")
    (textures / "Wood.PNG").write_bytes(PNG)
    (meshes / "notes.txt").write_text("private")
    os.symlink(secret / "b.dae", meshes / "link.dae")
    made = case(mesh_model(meshes / "a b.dae", "good"), mesh_model(secret / "b.dae", "bad"),
                mesh_model(meshes / "link.dae", "link"), resolver=Resolver([str(models)]))

    async def look(browser):
        shown = {name: browser.model(name)["links"][0]["visuals"][0]["geometry"]
                 for name in ("good", "bad", "link")}
        assert shown["good"]["format"] == "dae" and " " not in shown["good"]["url"]
        for name in ("bad", "link"):
            assert shown[name]["url"] is None and shown[name]["problem"]
        return shown["good"]["url"]

    url = made.browse(look)
    base = made.url.rstrip("/")
    assert request(base + url)[2] == b"<COLLADA/>"
    folder = url.rsplit("/", 1)[0]
    assert request(f"{base}{folder}/wood.png")[2] == PNG  # where Gazebo looks for textures
    # A mesh may name its picture by URI; the page puts its own folder before that.
    assert request(f"{base}{folder}/model://m%201/materials/textures/Wood.PNG")[2] == PNG
    for inside in ("model://m%201/meshes/notes.txt", "model:///etc/passwd.png",
                   "model://nix/a.png", "model://../secret/a.png", "notes.txt", "link.dae",
                   "%2e%2e/%2e%2e/%2e%2e/secret/b.dae", "none.png"):
        assert request(f"{base}{folder}/{inside}")[0] == 404


def served_mesh(case, path):
    """Format and bytes of a mesh file as a page gets it."""
    made = case(mesh_model(path), resolver=Resolver([str(path.parent.parent)]))

    async def look(browser):
        return browser.model("m")["links"][0]["visuals"][0]["geometry"]

    geometry = made.browse(look)
    status, _, body = request(made.url.rstrip("/") + geometry["url"])
    assert status == 200
    return geometry["format"], body


def test_odd_mesh_files_come_as_stl(case, tmp_path):
    (tmp_path / "m").mkdir()
    path = tmp_path / "m" / "t.off"
    path.write_text("OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n")
    form, body = served_mesh(case, path)
    assert form == "stl" and len(body) == 84 + 50


PLY = """ply
format ascii 1.0
element vertex 5
property float x
property float y
property float z{vertex}
element face 3
property list uchar int vertex_indices{face}
end_header
0 0 0{0}
2 0 0{1}
3 1 0{2}
2 2 0{2}
0 2 0{0}
3 0 1 2{3}
3 0 2 3{4}
3 0 3 4{4}
"""
COLORS = "".join(f"\nproperty uchar {name}" for name in ("red", "green", "blue"))
RED, GREEN, BLUE = " 255 0 0", " 0 128 0", " 0 0 40"


def corners_of(body):
    """(m, 3, k) of a served PLY file, and whether its corners have colours."""
    head, _, rest = body.partition(b"end_header\n")
    colored = b"float red" in head
    count = int(re.search(rb"element vertex (\d+)", head).group(1))
    rows = np.frombuffer(rest, "<f4", count * (6 if colored else 3))
    return rows.reshape(count // 3, 3, -1), colored


@pytest.mark.parametrize(("text", "expected"), [
    (PLY.format(RED, GREEN, BLUE, "", "", vertex=COLORS, face=""),
     {(0, 0): RED, (2, 0): GREEN, (3, 1): BLUE, (2, 2): BLUE, (0, 2): RED}),
    (PLY.format("", "", "", GREEN, BLUE, vertex="", face=COLORS),
     {(2, 0): GREEN, (2, 2): BLUE, (0, 2): BLUE})], ids=["vertices", "faces"])
def test_ply_files_come_with_the_colors_of_their_corners(case, tmp_path, text, expected):
    (tmp_path / "m").mkdir()
    path = tmp_path / "m" / "t.ply"
    path.write_text(text)
    form, body = served_mesh(case, path)
    triangles, colored = corners_of(body)
    assert form == "ply" and colored and len(triangles) == 3
    for row in triangles.reshape(-1, 6):
        told = expected.get((row[0], row[1]))
        if told:
            assert row[3:] * 255.0 == pytest.approx([int(one) for one in told.split()])


def test_a_ply_file_without_colors_comes_without(case, tmp_path):
    (tmp_path / "m").mkdir()
    path = tmp_path / "m" / "t.ply"
    path.write_text(PLY.format("", "", "", "", "", vertex="", face=""))
    form, body = served_mesh(case, path)
    triangles, colored = corners_of(body)
    assert form == "ply" and not colored and len(triangles) == 3


def test_thumbnails_are_kept(case):
    made = case()
    url = made.url + "thumb/" + "ab" * 16 + ".png"
    assert request(url)[0] == 204  # not drawn yet
    assert request(url, "PUT", data=b"no picture")[0] == 400
    assert request(url, "PUT", data=PNG)[0] == 204
    assert request(url)[2] == PNG
    assert request(url, "PUT", data=PNG * (1 << 17))[0] == 413


def test_uploads_get_a_place_of_their_own_and_replace_nothing(case):
    made = case()
    first = request(made.url + "upload/a.stl", "PUT", data=b"one")
    second = request(made.url + "upload/a.stl", "PUT", data=b"two")
    assert (first[0], second[0]) == (200, 200)
    folder = made.folder / "data" / "uploads"
    assert sorted(path.name for path in folder.iterdir()) == ["a.stl", "a_1.stl"]
    assert (folder / "a.stl").read_bytes() == b"one"
    for name in ("a.py", ".stl", "..%2fa.stl", "x"):
        assert request(made.url + "upload/" + name, "PUT", data=b"x")[0] in (400, 404)
    assert request(made.url + "upload/a.stl", "PUT", data=b"not gzip",
                   headers={"Content-Encoding": "gzip"})[0] == 415


def test_the_world_can_be_downloaded(case):
    made = case(box("a"))
    status, headers, body = request(made.url + "export/mine.world")
    assert status == 200 and b'<model name="a"' in body
    assert "mine.world" in headers["Content-Disposition"]
    assert request(made.url + "export/nix.zip")[0] == 404
