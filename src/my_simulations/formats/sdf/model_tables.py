"""The elements of SDF 1.7 that are simulated, as tables. Source: SDF specification, 1.2 to 1.7."""
from __future__ import annotations

from typing import Mapping

from ...description.light import Light
from ...description.model import Inertial, Joint, JointAxis, Link, Model
from ...description.shapes import (
    Box,
    Capsule,
    Collision,
    Cone,
    Cylinder,
    Ellipsoid,
    Empty,
    Heightmap,
    ImageMap,
    Material,
    Mesh,
    Plane,
    Polyline,
    Sphere,
    Surface,
    TerrainBlend,
    TerrainTexture,
    Visual,
)
from ...description.world import Physics, World
from ..xml.source import FaultLevel
from ..xml.tables import (
    Entry,
    Group,
    Kept,
    Nested,
    Part,
    Table,
    Use,
    Value,
    kept,
    values_named,
)
from ..xml.values import (
    BOOL,
    COLOR,
    FLOAT,
    FRICTION,
    INT,
    LIMIT,
    PLANE_SIZE,
    POSE,
    SCALE,
    TEXT,
    VECTOR3,
)
from .world_tables import SURROUNDINGS

FATAL, ERROR, WARNING = FaultLevel.FATAL, FaultLevel.ERROR, FaultLevel.WARNING


PLUGINS, SHOWN, KEPT = Use.PLUGINS, Use.SHOWN, Use.KEPT


TERRAIN_TEXTURE = Table("texture", TerrainTexture, {
    "diffuse": Value("diffuse", TEXT), "normal": Value("normal", TEXT),
    "size": Value("size", FLOAT),
}, level=WARNING, use=SHOWN)
TERRAIN_BLEND = Table("blend", TerrainBlend, values_named(FLOAT, "min_height", "fade_dist"),
                      level=WARNING, use=SHOWN)

GEOMETRIES: Mapping[str, Table] = {
    "box": Table("box", Box, {"size": Value("size", VECTOR3)}),
    "sphere": Table("sphere", Sphere, {"radius": Value("radius", FLOAT)}),
    "cylinder": Table("cylinder", Cylinder, values_named(FLOAT, "radius", "length")),
    "plane": Table("plane", Plane, {
        "normal": Value("normal", VECTOR3), "size": Value("size", PLANE_SIZE),
    }),
    "mesh": Table("mesh", Mesh, {
        "uri": Value("uri", TEXT),
        "filename": Value("uri", TEXT),  # SDF 1.0 to 1.2
        "scale": Value("scale", SCALE),
        "submesh": Group({"name": Value("submesh", TEXT), "center": Value("center", BOOL)}),
        "convex_decomposition": Kept("1.11"),
    }),
    "capsule": Table("capsule", Capsule, values_named(FLOAT, "radius", "length")),
    "ellipsoid": Table("ellipsoid", Ellipsoid, {"radii": Value("radii", VECTOR3)}),
    "cone": Table("cone", Cone, values_named(FLOAT, "radius", "length")),
    "heightmap": Table("heightmap", Heightmap, {
        "uri": Value("uri", TEXT),
        "filename": Value("uri", TEXT),  # SDF 1.0 to 1.2
        "size": Value("size", VECTOR3),
        "pos": Value("position", VECTOR3),
        "offset": Value("position", VECTOR3),  # SDF 1.0 to 1.2
        "sampling": Value("sampling", INT),
        "texture": Nested("textures", TERRAIN_TEXTURE, required=("diffuse", "normal", "size"),
                          use=SHOWN),
        "blend": Nested("blends", TERRAIN_BLEND, required=("min_height", "fade_dist"), use=SHOWN),
        **kept("use_terrain_paging"),
    }),
    "image": Table("image", ImageMap, {
        "uri": Value("uri", TEXT),
        "filename": Value("uri", TEXT),  # SDF 1.0 to 1.2
        "scale": Value("scale", FLOAT),
        "threshold": Value("threshold", INT),
        "height": Value("height", FLOAT),
        "granularity": Value("granularity", INT),
    }),
    "polyline": Table("polyline", Polyline, {
        "point": Part(), "height": Value("height", FLOAT),
    }),
    "empty": Table("empty", Empty),
}

