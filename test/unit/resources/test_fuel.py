"""Models of a Fuel server: their addresses, the caches, and a server on this machine."""
from __future__ import annotations

import io
import os
import random
import stat
import threading
import zipfile
from concurrent.futures import ThreadPoolExecutor

import pytest
from reading import sdf
from test_database import Server

from my_simulations.errors import errors_of
from my_simulations.formats.reading import parse_world
from my_simulations.resources.database.download_time import DownloadTime
from my_simulations.resources.database.fuel import FuelModels
from my_simulations.resources.database.fuel_uri import FuelUri, fuel_uri
from my_simulations.resources.model_provider import ModelNotProvidedError
from my_simulations.resources.resolver import Resolver, ResourceNotFoundError

PUBLIC = "https://fuel.gazebosim.org"
CONFIG = '<model><name>{}</name><sdf version="1.6">model.sdf</sdf></model>'
MODEL = sdf('<model name="{0}"><static>1</static><link name="l"><visual name="v"><geometry><mesh>'
            "<uri>model://{0}/meshes/a.stl</uri></mesh></geometry></visual></link></model>", "1.6")
MESH = "solid a\nendsolid a\n"


def cached(cache, host, owner, name, version):
    folder = cache / host / owner / "models" / name / str(version)
    (folder / "meshes").mkdir(parents=True)
    (folder / "model.config").write_text(CONFIG.format(name))
    (folder / "model.sdf").write_text(MODEL.format(name))
    (folder / "meshes" / "a.stl").write_text(MESH)
    return folder


def archive(name, more=()):
    """The zip file of a model; `more`: (ZipInfo or name, content) besides."""
    stream = io.BytesIO()
    with zipfile.ZipFile(stream, "w", zipfile.ZIP_DEFLATED) as packed:
        packed.writestr("model.config", CONFIG.format(name))
        packed.writestr("model.sdf", MODEL.format(name))
        packed.writestr("meshes/", "")
        packed.writestr("meshes/a.stl", MESH)
        for info, content in more:
            packed.writestr(info, content)
    return stream.getvalue()


@pytest.fixture
def server(monkeypatch):
    monkeypatch.setenv("no_proxy", "127.0.0.1")
    made = Server()
    yield made
    made.close()


@pytest.fixture
def cache(tmp_path):
    return tmp_path / "fuel"


@pytest.fixture
def models(server, cache):
    return FuelModels([str(cache)], [server.uri])


def lamp(server, **how):
    return FuelUri(server.uri, "Acme", "Desk Lamp", **how)


def offer(server, version="3", path="tip", **how):
    where = f"1.0/Acme/models/Desk%20Lamp/{path}/Desk%20Lamp.zip"
    server.files[where] = archive("Desk Lamp", **how)
    server.headers[where] = {"X-Ign-Resource-Version": version,
                             "Content-Type": "application/zip"}
    return where


@pytest.mark.parametrize("text, expected", [
    ("/1.0/OpenRobotics/models/Sun", ("OpenRobotics", "Sun", 0, "")),
    ("/OpenRobotics/models/Sun/", ("OpenRobotics", "Sun", 0, "")),
    ("/1.0/OpenRobotics/models/Sun/2", ("OpenRobotics", "Sun", 2, "")),
    ("/1.0/OpenRobotics/models/Sun/tip", ("OpenRobotics", "Sun", 0, "")),
    ("/1.0/a b/models/Ground%20Plane", ("a b", "Ground Plane", 0, "")),
    ("/1.0/a/models/b/4/files/meshes/c%20d.dae", ("a", "b", 4, "meshes/c d.dae")),
    ("/1.0/a/models/b/tip/files/x/../../y", None),
    ("/1.0/a/models/..%2F..%2Fetc", None), ("/1.0/../models/x", None),
    ("/1.0/a/worlds/b", None), ("/x.dae", None), ("", None),
])
def test_addresses_are_read_as_the_tools_of_gazebo_do(text, expected):
    found = fuel_uri(PUBLIC + text)
    assert (found and (found.owner, found.name, found.version, found.inside)) == expected


def test_the_newest_version_in_the_cache_counts_unless_one_is_named(models, server, cache):
    host = server.uri.partition("://")[2]
    old = cached(cache, host, "acme", "desk lamp", 2)
    new = cached(cache, host, "acme", "desk lamp", 10)
    assert models.path(lamp(server)) == str(new)
    assert models.path(lamp(server, version=2)) == str(old)
    assert models.path(lamp(server, inside="meshes/a.stl")) == str(new / "meshes/a.stl")
    assert server.asked == []


