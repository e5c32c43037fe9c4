"""Study files and their faults."""
from __future__ import annotations

import pytest

from my_simulations.errors import InputError
from my_simulations.studies.study_file import read_study
from my_simulations.studies.variation import Target, target_of

ALL_CASES = """study: slide
world: worlds/empty.world
models:
  box: {file: box.sdf, pose: [0, 0, 1]}
duration: 2
seeds: {first: 5, count: 3}
vary:
  mu: {set: friction.box, range: {from: 0.2, to: 1.0, step: 0.2}}
  place: {set: pose.box, values: [[0, 0, 1], [1, 0, 1, 0, 0, 0.5]]}
  what: {set: objects, values: [crate, [crate, MY_OBJECT]]}
  push: {normal: [0, 2], samples: 4}
measure:
  far: final(pose.box.x)
require:
  still: final(speed.box) < vary.push
keep:
  trajectory: {every: 0.5}
limits: {processor_seconds: 3, attempts: 1}
"""


def read(tmp_path, text):
    (tmp_path / "box.sdf").write_text("<sdf/>")
    path = tmp_path / "my.yaml"
    path.write_text(text)
    return read_study(str(path))


def faults(tmp_path, text):
    with pytest.raises(InputError) as told:
        read(tmp_path, text)
    return [(issue.line, issue.xpath, issue.message) for issue in told.value.issues]


def test_a_whole_study_is_read(tmp_path):
    study, issues = read(tmp_path, ALL_CASES)
    assert issues == [] and study.name == "slide" and study.count == 3 * 5 * 2 * 2 * 4
    mu, place, what, push = study.parameters
    assert mu.values == pytest.approx((0.2, 0.4, 0.6, 0.8, 1.0))
    assert mu.target == Target("friction", "box")
    assert place.values[1] == (1, 0, 1, 0, 0, 0.5)
    assert what.values == (("crate",), ("crate", "MY_OBJECT"))
    assert push.distribution == "normal" and push.samples == 4
    assert study.models[0].file == str(tmp_path / "box.sdf")
    assert [study.seeds.at(n) for n in range(3)] == [5, 6, 7]
    assert study.limits.processor_seconds == 3 and study.limits.attempts == 1
    assert study.trajectory.every == 0.5


def test_the_least_study_is_a_duration(tmp_path):
    study, _ = read(tmp_path, "duration: 1\n")
    assert study.name == "my" and study.count == 1 and study.world.endswith("worlds/empty.world")


