"""Libraries of Gazebo whose plugins are accepted and have no effect, each with the reason."""
from __future__ import annotations

from typing import Mapping, Optional

from ..description.plugin import PluginSpec
from ..errors import Issue, Severity
from .registry import library_name

_REASONS: Mapping[str, str] = {
    "it only draws in Gazebo's own window, or takes input from it":
        "CessnaGUIPlugin HeightmapLODPlugin KeyboardGUIPlugin LightVisualPlugin LinkPlot3DPlugin "
        "LookAtDemoPlugin TimerGUIPlugin unitreeDrawForcePlugin",
    "the lights stay as the file sets them": "FlashLightPlugin RosFlashLightPlugin LedPlugin",
    "pictures have no lens flare": "LensFlareSensorPlugin LensFlareVisualPlugin",
    "pictures have no bloom": "BloomVisualPlugin",
    "it publishes on topics of Gazebo's own transport, or only prints":
        "CameraPlugin ContactPlugin ContainPlugin DepthCameraPlugin FiducialCameraPlugin "
        "ForceTorquePlugin ImuSensorPlugin LinearBatteryPlugin LinearBatteryConsumerPlugin "
        "PressurePlugin RayPlugin SonarPlugin TouchPlugin",
    "its commands come from topics of Gazebo's own transport":
        "CessnaPlugin DiffDrivePlugin JoyPlugin KeysToCmdVelPlugin KeysToJointsPlugin "
        "SimpleTrackedVehiclePlugin SkidSteerDrivePlugin WheelTrackedVehiclePlugin",
    "it is Gazebo's own test of one arm, simple_arm_gripper, whose joints it moves":
        "JointTrajectoryPlugin",
    "models that reach its pads are not moved, although Gazebo moves them": "TransporterPlugin",
}

WITHOUT_EFFECT: Mapping[str, str] = {
    f"lib{name}.so": reason for reason, names in _REASONS.items() for name in names.split()}
"""The reason, by library."""


def no_effect_note(spec: PluginSpec) -> Optional[Issue]:
    """The note that a plugin has no effect, with the reason; None for other libraries."""
    library = library_name(spec.filename)
    if library not in WITHOUT_EFFECT:
        return None
    return Issue(Severity.NOTE, "not-simulated", f"<plugin {spec.name}> of {library} has no effect:"
                 f" {WITHOUT_EFFECT[library]}", spec.file, spec.line)
