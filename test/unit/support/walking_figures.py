"""A skin that tests see, in COLLADA: a rod of two bones whose upper half swings; centimetres."""
from __future__ import annotations

from typing import Sequence, Tuple

HEAD = """<?xml version="1.0"?>
<COLLADA xmlns="http://www.collada.org/2005/11/COLLADASchema" version="1.4.1">
<asset><unit name="cm" meter="0.01"/><up_axis>Z_UP</up_axis></asset>
"""
STILL = "1 0 0 0 0 1 0 0 0 0 1 0 0 0 0 1"
RAISED = "1 0 0 0 0 1 0 0 0 0 1 100 0 0 0 1"
QUARTER = "1 0 0 0 0 0 -1 0 0 1 0 100 0 0 0 1"
"""The upper bone, 100 cm up, turned by a quarter about x: up becomes -y."""


def box(x: Sequence[float], y: Sequence[float], z: Sequence[float]) -> str:
    """Eight corners."""
    return " ".join(f"{a} {b} {c}" for a in x for b in y for c in z)


TRIANGLES = ("0 1 3 0 3 2 4 6 7 4 7 5 0 4 5 0 5 1 2 3 7 2 7 6 0 2 6 0 6 4 1 5 7 1 7 3")


def source(name: str, kind: str, count: int, values: str, stride: int, form: str = "float") -> str:
    """A `<source>`."""
    return (f'<source id="{name}"><{kind}_array id="{name}-all" count="{count}">{values}'
            f"</{kind}_array><technique_common><accessor source=\"#{name}-all\" "
            f'count="{count // stride}" stride="{stride}">'
            + "".join(f'<param name="P{n}" type="{form}"/>' for n in range(1 if stride == 16
                                                                           else stride))
            + "</accessor></technique_common></source>")


def look(color: str) -> str:
    """A material that shines by itself."""
    return ('<library_effects><effect id="e"><profile_COMMON><technique sid="t"><lambert>'
            f"<emission><color>{color} 1</color></emission><diffuse><color>0 0 0 1</color>"
            "</diffuse></lambert></technique></profile_COMMON></effect></library_effects>"
            '<library_materials><material id="m"><instance_effect url="#e"/></material>'
            "</library_materials>")


def animation(times: Sequence[float], matrices: Sequence[str], node: str = "upper") -> str:
    """Keys of a node's matrix."""
    return ("<library_animations><animation id='a'>"
            + source("a-in", "float", len(times), " ".join(map(str, times)), 1)
            + source("a-out", "float", 16 * len(times), " ".join(matrices), 16, "float4x4")
            + source("a-how", "Name", len(times), " ".join(["LINEAR"] * len(times)), 1, "name")
            + "<sampler id='a-s'><input semantic='INPUT' source='#a-in'/><input semantic='OUTPUT' "
            "source='#a-out'/><input semantic='INTERPOLATION' source='#a-how'/></sampler>"
            f"<channel source='#a-s' target='{node}/transform'/></animation></library_animations>")


def influences(*vertices: Sequence[Tuple[int, int]]) -> str:
    """Bone and number of the weight, of each vertex."""
    flat = " ".join(f"{bone} {weight}" for vertex in vertices for bone, weight in vertex)
    return (f"<vcount>{' '.join(str(len(one)) for one in vertices)}</vcount><v>{flat}</v>")


BLENDED = ((0, 1), (1, 2))
"""A quarter follows the lower bone, the rest the upper one."""


def rod(color: str = "1 0 0", moves: str = "", root: str = STILL,
        blended: Sequence[Tuple[int, int]] = BLENDED) -> str:
    """A rod of 20 x 20 cm in blocks: one from z = 0 to 90 cm hangs on the lower bone, one from 110
    to 200 cm on the upper one, which is 100 cm up, and a small one behind the gap on both.

    `moves`: `animation` of the bones `lower` and `upper`; `root`: matrix of the lower one;
    `blended`: bones and weights (0: 1, 1: 0.25, 2: 0.75, 3: 0.1) of the small block.
    """
    places = " ".join([box((-10, 10), (-10, 10), (0, 90)), box((-10, 10), (-10, 10), (110, 200)),
                       box((20, 30), (-5, 5), (95, 105))])
    faces = " ".join(str(int(n) + first) for first in (0, 8, 16) for n in TRIANGLES.split())
    down = "1 0 0 0 0 1 0 0 0 0 1 -100 0 0 0 1"
    held = influences(*[[(0, 0)]] * 8, *[[(1, 0)]] * 8, *[blended] * 8)
    return (HEAD + look(color) + '<library_geometries><geometry id="g"><mesh>'
            + source("p", "float", 72, places, 3)
            + '<vertices id="v"><input semantic="POSITION" source="#p"/></vertices>'
            '<triangles count="36" material="paint"><input semantic="VERTEX" source="#v" offset="0"'
            f"/><p>{faces}</p></triangles></mesh></geometry></library_geometries>"
            '<library_controllers><controller id="c"><skin source="#g">'
            f"<bind_shape_matrix>{STILL}</bind_shape_matrix>"
            + source("j", "Name", 2, "low high", 1, "name")
            + source("i", "float", 32, f"{STILL} {down}", 16, "float4x4")
            + source("w", "float", 4, "1 0.25 0.75 0.1", 1)
            + '<joints><input semantic="JOINT" source="#j"/><input semantic="INV_BIND_MATRIX" '
            'source="#i"/></joints><vertex_weights count="24"><input semantic="JOINT" source="#j" '
            'offset="0"/><input semantic="WEIGHT" source="#w" offset="1"/>' + held
            + "</vertex_weights></skin></controller></library_controllers>"
            '<library_visual_scenes><visual_scene id="s"><node id="lower" sid="low" name="lower" '
            f'type="JOINT"><matrix sid="transform">{root}</matrix><node id="upper" sid="high" '
            f'name="upper" type="JOINT"><matrix sid="transform">{RAISED}</matrix></node></node>'
            '<node id="body" name="body" type="NODE"><instance_controller url="#c">'
            '<skeleton>#lower</skeleton><bind_material><technique_common><instance_material '
            'symbol="paint" target="#m"/></technique_common></bind_material></instance_controller>'
            "</node></visual_scene></library_visual_scenes>" + moves
            + '<scene><instance_visual_scene url="#s"/></scene></COLLADA>')


def swinging(color: str = "1 0 0", seconds: float = 2.0) -> str:
    """The rod, whose upper half falls to -y within `seconds`, evenly."""
    return rod(color, animation((0.0, seconds), (RAISED, QUARTER)))


BVH = """HIERARCHY
ROOT hip
{
  OFFSET 0.0 0.0 0.25
  CHANNELS 6 Xposition Yposition Zposition Zrotation Xrotation Yrotation
  JOINT chest
  {
    OFFSET 0.0 0.0 1.0
    CHANNELS 3 Zrotation Xrotation Yrotation
    End Site
    {
      OFFSET 0.0 0.0 1.0
    }
  }
}
MOTION
Frames: 4
Frame Time: 0.5
0 0 0 0 0 0 0 0 0
0 0 0 0 0 0 0 90 0
0 0 0.25 90 90 0 0 45 30
0.2 0 0.5 0 30 0 10 0 0
"""
"""A skeleton that branches as that of `rod`, in metres, and what it does within 1.5 s."""
