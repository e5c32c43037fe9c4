"""The editor's server by real sockets: greeting, changes, poses, several browsers, the end."""
from __future__ import annotations

import asyncio
import time

import aiohttp
import pytest
from editor_case import DEADLINE, Browser, Case, Refused, arm, box, cases, sun
from free_ports import free_port

from my_simulations.editor.editor_options import EditorOptions
from my_simulations.editor.transport import listening
from my_simulations.errors import CommandError, error
from my_simulations.geometry import STILL, Pose, Twist
from my_simulations.plugins.plugin_state import PluginState

case = pytest.fixture(cases)


def test_a_browser_gets_the_whole_world_with_present_poses(case):
    made = case(box("a", (1.0, 2.0, 3.0)), arm("b"), lights=[sun()])
    made.sim.states.set_model_state("a", Pose((5.0, 0.0, 1.0)), STILL)

    async def look(browser):
        assert [model["name"] for model in browser.document["models"]] == ["a", "b"]
        assert browser.model("a")["pose"][:3] == [5.0, 0.0, 1.0]
        assert browser.light("sun")["type"] == "directional"
        await browser.until(lambda: len(browser.poses) == 3)
        assert browser.link_pose("b", 1) == pytest.approx([0.0, 0.0, 1.0])

    made.browse(look)


def test_a_page_of_another_version_is_refused(case):
    async def greet(browser):
        with pytest.raises(Refused) as refused:
            await browser.ask("hello", version=99)
        assert refused.value.code == "version"

    case().browse(greet, hello=False)


def test_what_others_do_to_the_world_arrives_as_changes(case):
    made = case(box("a"))

    async def watch(browser):
        made.sim.models.spawn(box("b"))
        await browser.until(lambda: browser.model("b"))
        made.sim.models.delete("a")
        await browser.until(lambda: not browser.model("a"))
        made.sim.lights.add(sun())
        await browser.until(lambda: browser.light("sun"))
        assert browser.last("world") is browser.pushes[0]  # all of it was told by differences

    made.browse(watch)


def test_poses_of_what_moves_come_and_of_nothing_else(case):
    made = case(box("still"), box("flying"), paused=False)
    made.sim.states.set_model_state("flying", Pose((0, 0, 9)), Twist((1.0, 0.0, 0.0)))

    async def watch(browser):
        await browser.until(lambda: len(browser.poses) == 2)
        first = browser.link_pose("flying")[0]
        count = len(browser.frames)
        await browser.until(lambda: browser.link_pose("flying")[0] > first + 0.2)
        assert {frame[3] for frame in browser.frames[count:]} == {1}
        assert browser.frames[-1][0] == 1

    made.browse(watch)


def test_a_world_that_stands_still_is_looked_at_less_often_until_something_happens(case):
    made = case(box("a"))
    hub = made.server._editor.hub

    async def quiet():
        deadline = asyncio.get_running_loop().time() + DEADLINE
        while not hub._is_idle():
            assert asyncio.get_running_loop().time() < deadline, "it never comes to rest"
            await asyncio.sleep(0.01)

    async def watch(browser):
        await quiet()
        made.sim.models.spawn(box("b"))          # by another client
        await browser.until(lambda: browser.model("b"))
        assert not hub._is_idle()
        await quiet()
        await browser.ask("folders")      # by a page
        assert not hub._is_idle()
        await quiet()
        made.sim.clock.unpause()
        assert not hub._is_idle()
        made.sim.states.set_model_state("a", Pose((0, 0, 9)), Twist((1.0, 0.0, 0.0)))
        await browser.until(lambda: browser.link_pose("a")[0] > 0.1)

    made.browse(watch)


def test_a_paused_world_sends_no_frames(case):
    made = case(box("a"))

    async def watch(browser):
        await browser.until(lambda: browser.poses)
        await browser.ask("folders")
        count = len(browser.frames)
        await browser.edit("set", target="", path="gravity", value=[0, 0, -1])
        await browser.until(lambda: browser.document["gravity"] == [0, 0, -1])
        assert len(browser.frames) == count

    made.browse(watch)


def test_several_browsers_see_each_others_edits_and_history(case):
    made = case(box("a"))

    async def both(first):
        second = await Browser.open(first.session, made.url)
        await first.edit("insert", shape="sphere")
        await second.until(lambda: second.model("unit_sphere"))
        await second.until(lambda: second.last("history")["undo"] == ["Insert unit_sphere"])
        await second.ask("undo")
        await first.until(lambda: not first.model("unit_sphere"))
        await first.until(lambda: first.last("history")["redo"] == ["Insert unit_sphere"])

    made.browse(both)


def test_time_stands_and_goes_on_request(case):
    made = case(box("a"))

    async def run(browser):
        step = (await browser.ask("step", steps=7))["step"]
        assert step == 7 == made.sim.clock.step
        await browser.until(lambda: browser.last("stats")["iterations"] == 7)
        await browser.ask("play")
        await browser.until(lambda: not browser.last("stats")["paused"])
        assert not made.sim.clock.paused
        await browser.until(lambda: browser.last("stats")["factor"] > 0)
        await browser.ask("pause")
        await browser.until(lambda: browser.last("stats")["paused"])
        for steps in (0, -1, 10 ** 9):
            with pytest.raises(Refused):
                await browser.ask("step", steps=steps)

    made.browse(run)