def test_both_names_of_the_public_server_share_their_caches(cache, tmp_path):
    folder = cached(tmp_path / "gz", "fuel.gazebosim.org", "OpenRobotics", "Sun", 1)
    models = FuelModels([str(cache), str(tmp_path / "gz")], [])
    found = models.path(fuel_uri("https://fuel.ignitionrobotics.org/1.0/openrobotics/models/sun"))
    assert found == str(folder)


def test_a_world_includes_a_cached_model_whose_meshes_are_named_in_either_way(cache):
    folder = cached(cache, "fuel.gazebosim.org", "acme", "lamp", 1)
    resolver = Resolver(fuel=FuelModels([str(cache)], []))
    text = sdf(f"<world name='w'><include><uri>{PUBLIC}/1.0/Acme/models/Lamp</uri></include>"
               "</world>")
    for address in ("model://lamp/meshes/a.stl", f"{PUBLIC}/1.0/acme/models/lamp/1/files/meshes/"
                    "a.stl"):
        (folder / "model.sdf").write_text(
            MODEL.format("lamp").replace("model://lamp/meshes/a.stl", address))
        world, issues = parse_world(text, resolver)
        assert errors_of(issues) == []
        [model] = world.models
        assert model.uri == f"{PUBLIC}/1.0/Acme/models/Lamp"
        assert model.links[0].visuals[0].geometry.path == str(folder / "meshes" / "a.stl")


def test_what_no_cache_holds_is_downloaded_once(models, server, cache):
    path = offer(server)
    host = server.uri.partition("://")[2]
    expected = cache / host / "acme" / "models" / "desk lamp" / "3"
    assert models.path(lamp(server)) == str(expected)
    assert models.path(lamp(server, inside="meshes/a.stl")) == str(expected / "meshes/a.stl")
    assert server.asked == [path]
    assert os.listdir(expected.parent) == ["3"]
    # As Gazebo's own tools leave it, who may share this cache.
    assert f"{server.uri}/1.0/Acme/models/Desk%20Lamp/3/files/meshes/a.stl" in (
        expected / "model.sdf").read_text()


def test_two_threads_download_one_model_at_the_same_time(models, server, cache):
    offer(server)
    both, one_is_done, answer = threading.Barrier(2), threading.Event(), server.answer

    def one_after_the_other(handler):
        if both.wait(30) == 1:
            one_is_done.wait(30)
        answer(handler)

    server.answer = one_after_the_other
    with ThreadPoolExecutor(2) as threads:
        asked = [threads.submit(models.path, lamp(server, inside="meshes/a.stl"))
                 for _ in range(2)]
        for one in asked:
            one.add_done_callback(lambda _: one_is_done.set())
        found = [one.result() for one in asked]
    (path,) = set(found)
    with open(path) as stream:
        assert stream.read() == MESH
    assert [name for _, _, names in os.walk(cache) for name in names if name.endswith("zip")] == []


def test_a_version_that_is_named_is_the_one_that_is_asked_for(models, server, cache):
    cached(cache, server.uri.partition("://")[2], "acme", "desk lamp", 3)
    path = offer(server, version="2", path="2")
    assert models.path(lamp(server, version=2)).endswith("/2")
    assert server.asked == [path]


def test_a_server_that_nobody_named_is_not_asked(server, cache):
    offer(server)
    with pytest.raises(ModelNotProvidedError, match="not a configured server"):
        FuelModels([str(cache)], [PUBLIC]).path(lamp(server))
    assert server.asked == []


def test_the_configuration_of_the_cache_names_servers(server, tmp_path, monkeypatch):
    offer(server)
    monkeypatch.setenv("HOME", str(tmp_path))
    for name in ("IGN_FUEL_CACHE_PATH", "GZ_FUEL_CACHE_PATH"):
        monkeypatch.delenv(name, raising=False)
    folder = tmp_path / ".ignition" / "fuel"
    folder.mkdir(parents=True)
    (folder / "config.yaml").write_text(f"servers:\n  -\n    name: here\n    url: {server.uri}\n")
    found = Resolver.from_environment().model_file(f"{server.uri}/1.0/Acme/models/Desk Lamp")
    assert found.startswith(str(folder)) and found.endswith("/desk lamp/3/model.sdf")


