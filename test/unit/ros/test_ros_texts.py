"""Texts of service requests that no world file could hold."""
from __future__ import annotations

import pytest
from gazebo_msgs.msg import ModelState
from gazebo_msgs.srv import (
    SetModelConfigurationRequest,
    SetModelState,
    SetModelStateRequest,
    SpawnModel,
    SpawnModelRequest,
)

from my_simulations.errors import CommandError
from my_simulations.ros.endpoints import Endpoint, TextCheck, make_service_callback


@pytest.mark.parametrize("field", ["model_name", "robot_namespace", "reference_frame"])
def test_a_request_is_refused_with_field_and_character(field):
    called = []
    endpoint = Endpoint("spawn_sdf_model", "SpawnModel", SpawnModel,
                        lambda request, response: called.append(request) or "done")
    request = SpawnModelRequest(**{field: "a\x01b"})
    response = make_service_callback(endpoint)(request)
    assert not response.success and not called
    assert response.status_message == (
        f"SpawnModel: {field} contains the character U+0001 at position 2, which an XML file "
        "cannot hold")


def test_nested_messages_and_lists_are_looked_at_and_documents_are_not():
    with pytest.raises(CommandError, match="model_state.model_name contains .*U[+]FFFE"):
        TextCheck(SetModelStateRequest)(SetModelStateRequest(ModelState(model_name="\ufffe")))
    with pytest.raises(CommandError, match=r"joint_names\[1\] contains .*U[+]D800"):
        TextCheck(SetModelConfigurationRequest)(
            SetModelConfigurationRequest(joint_names=["fine", "\ud800"]))
    TextCheck(SpawnModelRequest)(SpawnModelRequest(model_name="fine", model_xml="<sdf>\x01</sdf>"))


def test_a_status_does_not_repeat_a_name_of_a_megabyte():
    def refuse(request, response):
        raise CommandError(f"no model {request.model_state.model_name}, did you mean x?")

    endpoint = Endpoint("set_model_state", "SetModelState", SetModelState, refuse)
    answer = make_service_callback(endpoint)(
        SetModelStateRequest(ModelState(model_name="x" * 1_000_000)))
    assert answer.status_message.startswith("SetModelState: no model xxx")
    assert "x... (990026 more characters) ...x" in answer.status_message
    assert answer.status_message.endswith("x, did you mean x?") and len(
        answer.status_message) < 10_100


def test_every_fitting_text_passes():
    endpoint = Endpoint("set_model_state", "SetModelState", SetModelState,
                        lambda request, response: request.model_state.model_name)
    name = "caf\u00e9 \U0001f916\t"
    answer = make_service_callback(endpoint)(SetModelStateRequest(ModelState(model_name=name)))
    assert answer.success and answer.status_message == f"SetModelState: {name}"