def test_the_times_of_issues_grow_also_if_the_clock_is_set_back(case, monkeypatch):
    made = case()
    monkeypatch.setattr(time, "time", iter(range(10 ** 9, 0, -1)).__next__)

    async def run(browser):
        for code in ("first", "second"):
            made.server.show_issue(error(code, "text"))
        await browser.until(lambda: sum(push["type"] == "issue" for push in browser.pushes) == 2)
        first, second = (push["time"] for push in browser.pushes if push["type"] == "issue")
        assert 0 < first < second

    made.browse(run)


def test_what_is_no_message_is_refused_and_the_connection_lives(case):
    async def talk(browser):
        for text in ("nonsense", "[]", "{}", '{"type": "nix"}', '{"type": "edit"}',
                     '{"type": "step", "steps": NaN, "id": 2}', '{"type": 5}',
                     '{"type": "edit", "id": "one", "op": {}}', "[" * 100000,
                     '{"type": "undo", "id": 1e999}', '{"type": "undo", "id": true}',
                     '{"type": "undo", "id": 1' + 400 * "0" + "}"):
            count = sum(push["type"] == "issue" for push in browser.pushes)
            await browser.socket.send_str(text)
            await browser.until(
                lambda n=count: sum(push["type"] == "issue" for push in browser.pushes) > n)
            assert browser.last("issue")["issue"]["code"] == "protocol"
        with pytest.raises(Refused) as refused:
            await browser.ask("step", steps="many")
        assert refused.value.code == "protocol"
        with pytest.raises(Refused) as refused:
            await browser.ask("step", steps=1, more=2)
        assert "more" in str(refused.value)
        assert (await browser.ask("step", steps=1))["step"] == 1

    case().browse(talk)


def test_issues_are_shown_with_file_and_line_also_to_who_comes_later(case):
    made = case()

    async def see(first):
        made.server.show_issue(error("bad", "it is bad", file="/a.world", line=3))
        await first.until(lambda: first.last("issue"))
        second = await Browser.open(first.session, made.url)
        await second.until(lambda: second.last("issue"))
        shown = second.last("issue")["issue"]
        assert (shown["code"], shown["file"], shown["line"]) == ("bad", "/a.world", 3)

    made.browse(see)


def test_a_known_session_is_not_told_old_issues_again(case):
    made = case()

    async def see(first):
        made.server.show_issue(error("bad", "it is bad"))
        await first.until(lambda: first.last("issue"))
        fresh = await Browser.open(first.session, made.url, hello=False)
        known = (await fresh.ask("hello", version=1))["session"]
        again = await Browser.open(first.session, made.url, hello=False)
        assert (await again.ask("hello", version=1, session=known))["session"] == known
        await again.until(lambda: again.last("history"))
        assert again.last("issue") is None

    made.browse(see)


def test_a_session_of_another_simulator_is_a_new_one_and_is_shown_all_issues(case):
    made = case()

    async def see(first):
        made.server.show_issue(error("bad", "it is bad"))
        await first.until(lambda: first.last("issue"))
        other = await Browser.open(first.session, made.url, hello=False)
        assert (await other.ask("hello", version=1, session="0a1b-2c3d"))["session"] != "0a1b-2c3d"
        await other.until(lambda: other.last("issue"))
        assert other.last("issue")["time"] == first.last("issue")["time"]

    made.browse(see)


def test_the_end_is_announced(case):
    made = case()

    async def wait(browser):
        await asyncio.get_running_loop().run_in_executor(None, made.server.stop, "over")
        await browser.until(lambda: browser.last("shutdown"))
        assert browser.last("shutdown")["reason"] == "over"

    made.browse(wait)


def test_an_engine_that_dies_costs_nobody_the_connection(case):
    made = case(box("a", (1.0, 0.0, 0.5)))

    async def survive(browser):
        await asyncio.get_running_loop().run_in_executor(None, made.engine.kill)
        await browser.edit("insert", shape="box")
        await browser.until(lambda: browser.model("unit_box"))
        await browser.until(lambda: browser.link_pose("a") == pytest.approx([1.0, 0.0, 0.5]))

    made.browse(survive)


def test_a_dragged_body_moves_live_and_a_move_is_one_step_from_where_it_was(case):
    made = case(box("a", (0.0, 0.0, 0.5)))

    async def drag(browser):
        for x in (1.0, 2.0, 3.0):
            await browser.notify("drag", names=["a"], poses=[[x, 0, 0.5, 0, 0, 0, 1]])
        await browser.until(lambda: browser.link_pose("a") == pytest.approx([3.0, 0.0, 0.5]))
        assert browser.last("history")["undo"] == []
        await browser.edit("move", poses={"a": [4, 0, 0.5, 0, 0, 0, 1]}, label="translate")
        assert made.sim.states.model_state("a")[0].position[0] == pytest.approx(4.0)
        await browser.ask("undo")
        assert made.sim.states.model_state("a")[0].position[0] == pytest.approx(0.0)
        await browser.ask("redo")
        assert made.sim.states.model_state("a")[0].position[0] == pytest.approx(4.0)

    made.browse(drag)


