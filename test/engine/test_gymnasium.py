"""Worlds as environments of gymnasium."""
from __future__ import annotations

import asyncio
import math
import os
import re
import runpy
import signal
import subprocess
import sys
import time
import urllib.request
import warnings
from dataclasses import replace
from pathlib import Path

import aiohttp
import gymnasium
import numpy as np
import pytest
from editor_case import Browser, Refused
from gymnasium.utils.env_checker import check_env

import my_simulations.gym
from my_simulations.description.model import Link, Model
from my_simulations.description.shapes import Box, Visual
from my_simulations.errors import CommandError
from my_simulations.geometry import Pose
from my_simulations.gym import Evaluation, View, WorldEnv, push_box, stack_boxes
from my_simulations.python_api import OpenWorld, Randomisation, RobotOptions, WorldChoice

REPOSITORY = Path(__file__).resolve().parents[2]
PUSH, STACK = "my_simulations/PushBox-v0", "my_simulations/StackBoxes-v0"
ALL = [PUSH, STACK, "my_simulations/Navigate-v0", "my_simulations/Reach-v0",
       "my_simulations/PickAndPlace-v0"]


@pytest.fixture
def make():
    made = []

    def one(name, **options):
        made.append(gymnasium.make(name, **options))
        return made[-1]

    yield one
    for env in made:
        env.close()


@pytest.mark.parametrize("name", ALL)
def test_gymnasiums_own_checker_finds_nothing(make, name):
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        check_env(make(name, render_mode="rgb_array").unwrapped)


@pytest.mark.parametrize("name", ALL[3:])
def test_a_task_of_the_arm_is_seen_by_its_camera(make, name):
    env = make(name, camera=True)
    check_env(env.unwrapped, skip_render_check=True)
    seen, _ = env.reset(seed=1)
    assert len(np.unique(seen["camera"].reshape(-1, 3), axis=0)) > 10
    moved = env.step(np.ones(env.action_space.shape, np.float32))[0]
    assert (moved["camera"] != seen["camera"]).any()


@pytest.mark.parametrize("task, seeds", [("navigate", (0, 3)), ("reach", (0, 1, 2, 3, 4)),
                                         ("pick_and_place", (0, 1, 2))])
def test_short_rules_solve_a_task(task, seeds):
    example = runpy.run_path(str(REPOSITORY / "examples" / "solve_tasks.py"), run_name="example")
    found = list(example["episodes"](example["TASKS"][task], seeds))
    assert [success for *_, success in found] == len(seeds) * [True]
    assert min(total for *_, total, _ in found) > 1.0


@pytest.mark.parametrize("name", [PUSH, ALL[2]])
def test_a_task_with_wheels_has_the_friction_that_is_asked_for(make, name):
    def model(**options):
        env = make(name, **options)
        env.reset(seed=1)
        return env.unwrapped.world.simulator.physics.settings.ode.friction_model

    assert model() == "pyramid_model"
    assert model(accurate_friction=True) in ("", "cone_model")


def test_a_collision_ends_a_drive_without_success(make):
    env = make(ALL[2])
    env.reset(seed=0)
    over = False
    while not over:
        _, reward, ended, cut, info = env.step(np.array([1.0, 0.0], np.float32))
        over = ended or cut
    assert ended and info == {"is_success": False, "collision": True} and reward < -0.9


def _episode(env, seed, steps=15):
    observation, _ = env.reset(seed=seed)
    generator, found = np.random.default_rng(seed), [observation]
    for _ in range(steps):
        found.append(env.step(generator.uniform(-1, 1, env.action_space.shape))[0])
    return np.array(found)


@pytest.mark.parametrize("name", [PUSH, STACK])
def test_an_episode_goes_on_bit_for_bit_from_a_saved_state(make, name):
    env = make(name)
    _episode(env, 4)
    world = env.unwrapped.world
    saved, actions = world.save(), np.random.default_rng(7)
    tries = [actions.uniform(-1, 1, (10, *env.action_space.shape)) for _ in range(2)]
    found = []
    for number in (0, 1, 0):
        found.append(np.array([env.step(action)[0] for action in tries[number]]))
        world.restore(saved)
    assert (found[2] == found[0]).all()
    assert (found[1] != found[0]).any()


