"""Topics of plugins leave the ROS graph in another thread; a name that is used again has left."""
from __future__ import annotations

import threading
from types import SimpleNamespace

import pytest

from my_simulations.ros.plugins import ros_graph
from my_simulations.ros.plugins.ros_graph import DeferredClosing, RosGraph

SECONDS = 60.0


@pytest.fixture
def events(monkeypatch):
    """What rospy does: `+name` and `-name`; removals wait until `go` is set."""
    found = SimpleNamespace(rows=[], go=threading.Event(), begun=threading.Event(),
                            ended=threading.Semaphore(0))

    class End:
        def __init__(self, name, *arguments, **options):
            self._name = name
            self.impl = None
            found.rows.append("+" + name)

        def publish(self, message):
            found.rows.append(message)

        def unregister(self):
            found.begun.set()
            assert found.go.wait(SECONDS)
            found.rows.append("-" + self._name)
            found.ended.release()

        shutdown = unregister

    for name in ("Publisher", "Subscriber", "Service"):
        monkeypatch.setattr(ros_graph.rospy, name, End)
    monkeypatch.setattr(ros_graph, "direct_publish", lambda publisher: publisher.publish)
    yield found
    found.go.set()


def ignore(*_arguments):
    pass


def opened(graph):
    return [graph.publish("/a", "std_msgs/Int64", 1, False, ignore),
            graph.subscribe("/b", "std_msgs/Int64", ignore, 1),
            graph.serve("/c", "std_srvs/Empty", ignore)]


def test_closing_does_not_wait_for_the_master(events):
    for end in opened(RosGraph()):
        end.close()
    assert events.begun.wait(SECONDS)
    assert events.rows == ["+/a", "+/b", "+/c"]
    events.go.set()
    assert all(events.ended.acquire(timeout=SECONDS) for _ in range(3))
    assert events.rows[3:] == ["-/a", "-/b", "-/c"]


def test_a_name_that_is_used_again_is_removed_before(events):
    graph = RosGraph()
    ends = opened(graph)
    events.go.set()
    for end in reversed(ends):
        end.close()
    opened(graph)
    for name in ("/a", "/b", "/c"):
        assert [row[0] for row in events.rows if row[1:] == name] == ["+", "-", "+"]


def test_a_call_that_is_under_way_is_waited_for():
    closing, go, begun, done = DeferredClosing(), threading.Event(), threading.Event(), []

    def slow():
        begun.set()
        assert go.wait(SECONDS)
        done.append("slow")

    closing.close_soon("/a", slow)
    assert begun.wait(SECONDS)
    waiting = threading.Thread(target=lambda: (closing.close_now("/a"), done.append("used again")))
    waiting.start()
    closing.close_now("/other")
    assert done == []
    go.set()
    waiting.join(SECONDS)
    assert done == ["slow", "used again"]


def test_a_removal_that_fails_is_logged_and_the_others_go_on(monkeypatch):
    logged, done = [], threading.Event()
    monkeypatch.setattr(ros_graph.rospy, "logerr", lambda *words: logged.append(words))
    closing = DeferredClosing()

    def fail():
        raise ValueError("no answer")

    closing.close_soon("/a", fail)
    closing.close_soon("/b", done.set)
    assert done.wait(SECONDS)
    assert [words[1] for words in logged] == ["/a"]
