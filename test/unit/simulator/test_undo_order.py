"""What was deleted comes back to its former place among models and lights."""
from __future__ import annotations

import threading
from dataclasses import replace

import pytest
from editor_case import box as shown_box
from editor_case import cases
from test_simulator import box, case, close  # noqa: F401

from my_simulations.description.light import Light
from my_simulations.description.model import Model
from my_simulations.errors import CommandError
from my_simulations.geometry import STILL, Pose
from my_simulations.simulator.history import LONGEST, History
from my_simulations.simulator.operations import (
    AddLight,
    AddModel,
    Group,
    RemoveLight,
    RemoveModel,
)
from my_simulations.simulator.saving import present_world

edited = pytest.fixture(cases)


def light_names(sim):
    return [light.name for light in sim.lights.all()]


def four_lights(sim):
    for name in "klmn":
        sim.lights.add(Light(name))


@pytest.mark.parametrize("name", ["a", "b", "d"])
def test_a_deleted_model_comes_back_to_its_place(case, name):
    sim = case(box("a"), box("b"), box("c"), box("d")).sim
    history = History(sim)
    history.do("delete", RemoveModel(name))
    before = sim.models.revision
    history.undo()
    assert sim.models.revision > before
    assert sim.models.names() == ["a", "b", "c", "d"]
    assert [model.name for model in present_world(sim).models] == ["a", "b", "c", "d"]
    assert sim.feed.states()[0].model_names == ["a", "b", "c", "d"]
    history.redo()
    assert name not in sim.models.names()
    history.undo()
    assert sim.models.names() == ["a", "b", "c", "d"]


def test_a_model_without_links_comes_back_to_its_place(case):
    sim = case(Model("a"), box("b")).sim
    sim.states.set_model_state("a", Pose((1, 2, 3)), STILL)
    history = History(sim)
    history.do("delete", RemoveModel("a"))
    history.undo()
    assert sim.models.names() == ["a", "b"]
    close(sim.states.model_state("a")[0], (1, 2, 3))


@pytest.mark.parametrize("name", ["k", "l", "n"])
def test_a_deleted_light_comes_back_to_its_place(case, name):
    sim = case().sim
    four_lights(sim)
    history = History(sim)
    history.do("delete", RemoveLight(name))
    for _ in range(2):
        history.undo()
        assert light_names(sim) == list("klmn")
        history.redo()
        assert name not in light_names(sim)


@pytest.mark.parametrize("names", ["ab", "ba", "dac", "abcd", "bd"])
def test_several_that_were_deleted_as_one_come_back_to_their_places(case, names):
    sim = case(box("a"), box("b"), box("c"), box("d")).sim
    four_lights(sim)
    lights = [chr(ord(name) + 10) for name in names]
    history = History(sim)
    history.do("delete", Group(tuple(
        operation for model, light in zip(names, lights)
        for operation in (RemoveModel(model), RemoveLight(light)))))
    for _ in range(2):
        history.undo()
        assert sim.models.names() == list("abcd")
        assert light_names(sim) == list("klmn")
        history.redo()
        assert not set(names) & set(sim.models.names())


@pytest.mark.parametrize("names", ["abce", "ecba", "cab", "bd"])
def test_several_models_are_added_and_deleted_by_one_command(case, monkeypatch, names):
    sim = case(box("a"), box("b"), box("c"), Model("d"), box("e")).sim
    sim.states.set_model_state("b", Pose((3, 2, 1)), STILL)
    sim.states.set_model_state("d", Pose((1, 2, 3)), STILL)
    sim.states.await_posted()
    few = 2 if "d" in names else 1  # a model without links is moved to its place by itself
    commands = []
    call = sim._session.call
    monkeypatch.setattr(sim._session, "call", lambda one: (commands.append(one), call(one))[1])
    history = History(sim)
    history.do("delete", Group(tuple(map(RemoveModel, names))))
    assert len(commands) == 1
    for _ in range(2):
        del commands[:]
        history.undo()
        assert len(commands) == few
        assert sim.models.names() == list("abcde")
        close(sim.states.model_state("b")[0], (3, 2, 1))
        close(sim.states.model_state("d")[0], (1, 2, 3))
        del commands[:]
        history.redo()
        assert len(commands) == few
        assert not set(names) & set(sim.models.names())


@pytest.mark.parametrize("parts", [
    (AddModel(box("x"), Pose()), AddModel(box("a"), Pose())),
    (AddModel(box("x"), Pose()), AddModel(box("x"), Pose())),
    (RemoveModel("a"), RemoveModel("nix")), (RemoveModel("a"), RemoveModel("a"))])
def test_all_of_several_models_are_added_or_deleted_or_none(case, parts):
    sim = case(box("a"), box("b")).sim
    history = History(sim)
    with pytest.raises(CommandError):
        history.do("edit", Group(parts))
    assert sim.models.names() == ["a", "b"]
    history.do("edit", Group((AddModel(box("x"), Pose()), AddModel(box("y"), Pose()))))
    assert sim.models.names() == ["a", "b", "x", "y"]


def test_chains_of_undo_and_redo_pass_the_same_orders_both_ways(case):
    sim = case(box("a"), box("b"), box("c")).sim
    history = History(sim)
    orders = [sim.models.names()]
    for operation in (RemoveModel("b"), AddModel(box("e"), Pose()), RemoveModel("a"),
                      AddModel(box("b"), Pose()), RemoveModel("e"), RemoveModel("c")):
        history.do("edit", operation)
        orders.append(sim.models.names())
    for order in reversed(orders[:-1]):
        history.undo()
        assert sim.models.names() == order
    for order in orders[1:]:
        history.redo()
        assert sim.models.names() == order


