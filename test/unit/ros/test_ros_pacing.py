import pytest

from my_simulations.ros.topics.publish_pacing import StateSchedule, StepSelector

MS = 1000000


def one_ms(step):
    return step * MS


def test_in_real_time_every_step_goes_out():
    selector = StepSelector(0, 0, now=0.0)
    published = []
    for step in range(1, 5001):
        published += selector.times(step, one_ms, now=step * 0.001)
    assert published == [one_ms(step) for step in range(1, 5001)]


def test_steps_missed_by_a_late_look_are_made_up_for():
    selector = StepSelector(10, one_ms(10), now=0.0)
    assert selector.times(14, one_ms, now=0.004) == [one_ms(s) for s in (11, 12, 13, 14)]


def test_nothing_new_publishes_nothing():
    selector = StepSelector(3, one_ms(3), now=0.0)
    assert selector.times(3, one_ms, now=1.0) == []


def test_faster_than_real_time_it_is_thinned_to_a_thousand_a_second_and_the_newest_is_sent():
    selector = StepSelector(0, 0, now=0.0)
    published = []
    for look in range(1, 2001):
        step = look * 100
        found = selector.times(step, one_ms, now=look * 0.001)
        assert found[-1] == one_ms(step)
        published += found
    assert 2000 <= len(published) <= 2000 + 250 + 2000 * 0.01
    assert published == sorted(set(published))


def test_a_world_that_goes_back_in_time_is_heard_of_at_once():
    selector = StepSelector(5000, one_ms(5000), now=0.0)
    assert selector.times(3, one_ms, now=0.001) == [one_ms(3)]
    assert selector.times(4, one_ms, now=0.002) == [one_ms(4)]


def test_a_clock_set_back_at_the_same_step_is_heard_of():
    selector = StepSelector(5000, one_ms(5000), now=0.0)
    assert selector.times(5000, lambda step: 0, now=0.001) == [0]
    assert selector.times(5000, lambda step: 0, now=0.002) == []


@pytest.mark.parametrize("rate, every", [(240.0, 1), (60.0, 4), (1000.0 / 3.0, 1)])
def test_a_clock_at_the_rate_of_the_steps_misses_none(rate, every):
    """Sim times of such steps are rounded to whole nanoseconds."""
    def at(step):
        return round(step * 1e9 / (rate * every))

    selector = StepSelector(0, 0, now=0.0, period_ns=round(1e9 / rate))
    found = [time for step in range(1, 481) for time in selector.times(step, at, 0.0)]
    assert found == [at(step) for step in range(every, 481, every)]


def test_a_clock_frequency_is_in_sim_time():
    selector = StepSelector(0, 0, now=0.0, period_ns=10 * MS)
    published = []
    for step in range(7, 1001, 7):
        published += selector.times(step, one_ms, now=step * 0.0001)
    gaps = [b - a for a, b in zip(published, published[1:])]
    assert set(gaps) == {10 * MS}
    assert 98 <= len(published) <= 100


def test_a_clock_frequency_goes_on_after_a_reset():
    selector = StepSelector(0, 0, now=0.0, period_ns=10 * MS)
    selector.times(500, one_ms, now=0.5)
    assert selector.times(1, one_ms, now=0.501) == [one_ms(1)]
    assert selector.times(11, one_ms, now=0.511) == [one_ms(11)]


def running():
    return None


def test_states_go_out_at_every_step_by_default():
    gate = StateSchedule(0.0)
    assert all(gate.due(step, one_ms(step), False, running) for step in range(1, 20))


def test_a_late_state_does_not_delay_those_that_follow():
    gate = StateSchedule(50.0)
    looks = [1, 21, 47, 61, 81, 112, 121, 141]  # some polls come late
    assert [step for step in looks if gate.due(step, one_ms(step), False, running)] == looks


def test_states_at_the_rate_of_the_steps_miss_none():
    gate = StateSchedule(240.0)
    assert all(gate.due(step, round(step * 1e9 / 240), False, running) for step in range(1, 481))


def test_states_are_limited_in_sim_time():
    gate = StateSchedule(50.0)
    sent = [step for step in range(1, 101) if gate.due(step, one_ms(step), False, running)]
    assert sent == [1, 21, 41, 61, 81]


def test_a_new_listener_gets_one_message_of_a_paused_world():
    gate = StateSchedule(0.0)
    assert gate.due(7, one_ms(7), True, lambda: (1, 1))
    gate.note_published((1, 1))
    assert not gate.due(7, one_ms(7), False, lambda: (1, 1))


def test_each_change_of_a_paused_world_is_shown_once_whatever_the_rate():
    gate = StateSchedule(1.0)
    assert gate.due(7, one_ms(7), True, lambda: (1, 1))
    gate.note_published((1, 1))
    assert gate.due(7, one_ms(7), False, lambda: (1, 2))
    gate.note_published((1, 2))
    assert not gate.due(7, one_ms(7), False, lambda: (1, 2))


def test_where_a_limited_world_came_to_stand_is_shown():
    gate = StateSchedule(50.0)
    assert gate.due(1, one_ms(1), False, running)
    gate.note_published((1, 1))
    assert not gate.due(9, one_ms(9), False, running)
    assert gate.due(9, one_ms(9), False, lambda: (1, 9))


def test_states_go_on_after_a_reset():
    gate = StateSchedule(50.0)
    assert gate.due(5000, one_ms(5000), False, running)
    assert gate.due(1, one_ms(1), False, running)