@pytest.mark.parametrize(("text", "line", "xpath", "said"), [
    ("study: a\n", 0, "", "'duration' is missing"),
    ("duration: -1\n", 1, "/duration", "above 0"),
    ("duration: soon\n", 1, "/duration", "must be a number, is 'soon'"),
    ("duration: .nan\n", 1, "/duration", "must be a number"),
    ("duration: 1\nmesure: {}\n", 2, "/mesure", "unknown key"),
    ("duration: 1\nmodels:\n  b: {file: none.sdf}\n", 3, "/models/b/file", "there is no file"),
    ("duration: 1\nseeds: [1, 1]\n", 2, "/seeds", "different"),
    ("duration: 1\nmeasure:\n  z: final(pose.b.q)\n", 3, "/measure/z", "one of x, y, z"),
    ("duration: 1\nmeasure:\n  z: vary.height * 1\n", 3, "/measure/z", "is not varied"),
    ("duration: 1\nmeasure:\n  status: 1 + 1\n", 3, "/measure/status", "name of a column"),
    ("duration: 1\nrequire:\n  z: 1 + 1\n", 3, "/require/z", "takes conditions"),
    ("duration: 1\nvary:\n  m: {set: mess.b, values: [1]}\n", 3, "/vary/m/set", "be varied"),
    ("duration: 1\nvary:\n  m:\n    set: mass.b\n", 3, "/vary/m", "needs one of values"),
    ("duration: 1\nvary:\n  m: {values: []}\n", 3, "/vary/m/values", "at least one value"),
    ("duration: 1\nvary:\n  m: {values: [1, 1]}\n", 3, "/vary/m/values", "twice"),
    ("duration: 1\nvary:\n  m: {uniform: [0, 1]}\n", 3, "/vary/m", "samples"),
    ("duration: 1\nvary:\n  m: {uniform: [2, 1], samples: 2}\n", 3, "/vary/m/uniform", "below"),
    ("duration: 1\nvary:\n  m: {log_uniform: [0, 1], samples: 2}\n", 3, "/vary/m/log_uniform",
     "above 0"),
    ("duration: 1\nvary:\n  m: {range: {from: 0, to: 1, step: -1}}\n", 3, "/vary/m/range/step",
     "does not lead"),
    ("duration: 1\nvary:\n  m: {set: pose.b, values: [[1, 2]]}\n", 3, "/vary/m/values",
     "3 or 6 numbers"),
    ("duration: 1\nlimits: {attempts: 0}\n", 2, "/limits/attempts", "between 1 and 10"),
    ("duration: 1\nworld: none.world\n", 2, "/world", "no world file 'none.world'"),
    ("duration: 1\nvary:\n  w: {set: world, values: [none.world]}\n", 3, "/vary/w/values",
     "no world file 'none.world'"),
    ("duration: 1" + 400 * "0" + "\n", 1, "/duration", "must be a number"),
    ("duration: 1\nvary: 2\nmeasure:\n  z: final(pose.b.z)\n", 2, "/vary", "must be a mapping"),
    ("duration: 1\nvary:\n  m: {set: mass.b, values: [1, 0]}\n", 3, "/vary/m/values",
     "'m' must be above 0, is 0"),
    ("duration: 1\nvary:\n  m: {set: mass.b, range: {from: -1, to: 1, count: 3}}\n", 3,
     "/vary/m/range", "'m' must be above 0, is -1"),
    ("duration: 1\nvary:\n  m: {set: mass.b, uniform: [-1, 1], samples: 2}\n", 3,
     "/vary/m/uniform", "'m' must be above 0, and may be -1"),
    ("duration: 1\nvary:\n  m: {set: friction.b, values: [-0.5]}\n", 3, "/vary/m/values",
     "at least 0"),
    ("duration: 1\nvary:\n  m: {set: physics.step_size, values: [0]}\n", 3, "/vary/m/values",
     "above 0"),
    ("duration: 1\nvary:\n  m: {set: physics.iterations, values: [10, 0]}\n", 3,
     "/vary/m/values", "at least 1"),
    ("duration: 1\nvary:\n  m: {set: physics.iterations, values: [2.5]}\n", 3,
     "/vary/m/values", "a whole number"),
    ("[1]\n", 0, "", "must be a mapping")])
def test_a_fault_is_told_with_its_line_and_key(tmp_path, text, line, xpath, said):
    (found,) = faults(tmp_path, text)
    assert found[0] == line and said in found[2]
    assert found[1] == xpath or not xpath


def test_all_faults_are_told_at_once(tmp_path):
    found = faults(tmp_path, "duration: 0\nsample: x\nvary:\n  m: {set: 3}\n")
    assert [line for line, _, _ in found] == [1, 2, 4, 4]


def test_values_at_their_bounds_are_taken(tmp_path):
    study, issues = read(tmp_path, """duration: 1
vary:
  mass: {set: mass.b, uniform: [0, 1], samples: 2}
  mu: {set: friction.b, values: [0]}
  bounce: {set: restitution.b, values: [0]}
  iterations: {set: physics.iterations, uniform: [1.5, 9], samples: 2}
  pull: {set: gravity.x, values: [-1]}
  place: {set: pose.b.z, values: [-1]}
""")
    assert issues == [] and study.count == 4


@pytest.mark.parametrize(("text", "target"), [
    ("world", Target("world")), ("pose.my.box.yaw", Target("pose", "my.box", "yaw")),
    ("pose.box", Target("pose", "box")), ("mass.box::link", Target("mass", "box::link")),
    ("gravity.z", Target("gravity", "", "z")), ("physics.step_size", Target("physics", "",
                                                                           "step_size")),
    ("gravity.w", None), ("physics.solver", None), ("mass", None), ("world.x", None)])
def test_what_is_varied_is_named(text, target):
    assert target_of(text) == target