def test_a_group_that_fails_half_way_leaves_the_order_as_it_was(case):
    sim = case(box("a"), box("b")).sim
    four_lights(sim)
    with pytest.raises(CommandError):
        Group((RemoveModel("a"), RemoveLight("k"), RemoveModel("nobody"))).apply(sim)
    assert sim.models.names() == ["a", "b"]
    assert light_names(sim) == list("klmn")


def test_it_comes_back_behind_its_neighbour_whatever_others_did_meanwhile(case):
    sim = case(box("a"), box("b"), box("c")).sim
    four_lights(sim)
    history = History(sim)
    history.do("delete", Group((RemoveModel("c"), RemoveLight("m"))))
    sim.models.delete("a")
    sim.models.spawn(box("x"))
    sim.lights.delete("k")
    sim.lights.add(Light("x-lamp"))
    history.undo()
    assert sim.models.names() == ["b", "c", "x"]
    assert light_names(sim) == ["l", "m", "n", "x-lamp"]


def test_it_comes_back_when_its_neighbours_have_gone(case):
    sim = case(box("a"), box("b"), box("c")).sim
    history = History(sim)
    history.do("delete", RemoveModel("c"))
    sim.models.delete("a")
    sim.models.delete("b")
    history.undo()
    assert sim.models.names() == ["c"]


def test_nobody_sees_it_elsewhere_before(case, quick_threads):
    sim = case(box("a"), box("b"), box("c")).sim
    history = History(sim)
    seen, stop = set(), threading.Event()

    def watch():
        while not stop.is_set():
            seen.add(tuple(sim.models.names()))

    watcher = threading.Thread(target=watch)
    watcher.start()
    for _ in range(100):
        history.do("delete", RemoveModel("a"))
        history.undo()
    stop.set()
    watcher.join()
    assert seen <= {("a", "b", "c"), ("b", "c")}


def test_one_that_could_not_come_back_goes_last_when_it_comes_anew(case):
    sim = case(box("a"), box("b")).sim
    history = History(sim)
    history.do("delete", RemoveModel("a"))
    sim.models.spawn(box("a"))
    with pytest.raises(CommandError):
        history.undo()
    sim.models.delete("a")
    sim.models.spawn(box("a"))
    assert sim.models.names() == ["b", "a"]


def test_what_is_added_anew_comes_last(case):
    sim = case(box("a")).sim
    four_lights(sim)
    history = History(sim)
    history.do("insert", Group((AddModel(box("0"), Pose()), AddLight(Light("0-lamp")))))
    assert sim.models.names() == ["a", "0"]
    assert light_names(sim) == ["k", "l", "m", "n", "0-lamp"]


def test_a_plain_link_name_means_the_same_link_after_an_undo_and_after_an_edit(case):
    sim = case(box("a", ("x",), pose=Pose((1, 0, 0))), box("b", ("x",), pose=Pose((2, 0, 0)))).sim
    history = History(sim)
    history.do("delete", RemoveModel("a"))
    history.undo()
    close(sim.states.link_state("x")[0], (1, 0, 0))
    sim.models.edit("a", replace(sim.models.get("a"), self_collide=True))
    close(sim.states.link_state("x")[0], (1, 0, 0))


def test_pages_hear_of_the_order_of_models_and_lights(edited):
    made = edited(shown_box("a"), shown_box("b"), shown_box("c"),
                  lights=[Light(name) for name in "klm"])

    def names(browser, kind):
        return [one["name"] for one in browser.document[kind]]

    async def edit(browser):
        await browser.edit("delete", names=["a", "l", "b"])
        await browser.until(lambda: names(browser, "models") == ["c"])
        await browser.ask("undo")
        await browser.until(lambda: names(browser, "models") == ["a", "b", "c"]
                            and names(browser, "lights") == ["k", "l", "m"])
        await browser.edit("rename", name="k", to="z")
        await browser.until(lambda: names(browser, "lights") == ["z", "l", "m"])

    made.browse(edit)


@pytest.mark.parametrize("dirty", [False, True])
def test_the_oldest_steps_are_forgotten_also_of_a_world_that_was_never_saved(case, dirty):
    sim = case(box("a")).sim
    history = History(sim)
    history.clear(dirty)
    for n in range(LONGEST + 20):
        history.do(f"light {n}", AddLight(Light(f"l{n}")))
    assert len(history.undo_labels) == LONGEST
    assert history.depth == LONGEST + 20
    history.undo(4)
    assert history.depth == LONGEST + 15


def test_pages_are_told_of_more_steps_than_labels(edited):
    made = edited(shown_box("a"))

    async def edit(browser):
        for n in range(210):
            await browser.edit("rename", name=f"b{n}" if n else "a", to=f"b{n + 1}")
        await browser.until(lambda: browser.last("history")["depth"] == 210)
        told = browser.last("history")
        assert told["undoable"] == 210 > len(told["undo"])
        await browser.ask("undo", to=209)
        await browser.until(lambda: browser.last("history")["depth"] == 0)
        await browser.until(lambda: browser.model("a"))

    made.browse(edit)


def test_a_world_that_was_saved_at_the_oldest_step_is_unchanged_once_all_others_are_undone(case):
    sim = case(box("a")).sim
    history = History(sim)
    history.do("light", AddLight(Light("first")))
    history.mark_saved()
    for n in range(LONGEST):
        history.do(f"light {n}", AddLight(Light(f"l{n}")))
    history.undo(LONGEST - 1)
    assert not history.dirty
