"""Requests of plugins to the sensing process: order, lateness, faults; and messages made later."""
from __future__ import annotations

import threading
from collections import deque
from concurrent.futures import Future

from my_simulations.geometry import Pose
from my_simulations.plugins.context import View
from my_simulations.plugins.message_maker import MessageMaker, PendingMessage
from my_simulations.plugins.sensing_requests import SensingRequests
from my_simulations.sensing.api import CameraSpec, Mount, SensingEndedError

VIEW = (Mount(), View("head", Pose(), CameraSpec(), ("rgb",)))


class Sensing:
    def __init__(self):
        self.asked = []

    def render(self, views, ns, rows):
        self.at = ns
        self.asked.append([Future() for _ in views])
        return self.asked[-1]

    def send(self):
        self.sent = True

    def cast(self, mount, fan, visuals, ns, rows):
        self.asked.append(Future())
        return self.asked[-1]


class Case:
    """Requests to a renderer that has started, unless `cold`; `again` counts repeated requests."""

    def __init__(self, cold=False):
        self.sensing, self.inbox, self.said, self.seen = Sensing(), deque(), [], []
        self.requests = SensingRequests(self.sensing, self.inbox, lambda: None, self.said.append,
                                        sensor="eye")
        self.again = 0
        if not cold:
            self.shoot(0)
            self.answer("nobody sees it")
            self.deliver()
            self.sensing.asked.clear()

    def answer(self, picture):
        self.sensing.asked[-1][0].set_result(picture)

    def ask_again(self):
        self.again += 1

    def shoot(self, ns, wait=False, views=1):
        return self.requests.photograph([VIEW] * views, lambda got, at: self.seen.append((got, at)),
                                        ns, b"", wait, self.ask_again)

    def deliver(self):
        while self.inbox:
            self.inbox.popleft()()


def test_a_picture_is_handed_over_with_its_moment():
    case = Case()
    assert case.shoot(5) and case.sensing.at == 5
    case.sensing.asked[0][0].set_result("picture")
    assert not case.seen
    case.deliver()
    assert case.seen == [(["picture"], 5)]


def test_the_first_picture_is_taken_anew_once_the_renderer_has_started():
    case = Case(cold=True)
    assert [case.shoot(ns) for ns in (1, 2, 3)] == [True, False, False]
    case.answer("too old")
    case.deliver()
    assert case.again == 1 and not case.seen and not case.said
    assert case.shoot(4)
    case.answer("fresh")
    case.deliver()
    assert case.seen == [(["fresh"], 4)] and case.again == 1


def test_a_step_that_comes_first_takes_the_picture_that_was_to_be_taken_anew():
    case = Case(cold=True)
    case.shoot(1)
    case.answer("too old")
    assert case.shoot(2)
    case.deliver()
    case.answer("fresh")
    case.deliver()
    assert case.seen == [(["fresh"], 2)] and case.again == 0


def test_a_world_stepped_by_hand_sees_the_first_picture():
    case = Case(cold=True)
    assert case.shoot(1, wait=True)
    case.answer("picture")
    case.deliver()
    assert case.seen == [(["picture"], 1)] and case.again == 0


def test_after_a_loss_the_first_picture_is_taken_anew():
    case = Case()
    before = case.again
    case.shoot(1)
    case.sensing.asked[-1][0].set_exception(SensingEndedError("it was killed"))
    case.deliver()
    case.shoot(2)
    case.answer("too old")
    case.deliver()
    assert case.again == before + 1 and not case.seen


def test_pictures_of_one_moment_are_handed_over_together():
    case = Case()
    case.shoot(5, views=2)
    first, second = case.sensing.asked[0]
    second.set_result("b")
    case.deliver()
    assert not case.seen
    first.set_result("a")
    case.deliver()
    assert case.seen == [(["a", "b"], 5)]


def test_a_late_picture_leaves_others_out_and_this_is_told_once():
    case = Case()
    assert [case.shoot(ns) for ns in (1, 2, 3)] == [True, False, False]
    assert len(case.said) == 1 and "pictures of sensor 'eye' are late" in case.said[0]
    case.sensing.asked[0][0].set_result("picture")
    assert case.shoot(4) and len(case.sensing.asked) == 2
    assert case.seen == [(["picture"], 1)]


def test_a_world_stepped_by_hand_waits_for_late_pictures():
    case = Case()
    case.shoot(1)
    threading.Timer(0.05, case.sensing.asked[0][0].set_result, ["picture"]).start()
    assert case.shoot(2, wait=True) and not case.said
    assert case.seen == [(["picture"], 1)]


def test_a_message_that_is_still_being_made_counts_as_late():
    case = Case()
    case.requests.unsent.append(None)
    assert not case.shoot(1)
    case.requests.unsent.popleft()
    assert case.shoot(2)


def test_a_lost_picture_is_told_and_the_next_is_taken():
    case = Case()
    for ns in (1, 2):
        case.shoot(ns)
        case.sensing.asked[-1][0].set_exception(SensingEndedError("it was killed"))
        case.deliver()
    assert case.said == ["a picture is left out: it was killed"] and case.shoot(3)


def test_a_picture_of_a_time_that_was_set_back_is_forgotten():
    case = Case()
    case.shoot(5)
    case.requests.discard_pending()
    case.sensing.asked[0][0].set_result("picture")
    case.deliver()
    assert not case.seen and case.shoot(1)


class Topic:
    def __init__(self):
        self.sent = []

    def send(self, message):
        self.sent.append((message, threading.current_thread().name))


def test_messages_are_made_in_order_by_another_thread():
    maker, topic, unsent = MessageMaker(), Topic(), deque()
    for n in range(3):
        maker.put(topic, PendingMessage(lambda n=n: n, unsent), lambda fault: None)
    maker.stop()
    assert topic.sent == [(n, "plugin messages") for n in range(3)] and not unsent


def test_a_message_that_cannot_be_made_is_told_and_the_next_is_sent():
    maker, topic, unsent, faults = MessageMaker(), Topic(), deque(), []
    maker.put(topic, PendingMessage(lambda: 1 // 0, unsent), faults.append)
    maker.put(topic, PendingMessage(lambda: "next", unsent), faults.append)
    maker.stop()
    assert [type(fault) for fault in faults] == [ZeroDivisionError]
    assert topic.sent[0][0] == "next" and not unsent


def test_streams_do_not_wait_for_each_other():
    case = Case()
    assert case.shoot(1) and case.requests.photograph([VIEW], lambda *_: None, 1, b"", False,
                                                      case.ask_again, "depth")
    assert not case.said


def test_who_asks_one_by_one_does_not_wait_for_messages_that_are_being_made():
    case = Case()
    assert case.shoot(1)
    case.answer("first")
    case.deliver()
    case.requests.unsent.append(None)   # its message is not made yet
    assert not case.shoot(2) and len(case.said) == 1   # a stream leaves out
    assert case.requests.photograph([VIEW], lambda *_: None, 2, b"", False, case.ask_again,
                                    queue=True)