def test_a_world_goes_on_without_what_cannot_be_had(models, server):
    text = sdf(f"<world name='w'><include><uri>{server.uri}/1.0/a/models/none</uri></include>"
               "<model name='m'><link name='l'/></model></world>")
    world, issues = parse_world(text, Resolver(fuel=models))
    [fault] = errors_of(issues)
    assert fault.code == "model-not-found" and "404" in fault.message and fault.line
    assert [model.name for model in world.models] == ["m"]


def test_a_server_that_hangs_costs_the_deadline_once(server, cache):
    server.hang = {offer(server)}
    models = FuelModels([str(cache)], [server.uri], seconds=3.0)
    for _ in range(2):
        with pytest.raises(ModelNotProvidedError, match="timed out"):
            models.path(lamp(server))
    assert len(server.asked) == 1
    server.hang.clear()
    models.set_seconds(30.0)  # what follows is no matter of time: a busy machine unpacks slowly
    models.begin()
    assert models.path(lamp(server))


def symlink(name):
    info = zipfile.ZipInfo(name)
    info.external_attr = (stat.S_IFLNK | 0o777) << 16
    return info


@pytest.mark.parametrize("more", [
    ("../evil.txt", b""), ("/tmp/evil.txt", b""), ("a\\..\\evil.txt", b""),
    (symlink("link"), b"/etc/passwd"),
], ids=["dots", "absolute", "backslashes", "link"])
def test_an_archive_that_reaches_out_is_refused_whole(more, models, server, cache):
    offer(server, more=[more])
    with pytest.raises(ModelNotProvidedError):
        models.path(lamp(server))
    assert [name for _, _, files in os.walk(cache) for name in files] == []


@pytest.mark.parametrize("data", [b"", b"<html>", archive("x")[:-30], b"PK\x05\x06" + bytes(18)])
def test_a_broken_archive_is_refused(data, models, server, cache):
    server.files[offer(server)] = data
    with pytest.raises(ModelNotProvidedError):
        models.path(lamp(server))
    assert models.models() == []


def test_a_zip_bomb_is_refused_by_what_comes_out_of_it(server, cache, monkeypatch):
    offer(server, more=[("bomb.bin", bytes(8 << 20))])
    small = type("Limits", (), dict(archive_bytes=1 << 20, unpacked_bytes=1 << 20, files=99))()
    monkeypatch.setattr(DownloadTime, "__init__", _limited(small))
    with pytest.raises(ModelNotProvidedError, match="more than 99 files or 1048576 bytes"):
        FuelModels([str(cache)], [server.uri]).path(lamp(server))


@pytest.mark.parametrize("method", [zipfile.ZIP_DEFLATED, zipfile.ZIP_BZIP2, zipfile.ZIP_LZMA],
                         ids=["deflate", "bzip2", "lzma"])
def test_a_damaged_entry_is_called_broken_however_it_is_compressed(method, models, server):
    info = zipfile.ZipInfo("texture.bin")
    info.compress_type = method
    content = random.Random(1).getrandbits(40000).to_bytes(5000, "little")
    where = offer(server, more=[(info, content)])
    packed = bytearray(server.files[where])
    begin = packed.index(b"texture.bin")
    packed[begin + 40:begin + 3000] = b"\xff" * 2960
    server.files[where] = bytes(packed)
    with pytest.raises(ModelNotProvidedError, match="the archive is broken: "):
        models.path(lamp(server))


def _limited(limits):
    original = DownloadTime.__init__

    def init(self, progress=None, seconds=10.0):
        original(self, progress, seconds, limits)
    return init


def test_other_addresses_are_refused_with_what_is_read(models):
    with pytest.raises(ResourceNotFoundError, match="https://HOST/1.0/OWNER/models/NAME"):
        Resolver(fuel=models).resolve("https://example.invalid/mesh.dae")


def test_the_caches_are_listed_in_their_newest_versions(cache, tmp_path):
    cached(cache, "fuel.gazebosim.org", "acme", "lamp", 1)
    newest = cached(cache, "fuel.gazebosim.org", "acme", "lamp", 2)
    other = cached(tmp_path / "gz", "127.0.0.1:1", "me", "big table", 1)
    found = FuelModels([str(cache), str(tmp_path / "gz")], ["http://127.0.0.1:1"]).models()
    assert [(one.uri, one.name, one.folder) for one in found] == [
        (f"{PUBLIC}/1.0/acme/models/lamp", "lamp", str(newest)),
        ("http://127.0.0.1:1/1.0/me/models/big%20table", "big table", str(other))]
