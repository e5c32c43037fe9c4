"""A strict little reader of the shipped SDF and URDF files.

Tests of the content do not rest on the package's own readers, but for meshes.
"""
from __future__ import annotations

import subprocess
import sys
import xml.etree.ElementTree as ElementTree
from dataclasses import dataclass, field
from pathlib import Path
from typing import List, Optional

import content_solids as solids
import numpy as np

from my_simulations.description.shapes import Mesh
from my_simulations.geometry import IDENTITY, Pose, compose, pose_from_xyzrpy, transform

ROOT = Path(__file__).resolve().parents[3]
COLLADA = "{http://www.collada.org/2005/11/COLLADASchema}"


@dataclass
class Inertial:
    mass: float
    pose: Pose
    matrix: np.ndarray


@dataclass
class Body:
    """A link; poses in the frame that the reader was given."""

    name: str
    static: bool
    solids: List[solids.Solid] = field(default_factory=list)
    inertial: Optional[Inertial] = None


def numbers(text: Optional[str]) -> List[float]:
    return [float(word) for word in (text or "").split()]


def sdf_pose(element: Optional[ElementTree.Element]) -> Pose:
    found = element.find("pose") if element is not None else None
    return pose_from_xyzrpy(*numbers(found.text)) if found is not None else IDENTITY


def world_bodies(path: Path) -> List[Body]:
    """Every link of a world file, includes resolved in models/, in the world frame."""
    world = ElementTree.parse(path).getroot().find("world")
    bodies: List[Body] = []
    for element in world:
        if element.tag == "model":
            bodies += model_bodies(element, sdf_pose(element), element.get("name"))
        elif element.tag == "include":
            uri = element.findtext("uri")
            assert uri.startswith("model://"), uri
            model = ElementTree.parse(
                ROOT / "models" / uri[len("model://"):] / "model.sdf").getroot().find("model")
            if model is None:
                continue
            place = sdf_pose(element if element.find("pose") is not None else model)
            bodies += model_bodies(model, place, element.findtext("name") or model.get("name"))
    return bodies


def model_bodies(model: ElementTree.Element, place: Pose, name: str) -> List[Body]:
    static = (model.findtext("static") or "false") == "true"
    bodies = []
    for link in model.findall("link"):
        frame = compose(place, sdf_pose(link))
        body = Body(f"{name}::{link.get('name')}", static)
        for collision in link.findall("collision"):
            solid = sdf_solid(collision.find("geometry"), compose(frame, sdf_pose(collision)))
            if solid is not None:
                body.solids.append(solid)
        inertial = link.find("inertial")
        if inertial is not None:
            pose = compose(frame, sdf_pose(inertial))
            tensor = inertial.find("inertia")
            body.inertial = Inertial(float(inertial.findtext("mass")), pose, symmetric(
                lambda key, t=tensor: t.findtext(key)))
        bodies.append(body)
    return bodies


def sdf_solid(geometry: ElementTree.Element, pose: Pose) -> Optional[solids.Solid]:
    shape = geometry[0]
    if shape.tag == "box":
        return solids.box(numbers(shape.findtext("size")), pose)
    if shape.tag == "sphere":
        return solids.sphere(float(shape.findtext("radius")), pose)
    if shape.tag == "cylinder":
        return solids.cylinder(float(shape.findtext("radius")), float(shape.findtext("length")),
                               pose)
    assert shape.tag == "plane", shape.tag
    return None


def urdf_root(path: Path) -> ElementTree.Element:
    if path.suffix == ".xacro":
        return ElementTree.fromstring(xacro(path))
    return ElementTree.parse(path).getroot()


def xacro(path: Path) -> bytes:
    done = subprocess.run([sys.executable, "-c", "import xacro; xacro.main()", str(path)],
                          capture_output=True, check=True, cwd=str(ROOT))
    return done.stdout


def urdf_bodies(path: Path) -> List[Body]:
    """Every link of a URDF, each in its own frame."""
    root = urdf_root(path)
    static = (root.findtext("gazebo/static") or "false") == "true"
    bodies = []
    for link in root.findall("link"):
        body = Body(link.get("name"), static)
        for collision in link.findall("collision"):
            body.solids.append(urdf_solid(collision.find("geometry")[0], origin(collision)))
        inertial = link.find("inertial")
        if inertial is not None:
            tensor = inertial.find("inertia")
            body.inertial = Inertial(float(inertial.find("mass").get("value")), origin(inertial),
                                     symmetric(tensor.get))
        bodies.append(body)
    return bodies


def origin(element: ElementTree.Element) -> Pose:
    found = element.find("origin")
    if found is None:
        return IDENTITY
    return pose_from_xyzrpy(*numbers(found.get("xyz", "0 0 0")),
                            *numbers(found.get("rpy", "0 0 0")))


def urdf_solid(shape: ElementTree.Element, pose: Pose) -> solids.Solid:
    if shape.tag == "box":
        return solids.box(numbers(shape.get("size")), pose)
    if shape.tag == "sphere":
        return solids.sphere(float(shape.get("radius")), pose)
    if shape.tag == "cylinder":
        return solids.cylinder(float(shape.get("radius")), float(shape.get("length")), pose)
    path = mesh_path(shape.get("filename"))
    return solids.mesh(Mesh(path.name, str(path), tuple(numbers(shape.get("scale", "1 1 1")))),
                       pose)


def mesh_path(uri: str) -> Path:
    assert uri.startswith("package://my_simulations/"), uri
    return ROOT / uri[len("package://my_simulations/"):]


def symmetric(get) -> np.ndarray:
    xx, xy, xz, yy, yz, zz = (float(get(key)) for key in ("ixx", "ixy", "ixz", "iyy", "iyz", "izz"))
    return np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]])


def in_frame(inertial: Inertial) -> np.ndarray:
    """The inertia about the centre of mass, in the axes of the frame its pose is given in."""
    turn = np.array([transform(Pose((0, 0, 0), inertial.pose.orientation), axis)
                     for axis in ((1, 0, 0), (0, 1, 0), (0, 0, 1))]).T
    return turn @ inertial.matrix @ turn.T
