"""Feeds changed files to the readers of files."""
from __future__ import annotations

import contextlib
import itertools
import json
import re
from pathlib import Path
from random import Random
from typing import Any, Callable, Dict, Hashable, Iterable, Iterator, List, Mapping

import yaml
from building_plans import two_rooms
from lxml import etree
from mutant_run import Target, shape
from mutations import (
    STRANGE_NUMBERS,
    STRANGE_TEXTS,
    STRANGE_YAML,
    Element,
    TreeKnowledge,
    XmlKnowledge,
    element_of,
    xml_text,
    yaml_text,
)

from my_simulations.appearance.material_script import read_materials
from my_simulations.appearance.textures import TextureFiles
from my_simulations.building.building_operations import building_sdf
from my_simulations.building.plan_json import plan_to_json
from my_simulations.description.light import Light
from my_simulations.description.model import Model
from my_simulations.description.shapes import Mesh
from my_simulations.description.world import World
from my_simulations.errors import CommandError, InputError, Issue
from my_simulations.formats.mesh.loading import load_mesh
from my_simulations.formats.reading import read_any
from my_simulations.formats.sdf import model_tables, sensor_tables, world_tables
from my_simulations.formats.sdf.writer.entities import write_entity, write_world
from my_simulations.formats.urdf import urdf_tables
from my_simulations.objects.object_list import parse_objects
from my_simulations.objects.yaml_source import read_yaml
from my_simulations.resources.resolver import Resolver
from my_simulations.studies.study_file import read_study

ROOT = Path(__file__).resolve().parents[2]
FOLDERS = ("test/data", "models", "world", "config", "examples", "objects", "urdf")
SMALL, LARGE = 6000, 100_000
"""Bytes of a file that is changed, and of one that is learnt from."""

ATTRIBUTES = ("name", "type", "version", "xyz", "rpy", "value", "filename", "link", "radius",
              "size", "relative_to", "degrees", "rotation_format", "lower", "upper", "ixx", "scale")
NAMES_KEPT = 10.0
"""Bytes of an input: one in twenty has a name or two that libxml2 keeps, 48 to 78 bytes each."""

COLLADA = "http://www.collada.org/2005/11/COLLADASchema"
COLLADA_TREE = {
    "COLLADA": ["asset", "library_geometries", "library_nodes", "library_visual_scenes", "scene",
                "library_controllers", "node"],
    "node": ["translate", "rotate", "scale", "matrix", "lookat", "skew", "node", "instance_node",
             "instance_geometry", "instance_controller", "instance_light"],
    "visual_scene": ["node"], "library_controllers": ["controller"],
    "controller": ["skin", "morph"],
    "skin": ["bind_shape_matrix", "source"], "instance_controller": ["skeleton"],
    "mesh": ["source", "vertices", "triangles", "polylist", "polygons", "lines", "trifans",
             "tristrips", "linestrips"],
    "triangles": ["input", "p"], "polylist": ["input", "vcount", "p"],
    "polygons": ["input", "p", "ph"], "ph": ["p", "h"], "vertices": ["input"],
    "source": ["float_array", "Name_array", "technique_common"], "technique_common": ["accessor"],
    "accessor": ["param"], "asset": ["unit", "up_axis"], "geometry": ["mesh", "convex_mesh"]}
_NAMESPACE = re.compile(rb"""xmlns=["'][^"']*["']""")


def files(*suffixes: str) -> List[Path]:
    """Return the files of the project with one of these endings."""
    return [path for folder in FOLDERS for path in sorted((ROOT / folder).rglob("*"))
            if path.suffix in suffixes and path.stat().st_size <= LARGE]


def tables(*modules: Any) -> List[Any]:
    """Return the tables of readers, which list the known elements."""
    return [value for module in modules for value in vars(module).values()
            if hasattr(value, "children") and hasattr(value, "of")]


def children_by_element(tables: Iterable[Any]) -> Dict[str, List[str]]:
    """Return the children that each element may have, from the tables of the readers."""
    found: Dict[str, List[str]] = {}

    def add(tag: str, children: Mapping[str, Any]) -> None:
        found.setdefault(tag, []).extend(name.strip("/") for name in children)
        for name, entry in children.items():
            inside = getattr(entry, "children", None)
            if inside:
                add(name, inside)

    for table in tables:
        add(table.of.__name__.lower(), table.children)
    return found


SDF = children_by_element(tables(model_tables, world_tables, sensor_tables))
URDF = children_by_element(tables(urdf_tables))