def test_an_episode_repeats_bit_for_bit_in_the_same_and_in_another_engine(make):
    env = make(PUSH)
    first = _episode(env, 4)
    assert (_episode(env, 5) != first).any()
    assert (_episode(env, 4) == first).all()
    assert (_episode(make(PUSH), 4) == first).all()


def test_environments_side_by_side_do_what_each_does_alone(make):
    together = my_simulations.gym.WorldVectorEnv([push_box.make, push_box.make])
    try:
        seen, _ = together.reset(seed=7)
        actions = np.array([[1.0, 0.2], [0.5, -0.4]], dtype=np.float32)
        for _ in range(5):
            seen, rewards, ended, cut, infos = together.step(actions)
        assert rewards.shape == ended.shape == cut.shape == (2,)
        assert infos["is_success"].tolist() == [False, False]
    finally:
        together.close()
    for number in range(2):
        env = make(PUSH)
        env.reset(seed=7 + number)
        for _ in range(5):
            alone = env.step(actions[number])[0]
        assert (alone == seen[number]).all()


def test_an_ended_episode_of_several_begins_anew_with_the_next_step():
    together = my_simulations.gym.WorldVectorEnv([push_box.make])
    try:
        start, _ = together.reset(seed=1)
        os.kill(together.envs[0].world.simulator.engine_pid, signal.SIGKILL)
        action = np.ones((1, 2), dtype=np.float32)
        _, _, ended, cut, infos = together.step(action)
        assert cut[0] and not ended[0] and "SIGKILL" in infos["fault"][0]
        seen, rewards, ended, cut, _ = together.step(action)
        assert not cut[0] and rewards[0] == 0.0 and seen[0][0] == start[0][0] == 0.0
    finally:
        together.close()


def test_what_is_used_before_the_first_reset_says_so(make):
    env = make(PUSH).unwrapped
    with pytest.raises(gymnasium.error.ResetNeeded):
        env.step(np.zeros(2, dtype=np.float32))
    with pytest.raises(ValueError, match="not 'ansi'"):
        push_box.make("ansi")


def _code_of_the_manual(begin):
    text = (REPOSITORY / "doc" / "gymnasium.md").read_text(encoding="utf-8")
    code, = (found for found in re.findall(r"```python\n(.*?)```", text, re.DOTALL)
             if begin in found)
    return code


@pytest.mark.parametrize("begin", ["class Hover", "class Drive"])
def test_an_environment_of_the_manual_passes_the_checker(begin):
    names = {}
    exec(compile(_code_of_the_manual(begin), "doc/gymnasium.md", "exec"), names)
    try:
        check_env(names["env"].unwrapped, skip_render_check=True)
    finally:
        names["env"].close()


def test_the_navigation_of_the_manual_is_changed_for_another_robot_in_three_lines():
    code = _code_of_the_manual("class Drive")
    burger = REPOSITORY / "test" / "data" / "robots" / "burger.urdf"
    for line, change in (('own_directory() + "/urdf/robo.urdf"', repr(str(burger))),
                         ("2.0 * action[1]", "2.84 * action[1]"), ("< 0.18", "< 0.13")):
        assert code.count(line) == 1
        code = code.replace(line, change)
    gymnasium.registry.pop("Drive-v0", None)   # by another test of this code
    names = {}
    exec(compile(code, "doc/gymnasium.md", "exec"), names)
    env = names["env"]
    try:
        reached = 0
        for seed in range(3):
            seen, over = env.reset(seed=seed)[0], False
            while not over:
                bearing = np.arctan2(seen[361], seen[360])
                seen, _, terminated, truncated, _ = env.step(np.array(
                    [1.0 if abs(bearing) < 0.5 else 0.0, np.clip(bearing, -1.0, 1.0)]))
                over = terminated or truncated
            reached += terminated and np.hypot(*seen[360:]) < 0.2
        assert reached == 3
    finally:
        env.close()


def test_gymnasium_imports_the_package_that_a_name_begins_with():
    code = ("import gymnasium\n"
            f"print(gymnasium.make('my_simulations.gym:{PUSH}').spec.id)\n")
    done = subprocess.run([sys.executable, "-c", code], check=True, timeout=60,
                          capture_output=True, text=True)
    assert done.stdout.strip() == PUSH


