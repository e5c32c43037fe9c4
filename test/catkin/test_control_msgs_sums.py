"""The companions with messages of controllers are the original ones on the wire."""
from __future__ import annotations

import importlib
from pathlib import Path

import pytest

COMPAT = Path(__file__).resolve().parents[2] / "compat"

SUMS = {
    ("control_msgs", "msg"): {
        "FollowJointTrajectoryAction": "bc4f9b743838566551c0390c65f1a248",
        "FollowJointTrajectoryActionFeedback": "d8920dc4eae9fc107e00999cce4be641",
        "FollowJointTrajectoryActionGoal": "cff5c1d533bf2f82dd0138d57f4304bb",
        "FollowJointTrajectoryActionResult": "c4fb3b000dc9da4fd99699380efcc5d9",
        "GripperCommand": "680acaff79486f017132a7f198d40f08",
        "GripperCommandAction": "950b2a6ebe831f5d4f4ceaba3d8be01e",
        "JointControllerState": "987ad85e4756f3aef7f1e5e7fe0595d1",
        "JointJog": "1685da700c8c2e1254afc92a5fb89c96",
        "JointTolerance": "f544fe9c16cf04547e135dd6063ff5be",
        "JointTrajectoryAction": "a04ba3ee8f6a2d0985a6aeaf23d9d7ad",
        "JointTrajectoryControllerState": "10817c60c2486ef6b33e97dcd87f4474",
        "PidState": "b138ec00e886c10e73f27e8712252ea6",
        "PointHeadAction": "7252920f1243de1b741f14f214125371",
        "SingleJointPositionAction": "c4a786b7d53e5d0983decf967a5a779e",
    },
    ("control_msgs", "srv"): {
        "QueryCalibrationState": "28af3beedcb84986b8e470dc5470507d",
        "QueryTrajectoryState": "ec93cdecbd8062d761aa52b7c90cd44b",
    },
    ("controller_manager_msgs", "msg"): {
        "ControllerState": "aeb6b261d97793ab74099a3740245272",
        "ControllerStatistics": "697780c372c8d8597a1436d0e2ad3ba8",
        "ControllersStatistics": "a154c347736773e3700d1719105df29d",
        "HardwareInterfaceResources": "f25b55cbf1d1f76e82e5ec9e83f76258",
    },
    ("controller_manager_msgs", "srv"): {
        "ListControllers": "1341feb2e63fa791f855565d0da950d8",
        "ListControllerTypes": "c1d4cd11aefa9f97ba4aeb5b33987f4e",
        "LoadController": "647e5c54b8d6468952d8d31f1efe96c0",
        "ReloadControllerLibraries": "40e8c411fd1797d2e2c486018f846040",
        "SwitchController": "b29a7abc673b2c54c14b54e50f8d06a5",
        "UnloadController": "647e5c54b8d6468952d8d31f1efe96c0",
    },
    ("four_wheel_steering_msgs", "msg"): {
        "FourWheelSteering": "04dd0f55e1f168668af1e2587a7cdd2a",
        "FourWheelSteeringStamped": "9226582df815bc6df9e3206bc05923af",
    },
    ("unitree_legged_msgs", "msg"): {
        "BmsCmd": "c09195f3200bd8917201f8805a3fe1d1",
        "BmsState": "8e007c660c590388bca7c2464d80df54",
        "Cartesian": "cc153912f1453b708d221682bc23d9ac",
        "HighCmd": "b4825051cf66ae8183b54c57dba16b66",
        "HighState": "7904f43019dadf7640d573b4c14b9066",
        "IMU": "c2bcd83820da00fff261b67d6490da58",
        "LED": "353891e354491c51aabe32df673fb446",
        "LowCmd": "7a33b01032a894134df9b65b5cd356d1",
        "LowState": "481f8a83f729a25e7cc170da192f80f9",
        "MotorCmd": "bbb3b7d91319c3a1b99055f0149ba221",
        "MotorState": "94c55ee3b7852be2bd437b20ce12a254",
    },
}
ROWS = [(package, kind, name, wanted) for (package, kind), sums in SUMS.items()
        for name, wanted in sums.items()]


@pytest.mark.parametrize("package, kind, name, wanted", ROWS)
def test_generated_class_has_the_sum_of_the_original(package, kind, name, wanted):
    assert getattr(importlib.import_module(f"{package}.{kind}"), name)._md5sum == wanted


@pytest.mark.parametrize("package", sorted({package for package, _ in SUMS}))
def test_every_definition_is_checked_and_built(package):
    checked = {name for (owner, _), sums in SUMS.items() if owner == package for name in sums}
    built = (COMPAT / package / "CMakeLists.txt").read_text().split()
    for path in (path for kind in ("msg", "srv", "action")
                 for path in (COMPAT / package / kind).glob("*.*")):
        assert path.name in built
        assert (path.stem if path.suffix != ".action" else f"{path.stem}Action") in checked
