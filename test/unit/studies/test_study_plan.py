"""Cases and their ids."""
from __future__ import annotations

import itertools
import statistics

from my_simulations.studies.plan import CasePlan, Shard
from my_simulations.studies.study_file import read_study

GRID = """duration: 1
seeds: 2
vary:
  a: {values: [1, 2, 3]}
  b: {uniform: [0, 1], samples: 4}
"""


def plan_of(tmp_path, text, name="s.yaml"):
    path = tmp_path / name
    path.write_text(text)
    return CasePlan(read_study(str(path))[0])


def ids(plan):
    return [case.id for case in plan.cases()]


def test_a_grid_has_all_combinations_once_and_the_last_changes_fastest(tmp_path):
    cases = list(plan_of(tmp_path, GRID).cases())
    assert len(cases) == 24 and [case.index for case in cases] == list(range(24))
    found = [(case.settings["a"], case.settings["b"], case.seed) for case in cases]
    values = sorted({b for _, b, _ in found}, key=[b for _, b, _ in found].index)
    assert found == list(itertools.product([1, 2, 3], values, [0, 1]))
    assert len({case.id for case in cases}) == 24


def test_shards_share_the_cases(tmp_path):
    plan = plan_of(tmp_path, GRID)
    shards = [[case.id for case in plan.cases(Shard(number, 5))] for number in range(1, 6)]
    assert sorted(itertools.chain(*shards)) == sorted(ids(plan))


def test_a_case_is_found_by_the_beginning_of_its_id(tmp_path):
    plan = plan_of(tmp_path, GRID)
    assert plan.find(plan.case(7).id[:10]) == plan.case(7)
    assert plan.find("xyz") is None


def test_draws_repeat_and_depend_on_the_seed(tmp_path):
    text = "duration: 1\nplan: {random: 2000, seed: %d}\nvary:\n  m: {normal: [3, 2]}\n" \
           "  c: {values: [1, 2]}\n"
    first, second = plan_of(tmp_path, text % 1), plan_of(tmp_path, text % 2)
    drawn = [case.settings["m"] for case in first.cases()]
    assert drawn == [case.settings["m"] for case in plan_of(tmp_path, text % 1).cases()]
    assert drawn != [case.settings["m"] for case in second.cases()]
    assert abs(statistics.mean(drawn) - 3) < 0.2 and abs(statistics.stdev(drawn) - 2) < 0.2
    ones = sum(case.settings["c"] == 1 for case in first.cases())
    assert 900 < ones < 1100
    assert len(set(ids(first))) == 2000


def test_an_id_depends_on_files_and_values_but_not_on_names_and_limits(tmp_path):
    world = tmp_path / "w.world"
    world.write_text("<sdf version='1.6'><world name='w'/></sdf>")
    text = "study: x\nworld: w.world\n" + GRID
    before = ids(plan_of(tmp_path, text))
    assert ids(plan_of(tmp_path, text)) == before
    assert ids(plan_of(tmp_path, text.replace("study: x", "study: y"), "t.yaml")) == before
    assert ids(plan_of(tmp_path, text + "limits: {attempts: 1}\n")) == before
    assert not set(ids(plan_of(tmp_path, text.replace("duration: 1", "duration: 2")))) & set(before)
    more = ids(plan_of(tmp_path, text.replace("[1, 2, 3]", "[0, 1, 2, 3]")))
    assert set(more) > set(before)
    world.write_text("<sdf version='1.6'><world name='w2'/></sdf>")
    assert not set(ids(plan_of(tmp_path, text))) & set(before)


def test_an_included_file_counts(tmp_path):
    world, model = tmp_path / "w.world", tmp_path / "m.sdf"
    world.write_text("<sdf version='1.6'><world name='w'><include><uri>file://m.sdf</uri></include>"
                     "</world></sdf>")
    model.write_text("<sdf version='1.6'><model name='m'><link name='l'/></model></sdf>")
    before = ids(plan_of(tmp_path, "world: w.world\nduration: 1\n"))
    model.write_text("<sdf version='1.6'><model name='m'><link name='k'/></model></sdf>")
    assert ids(plan_of(tmp_path, "world: w.world\nduration: 1\n")) != before
