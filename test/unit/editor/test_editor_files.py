"""World files from the editor: save, open, new, listing; and edits that survive a crash."""
from __future__ import annotations

import asyncio
import json
import os
import subprocess
import sys
import threading

import pytest
from editor_case import Browser, Refused, box, cases

from my_simulations.editor.library import world_files
from my_simulations.editor.library.autosave import process_id
from my_simulations.formats.reading import parse_world, read_world
from my_simulations.resources.package_files import own_directory
from my_simulations.resources.resolver import Resolver

case = pytest.fixture(cases)


def test_save_asks_for_a_name_once_and_replaces_its_own_file_later(case):
    made = case(box("a"))

    async def save(browser):
        await browser.edit("insert", shape="box")
        with pytest.raises(Refused) as refused:
            await browser.ask("save")
        assert refused.value.code == "path-needed"
        path = (await browser.ask("save", path="mine"))["path"]
        assert path == str(made.worlds / "mine.world")
        await browser.until(lambda: not browser.last("history")["dirty"])
        assert browser.last("history")["file"] == path
        await browser.edit("insert", shape="sphere")
        assert (await browser.ask("save"))["path"] == path
        loaded = read_world(path, Resolver())
        world, issues = loaded.world, loaded.issues
        assert [model.name for model in world.models] == ["a", "unit_box", "unit_sphere"]
        assert not [issue for issue in issues if issue.severity.value == "error"]

    made.browse(save)


def test_a_copy_has_the_state_and_leaves_the_file_of_the_world_alone(case):
    made = case(box("a"))

    async def clone(browser):
        await browser.ask("save", path="mine")
        await browser.edit("insert", shape="box")
        await browser.ask("step", steps=5)
        with pytest.raises(Refused) as refused:
            await browser.ask("save", path="mine", copy=True)
        assert refused.value.code == "exists"
        path = (await browser.ask("save", path="clone", copy=True))["path"]
        assert path == str(made.worlds / "clone.world")
        assert browser.last("history")["file"] == str(made.worlds / "mine.world")
        assert browser.last("history")["dirty"]
        with open(path, encoding="utf-8") as stream:
            world, _ = parse_world(stream.read(), Resolver())
        assert [model.name for model in world.models] == ["a", "unit_box"]
        assert world.state is not None and world.state.sim_time_ns == 5_000_000

    made.browse(clone)


def test_no_file_is_replaced_without_asking(case):
    made = case(box("a"))
    there = made.worlds / "there.world"
    there.write_text("precious")

    async def save(browser):
        with pytest.raises(Refused) as refused:
            await browser.ask("save", path="there.world")
        assert refused.value.code == "exists"
        assert there.read_text() == "precious"
        await browser.ask("save", path="there.world", overwrite=True)
        assert "<world" in there.read_text()

    made.browse(save)


LOSSY = """<sdf version="1.6"><world name="w">
<include><uri>model://nowhere</uri></include>
<model name="a"><static>true</static><link name="l"/></model></world></sdf>"""


def test_a_file_of_which_a_part_was_not_loaded_is_replaced_only_when_asked_to(case):
    made = case(box("a"))
    there = made.worlds / "lossy.world"
    there.write_text(LOSSY)

    async def save(browser):
        await browser.ask("open", path="lossy.world", discard=True)
        with pytest.raises(Refused, match="not everything in the file could be loaded") as refused:
            await browser.ask("save")
        assert refused.value.code == "path-needed"
        with pytest.raises(Refused, match="would be lost: .*nowhere") as refused:
            await browser.ask("save", path="lossy.world")
        assert refused.value.code == "exists" and there.read_text() == LOSSY
        other = (await browser.ask("save", path="other"))["path"]
        assert (await browser.ask("save"))["path"] == other
        assert there.read_text() == LOSSY
        await browser.ask("save", path="lossy.world", overwrite=True)
        assert "nowhere" not in there.read_text()

    made.browse(save)


@pytest.mark.parametrize("path", ["../out.world", "/etc/x.world", "x.txt", "a\0.world",
                                  "link/x.world"])
def test_nothing_is_written_elsewhere(case, path, tmp_path):
    made = case(box("a"))
    os.symlink(tmp_path, made.worlds / "link")

    async def save(browser):
        with pytest.raises(Refused):
            await browser.ask("save", path=path, overwrite=True)

    made.browse(save)
    assert not [name for name in os.listdir(tmp_path) if name.endswith(".world")]


