"""State logs of an earlier session find the files that this one may serve, and no others."""
from __future__ import annotations

import hashlib
from dataclasses import replace
from urllib.error import HTTPError
from urllib.request import urlopen

import pytest
from editor_case import Case, box

from my_simulations.description.shapes import Material, Mesh
from my_simulations.editor.scene.served_files import ServedFiles
from my_simulations.resources.resolver import Resolver


def mesh_model(path, **material):
    model = box(path.stem)
    model.links[0].visuals[0].geometry = Mesh(f"file://{path}", str(path))
    model.links[0].visuals[0].material = Material(**material) if material else None
    return model


def resolver(models, package):
    return Resolver([str(folder) for folder in models],
                    find_package={"robots": str(package)}.get, packages=lambda: [str(package)])


@pytest.fixture
def places(tmp_path):
    """Meshes in a model folder, a package, a world's folder in that, and a folder of its own."""
    found = {"model": tmp_path / "models" / "m" / "model.dae",
             "part": tmp_path / "robots" / "meshes" / "part.dae",
             "near": tmp_path / "robots" / "worlds" / "near.dae",
             "private": tmp_path / "private" / "private.dae"}
    for path in found.values():
        path.parent.mkdir(parents=True)
        path.write_text("<COLLADA/>")
    (tmp_path / "robots" / "package.xml").write_text("<package><name>robots</name></package>")
    (tmp_path / "models" / "m" / "bark.png").write_bytes(b"\x89PNG")
    return found


def status(url):
    try:
        with urlopen(url) as answer:
            return answer.status
    except HTTPError as refusal:
        return refusal.code


def test_a_log_of_an_earlier_session_finds_its_meshes_and_textures(places, tmp_path):
    models = [tmp_path / "models", tmp_path / "private"]
    shown = [mesh_model(path) for name, path in places.items() if name != "model"]
    texture = str(tmp_path / "models" / "m" / "bark.png")
    first = Case(tmp_path, [mesh_model(places["model"], texture=texture), *shown],
                 resolver=resolver(models, tmp_path / "robots"))
    first.sim._session.world = replace(first.sim.world, file=str(places["near"].parent / "x.world"))

    async def record(browser):
        await browser.ask("log_start", name="flight")
        await browser.ask("step", steps=5)
        await browser.ask("log_stop")

    try:
        first.browse(record)
    finally:
        first.close()
    second = Case(tmp_path, resolver=resolver(models[:1], tmp_path / "robots"))

    async def replay(browser):
        await browser.ask("log_open", name="flight")
        await browser.until(lambda: browser.model("model"))
        visuals = {name: browser.model(name)["links"][0]["visuals"][0] for name in places}
        return {**{name: visual["geometry"]["url"] for name, visual in visuals.items()},
                "texture": visuals["model"]["material"]["texture"]["url"]}

    try:
        urls = second.browse(replay)
        found = {name: status(second.url.rstrip("/") + url) for name, url in urls.items()}
    finally:
        second.close()
    assert found == {"model": 200, "part": 200, "near": 200, "texture": 200, "private": 404}


def test_a_log_cannot_name_a_folder_that_may_not_be_served(places, tmp_path):
    served = ServedFiles(resolver([tmp_path / "models"], tmp_path / "robots"))

    def ask(folder, beside):
        known = hashlib.sha256(str(folder).encode()).hexdigest()[:10]
        served.serve_again(f'"/resource/{known}/private.dae"'.encode(), str(beside))
        return [served.path(known, inside) for inside in ("private.dae", "private/private.dae")]

    for beside in (tmp_path / "private", tmp_path, "", "/", "nowhere", "/a\0b"):
        assert ask(tmp_path / "private", beside) == [None, None]
        assert ask(tmp_path, beside) == [None, None]
        assert ask("/", beside) == [None, None]
