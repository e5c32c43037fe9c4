"""The model database, served from this machine."""
from __future__ import annotations

import base64
import gzip
import hashlib
import http.server
import io
import os
import resource
import socket
import tarfile
import threading
import time

import pytest
from free_ports import silent_uri
from reading import sdf

from my_simulations.errors import Severity, errors_of
from my_simulations.formats.reading import parse_world
from my_simulations.resources.database.download_notes import DownloadNotes
from my_simulations.resources.database.http_download import Limits
from my_simulations.resources.database.model_database import ModelDatabase
from my_simulations.resources.model_provider import ModelNotProvidedError
from my_simulations.resources.resolver import Resolver, ResourceNotFoundError

LIST = "<database><name>d</name><models>{}</models></database>"
MODEL = sdf('<model name="{}"><static>1</static><link name="l"/></model>', "1.6")
CONFIG = ('<model><name>n</name><sdf version="1.6">model.sdf</sdf><depend>{}</depend></model>')


def archive(name, depends=(), more=()):
    """model.tar.gz of a small model; `more`: (TarInfo, content) besides."""
    uris = "".join(f"<model><uri>model://{other}</uri></model>" for other in depends)
    files = {f"{name}/model.config": CONFIG.format(uris), f"{name}/model.sdf": MODEL.format(name),
             f"{name}/meshes/a.txt": "x"}
    stream = io.BytesIO()
    with tarfile.open(fileobj=stream, mode="w:gz") as packed:
        for path, text in files.items():
            packed.addfile(entry(path, len(text)), io.BytesIO(text.encode()))
        for info, content in more:
            packed.addfile(info, io.BytesIO(content))
    return stream.getvalue()


def entry(path, size=0, kind=tarfile.REGTYPE, target=""):
    info = tarfile.TarInfo(path)
    info.size, info.type, info.linkname = size, kind, target
    return info


class Server:
    """Serves `files`; `headers` by path replace or add; `hang`: paths that never end."""

    def __init__(self):
        self.files, self.headers, self.hang, self.fail = {}, {}, set(), {}
        self.asked = []
        self.released = threading.Event()
        outer = self

        class Handler(http.server.BaseHTTPRequestHandler):
            def do_GET(self):
                outer.answer(self)

            def log_message(self, *args):
                pass

        self.server = http.server.ThreadingHTTPServer(("127.0.0.1", 0), Handler)
        self.server.daemon_threads = True
        self.thread = threading.Thread(target=self.server.serve_forever, daemon=True)
        self.thread.start()
        self.uri = f"http://127.0.0.1:{self.server.server_address[1]}"

    def answer(self, handler):
        path = handler.path.lstrip("/")
        self.asked.append(path)
        if self.fail.get(path, 0) > 0:
            self.fail[path] -= 1
            handler.send_error(503)
            return
        if path not in self.files:
            handler.send_error(404)
            return
        data = self.files[path]
        headers = {"Content-Length": str(len(data)), **self.headers.get(path, {})}
        handler.send_response(200)
        for name, value in headers.items():
            if value is not None:
                handler.send_header(name, value)
        handler.end_headers()
        if path in self.hang:
            handler.wfile.write(data[:10])
            handler.wfile.flush()
            self.released.wait(30)
            return
        handler.wfile.write(data)

    def add(self, name, **how):
        self.files[f"{name}/model.tar.gz"] = archive(name, **how)
        names = [path.split("/")[0] for path in self.files if "/" in path]
        self.files["database.config"] = LIST.format(
            "".join(f"<uri>file://{name}</uri>" for name in names)).encode()

    def close(self):
        self.released.set()
        self.server.shutdown()
        self.server.server_close()


@pytest.fixture
def server(monkeypatch):
    monkeypatch.setenv("no_proxy", "127.0.0.1")
    made = Server()
    yield made
    made.close()


@pytest.fixture
def database(server, tmp_path):
    def make(**how):
        return ModelDatabase(server.uri, str(tmp_path / "models"), **how)

    return make


def nothing_left(tmp_path):
    folder = tmp_path / "models"
    return not folder.exists() or list(folder.iterdir()) == []


def test_a_missing_model_is_downloaded_once(server, database, tmp_path):
    server.add("lamp")
    source = database()
    path = source.provide("lamp")
    assert path == str(tmp_path / "models" / "lamp")
    assert (tmp_path / "models/lamp/meshes/a.txt").read_text() == "x"
    assert source.provide("lamp") == database().provide("lamp") == path
    assert server.asked == ["database.config", "lamp/model.tar.gz"]
    assert os.listdir(tmp_path / "models") == ["lamp"]


def test_what_a_model_depends_on_comes_with_it(server, database, tmp_path):
    server.add("desk", depends=["leg", "gone"])
    server.add("leg", depends=["desk"])
    database().provide("desk")
    assert sorted(os.listdir(tmp_path / "models")) == ["desk", "leg"]