def _push(seen):
    """Drive behind the box, as seen from the mark; then push it there."""
    x, y, cos, sin, _, _, bx, by, mx, my, apart = (float(value) for value in seen)
    away = np.array([bx - mx, by - my]) / apart
    behind = np.array([bx, by]) + 0.35 * away
    along = (np.array([x, y]) - (bx, by)) @ away
    across = abs(np.cross(away, np.array([x, y]) - (bx, by)))
    goal = np.array([bx, by]) if along > 0.15 and across < 0.06 else behind
    bearing = math.atan2(goal[1] - y, goal[0] - x) - math.atan2(sin, cos)
    bearing = math.remainder(bearing, 2 * math.pi)
    return np.clip([0.6 if abs(bearing) < 0.3 else 0.0, 1.5 * bearing], -1, 1)


def test_the_robot_can_push_the_box_to_the_mark(make):
    env = make(PUSH)
    seen, _ = env.reset(seed=3)
    total, ended, cut = 0.0, False, False
    while not (ended or cut):
        seen, reward, ended, cut, info = env.step(_push(seen))
        total += reward
    assert ended and info["is_success"] and total > 1.0 and seen[10] < push_box.NEAR


class _Stacker:
    """Moves to the red box, grips it, lifts it, carries it over the blue one, and lets go."""

    def __init__(self):
        self.stage, self.since = 0, 0

    def __call__(self, seen):
        seen = seen.astype(float)
        at, red, blue = seen[:3], seen[5:8], seen[8:11]
        # The fingers' middle is 0.355 m above the ground at z = 0.
        height = 0.355 + at[2]
        goals = [(red, 0.2, -1), (red, 0.034, -1), (red, 0.034, 1), (at, 0.2, 1),
                 (blue, 0.2, 1), (blue, 0.085, 1), (blue, 0.085, -1), (at, 0.2, -1)]
        where, up, grip = goals[self.stage]
        off = np.array([where[0] - at[0], where[1] - at[1], up - height])
        if self.stage == 4:  # the box, not the palm, is to be above the other
            off[:2] = (blue - red)[:2]
        self.since += 1
        waits = self.since >= 8 if self.stage in (2, 6) else np.abs(off).max() < 0.004
        if waits and self.stage < len(goals) - 1:
            self.stage, self.since = self.stage + 1, 0
        return np.clip([*off * 30.0, grip], -1, 1)


def test_the_gripper_can_put_one_box_on_the_other(make):
    env = make(STACK)
    seen, _ = env.reset(seed=2)
    stacker, ended, cut = _Stacker(), False, False
    while not (ended or cut):
        seen, reward, ended, cut, info = env.step(stacker(seen))
    assert ended and info["is_success"] and reward > 0.5
    assert seen[13] == pytest.approx(stack_boxes.SIZE, abs=0.004)


@pytest.mark.parametrize("seeds", [[1], [1, 2, 3]])
def test_another_number_of_seeds_than_of_environments_is_refused(seeds):
    class Counting(gymnasium.Env):
        observation_space = action_space = gymnasium.spaces.Box(-1.0, 1.0, (1,))
        resets = 0

        def reset(self, **_):
            self.resets += 1
            return np.zeros(1, np.float32), {}

    together = my_simulations.gym.WorldVectorEnv([Counting, Counting])
    with pytest.raises(ValueError, match="2 environments"):
        together.reset(seed=seeds)
    assert [env.resets for env in together.envs] == [0, 0]
    together.close()


class _Own(push_box.PushBox):
    def __init__(self, **attributes):
        super().__init__()
        vars(self).update(attributes)


@pytest.mark.parametrize(("make", "told"), [
    (lambda: WorldEnv(push_box.PushBox), r"an object, not a class: PushBox\(\)"),
    (lambda: WorldEnv(View()), "the task View has no choice, period, action_space, "),
    (lambda: WorldEnv(_Own(choice="lab_room.world")), "is a WorldChoice, not 'lab_room.world'"),
    (lambda: WorldEnv(_Own(period=0)), "a number of s above 0, not 0"),
    (lambda: WorldEnv(_Own(), robots={"plugins": False}), "robots are RobotOptions, not {"),
    (lambda: WorldEnv(_Own(), randomisation={"mass": (1, 2)}), "is a Randomisation, not {"),
    (lambda: my_simulations.gym.WorldVectorEnv(push_box.make), "takes a list of functions"),
    (lambda: my_simulations.gym.WorldVectorEnv([push_box.make()]), "takes a list of functions"),
    (lambda: my_simulations.gym.WorldVectorEnv([]), "needs one function at least"),
])
def test_what_is_no_task_and_no_list_of_makers_is_named(make, told):
    with pytest.raises((TypeError, ValueError), match=told):
        make()