_ODE_FRICTION = Group({
    "mu": Value("mu", FRICTION), "mu2": Value("mu2", FRICTION), "fdir1": Value("fdir1", VECTOR3),
    "slip1": Value("slip1", FLOAT), "slip2": Value("slip2", FLOAT),
})
_ODE_CONTACT = Group({
    **values_named(FLOAT, "kp", "kd", "max_vel"),
    "min_depth": Value("min_depth", FLOAT, use=KEPT),
    **kept("soft_cfm", "soft_erp"),
})
_TORSIONAL = Group({
    "coefficient": Value("torsion", FLOAT), "patch_radius": Value("patch_radius", FLOAT),
    "use_patch_radius": Value("use_patch_radius", BOOL),
    "surface_radius": Value("surface_radius", FLOAT, use=KEPT), **kept("ode"),
})
SURFACE_CHILDREN: Mapping[str, Entry] = {
    "bounce": Group({
        "restitution_coefficient": Value("restitution", FLOAT),
        "threshold": Value("bounce_threshold", FLOAT),
    }),
    "friction": Group({"ode": _ODE_FRICTION, "torsional": _TORSIONAL, **kept("bullet")}),
    "contact": Group({
        "ode": _ODE_CONTACT,
        "collide_without_contact": Value("collide_without_contact", BOOL),
        "collide_bitmask": Value("collide_bitmask", INT),
        **kept("bullet", "collide_without_contact_bitmask", "category_bitmask", "poissons_ratio",
               "elastic_modulus"),
    }),
    **kept("soft_contact"),
}
SURFACE = Table("surface", Surface, SURFACE_CHILDREN)

COLLISION = Table("collision", Collision, {
    "pose": Value("pose", POSE, FATAL),
    "geometry": Part(),
    "surface": Group(SURFACE_CHILDREN, part="surface"),
    "max_contacts": Value("max_contacts", INT, use=KEPT),
    "laser_retro": Value("laser_retro", FLOAT, use=PLUGINS),
    **kept("frame", "density", "mass"),
}, known_attributes=("name",))

VISUAL = Table("visual", Visual, {
    "pose": Value("pose", POSE),
    "geometry": Part(),
    "material": Part(),
    "cast_shadows": Value("cast_shadows", BOOL),
    "transparency": Value("transparency", FLOAT),
    "laser_retro": Value("laser_retro", FLOAT, use=PLUGINS),
    "meta": Group({"layer": Value("layer", INT)}),
    **kept("frame", "visibility_flags"), **kept("plugin", reported=True),
}, level=WARNING, known_attributes=("name",), use=SHOWN)

MATERIAL = Table("material", Material, {
    **values_named(COLOR, "ambient", "diffuse", "specular", "emissive"),
    "script": Group({
        "uri": Value("script_uris", TEXT, repeated=True), "name": Value("script_name", TEXT),
    }),
    "double_sided": Value("double_sided", BOOL),
    **kept("shader", "lighting", "shininess", "pbr", "render_order"),
}, level=WARNING, use=SHOWN)

INERTIAL = Table("inertial", Inertial, {
    "mass": Value("mass", FLOAT),
    "pose": Value("pose", POSE),
    "inertia": Group(values_named(FLOAT, "ixx", "ixy", "ixz", "iyy", "iyz", "izz")),
    **kept("frame", "density", "fluid_added_mass"),
}, level=FATAL, known_attributes=("auto",))

LINK = Table("link", Link, {
    "pose": Value("pose", POSE, FATAL),
    "inertial": Part(),
    "collision": Part(),
    "visual": Part(),
    **values_named(BOOL, "gravity", "kinematic", "self_collide"),
    "velocity_decay": Group({
        "linear": Value("linear_decay", FLOAT), "angular": Value("angular_decay", FLOAT),
    }),
    **kept("frame", "light", "must_be_base_link"), "enable_wind": Kept(use=PLUGINS),
    "sensor": Part(use=PLUGINS, kept=True),
    **kept("projector", "audio_source", "audio_sink", "battery", "particle_emitter",
           "plugin", reported=True),
}, known_attributes=("name",))

_AXIS_CHILDREN: Mapping[str, Entry] = {
    "xyz": Part(),
    "limit": Group({
        **values_named(LIMIT, "lower", "upper", "effort", "velocity"),
        **kept("stiffness", "dissipation"),
    }),
    "dynamics": Group(values_named(
        FLOAT, "damping", "friction", "spring_reference", "spring_stiffness")),
    "mimic": Part("1.11"),
    **kept("initial_position"),
}
AXIS = Table("axis", JointAxis, _AXIS_CHILDREN, level=FATAL)
AXIS2 = Table("axis2", JointAxis, _AXIS_CHILDREN, level=FATAL)