def test_the_older_list_is_read_where_there_is_no_newer(server, database):
    server.add("lamp")
    server.files["manifest.xml"] = server.files.pop("database.config")
    assert database().provide("lamp")


def test_progress_is_told(server, database):
    server.add("lamp")
    heard = []
    database(progress=lambda *told: heard.append(told)).provide("lamp")
    size = len(server.files["lamp/model.tar.gz"])
    assert heard[-1] == ("lamp", size, size)


def test_notes_say_how_far_a_download_is(server, database):
    server.add("lamp")
    notes = []
    database(progress=DownloadNotes(notes.append)).provide("lamp")
    assert notes and all(note.severity is Severity.NOTE for note in notes)
    assert "downloading model 'lamp': 0.0 of 0.0 MB" in notes[-1].message


def test_a_world_gets_its_models_and_goes_on_without_those_that_are_nowhere(
        server, database, tmp_path):
    server.add("lamp")
    resolver = Resolver([str(tmp_path / "models")], missing=database())
    text = sdf('<world name="w"><include><uri>model://lamp</uri></include>'
               "<include><uri>model://nowhere</uri></include></world>")
    world, issues = parse_world(text, resolver)
    assert [model.name for model in world.models] == ["lamp"]
    (missing,) = errors_of(issues)
    assert missing.code == "model-not-found" and "not contain model 'nowhere'" in missing.message


def test_a_file_inside_a_downloaded_model_resolves(server, database, tmp_path):
    server.add("lamp")
    resolver = Resolver(missing=database())
    assert resolver.resolve("model://lamp/meshes/a.txt").endswith("lamp/meshes/a.txt")
    with pytest.raises(ResourceNotFoundError):
        resolver.resolve("model://lamp/meshes/none.txt")


@pytest.mark.parametrize("value", [None, "", "  "])
def test_without_the_variable_there_is_no_network(value, server, monkeypatch):
    if value is None:
        monkeypatch.delenv("GAZEBO_MODEL_DATABASE_URI", raising=False)
    else:
        monkeypatch.setenv("GAZEBO_MODEL_DATABASE_URI", value)

    def connect(*_args):
        raise AssertionError("a connection was made")

    monkeypatch.setattr(socket.socket, "connect", connect)
    with pytest.raises(ResourceNotFoundError):
        Resolver.from_environment().resolve("model://surely_not_here")


def test_the_variable_names_the_database(server, monkeypatch, tmp_path):
    server.add("lamp_of_the_test")
    monkeypatch.setenv("GAZEBO_MODEL_DATABASE_URI", server.uri + "/")
    monkeypatch.setenv("HOME", str(tmp_path))
    found = Resolver.from_environment().model_file("model://lamp_of_the_test")
    assert found == str(tmp_path / ".gazebo/models/lamp_of_the_test/model.sdf")


def test_a_server_that_hangs_costs_no_more_than_the_deadline_for_all_models(
        server, database, tmp_path):
    server.add("slow")
    server.add("other")
    server.hang = {"slow/model.tar.gz", "other/model.tar.gz"}
    source = database(seconds=3.0)  # enough to ask for the archive
    for name in ("slow", "other", "slow"):
        with pytest.raises(ModelNotProvidedError, match="timed out"):
            source.provide(name)
    assert server.asked.count("slow/model.tar.gz") == 1
    assert nothing_left(tmp_path)
    server.hang.clear()
    source.set_seconds(30.0)  # what follows is no matter of time: a busy machine unpacks slowly
    source.begin()
    assert source.provide("other")


def test_a_server_that_is_not_there_is_reported(tmp_path):
    with pytest.raises(ModelNotProvidedError, match="cannot download"):
        ModelDatabase(silent_uri(), str(tmp_path / "models")).provide("lamp")


@pytest.mark.parametrize("uri", ["http://[bad/", "http://a..b/", "http://127.0.0.1:1/é/"])
def test_an_address_that_is_none_is_reported(uri, tmp_path):
    with pytest.raises(ModelNotProvidedError, match="cannot download http"):
        ModelDatabase(uri, str(tmp_path / "models")).provide("lamp")


@pytest.mark.parametrize("length", ["\xb2", "9" * 5000])
def test_a_length_that_is_none_is_reported(length, server, database, tmp_path):
    server.add("lamp")
    server.headers["lamp/model.tar.gz"] = {"Content-Length": length}
    with pytest.raises(ModelNotProvidedError):
        database().provide("lamp")
    assert nothing_left(tmp_path)


def test_a_passing_fault_is_tried_again(server, database):
    server.add("lamp")
    server.fail["lamp/model.tar.gz"] = 3
    assert database().provide("lamp")
    assert server.asked.count("lamp/model.tar.gz") == 4