def test_an_evaluation_and_a_number_of_actions_are_needed():
    envs = my_simulations.gym.WorldVectorEnv(
        [lambda: WorldEnv(_Own(evaluate=lambda world, action: 1.0))])
    try:
        envs.reset(seed=1)
        with pytest.raises(ValueError, match="1 environments need as many actions, not 2"):
            envs.step(np.zeros((2, 2)))
        with pytest.raises(TypeError, match="evaluate of _Own returns an Evaluation, not 1.0"):
            envs.step(np.zeros((1, 2)))
    finally:
        envs.close()


def test_an_info_that_is_not_a_dictionary_is_refused():
    with pytest.raises(TypeError, match="info of an Evaluation is a dictionary.*not True"):
        Evaluation(1.0, True, True)


def test_environments_are_closed_when_one_of_several_cannot_be_made():
    class Closing(gymnasium.Env):
        closed = False

        def close(self):
            self.closed = True

    first = Closing()
    with pytest.raises(CommandError, match="no such world"):
        my_simulations.gym.WorldVectorEnv([lambda: first, _failing])
    assert first.closed


def _failing():
    raise CommandError("no such world")


class _Explore:
    """Drives the lab robot and sees with its laser."""

    choice = WorldChoice(str(REPOSITORY / "test/rostest/live_robot.world"))
    period = 0.1
    action_space = gymnasium.spaces.Box(-1.0, 1.0, (2,))
    observation_space = gymnasium.spaces.Box(0.0, 10.0, (360,))
    view = View()

    def begin(self, world, random, options):
        self.scan = world.topics["/scan"]
        self.scan.wait()

    def act(self, world, action):
        world.publish("/cmd_vel", {"linear": {"x": 0.5 * action[0]}, "angular": {"z": action[1]}})

    def observe(self, world):
        return np.clip(np.nan_to_num(self.scan.latest.ranges, posinf=10.0), 0.0, 10.0)

    def evaluate(self, world, action):
        return Evaluation(reward=float(self.scan.latest.ranges.min()))


def test_a_task_drives_a_robot_by_its_laser_and_repeats():
    env = WorldEnv(_Explore())
    try:
        episodes = []
        for _ in range(2):
            seen = [env.reset(seed=1)[0]]
            seen += [env.step(np.array([1.0, 0.1]))[0] for _ in range(8)]
            episodes.append(np.array(seen))
        assert np.array_equal(*episodes)
        assert episodes[0][-1].min() < episodes[0][0].min() - 0.1
    finally:
        env.close()
    silent = WorldEnv(_Explore(), robots=RobotOptions(plugins=False))
    with pytest.raises(CommandError, match="there is no topic /scan"):
        silent.reset(seed=1)
    silent.close()


RANDOM = Randomisation(friction=(0.5, 1.5), mass=(0.5, 2.0), gravity=(0.9, 1.1), light=(0.3, 0.9),
                       colour=0.3, sensor_noise=(2.0, 8.0))


@pytest.mark.parametrize(("wrong", "told"), [
    ({"friction": (2.0, 1.0)}, "the least value of friction comes first"),
    ({"mass": 1.0}, r"mass is a range \(least, greatest\), not 1.0"),
    ({"light": (-1.0, 1.0)}, "light must not be negative"),
    ({"sensor_noise": ("low", 1.0)}, "sensor_noise must be a finite number, is 'low'"),
    ({"colour": 2.0}, "colour must be between 0 and 1"),
    ({"textures": "wood.png"}, "textures is a list of names"),
    ({"models": (3,)}, r"models is a list of names, not \(3,\)"),
])
def test_a_randomisation_that_is_not_possible_is_refused(wrong, told):
    with pytest.raises(CommandError, match=told):
        Randomisation(**wrong)


def _drawn(world):
    box, robot = world.description("box"), world.description("robo")
    laser, = (sensor for link in robot.links for sensor in link.sensors if sensor.ray)
    link = box.links[0]
    return (link.collisions[0].surface.mu, link.inertial.mass, link.inertial.ixx,
            world.simulator.physics.gravity[2], link.visuals[0].material.diffuse,
            laser.ray.noise.stddev, world.simulator.lights.all()[0].diffuse)