def test_a_drag_that_is_broken_off_goes_back(case):
    made = case(box("a"), lights=[sun()])

    async def drag(browser):
        await browser.notify("drag", names=["a", "sun"],
                           poses=[[9, 0, 0.5, 0, 0, 0, 1], [7, 0, 0, 0, 0, 0, 1]])
        await browser.until(lambda: browser.light("sun")["pose"][0] == 7)
        await browser.notify("drag_end")
        await browser.until(lambda: browser.light("sun")["pose"][0] == 0)
        assert made.sim.states.model_state("a")[0].position[0] == pytest.approx(0.0)
        other = await Browser.open(browser.session, made.url)
        await other.notify("drag", names=["a"], poses=[[9, 0, 0.5, 0, 0, 0, 1]])
        await browser.until(lambda: (browser.link_pose("a") or [0])[0] == pytest.approx(9.0))
        await other.socket.close()
        await browser.until(lambda: browser.link_pose("a")[0] == pytest.approx(0.0))

    made.browse(drag)


@pytest.mark.parametrize("how", ["open", "new"])
def test_a_drag_ends_with_its_world(case, how):
    """What follows it leaves the models of the next world alone, of the same names or not."""
    made = case(box("a"))

    async def drag(browser):
        await browser.ask("save", path="kept.world")
        await browser.edit("move", poses={"a": [5, 0, 0.5, 0, 0, 0, 1]})
        await browser.notify("drag", names=["a"], poses=[[9, 0, 0.5, 0, 0, 0, 1]])
        await browser.until(lambda: browser.link_pose("a") == pytest.approx([9.0, 0.0, 0.5]))
        if how == "new":
            await browser.ask("new", discard=True)
            await browser.edit("insert", shape="box", name="a", pose=[0, 0, 0.5, 0, 0, 0, 1])
        else:
            await browser.ask("open", path="kept.world", discard=True)
        await browser.ask("drag_end")
        assert made.sim.states.model_state("a")[0].position[0] == pytest.approx(0.0)
        assert browser.last("people")["people"][0]["held"] == []

    made.browse(drag)


def test_a_drag_of_what_is_not_there_harms_nobody(case):
    async def drag(browser):
        await browser.notify("drag", names=["nix"], poses=[[0, 0, 0, 0, 0, 0, 1]])
        await browser.notify("drag", names=["a", "b"], poses=[[0, 0, 0, 0, 0, 0, 1]])
        await browser.until(lambda: browser.last("issue"))
        assert (await browser.ask("step", steps=1))["step"] == 1

    case(box("a")).browse(drag)


def test_a_port_that_is_taken_is_told(case, tmp_path):
    made = case()
    port = int(made.url.rstrip("/").rpartition(":")[2])
    with pytest.raises(CommandError, match=str(port)):
        Case(tmp_path, port=port)


def test_a_default_port_that_is_taken_is_named_and_the_next_free_one_used(monkeypatch):
    taken = free_port()
    monkeypatch.setattr(listening, "DEFAULT_PORT", taken)
    issues = []
    options = EditorOptions(port=taken, log=issues.append)
    with listening.open_listening_socket(options) as first, \
            listening.open_listening_socket(options) as second:
        assert first.getsockname()[1] == taken
        port = second.getsockname()[1]
    assert taken < port < taken + 100
    assert [issue.code for issue in issues] == ["editor-port"]
    assert f"port {taken} is in use" in issues[0].message
    assert f"listens at port {port}" in issues[0].message


def test_a_page_that_is_not_installed_is_told(tmp_path):
    with pytest.raises(CommandError, match="protocol.json"):
        Case(tmp_path, web=str(tmp_path))


def test_too_large_a_message_ends_the_connection(case):
    made = case()

    async def send(browser):
        await browser.socket.send_str('"' + "x" * (33 << 20) + '"')
        await browser._reader
        assert browser.socket.close_code == aiohttp.WSCloseCode.MESSAGE_TOO_BIG

    made.browse(send)


def test_states_of_plugins_are_sent_when_they_change(case):
    states = [PluginState("a", "drive", "libdrive.so", "waiting")]
    made = case(box("a"), plugins=lambda: list(states))

    async def follow(browser):
        await browser.until(lambda: any(one["type"] == "plugins" and one["states"] == [
            {"model": "a", "name": "drive", "filename": "libdrive.so", "state": "waiting",
             "reason": "", "parameters": []}] for one in browser.pushes))
        states[0] = PluginState("a", "drive", "libdrive.so", "failed", "no joint")
        await browser.until(lambda: browser.last("plugins")["states"][0]["reason"] == "no joint")

    made.browse(follow)