BROKEN = {
    "cut-off": lambda data: (data, {"Content-Length": str(len(data) + 5)}),
    "content-md5": lambda data: (data, {"Content-MD5": base64.b64encode(b"x" * 16).decode()}),
    "etag": lambda data: (data, {"ETag": '"' + "0" * 32 + '"'}),
    "gzip-crc": lambda data: (data[:-8] + b"\0\0\0\0" + data[-4:], {}),
    "no-gzip": lambda data: (b"<html>not found</html>", {}),
    "truncated-gzip": lambda data: (data[:-20], {}),
}


@pytest.mark.parametrize("fault", BROKEN)
def test_a_damaged_archive_leaves_nothing_behind(fault, server, database, tmp_path):
    server.add("lamp")
    path = "lamp/model.tar.gz"
    server.files[path], server.headers[path] = BROKEN[fault](server.files[path])
    with pytest.raises(ModelNotProvidedError):
        database().provide("lamp")
    assert nothing_left(tmp_path)


def test_right_checksums_are_taken(server, database):
    server.add("lamp")
    digest = hashlib.md5(server.files["lamp/model.tar.gz"])
    server.headers["lamp/model.tar.gz"] = {
        "ETag": f'"{digest.hexdigest()}"', "Content-Length": None,
        "Content-MD5": base64.b64encode(digest.digest()).decode()}
    assert database().provide("lamp")


HOSTILE = {
    "absolute": entry("/tmp/evil.txt"), "dots": entry("lamp/../../evil.txt"),
    "outside": entry("evil/x.txt"), "top": entry("lamp2"),
    "link-out": entry("lamp/l", kind=tarfile.SYMTYPE, target="/etc"),
    "hard-link": entry("lamp/h", kind=tarfile.LNKTYPE, target="/etc/passwd"),
    "device": entry("lamp/d", kind=tarfile.CHRTYPE), "pipe": entry("lamp/p", kind=tarfile.FIFOTYPE),
}


@pytest.mark.parametrize("kind", HOSTILE)
def test_an_archive_that_reaches_out_is_refused_whole(kind, server, database, tmp_path):
    server.add("lamp", more=[(HOSTILE[kind], b"")])
    with pytest.raises(ModelNotProvidedError):
        database().provide("lamp")
    assert nothing_left(tmp_path)
    assert [p.name for p in tmp_path.iterdir() if "evil" in p.name] == []


@pytest.mark.parametrize("limits", [
    Limits(archive_bytes=100), Limits(unpacked_bytes=100), Limits(files=2), Limits(list_bytes=10),
])
def test_what_is_too_large_is_refused(limits, server, database, tmp_path):
    server.add("lamp")
    with pytest.raises(ModelNotProvidedError):
        database(limits=limits).provide("lamp")
    assert nothing_left(tmp_path)


def test_a_size_that_is_not_told_is_limited_too(server, database):
    server.add("lamp")
    server.files["lamp/model.tar.gz"] = gzip.compress(os.urandom(100000))
    server.headers["lamp/model.tar.gz"] = {"Content-Length": None}
    with pytest.raises(ModelNotProvidedError, match="limit of 1000 bytes"):
        database(limits=Limits(archive_bytes=1000)).provide("lamp")


def test_an_archive_that_is_all_headers_costs_this_process_nothing(server, database, tmp_path):
    server.add("lamp")
    stream = io.BytesIO()
    with gzip.GzipFile(fileobj=stream, mode="wb", compresslevel=1) as packed:
        packed.write(entry("lamp/x", 300 << 20, tarfile.XHDTYPE).tobuf(tarfile.USTAR_FORMAT))
        for _ in range(300):
            packed.write(bytes(1 << 20))
    server.files["lamp/model.tar.gz"] = stream.getvalue()
    assert len(stream.getvalue()) < 2 << 20
    before = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    with pytest.raises(ModelNotProvidedError, match="MB of memory"):
        database().provide("lamp")
    assert resource.getrusage(resource.RUSAGE_SELF).ru_maxrss - before < 64 << 10
    assert nothing_left(tmp_path)


@pytest.mark.parametrize("name", ["", ".", "..", "../x", "a/b", ".hidden", "a\0b", "a\n"])
def test_a_name_that_is_none_asks_nobody(name, server, database):
    with pytest.raises(ModelNotProvidedError):
        database().provide(name)
    assert server.asked == []


def test_what_is_there_is_never_asked_for(server, tmp_path):
    folder = tmp_path / "models" / "lamp"
    folder.mkdir(parents=True)
    (folder / "model.sdf").write_text(MODEL.format("lamp"))
    resolver = Resolver([str(tmp_path / "models")],
                        missing=ModelDatabase(server.uri, str(tmp_path / "models")))
    assert resolver.model_file("model://lamp") == str(folder / "model.sdf")
    assert server.asked == []


def test_the_deadline_counts_from_the_first_download(server, database):
    server.add("lamp")
    source = database(seconds=5.0)
    before = time.monotonic()
    source.provide("lamp")
    assert source._deadline is not None and source._deadline >= before + 5.0
