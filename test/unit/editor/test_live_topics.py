"""Topics that pages look at, and robots that pages drive, by real sockets."""
from __future__ import annotations

import asyncio
import json
import struct

import aiohttp
import pytest
from editor_case import DEADLINE, Browser, Refused, box, cases
from sensor_msgs.msg import LaserScan
from topic_source_case import Listed, Source

from my_simulations.editor.topics.driving import velocity_topic
from my_simulations.geometry import Pose

case = pytest.fixture(cases)

SCAN = Listed("/scan", "sensor_msgs/LaserScan", model="robo", link="base", pose=Pose((1, 2, 3)))
TWIST = "geometry_msgs/Twist"


def scan(*ranges):
    return LaserScan(range_max=10.0, ranges=ranges)


async def until(condition):
    for _ in range(int(DEADLINE / 0.01)):
        if condition():
            return
        await asyncio.sleep(0.01)
    raise AssertionError("it did not happen")


def views(browser):
    """(head, payload) of the views that have come."""
    found = []
    for data in browser.views:
        _, size = struct.unpack_from("<II", data)
        assert (8 + size) % 8 == 0
        found.append((json.loads(data[8:8 + size]), data[8 + size:]))
    return found


def test_topics_are_listed_with_the_place_of_their_sensor(case):
    async def look(browser):
        listed = await browser.ask("topics")
        assert listed["available"] is True
        assert listed["topics"] == [{
            "name": "/scan", "type": "sensor_msgs/LaserScan", "publishers": 1, "subscribers": 0,
            "model": "robo", "driven": False,
            "mount": {"link": "base", "pose": [1, 2, 3, 0, 0, 0, 1]}}]

    case(topics=Source([SCAN])).browse(look)


def test_a_world_without_ros_has_no_topics(case):
    async def look(browser):
        assert await browser.ask("topics") == {"available": False, "topics": []}
        with pytest.raises(Refused, match="without ROS"):
            await browser.ask("watch", topics=["ros:/scan"])
        with pytest.raises(Refused, match="without ROS"):
            await browser.ask("drive", model="a", linear=[1, 0, 0], angular=[0, 0, 0])

    case(box("a")).browse(look)


def test_a_topic_is_heard_while_a_page_looks_at_it_and_no_longer(case):
    source = Source([SCAN])

    async def look(browser):
        assert source.heard == {}
        await browser.ask("watch", topics=["ros:/scan", "contacts"])
        await until(lambda: "/scan" in source.heard)
        source.heard["/scan"](scan(1.0, 2.0))
        await browser.until(lambda: browser.views)
        head, payload = views(browser)[0]
        assert head["topic"] == "/scan" and head["view"]["count"] == 2
        assert struct.unpack("<2f", payload) == (1.0, 2.0)
        await browser.ask("watch", topics=["contacts"])
        await until(lambda: source.heard == {})

    case(topics=source).browse(look)


def test_a_page_that_goes_away_is_no_listener_any_more(case):
    source = Source([SCAN])

    async def look(browser):
        await browser.ask("watch", topics=["ros:/scan"])
        await until(lambda: "/scan" in source.heard)
        await browser.socket.close()
        await until(lambda: source.heard == {})

    case(topics=source).browse(look)


def test_a_page_that_is_slow_gets_the_newest_message_when_it_has_shown_the_last(case):
    source = Source([SCAN])
    made = case(topics=source)

    async def look(browser):
        async with aiohttp.ClientSession() as session:
            quick = await Browser.open(session, made.url)
            for one in (browser, quick):
                await one.ask("watch", topics=["ros:/scan"])
            await until(lambda: "/scan" in source.heard)
            for n in range(1, 6):
                source.heard["/scan"](scan(float(n)))
                count = n
                await quick.until(lambda: len(quick.views) == count)
                await quick.notify("viewed", topic="/scan")
            assert len(browser.views) == 1
            await browser.notify("viewed", topic="/scan")
            await browser.until(lambda: len(browser.views) == 2)
            assert struct.unpack("<f", views(browser)[-1][1]) == (5.0,)
            await browser.notify("viewed", topic="/scan")
            await browser.ask("watch", topics=["ros:/scan"])
            assert len(browser.views) == 2  # nothing new has come

    made.browse(look)