def test_a_saved_world_is_opened_as_it_was(case):
    made = case(box("a", (1.0, 2.0, 0.5)))

    async def run(browser):
        await browser.ask("save", path="one")
        await browser.edit("move", poses={"a": [9, 9, 9, 0, 0, 0, 1]})
        with pytest.raises(Refused) as refused:
            await browser.ask("open", path="one.world")
        assert refused.value.code == "unsaved"
        await browser.ask("open", path="one.world", discard=True)
        assert made.sim.states.model_state("a")[0].position == (1.0, 2.0, 0.5)
        await browser.until(lambda: browser.last("history")["undo"] == []
                            and not browser.last("history")["dirty"])
        await browser.ask("new")
        assert made.sim.models.names() == ["ground_plane"]
        await browser.until(lambda: browser.last("history")["file"] == "")

    made.browse(run)


def test_folders_are_listed_while_a_world_opens(case, monkeypatch):
    made = case(box("a"))
    (made.worlds / "slow.world").write_text(
        "<sdf version='1.7'><world name='w'><model name='b'><link name='l'/></model></world></sdf>")
    begun, listed = threading.Event(), threading.Event()
    load = world_files.load_world

    def slow(*args, **more):
        begun.set()
        assert listed.wait(60.0)
        return load(*args, **more)

    monkeypatch.setattr(world_files, "load_world", slow)

    async def run(browser):
        opening = asyncio.ensure_future(browser.ask("open", path="slow.world"))
        await asyncio.get_running_loop().run_in_executor(None, begun.wait, 60.0)
        found = await browser.ask("folders")
        assert [entry["name"] for entry in found["files"]] == ["slow.world"]
        assert not opening.done() and made.sim.models.names() == ["a"]
        listed.set()
        await opening
        assert made.sim.models.names() == ["b"]

    try:
        made.browse(run)
    finally:
        listed.set()


def test_a_file_that_is_no_world_leaves_the_old_one(case):
    made = case(box("a"))
    (made.worlds / "bad.world").write_text("<sdf version='1.7'><world name=")

    async def run(browser):
        for path in ("bad.world", "missing.world", "/etc/passwd"):
            with pytest.raises(Refused):
                await browser.ask("open", path=path)
        assert made.sim.models.names() == ["a"]

    made.browse(run)


def test_what_the_launch_file_spawned_is_saved_when_asked_for_and_then_by_every_save(case):
    made = case(box("a"))
    made.sim.models.spawn(box("robo", (2.0, 0.0, 0.5)), launched=True)

    def saved():
        world, _ = parse_world((made.worlds / "w.world").read_bytes(), Resolver())
        return [model.name for model in world.models], world.state is not None

    async def save(browser):
        found = await browser.ask("folders")
        assert found["launched"] == ["robo"]
        assert found["chosen"] == {"state": False, "launched": False}
        reply = await browser.ask("save", path="w.world")
        assert reply["left_out"] == ["robo"] and saved() == (["a"], False)
        reply = await browser.ask("save", path="w.world", overwrite=True, launched=True, state=True)
        assert reply["left_out"] == [] and saved() == (["a", "robo"], True)
        assert (await browser.ask("folders"))["chosen"] == {"state": True, "launched": True}
        await browser.ask("save")
        assert saved() == (["a", "robo"], True)

    made.browse(save)


def test_no_save_goes_into_a_file_that_ships(case):
    world = os.path.join(own_directory(), "world")
    shipped = os.path.join(world, "lab_course.world")
    with open(shipped, "rb") as file:
        before = file.read()
    made = case(box("a"), save_roots=[world])

    async def save(browser):
        with pytest.raises(Refused, match="ships with my_simulations"):
            await browser.ask("save", path="lab_course.world", overwrite=True)
        await browser.ask("open", path="lab_course.world")
        with pytest.raises(Refused) as refused:
            await browser.ask("save")
        assert refused.value.code == "path-needed"

    made.browse(save)
    with open(shipped, "rb") as file:
        assert file.read() == before