def features(issues: Iterable[Issue], more: Hashable = "read") -> List[Hashable]:
    """Return the features of an answer: codes of issues with the names of their elements."""
    return [more, *((issue.code, issue.xpath.rpartition("/")[2].partition("[")[0][:20])
                    for issue in issues)]


def read_document(text: Any, resolver: Resolver = Resolver([])) -> List[Hashable]:
    """Read a document as the node does, and write what was read."""
    try:
        found, issues = read_any(text, resolver, "fuzz.sdf")
    except InputError as fault:
        assert fault.issues
        return features(fault.issues, "refused")
    if isinstance(found, World):
        write_world(found, found.state)
    elif isinstance(found, (Model, Light)):
        write_entity(found)
    return features(issues, type(found).__name__)


def damaged(text: str, chance: Random) -> str:
    """Return the text; one in twenty has a slice removed, doubled or replaced."""
    if chance.random() > 0.05:
        return text
    start = chance.randrange(len(text) + 1)
    end = start + int(chance.expovariate(0.1))
    put = chance.choice(("", text[start:end] * 2, "\0", "<", ">", "\ufffe", "]]>", "<!--",
                         "<!DOCTYPE a [", "'", "&#0;", "\ud800", "<?xml version='1.1'?>", "\t"))
    return text[:start] + put + text[end:]


def documents(name: str, roots: Iterable[str], suffixes: Iterable[str], tree: Any) -> Target:
    """SDF or URDF."""
    known = XmlKnowledge()
    model = Element("model", (("name", "m"),), "", ())
    seeds = [Element("sdf", (("version", "1.7"),), "", (model,)) if name == "SDF" else
             Element("robot", (("name", "r"),), "", ())]
    for path in files(*suffixes):
        with contextlib.suppress(etree.XMLSyntaxError):
            root = element_of(etree.fromstring(path.read_bytes()))
            if root.tag in roots:
                known.learn(root)
                if path.stat().st_size <= SMALL:
                    seeds.append(root)
    known.learn_names(tree, ATTRIBUTES)
    read_document(xml_text(seeds[0]))
    return Target(name, seeds, known.change,
                  lambda made, chance: damaged(xml_text(made), chance), read_document,
                  suffix=".sdf", kept_bytes=NAMES_KEPT)


def sdf(_folder: Path) -> Target:
    """Worlds, models, lights and actors."""
    return documents("SDF", ("sdf", "gazebo"), (".sdf", ".world"),
                     {**SDF, "sdf": ["world", "model", "light", "actor"]})


def urdf(_folder: Path) -> Target:
    return documents("URDF", ("robot",), (".urdf",), {
        **URDF, "robot": ["link", "joint", "material", "gazebo", "transmission"]})


def collada(folder: Path) -> Target:
    """Meshes as COLLADA."""
    known = XmlKnowledge()
    seeds = []
    for path in files(".dae"):
        with contextlib.suppress(etree.XMLSyntaxError):
            root = element_of(etree.fromstring(_NAMESPACE.sub(b"", path.read_bytes())))
            known.learn(root)
            if path.stat().st_size <= SMALL:
                seeds.append(root._replace(attributes=(("xmlns", COLLADA), *root.attributes)))
    known.learn_names(COLLADA_TREE, ("id", "sid", "url", "source", "semantic", "count", "offset"))
    paths = itertools.cycle([folder / f"m{number}.dae" for number in range(40)])

    def load(text: str) -> List[Hashable]:
        path = next(paths)  # the cache of meshes is smaller than the number of paths
        path.write_bytes(text.encode("utf-8", "surrogatepass"))
        try:
            data = load_mesh(Mesh(path.name, str(path)))
        except InputError as fault:
            assert fault.issues
            return [shape(fault.first.message)]
        assert len(data.triangles) and data.triangles.max() < len(data.vertices)
        return [min(len(data.triangles), 50)]

    return Target("DAE", seeds, known.change,
                  lambda made, chance: damaged(xml_text(made), chance), load, suffix=".dae",
                  kept_bytes=NAMES_KEPT)


def yaml_files(name: str, seeds: List[Any], path: Path,
               read: Callable[[str], Iterable[Issue]]) -> Target:
    """A reader of YAML files; it returns issues or raises them."""
    known = TreeKnowledge(STRANGE_YAML)
    for seed in seeds:
        known.learn(seed)

    def load(text: str) -> List[Hashable]:
        path.write_bytes(text.encode("utf-8", "surrogatepass"))
        try:
            return features(read(str(path)))
        except InputError as fault:
            assert fault.issues
            return [*features(fault.issues, "refused"),
                    shape(fault.first.message)]

    return Target(name, seeds, known.change,
                  lambda made, chance: damaged(yaml_text(made, chance), chance), load,
                  suffix=".yaml")


