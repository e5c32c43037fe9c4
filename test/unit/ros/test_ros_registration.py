"""Services of the interface table whose definitions are not built."""
from __future__ import annotations

import pytest
import rospy

from my_simulations.ros.interface import SERVES, Row
from my_simulations.ros.registration import register_endpoints


@pytest.mark.parametrize("kind", ["no_such_package/Empty", "std_srvs/NoSuchService"])
def test_a_service_without_its_definition_is_left_out_with_a_warning(kind, monkeypatch):
    warnings = []
    monkeypatch.setattr(rospy, "logwarn", lambda text, *values: warnings.append(text % values))
    assert register_endpoints([Row("count_models", kind, SERVES, "counting.count")], {}) == []
    assert warnings == [
        f"service count_models is not available: {kind} is not built; run tools/run"]
