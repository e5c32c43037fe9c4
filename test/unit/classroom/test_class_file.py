"""Class files, and the containers that are made of them."""
from __future__ import annotations

import json

import pytest
import yaml
from lxml import etree

from my_simulations.classroom.class_file import read_class
from my_simulations.classroom.class_plan import launch_text
from my_simulations.classroom.class_state import TUTOR, ClassState
from my_simulations.classroom.local_world import processors_of
from my_simulations.classroom.manifests import compose, kubernetes
from my_simulations.errors import CommandError, InputError

CLASS = """class: Robotics 26
students: [anna, ben_2]
port: 12000
launch: my_simulations lab_room.launch
args: {robot: true, x: 1.5}
limits: {memory_mb: 1500, processors: 2, processes: 300, file_mb: 200, home_mb: 900}
"""


@pytest.fixture
def plan(tmp_path):
    (tmp_path / "class.yaml").write_text(CLASS)
    return read_class(str(tmp_path / "class.yaml"))[0]


def faults(tmp_path, text):
    (tmp_path / "class.yaml").write_text(text)
    with pytest.raises(InputError) as fault:
        read_class(str(tmp_path / "class.yaml"))
    return [(issue.line, issue.code) for issue in fault.value.issues]


def test_students_have_ports_users_and_homes(plan, tmp_path):
    anna, ben = plan.students
    assert (anna.name, anna.port, ben.name, ben.port) == ("anna", 12001, "ben_2", 12002)
    assert anna.user != ben.user
    assert plan.home(ben) == str(tmp_path / "Robotics 26" / "students" / "ben_2")
    assert (plan.limits.processors, plan.idle_minutes, plan.submission) == (2, 60.0, "submission")


def test_a_number_of_students_is_enough(tmp_path):
    (tmp_path / "lab.yaml").write_text("students: 12\n")
    plan = read_class(str(tmp_path / "lab.yaml"))[0]
    assert [student.name for student in plan.students][::11] == ["student1", "student12"]
    assert (plan.name, plan.folder) == ("lab", str(tmp_path / "lab"))


@pytest.mark.parametrize("text, line, code", [
    ("students: []\n", 1, "class-value"), ("students: 0\n", 1, "class-value"),
    ("class: a\n", 1, "class-key"), ("students: [Anna]\n", 1, "class-value"),
    ("students: [../x]\n", 1, "class-value"),
    ("students: [a, a]\n", 1, "class-value"), ("students: 2\nprot: 1\n", 2, "class-key"),
    ("students: 2\nlaunch: one\n", 2, "class-value"), ("[]\n", 1, "class-value"),
    ("students: 2\nsubmission: ../other\n", 2, "class-value"),
    ("students: 2\nlimits: {memory_mb: 0}\n", 2, "class-value")])
def test_faults_have_their_lines(tmp_path, text, line, code):
    (found,) = faults(tmp_path, text)
    assert found[1] == code and found[0] in (0, line)


def test_arguments_reach_the_launch_file_and_the_port_overrides_its_own(plan):
    root = etree.fromstring(launch_text(plan, 12001))
    assert [(one.get("name"), one.get("value")) for one in root.iterfind("arg")] == [
        ("robot", "true"), ("x", "1.5")]
    include = root.find("include")
    assert include.get("file") == "$(find my_simulations)/launch/lab_room.launch"
    assert include.get("pass_all_args") == "true"
    assert {one.get("name"): one.get("value") for one in include.itersiblings()} == {
        "/gazebo/editor_port": "12001", "/gazebo/editor_host": "0.0.0.0"}


def test_students_share_processors_in_turn():
    count = len(processors_of(0, 1000))
    assert len(processors_of(0, 1)) == 1
    assert processors_of(0, 1) != processors_of(1, 1) or count == 1


def test_tokens_are_kept_and_belong_to_the_owner_of_the_class(plan, tmp_path):
    tokens = ClassState(plan).tokens(plan)
    assert set(tokens) == {TUTOR, "anna", "ben_2"} and len(set(tokens.values())) == 3
    assert ClassState(plan).tokens(plan) == tokens
    state = tmp_path / "Robotics 26" / "class"
    assert [path.stat().st_mode & 0o077 for path in (state, state / "tokens.json")] == [0, 0]