def test_a_file_dialog_starts_where_the_command_was_typed_then_beside_the_users_world(
        case, tmp_path, monkeypatch):
    monkeypatch.setenv("HOME", str(tmp_path / "home"))
    typed, mine = tmp_path / "course", tmp_path / "course/mine"
    mine.mkdir(parents=True)
    made = case(box("a"), save_roots=None, caller=str(typed))

    async def save(browser):
        found = await browser.ask("folders")
        assert found["path"] == str(typed)
        users = str(tmp_path / "home/my_simulations/worlds")
        assert users in found["roots"]
        found = await browser.ask("folders", path=users)
        assert (found["folders"], found["files"]) == ([], [])
        assert (await browser.ask("save", path="one"))["path"] == f"{users}/one.world"
        await browser.ask("save", path=str(mine / "two.sdf"))
        assert (await browser.ask("folders"))["path"] == str(mine)
        assert (await browser.ask("save", path="three"))["path"] == str(mine / "three.world")

    made.browse(save)


def test_a_file_dialog_starts_in_the_first_folder_if_the_command_was_typed_in_none(
        case, tmp_path):
    made = case(caller=str(tmp_path))

    async def look(browser):
        assert (await browser.ask("folders"))["path"] == str(made.worlds)

    made.browse(look)


def test_a_new_folder_is_created_in_an_allowed_folder_only(case, tmp_path):
    made = case()
    outside = tmp_path / "outside"
    outside.mkdir()
    (made.worlds / "link").symlink_to(outside)

    async def create(browser):
        reply = await browser.ask("new_folder", parent=str(made.worlds), name=" first ")
        assert reply["path"] == str(made.worlds / "first")
        inner = await browser.ask("new_folder", parent=reply["path"], name="second")
        assert os.path.isdir(inner["path"])
        refusals = [(str(made.worlds), name, "folder-name")
                    for name in ("", "..", ".", ".x", "a/b", "../out")]
        refusals += [(str(parent), "new", "not-allowed")
                     for parent in (outside, made.worlds / "link", made.worlds / "..", "/")]
        refusals += [(str(made.worlds), "first", "exists"),
                     (str(made.worlds), "link", "exists"),
                     (str(made.worlds), "n" * 300, "folder-not-created")]
        for parent, name, code in refusals:
            with pytest.raises(Refused) as refused:
                await browser.ask("new_folder", parent=parent, name=name)
            assert refused.value.code == code, (parent, name)
        with pytest.raises(Refused):
            await browser.ask("new_folder", parent=str(made.worlds), name="a\u202eb")
        assert os.listdir(str(outside)) == []
        assert sorted(os.listdir(str(made.worlds))) == ["first", "link"]

    made.browse(create)


def test_folders_and_worlds_are_listed_below_the_roots_only(case, tmp_path):
    made = case()
    (made.worlds / "inner").mkdir()
    (made.worlds / "b.world").write_text("x")
    (made.worlds / "note.txt").write_text("x")
    (made.worlds / ".hidden").mkdir()

    async def look(browser):
        found = await browser.ask("folders")
        assert [entry["name"] for entry in found["folders"]] == ["inner"]
        assert [entry["name"] for entry in found["files"]] == ["b.world"]
        assert found["parent"] is None and found["roots"] == [str(made.worlds)]
        inner = await browser.ask("folders", path=str(made.worlds / "inner"))
        assert inner["parent"] == str(made.worlds)
        for path in (str(tmp_path), "/", str(made.worlds / "inner/../../.."), "~"):
            with pytest.raises(Refused) as refused:
                await browser.ask("folders", path=path)
            assert refused.value.code == "not-allowed"

    made.browse(look)


def entries(made):
    folder = made.folder / "cache" / "autosave"
    return sorted(folder.glob("*.json")) if folder.exists() else []


async def kept(condition):
    """Wait for the autosave, which comes by itself."""
    for _ in range(1200):
        if condition():
            return
        await asyncio.sleep(0.05)
    raise AssertionError("the autosave did not come")


def of_a_dead_process(made):
    """The entry as another process would have left it that was killed."""
    [about] = entries(made)
    gone = subprocess.run([sys.executable, "-c", "import os; print(os.getpid())"],
                          capture_output=True, text=True, check=True)
    data = json.loads(about.read_text())
    data["process"] = f"{gone.stdout.strip()}/1/of-a-boot-that-is-over"
    about.write_text(json.dumps(data))