def _trees(suffix: str, wanted: Callable[[Any], bool]) -> Iterator[Any]:
    for path in files(suffix):
        try:
            tree = yaml.safe_load(path.read_text(encoding="utf-8"))
        except (yaml.YAMLError, ValueError):
            continue
        if isinstance(tree, dict) and wanted(tree) and path.stat().st_size <= SMALL:
            yield json.loads(json.dumps(tree, default=str))


def object_lists(folder: Path) -> Target:
    def read(path: str) -> List[Issue]:
        tree, source, issues = read_yaml(path, "/objects")
        return issues + parse_objects(tree, source).issues()

    small = {"box": {"model": "box", "model_type": "urdf", "position": [0, 0, 0.5],
                     "orientation": [0, 0, 0],
                     "children": {"a": {"model": "p/a.sdf", "position": [1, 0, 0],
                                        "orientation": [0, 0, 1.57]}}}}
    found = [tree for tree in _trees(".yaml", lambda tree: any(
        isinstance(value, dict) and "model" in value for value in tree.values()))]
    return yaml_files("object lists", [small, *(tree for tree in found if len(tree) < 8)],
                      folder / "objects.yaml", read)


def study_files(folder: Path) -> Target:
    found = list(_trees(".yaml", lambda tree: "duration" in tree or "scenarios" in tree))
    assert found
    return yaml_files("study files", found, folder / "study.yaml",
                      lambda path: read_study(path)[1])


def plans(_folder: Path) -> Target:
    plan = json.loads(json.dumps(plan_to_json(two_rooms())))
    known = TreeKnowledge()
    known.learn(plan)

    def build(tree: Any) -> List[Hashable]:
        try:
            return features(building_sdf(tree)[2])
        except InputError as fault:
            return [(issue.code, shape(issue.message)[:40]) for issue in fault.issues]
        except CommandError as fault:
            return [shape(str(fault))]

    return Target("building plans", [plan], known.change, lambda made, chance: made, build,
                  suffix=".json")


SCRIPT_WORDS = ("material", "technique", "pass", "texture_unit", "{", "}", "\n", "\n", ":", "//",
                "/*", "*/", '"', '"a b.png"', "ambient", "diffuse", "scale", "alpha_rejection",
                "greater", "scene_blend", "alpha_blend", "lighting", "off", "1", "0.5", "nan",
                "1e999", "texture", "a.png", "\0")
SCRIPT = """material A { technique { pass { ambient 1 0 0 1 \n diffuse 0.5 0.5 0.5 \n
 alpha_rejection greater 128 \n lighting off \n texture_unit { texture a.png \n scale 2 2 \n } } } }
material B : A { technique { pass { specular 1 1 1 1 12 \n scene_blend alpha_blend \n } } }"""


def material_scripts(folder: Path) -> Target:
    """Ogre's scripts."""
    textures = TextureFiles(Resolver([str(folder)]))

    def change(words: List[str], chance: Random) -> List[str]:
        for _ in range(chance.choice((1, 1, 2, 3, 5))):
            at, kind = chance.randrange(len(words) + 1), chance.randrange(5)
            end = at + chance.choice((1, 1, 2, 5, 20))
            put = ([chance.choice(SCRIPT_WORDS)] if kind < 2 else
                   [chance.choice(STRANGE_NUMBERS + STRANGE_TEXTS)] if kind == 2 else
                   words[at:end] * chance.choice((0, 2, 2, 2, 2, 2, 2, 40)))
            words = words[:at] + put + words[end if kind else at:]
        return words[:3000]

    def read(text: str) -> List[Hashable]:
        found = read_materials(text)
        for material in found.values():
            textures.texture(material.texture, [str(folder)])
            json.dumps(vars(material), allow_nan=False)
        return [len(found), *(tuple(value is None for value in vars(material).values())
                              for material in itertools.islice(found.values(), 3))]

    words = re.findall(r"[^ \n]+|\n", SCRIPT)
    return Target("material scripts", [words], change, lambda made, chance: " ".join(made), read,
                  suffix=".material")


READERS = {"SDF": sdf, "URDF": urdf, "DAE": collada, "object lists": object_lists,
           "study files": study_files, "building plans": plans,
           "material scripts": material_scripts}
