"""All message types that plugins use are standard ones, but for those of packages of robots."""
from __future__ import annotations

import pickle
import re
from pathlib import Path

from my_simulations.messages.definitions import standard_definitions
from my_simulations.messages.message_types import MessageTypes

PLUGINS = Path(__file__).resolve().parents[3] / "src/my_simulations/plugins"
ROBOTS = {"cob_base_controller_utils", "kobuki_msgs", "pal_control_msgs", "pr2_msgs"}
"""Packages whose messages are read from their files, where they are installed."""


def test_types_are_known():
    used = set()
    for path in PLUGINS.rglob("*.py"):
        used |= set(re.findall(r'"([a-z]\w*_(?:msgs|srvs|utils|comm)/[A-Z]\w*)"', path.read_text()))
    known = standard_definitions()
    missing = {kind for kind in used if not known.keys() & {
        kind, f"{kind}Request", f"{kind}Action"}}
    assert len(used) > 60
    assert {kind.partition("/")[0] for kind in missing} <= ROBOTS, sorted(missing)


def test_messages_are_pickled_with_their_types(tmp_path):
    (tmp_path / "msg").mkdir()
    (tmp_path / "msg" / "Own.msg").write_text("int8 LEFT=1\ngeometry_msgs/Point[] at\nint8 side\n")
    types = MessageTypes({"own_msgs": str(tmp_path)}.get)
    own = types.message("own_msgs/Own")(at=[types.message("geometry_msgs/Point")(1.0)], side=1)
    for message in (own, types.message("nav_msgs/Odometry")()):
        again = pickle.loads(pickle.dumps(message))
        assert again == message and again.KIND == message.KIND
    assert pickle.loads(pickle.dumps(own)).LEFT == 1
