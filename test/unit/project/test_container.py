"""The container: what its file says holds together; test/reliability builds it (needs root)."""
from __future__ import annotations

import json
import re
import subprocess
import xml.etree.ElementTree as ElementTree

import pytest
import yaml
from dockerfile import REPOSITORY, arguments, stages

DOCKER = REPOSITORY / "docker"
HOME = "/home/student/simulation_ws/src/my_simulations/"


def test_both_stages_have_the_same_base_which_can_be_chosen():
    assert [stage[0][1].split()[0] for stage in stages()] == ["${BASE}"] * 2
    assert arguments() == {"BASE": "debian:12-slim"}


@pytest.mark.parametrize("stage", stages(), ids=["built", "run"])
def test_container_does_not_run_as_root(stage):
    assert [words for word, words in stage if word == "USER"] == ["student"]
    words = [word for word, _ in stage]
    assert words.index("USER") > max(i for i, word in enumerate(words) if word == "RUN")
    assert not any("sudo" in rest for _, rest in stage)


@pytest.mark.parametrize("stage", stages(), ids=["built", "run"])
def test_container_copies_and_runs_programs_that_exist(stage):
    checked = 0
    for word, rest in stage:
        if word == "COPY" and "--from" not in rest:
            sources = [name for name in rest.split()[:-1] if not name.startswith("--")]
            assert all((REPOSITORY / name).exists() for name in sources), rest
        for name in re.findall(r"my_simulations/((?:tools|docker)/\w+)\b", rest):
            program = REPOSITORY / name
            assert program.is_dir() or program.stat().st_mode & 0o111, name
            checked += 1
    assert checked


@pytest.mark.parametrize("stage", stages(), ids=["built", "run"])
def test_run_lines_are_shell_and_their_options_are_known(stage):
    for word, rest in stage:
        if word != "RUN":
            continue
        subprocess.run(["bash", "-n", "-c", rest], check=True, timeout=120)
        for option in re.findall(r"tools/run.*?(--[a-z-]+)", rest):
            known = "".join((REPOSITORY / "tools" / name).read_text()
                            for name in ("run", "lib/command.sh"))
            assert f"{option})" in known or f"{option} " in known


@pytest.mark.parametrize("name", ["entrypoint", "install_to_run", "strip_workspace"])
def test_programs_of_the_container_are_shell(name):
    subprocess.run(["bash", "-n", str(DOCKER / name)], check=True, timeout=120)


def test_container_serves_the_editor_to_its_host_with_a_launch_file_that_exists():
    last = dict(stages()[-1])
    words = json.loads(last["CMD"])
    assert words[:2] == ["roslaunch", "gazebo_ros"]
    (path,) = (REPOSITORY / "compat" / "gazebo_ros" / "launch").glob(f"{words[2]}*")
    names = {argument.get("name") for argument in ElementTree.parse(path).getroot().findall("arg")}
    assert {word.split(":=")[0] for word in words[3:]} <= names
    assert "editor_host:=0.0.0.0" in words
    assert last["EXPOSE"] == "11346"
    assert json.loads(last["ENTRYPOINT"]) == [HOME + "docker/entrypoint"]


def test_health_is_a_call_that_the_simulator_answers():
    words = json.loads(dict(stages()[-1])["HEALTHCHECK"].split("CMD", 1)[1])
    assert words == [HOME + "docker/entrypoint", "rosservice", "call",
                     "/gazebo/get_world_properties"]


def test_students_of_a_course_have_ports_and_tokens_of_their_own():
    services = yaml.safe_load((DOCKER / "compose.yaml").read_text())["services"]
    assert len(services) > 1
    ports = [port for service in services.values() for port in service["ports"]]
    tokens = [service["environment"]["MY_SIMULATIONS_EDITOR_TOKEN"]
              for service in services.values()]
    assert len(set(ports)) == len(ports) == len(services)
    assert all(port.endswith(":11346") for port in ports)
    assert len(set(tokens)) == len(tokens)
    # The file contains no token: teachers must set them before they start the course.
    assert all(re.fullmatch(r"\$\{\w+:\?[^}]+\}", token) for token in tokens)