def test_a_number_of_a_topic_is_plotted_until_no_page_wants_it(case):
    source = Source([SCAN])

    async def look(browser):
        source.message = lambda kind: {"sensor_msgs/LaserScan": LaserScan}[kind]()
        fields = (await browser.ask("topic_fields", topic="/scan"))["fields"]
        assert {"header.stamp", "range_min", "ranges[0]"} <= set(fields)
        assert "header.frame_id" not in fields
        with pytest.raises(Refused, match="unknown topic"):
            await browser.ask("topic_fields", topic="/none")
        for wrong in ("plot:/", "plot:/scan", "plot:/scan."):
            with pytest.raises(Refused, match="unknown topic"):
                await browser.ask("watch", topics=[wrong])
        watched = ["plot:/scan.ranges[1]", "plot:/scan.angle", "plot:/scan.ranges[9]"]
        await browser.ask("watch", topics=watched)
        await until(lambda: "/scan" in source.heard)
        source.heard["/scan"](scan(1.0, 2.5))
        # A world that stands still pushes once for each request.
        await browser.ask("watch", topics=watched)
        await browser.until(lambda: any(one.get("value") == 2.5 for one in browser.pushes))
        await browser.until(lambda: any("no field 'angle'" in one.get("problem", "")
                                        for one in browser.pushes))
        assert not browser.views
        await browser.ask("watch", topics=[])
        await until(lambda: source.heard == {})

    case(topics=source).browse(look)


def test_a_topic_that_nobody_publishes_yet_is_found_later(case):
    source = Source([])

    async def look(browser):
        await browser.ask("watch", topics=["ros:/scan"])
        await browser.until(lambda: browser.last("watch"))
        assert browser.last("watch")["problem"] == "no node publishes it yet"
        source.listed.append(SCAN)
        await until(lambda: "/scan" in source.heard)

    case(topics=source).browse(look)


def test_a_message_that_cannot_be_shown_is_said_once(case):
    from sensor_msgs.msg import Image

    source = Source([Listed("/picture", "sensor_msgs/Image")])

    async def look(browser):
        await browser.ask("watch", topics=["ros:/picture"])
        await until(lambda: "/picture" in source.heard)
        for _ in range(3):
            source.heard["/picture"](Image(encoding="yuv422"))
            await browser.until(lambda: browser.last("watch"))
        assert "yuv422" in browser.last("watch")["problem"]
        assert sum(push["type"] == "watch" for push in browser.pushes) == 1

    case(topics=source).browse(look)


# -- driving -----------------------------------------------------------------------------------


def drive(forward, turn=0.0, model="robo"):
    return {"model": model, "linear": [forward, 0, 0], "angular": [0, 0, turn]}


def cmd_vel(model="robo", name="/cmd_vel"):
    return Listed(name, TWIST, 0, 1, model, bool(model))


def test_a_driven_robot_stops_when_its_page_says_so(case):
    source = Source([cmd_vel()])

    async def go(browser):
        assert await browser.ask("drive", **drive(0.5, 0.2)) == {"topic": "/cmd_vel"}
        await browser.ask("drive", **drive(0.0))
        assert source.speeds() == [("/cmd_vel", 0.5, 0.2), ("/cmd_vel", 0.0, 0.0)]
        assert source.offered == ["/cmd_vel"]

    case(topics=source).browse(go)


def test_a_driven_robot_stops_when_its_page_falls_silent(case):
    source = Source([cmd_vel()])

    async def go(browser):
        await browser.ask("drive", **drive(0.5))
        await until(lambda: source.speeds()[-1] == ("/cmd_vel", 0.0, 0.0))

    case(topics=source).browse(go)


def test_a_driven_robot_stops_when_its_page_is_closed(case):
    source = Source([cmd_vel()])
    made = case(topics=source)

    async def go(browser):
        async with aiohttp.ClientSession() as session:
            other = await Browser.open(session, made.url)
            await other.ask("drive", **drive(0.5))
            await other.socket.close()
        await until(lambda: source.speeds()[-1] == ("/cmd_vel", 0.0, 0.0))

    made.browse(go)


def test_a_model_that_hears_no_velocities_cannot_be_driven(case):
    async def go(browser):
        with pytest.raises(Refused, match="box cannot be driven"):
            await browser.ask("drive", **drive(0.5, model="box"))

    case(topics=Source([cmd_vel("robo")])).browse(go)


@pytest.mark.parametrize(("listed", "expected"), [
    ([cmd_vel("a", "/x/cmd_vel"), cmd_vel("b", "/cmd_vel")], "/x/cmd_vel"),
    ([cmd_vel("a", "/a/stop"), cmd_vel("a", "/a/base/cmd_vel")], "/a/base/cmd_vel"),
    ([cmd_vel("", "/a/cmd_vel"), cmd_vel("", "/cmd_vel")], "/a/cmd_vel"),
    ([cmd_vel("", "/cmd_vel")], "/cmd_vel"),
    ([cmd_vel("", "/one"), cmd_vel("", "/two")], ""),
    ([cmd_vel("b", "/cmd_vel")], ""),
    ([Listed("/cmd_vel", TWIST, 1, 0)], ""),
    ([Listed("/a/pose", "geometry_msgs/Pose", 0, 1, "a", True)], ""),
])
def test_which_topic_drives_a_model(listed, expected):
    assert velocity_topic(listed, "a") == expected