@pytest.mark.parametrize(("wrong", "told"), [
    ({"mass": (0.5, 2.0), "models": ("boxx",)}, r"unknown model 'boxx'; did you mean box\?"),
    ({"textures": ("wodo.png",)}, "'wodo.png' was not found: searched "),
])
def test_models_and_textures_that_do_not_exist_are_refused(wrong, told):
    env = push_box.make(randomisation=Randomisation(**wrong))
    with pytest.raises(CommandError, match=told):
        env.reset(seed=1)
    env.close()


def test_each_episode_draws_other_values_and_a_seed_draws_them_again():
    env = WorldEnv(push_box.PushBox(), randomisation=RANDOM)
    try:
        first = _episode(env, 4)
        drawn = _drawn(env.world)
        mu, mass, ixx, gravity, colour, noise, light = drawn
        assert 0.15 <= mu <= 0.45 and 0.25 <= mass <= 1.0 and ixx == pytest.approx(
            0.0033 * mass / 0.5)
        assert -10.78 <= gravity <= -8.82 and 0.01 <= noise <= 0.04 and colour[3] == 1.0
        env.reset()
        assert all(one != other for one, other in zip(_drawn(env.world), drawn))
        assert (_episode(env, 4) == first).all() and _drawn(env.world) == drawn
    finally:
        env.close()


def test_a_registered_environment_draws_its_randomisation_from_the_seed(make):
    def masses(env, seed):
        env.reset(seed=seed)
        return env.unwrapped.world.description("box").links[0].inertial.mass

    env = make(PUSH, randomisation=Randomisation(mass=(0.5, 2.0)))
    first, other = masses(env, 1), masses(env, 2)
    assert first != other and masses(env, 1) == first
    plain = make(PUSH)
    assert masses(plain, 1) == masses(plain, 2)


def test_less_light_darkens_the_picture_and_textures_are_for_the_named_models():
    choice = WorldChoice(models=(("box", push_box._BOX, Pose()),))
    random = np.random.default_rng(1)
    textured = Randomisation(textures=("file:///one.png",), models=("box",)).apply(choice, random)
    model = Model("box", links=[Link("link", visuals=[Visual("v", Box())])])
    assert textured.alter_model(model).links[0].visuals[0].material.texture == "file:///one.png"
    assert textured.alter_model(replace(model, name="other")) == replace(model, name="other")
    means = []
    for factor in (0.2, 0.8):
        dim = Randomisation(light=(factor, factor)).apply(choice, random)
        with OpenWorld(dim, robots=RobotOptions(plugins=False)) as world:
            means.append(world.render([1, -1, 1], look_at=[0, 0, 0]).rgb.mean())
    assert means[1] > means[0] + 10.0


def test_people_watch_an_environment_on_a_page_that_cannot_change_it(make, monkeypatch, capsys):
    monkeypatch.setenv("MY_SIMULATIONS_NO_BROWSER", "1")
    env = make(PUSH, render_mode="human")
    began, steps = time.monotonic(), 5
    env.reset(seed=1)
    url = env.unwrapped.viewer.url
    assert f"the world editor is at {url}" in capsys.readouterr().out

    async def watch():
        async with aiohttp.ClientSession() as session:
            page = await Browser.open(session, url)
            assert page.model("box") is not None
            before = env.unwrapped.world.states().pose["box"]
            for kind, fields in (("pause", {}), ("play", {}), ("undo", {}), ("step", {"steps": 1}),
                                 ("new", {})):
                with pytest.raises(Refused, match=f"accepts no request '{kind}'"):
                    await page.ask(kind, **fields)
            async with session.put(url.partition("?")[0] + "upload/a.stl?" + url.partition("?")[2],
                                   data=b"x") as answer:
                assert answer.status == 404
            assert (env.unwrapped.world.states().pose["box"] == before).all()
            await page.socket.close()

    asyncio.run(watch())
    for _ in range(steps):
        env.step(env.action_space.sample())
    assert time.monotonic() - began >= steps * 0.1   # not faster than real time
    assert env.render() is None
    env.close()
    with pytest.raises(OSError):
        urllib.request.urlopen(url)
