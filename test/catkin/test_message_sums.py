"""The messages and services of the companions are the original ones on the wire."""
from __future__ import annotations

import importlib
from pathlib import Path

import pytest
from genmsg import MsgContext
from genmsg.gentools import compute_md5
from genmsg.msg_loader import load_depends, load_msg_from_file, load_srv_from_file
from rospkg import RosPack

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
    ("gazebo_msgs", "msg"): {
        "ContactState": "48c0ffb054b8c444f870cecea1ee50d9",
        "ContactsState": "acbcb1601a8e525bf72509f18e6f668d",
        "LinkState": "0818ebbf28ce3a08d48ab1eaa7309ebe",
        "LinkStates": "48c080191eb15c41858319b4d8a609c2",
        "ModelState": "9330fd35f2fcd82d457e54bd54e10593",
        "ModelStates": "48c080191eb15c41858319b4d8a609c2",
        "ODEJointProperties": "1b744c32a920af979f53afe2f9c3511f",
        "ODEPhysics": "667d56ddbd547918c32d1934503dc335",
        "PerformanceMetrics": "884f71fd5037b886ec5e126b83c4425a",
        "SensorPerformanceMetric": "01762ded18cfe9ebc7c8222667c99547",
        "WorldState": "de1a9de3ab7ba97ac0e9ec01a4eb481e",
    },
    ("gazebo_msgs", "srv"): {
        "ApplyBodyWrench": "585b9f9618aa0581b207e2f2d90866bc",
        "ApplyJointEffort": "c0039811b8cc919490b3cff748cdf46b",
        "BodyRequest": "5eade9afe7f232d78005bd0cafeab755",
        "DeleteLight": "ae11ea8100d536d5b92c2b5917abf912",
        "DeleteModel": "9ce56b4e9e54616de25d796dc972a262",
        "GetJointProperties": "7b30be900f50aa21efec4a0ec92d91c9",
        "GetLightProperties": "df2cef87e13e2e6990e81e8aaa454c19",
        "GetLinkProperties": "0e06a70386d0ee3fb880c02f23fcd821",
        "GetLinkState": "09d6c98cce97b35f7ab9bd70300657ab",
        "GetModelProperties": "5717f7bd34ed990fa80e28b3015027a3",
        "GetModelState": "4c515e936d3319c9610c559c60bfc3d4",
        "GetPhysicsProperties": "575a5e74786981b7df2e3afc567693a6",
        "GetWorldProperties": "36bb0f2eccf4d8be971410c22818ba3f",
        "JointRequest": "0be1351618e1dc030eb7959d9a4902de",
        "SetJointProperties": "15a76e921b1410c698d82782ea5fa370",
        "SetJointTrajectory": "88f5c10979e3f9649d5ae87a3b12aa65",
        "SetLightProperties": "e6f13430c57278bb364aca53a1bf5ebf",
        "SetLinkProperties": "d534ce1b36ee99de0ffa806c3a6348f0",
        "SetLinkState": "8a5146eb66ae4d26b0860b08f3f271be",
        "SetModelConfiguration": "10e3139d3b669c40afc057d38956fff7",
        "SetModelState": "5b3ab0281d4f5445def017e3a2e4a07b",
        "SetPhysicsProperties": "97e2057080558ce4730434b5fae75c91",
        "SpawnModel": "9ed9c82c96abe1a00c3e8cdaeee24413",
    },
}
ROWS = [(package, kind, name, wanted) for (package, kind), sums in SUMS.items()
        for name, wanted in sums.items()]


@pytest.mark.parametrize("package, kind, name, wanted", ROWS)
def test_generated_class_has_the_sum_of_the_original(package, kind, name, wanted):
    assert getattr(importlib.import_module(f"{package}.{kind}"), name)._md5sum == wanted


@pytest.mark.parametrize("package, kind, name, wanted", [
    row for row in ROWS if (COMPAT / row[0] / row[1] / f"{row[2]}.{row[1]}").exists()])
def test_definition_has_the_sum_of_the_original(package, kind, name, wanted):
    packages = RosPack()
    search_path = {one: [str(Path(packages.get_path(one)) / "msg")]
                   for one in ("geometry_msgs", "std_msgs", "trajectory_msgs")}
    search_path.update({one: [str(COMPAT / one / "msg")] for one, _ in SUMS})
    context = MsgContext.create_default()
    load = {"msg": load_msg_from_file, "srv": load_srv_from_file}[kind]
    spec = load(context, str(COMPAT / package / kind / f"{name}.{kind}"), f"{package}/{name}")
    load_depends(context, spec, search_path)
    assert compute_md5(context, spec) == wanted


@pytest.mark.parametrize("package", sorted({package for package, _ in SUMS}))
def test_every_definition_is_checked_and_built(package):
    checked = {name for (owner, _), sums in SUMS.items() if owner == package for name in sums}
    built = (COMPAT / package / "CMakeLists.txt").read_text().split()
    for path in (path for kind in ("msg", "srv", "action")
                 for path in (COMPAT / package / kind).glob("*.*")):
        assert path.name in built
        assert (path.stem if path.suffix != ".action" else f"{path.stem}Action") in checked