def test_unsaved_edits_of_a_server_that_was_killed_are_offered_and_restored(case):
    first = case(box("a"))
    first.sim.models.spawn(box("robo", (3.0, 0.0, 0.5)), launched=True)

    async def edit(browser):
        await browser.edit("insert", shape="box", pose=[1, 1, 0.5, 0, 0, 0, 1])
        await kept(lambda: entries(first))

    first.browse(edit)
    first.close()
    assert entries(first)  # still dirty: it stays
    of_a_dead_process(first)
    second = case(box("a"))

    async def restore(browser):
        await browser.until(lambda: browser.last("autosave"))
        assert browser.last("autosave")["found"]
        await browser.ask("autosave", action="restore")
        assert second.sim.states.model_state("unit_box")[0].position == (1, 1, 0.5)
        assert second.sim.models.launched() == ["robo"]  # the launch file's, as before
        await browser.until(lambda: browser.last("history")["dirty"])
        await browser.until(lambda: not browser.last("autosave")["found"])
        other = await Browser.open(browser.session, second.url)
        await other.until(lambda: other.last("history"))
        assert other.last("autosave") is None
        assert len(entries(second)) == 1  # the edits are still unsaved and kept again

    second.browse(restore)


async def insert_and_keep(browser, made):
    await browser.edit("insert", shape="box")
    await kept(lambda: entries(made))


def test_discarded_edits_are_not_offered_again_and_can_be_recovered_for_a_week(case):
    first = case(box("a"))
    first.browse(lambda browser: insert_and_keep(browser, first))
    first.close()
    of_a_dead_process(first)
    second = case(box("a"))

    async def discard(browser):
        await browser.ask("autosave", action="discard")
        with pytest.raises(Refused):
            await browser.ask("autosave", action="restore")

    second.browse(discard)
    second.close()
    third = case(box("a"))

    async def recover(browser):
        await browser.until(lambda: browser.last("history"))
        assert browser.last("autosave") is None
        [entry] = (await browser.ask("autosave", action="list"))["entries"]
        assert entry["discarded"] is True
        await browser.ask("autosave", action="restore", name=entry["name"])
        await browser.until(lambda: browser.model("unit_box"))
        assert (await browser.ask("autosave", action="list"))["entries"] == []

    third.browse(recover)
    third.close()
    [about] = entries(third)
    data = json.loads(about.read_text())
    about.write_text(json.dumps({**data, "discarded": data["time"] - 8 * 86400}))
    case(box("a"))
    assert entries(third) == []


def test_edits_of_another_world_are_mentioned_and_not_offered(case):
    first = case(box("a"))
    first.browse(lambda browser: insert_and_keep(browser, first))
    first.close()
    of_a_dead_process(first)
    [about] = entries(first)
    data = json.loads(about.read_text())
    about.write_text(json.dumps({**data, "file": "/worlds/other.world"}))
    second = case(box("a"))

    async def look(browser):
        await browser.until(lambda: browser.last("autosave"))
        assert browser.last("autosave")["found"] is False
        assert browser.last("autosave")["others"] == 1
        [entry] = (await browser.ask("autosave", action="list"))["entries"]
        assert entry["file"] == "/worlds/other.world"

    second.browse(look)


def test_what_opening_another_world_discards_can_be_recovered(case):
    made = case(box("a"))

    async def discard(browser):
        await insert_and_keep(browser, made)
        await browser.ask("new", discard=True)
        await browser.until(lambda: browser.model("ground_plane"))
        [entry] = (await browser.ask("autosave", action="list"))["entries"]
        await browser.edit("insert", shape="sphere")
        await browser.ask("autosave", action="restore", name=entry["name"])
        await browser.until(lambda: browser.model("unit_box"))
        # What was in its place can be recovered in turn.
        [entry] = (await browser.ask("autosave", action="list"))["entries"]
        await browser.ask("autosave", action="restore", name=entry["name"])
        await browser.until(lambda: browser.model("unit_sphere"))

    made.browse(discard)


def test_edits_of_a_server_that_lives_are_not_offered_to_others(case):
    first = case(box("a"))

    async def edit(browser):
        await browser.edit("insert", shape="box")
        await kept(lambda: entries(first))
        second = case(box("a"))
        other = await Browser.open(browser.session, second.url)
        await other.until(lambda: other.last("history"))
        assert other.last("autosave") is None

    first.browse(edit)


def test_saving_ends_the_autosave(case):
    made = case(box("a"))

    async def edit(browser):
        await browser.edit("insert", shape="box")
        await kept(lambda: entries(made))
        await browser.ask("save", path="x")
        await kept(lambda: not entries(made))

    made.browse(edit)


def test_a_process_is_told_from_a_later_one_of_its_number():
    mine = process_id(os.getpid())
    assert mine.startswith(f"{os.getpid()}/") and mine == process_id(os.getpid())
    assert process_id(2 ** 22 + 1) == ""