def test_a_class_runs_once(plan):
    first = ClassState(plan)
    with pytest.raises(CommandError, match="does not run"):
        first.manager()
    first.acquire_lock()
    first.store_address("http://127.0.0.1:12000/?token=t")
    assert first.manager()["address"].endswith("token=t")
    with pytest.raises(CommandError, match="runs already"):
        ClassState(plan).acquire_lock()


def test_compose_isolates_and_limits_each_student(plan):
    tokens = {"anna": "token-a", "ben_2": "token-b"}
    found = yaml.safe_load(compose(plan, tokens))
    assert set(found) == {"name", "services", "networks", "volumes"}
    for name, port, token in (("anna", 12001, "token-a"), ("ben_2", 12002, "token-b")):
        service = found["services"][name]
        assert service["ports"] == [f"127.0.0.1:{port}:11346"]
        assert service["environment"]["MY_SIMULATIONS_EDITOR_TOKEN"] == token
        assert "$$(find my_simulations)" in service["environment"]["LAUNCH"]   # not Compose's $
        assert (service["cpus"], service["mem_limit"], service["pids_limit"]) == (2.0, "1500m", 300)
        assert service["cap_drop"] == ["ALL"] and service["networks"] == [name]
        assert service["volumes"] == [f"{name}:/home/student/submission"]
        others = json.dumps({**service, "environment": None})
        assert "token" not in others
    assert set(found["networks"]) == set(found["volumes"]) == {"anna", "ben_2"}


REQUIRED = {
    "Namespace": set(), "NetworkPolicy": {"podSelector", "policyTypes", "ingress", "egress"},
    "PersistentVolumeClaim": {"accessModes", "resources"}, "Secret": set(),
    "Deployment": {"replicas", "selector", "template", "strategy"},
    "Service": {"selector", "ports"}}
VERSIONS = {"Deployment": "apps/v1", "NetworkPolicy": "networking.k8s.io/v1"}


def test_kubernetes_manifests_have_the_form_of_their_kinds(plan):
    objects = list(yaml.safe_load_all(kubernetes(plan, {"anna": "token-a", "ben_2": "token-b"})))
    assert [one["kind"] for one in objects] == ["Namespace", "NetworkPolicy"] + 2 * [
        "Secret", "PersistentVolumeClaim", "Deployment", "Service"]
    names = set()
    for one in objects:
        kind, meta = one["kind"], one["metadata"]
        assert one["apiVersion"] == VERSIONS.get(kind, "v1")
        assert set(one.get("spec", {})) == REQUIRED[kind]
        assert meta["name"].replace("-", "").isalnum() and meta["name"] == meta["name"].lower()
        assert kind == "Namespace" or meta["namespace"] == "robotics-26"
        assert (kind, meta["name"]) not in names
        names.add((kind, meta["name"]))


def test_students_who_would_share_their_objects_in_kubernetes_are_refused(tmp_path):
    (tmp_path / "class.yaml").write_text(CLASS.replace("anna, ben_2", "ben-2, ben_2"))
    plan, _ = read_class(str(tmp_path / "class.yaml"))
    with pytest.raises(CommandError, match="'ben-2' and 'ben_2' have the same name in Kubernetes"):
        kubernetes(plan, {"ben-2": "token-a", "ben_2": "token-b"})


def test_a_deployment_takes_its_token_from_its_own_secret(plan):
    objects = list(yaml.safe_load_all(kubernetes(plan, {"anna": "token-a", "ben_2": "token-b"})))
    secrets = {one["metadata"]["name"]: one["stringData"]["token"] for one in objects
               if one["kind"] == "Secret"}
    assert secrets == {"anna": "token-a", "ben-2": "token-b"}
    for one in objects:
        if one["kind"] != "Deployment":
            continue
        spec = one["spec"]["template"]["spec"]
        labels = one["spec"]["template"]["metadata"]["labels"]
        assert one["spec"]["selector"]["matchLabels"] == labels
        (container,) = spec["containers"]
        (token,) = [entry["valueFrom"]["secretKeyRef"] for entry in container["env"]
                    if "valueFrom" in entry]
        assert token == {"name": one["metadata"]["name"], "key": "token"}
        assert container["resources"]["limits"] == {"cpu": "2", "memory": "1500M"}
        assert spec["securityContext"]["runAsNonRoot"] is True
        assert spec["automountServiceAccountToken"] is False
        assert container["securityContext"]["allowPrivilegeEscalation"] is False
        mounts = {mount["name"] for mount in container["volumeMounts"]}
        assert mounts == {volume["name"] for volume in spec["volumes"]}
        assert "token-" not in json.dumps(one)
