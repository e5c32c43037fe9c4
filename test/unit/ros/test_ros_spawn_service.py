"""The spawn services on an engine without physics: options of requests, and what is logged."""
from __future__ import annotations

import os
import shutil
from types import SimpleNamespace

import pytest
from geometry_msgs.msg import Pose, Quaternion
from running_simulator import started

from my_simulations.description.world import World
from my_simulations.errors import CommandError, InputError
from my_simulations.resources.package_files import own_directory
from my_simulations.resources.resolver import Resolver
from my_simulations.ros.plugins.plugin_starter import PluginStarter
from my_simulations.ros.services.model_services import ModelServices

BOX = ("<sdf version='1.6'{0}><model name='m'><link name='l'><collision name='c'><geometry><box>"
       "<size>1 1 1</size></box></geometry></collision></link></model></sdf>")


def request(name="a", xml=BOX, **fields):
    return SimpleNamespace(**{
        "model_name": name, "model_xml": xml.format(""), "robot_namespace": "",
        "initial_pose": Pose(orientation=Quaternion(w=1.0)), "reference_frame": "",
        "replace": False, "file": "", "launch_pid": 0, **fields})


@pytest.fixture
def services():
    issues, reported = [], []
    simulator = started(World(), log=reported.append)
    made = ModelServices(simulator, Resolver(), issues.append, launcher=41)
    yield SimpleNamespace(spawn=made, simulator=simulator, issues=issues, reported=reported)
    simulator.close()


BAD = ("<sdf version='1.6'><model name='m'><link name='l'/><plugin name='p' filename='libbad.so'/>"
       "<plugin name='q' filename='libmystery.so'/></model></sdf>")


def test_the_reply_says_which_plugins_do_not_work_and_why(services, tmp_path, monkeypatch):
    monkeypatch.syspath_prepend(str(tmp_path))
    (tmp_path / "plugin_with_a_typo.py").write_text("\nundefined_name\n")
    starter = PluginStarter(services.simulator, services.simulator.report,
                            {"libbad.so": "plugin_with_a_typo:Bad"})
    spawn = ModelServices(services.simulator, Resolver(), services.issues.append,
                          changed=starter.wait_until_loaded)
    try:
        said = spawn.spawn_object(request(xml=BAD, file="/tmp/m.sdf"), None)
    finally:
        starter.stop()
    assert "2 problems" in said and "/tmp/m.sdf:1: plugin 'p' (libbad.so) of model 'a'" in said
    assert f"NameError: name 'undefined_name' is not defined (in <module>, {tmp_path}" in said
    assert [issue.code for issue in services.reported] == ["plugin-failed", "plugin-unknown"]


def test_a_model_is_replaced_only_on_request(services):
    services.spawn.spawn_object(request(), None)
    with pytest.raises(CommandError, match="already exists"):
        services.spawn.spawn_object(request(), None)
    services.spawn.spawn_object(request(replace=True), None)
    assert services.simulator.models.names() == ["a"]


def test_messages_name_the_file_of_the_request(services):
    with pytest.raises(InputError) as refused:
        services.spawn.spawn_object(request(xml="<robot name='r'/>", file="/tmp/arm.urdf"), None)
    assert refused.value.first.file == "model 'a', /tmp/arm.urdf"


def test_a_missing_texture_is_in_the_reply_and_in_the_log(services, tmp_path):
    mesh = tmp_path / "carton.dae"
    shutil.copy(os.path.join(own_directory(), "Media", "models", "my_object.dae"), mesh)
    visual = (f"<visual name='v'><geometry><mesh><uri>{mesh}</uri></mesh></geometry></visual>"
              "</link>")
    reply = services.spawn.spawn_sdf(request(xml=BOX.replace("</link>", visual)), None)
    assert reply.startswith(f"Successfully spawned entity (1 warning: {mesh}:9: the image"
                            " 'my_object/carton.png' was not found;")
    assert [(issue.code, issue.file) for issue in services.issues] == [
        ("image-not-found", str(mesh))]


def test_a_reply_has_the_first_of_several_warnings(services):
    text = BOX.replace("</link>", "<wrong/></link><wrogn/>")
    reply = services.spawn.spawn_sdf(request(xml=text), None)
    assert reply.startswith("Successfully spawned entity (2 warnings, see log; the first: model"
                            " 'a', model_xml:1: element <w")
    assert services.spawn.spawn_sdf(request("b"), None) == "Successfully spawned entity"


def test_a_model_of_the_simulators_own_launch_is_known_as_such(services):
    services.spawn.spawn_object(request("ours", launch_pid=41), None)
    services.spawn.spawn_object(request("theirs", launch_pid=42), None)
    services.spawn.spawn_object(request("nobodys"), None)
    assert services.simulator.models.launched() == ["ours"]


def test_deprecated_attributes_mean_the_same_and_are_logged_once(services):
    marks = " my_simulations_replace='true' my_simulations_launch='41' my_simulations_file='/f.sdf'"
    for _ in range(2):
        services.spawn.spawn_sdf(request(model_xml=BOX.format(marks)), None)
    assert services.simulator.models.launched() == ["a"]
    [issue] = services.issues
    assert (issue.code, issue.file) == ("attribute-deprecated", "model 'a', /f.sdf")
    assert "'my_simulations_replace'" in issue.message and "spawn_object" in issue.hint


def test_only_urdf_goes_to_the_urdf_service(services):
    with pytest.raises(CommandError, match="spawn_sdf_model"):
        services.spawn.spawn_urdf(request(), None)


@pytest.mark.parametrize("pose, height", [("", 1.0), ("<pose>0 0 2 0 0 0</pose>", 3.0)])
def test_the_pose_of_an_included_models_file_is_replaced(services, tmp_path, pose, height):
    (tmp_path / "raised").mkdir()
    (tmp_path / "raised" / "model.sdf").write_text(
        BOX.format("").replace("<link", "<pose>0 0 0.5 0 0 0</pose><link"))
    text = f"<sdf version='1.6'><world name='w'><include><uri>{tmp_path}/raised</uri>{pose}"
    asked = request(model_xml=text + "</include></world></sdf>")
    asked.initial_pose.position.z = 1.0
    services.spawn.spawn_sdf(asked, None)
    assert services.simulator.states.model_state("a")[0].position == (0.0, 0.0, height)
