"""The table of what is read, made from the readers' own tables."""
import pytest

from my_simulations.formats.sdf.model_tables import COLLISION, GEOMETRIES, LINK, MODEL, WORLD
from my_simulations.formats.sdf.sensor_tables import SENSOR
from my_simulations.formats.support_table import support_tables, supported_rows
from my_simulations.formats.xml.tables import Use
from my_simulations.plugins.registry import PluginRegistry


def uses(table):
    return {row.path: row.use for row in supported_rows(table)}


def test_every_element_has_a_use():
    assert uses(LINK)["gravity"] is Use.SIMULATED and uses(LINK)["sensor"] is Use.PLUGINS
    assert uses(LINK)["velocity_decay/linear"] is Use.SIMULATED
    assert uses(WORLD)["scene"] is Use.SHOWN and uses(WORLD)["atmosphere"] is Use.KEPT


@pytest.mark.parametrize("table, element, library", [
    (WORLD, "wind", "libWindPlugin.so"), (MODEL, "enable_wind", "libWindPlugin.so"),
    (WORLD, "magnetic_field", "libmy_simulations_magnetometer.so"),
    (WORLD, "spherical_coordinates", "libmy_simulations_gps.so"),
    (WORLD, "atmosphere", "libatmosphere.so"),
    (SENSOR, "camera", "libgazebo_ros_camera.so"), (SENSOR, "ray", "libgazebo_ros_laser.so"),
    (COLLISION, "laser_retro", "libgazebo_ros_laser.so"),
    (SENSOR, "contact", "libgazebo_ros_bumper.so"), (SENSOR, "imu", "libgazebo_ros_imu_sensor.so"),
    (SENSOR, "gps", "libmy_simulations_gps.so"),
    (SENSOR, "force_torque", "libgazebo_ros_ft_sensor.so"),
    (SENSOR, "altimeter", "libmy_simulations_altimeter.so"),
    (SENSOR, "magnetometer", "libmy_simulations_magnetometer.so"),
    (SENSOR, "air_pressure", "libmy_simulations_air_pressure.so"),
    (SENSOR, "logical_camera", "libmy_simulations_logical_camera.so")])
def test_elements_of_plugins_are_listed_as_used_if_the_registry_has_the_plugin(
        table, element, library):
    known = PluginRegistry().is_supported(library)
    assert uses(table)[element] is (Use.PLUGINS if known else Use.KEPT)


def test_the_text_is_a_table_with_a_row_for_each_element():
    lines = support_tables().splitlines()
    assert lines[0] == "| SDF element | simulated | used by plugins | shown | kept | ignored |"
    for name in (*GEOMETRIES, "world", "state", "robot"):
        assert sum(line.startswith(f"| `{name}` |") for line in lines) >= 1, name
    assert all(line.count("|") == 7 for line in lines if line)


def test_what_newer_versions_brought_says_since_when():
    assert "`screw_thread_pitch` (SDF 1.10)" in support_tables()