JOINT = Table("joint", Joint, {
    "parent": Value("parent", TEXT), "child": Value("child", TEXT),
    "pose": Value("pose", POSE, FATAL),
    "axis": Part(),
    "axis2": Part(),
    "thread_pitch": Value("thread_pitch", FLOAT),
    "screw_thread_pitch": Part("1.10"),
    "gearbox_ratio": Value("gearbox_ratio", FLOAT),
    "gearbox_reference_body": Value("gearbox_reference", TEXT),
    "sensor": Part(use=PLUGINS, kept=True),
    **kept("frame", "physics"),
}, known_attributes=("name", "type"))

FRAME = Table("frame", Link, {"pose": Value("pose", POSE, FATAL)},
              known_attributes=("name", "attached_to"))

MODEL = Table("model", Model, {
    "pose": Value("pose", POSE, FATAL),
    **values_named(BOOL, "static", "self_collide", "allow_auto_disable"),
    "link": Part(), "joint": Part(), "model": Part("1.5"), "include": Part("1.4"),
    "frame": Part("1.5", kept=True), "plugin": Part(use=PLUGINS),
    "enable_wind": Value("enable_wind", BOOL, use=PLUGINS),
    "gripper": Part(),
}, attributes={"canonical_link": Value("canonical_link", TEXT, since="1.7")},
   known_attributes=("name", "placement_frame"))

INCLUDE = Table("include", Model, {
    **values_named(TEXT, "uri", "name"),
    "pose": Value("pose", POSE, FATAL),
    "static": Value("static", BOOL),
    "plugin": Part(use=PLUGINS),
    "placement_frame": Part("1.8"),
}, known_attributes=("merge",))

LIGHT = Table("light", Light, {
    "pose": Value("pose", POSE),
    "cast_shadows": Value("cast_shadows", BOOL),
    "diffuse": Value("diffuse", COLOR), "specular": Value("specular", COLOR),
    "attenuation": Group(values_named(FLOAT, "range", "constant", "linear", "quadratic")),
    "direction": Value("direction", VECTOR3),
    "spot": Group(values_named(FLOAT, "inner_angle", "outer_angle", "falloff")),
    **kept("frame", "intensity", "light_on", "visualize"), **kept("plugin", reported=True),
}, attributes={"type": Value("type", TEXT)}, level=WARNING, known_attributes=("name",), use=SHOWN)

PHYSICS = Table("physics", Physics, {
    "max_step_size": Value("max_step_size", FLOAT),
    "real_time_factor": Value("real_time_factor", FLOAT, use=KEPT),
    "real_time_update_rate": Value("real_time_update_rate", FLOAT),
    "max_contacts": Value("max_contacts", INT, use=KEPT, part="ode"),
    "ode": Group({
        "solver": Group({
            "iters": Value("iters", INT),
            "precon_iters": Value("precon_iters", INT, use=KEPT),
            "sor": Value("sor", FLOAT, use=KEPT),
            "friction_model": Value("friction_model", TEXT),
            **kept("type", "min_step_size", "island_threads", "thread_position_correction",
                   "use_dynamic_moi_rescaling"),
        }),
        "constraints": Group(values_named(FLOAT, "cfm", "erp", "contact_max_correcting_vel",
                                          "contact_surface_layer", use=KEPT)),
        "max_contacts": Value("max_contacts", INT, use=KEPT),
        **kept("provide_feedback"),
    }, part="ode"),
    **kept("bullet", "simbody", "dart"),
}, attributes={"name": Value("name", TEXT, use=KEPT), "type": Value("type", TEXT, use=KEPT)},
   known_attributes=("default",))

WORLD = Table("world", World, {
    "gravity": Value("gravity", VECTOR3, since="1.6"),
    "physics": Part(), "light": Part(use=SHOWN), "model": Part(), "include": Part(),
    "plugin": Part(use=PLUGINS),
    "population": Part(), "frame": Part("1.7", kept=True),
    "state": Part(), "joint": Part("1.10"),
    "magnetic_field": Value("magnetic_field", VECTOR3, since="1.6", use=PLUGINS),
    **SURROUNDINGS,
    **kept("audio", reported=True),
}, known_attributes=("name",))
