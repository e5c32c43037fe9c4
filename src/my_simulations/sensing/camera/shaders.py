"""The programs of the renderer, GLSL 3.30.

Light and colour are those of the editor's page: colours of files are sRGB, light is added up in
linear units, a lamp of colour 1 falls on a white wall as 1. Places are given relative to the
camera, so that a world far from its origin keeps its accuracy.
"""
from __future__ import annotations

from typing import NamedTuple, Tuple

from ...appearance.palette import SHININESS, SKY_COLOR

MOST_LIGHTS = 8
MOST_SHADOWS = 2
MOST_LAYERS = 8
"""Of a terrain."""
MOST_BUMPS = 4
"""Normal maps of a terrain's lowest layers: 16 textures are what each machine has."""
FIRST_LAYER = 1 + MOST_SHADOWS
"""Texture unit of a terrain's lowest layer."""
FIRST_BUMPS = FIRST_LAYER + MOST_LAYERS
"""Texture unit of its normal map."""

_INSTANCE = """#version 330
in vec3 at; in vec3 normal; in vec2 uv;
in vec4 row0; in vec4 row1; in vec4 row2; in int link;
in vec4 diffuse; in vec3 specular; in vec3 emissive;
uniform mat4 clip;
vec3 placed() { vec4 p = vec4(at, 1.0); return vec3(dot(row0, p), dot(row1, p), dot(row2, p)); }
"""

LIT_VERTEX = _INSTANCE + """
uniform vec2 repeats;
out vec3 place; out vec3 out_normal; out vec2 out_uv; out float out_height;
out vec3 out_east;
flat out vec4 out_diffuse; flat out vec3 out_specular; flat out vec3 out_emissive;
void main() {
  place = placed();
  out_diffuse = diffuse;
  out_specular = specular;
  out_emissive = emissive;
  out_east = vec3(row0.x, row1.x, row2.x);
  out_normal = vec3(dot(row0.xyz, normal), dot(row1.xyz, normal), dot(row2.xyz, normal));
  out_uv = uv * repeats;
  out_height = at.z;
  gl_Position = clip * vec4(place, 1.0);
  // Of two faces at one place the one seen from its front wins: web/js/view/fronts_first.ts.
  if (dot(out_normal, place) > 0.0) gl_Position.z += 1.0e-6 * gl_Position.w;
}"""

COLOR = """
vec3 encoded(vec3 c) {
  return mix(1.055 * pow(c, vec3(1.0 / 2.4)) - 0.055, 12.92 * c, lessThanEqual(c, vec3(0.0031308)));
}
"""

class LitKind(NamedTuple):
    """What a fragment program is made for.

    Where the processor draws, both sides of each condition are computed for all pixels: there is a
    program for each combination that occurs, without conditions.

    Attributes:
        textured: has a picture.
        lit: lights count.
        shiny: has highlights.
        cut: what of the picture is nearly transparent is left out.
        blended: the picture's alpha counts.
        fog: "", or the law by which it hides what is further away: linear, exp or exp2.
        lights: type of each light, and the number of its shadow map or -1.
        layers: of a terrain; whether each has a normal map.
    """

    textured: bool
    lit: bool
    shiny: bool
    cut: bool
    blended: bool
    fog: str
    lights: Tuple[Tuple[str, int], ...]
    layers: Tuple[bool, ...] = ()


_UNIFORMS = f"""#version 330
#define LIGHTS {MOST_LIGHTS}
#define SHADOWS {MOST_SHADOWS}
#define LAYERS {MOST_LAYERS}
""" + """in vec3 place; in vec3 out_normal; in vec2 out_uv; in float out_height; in vec3 out_east;
flat in vec4 out_diffuse; flat in vec3 out_specular; flat in vec3 out_emissive;
out vec4 seen;
uniform vec3 ambient, up;
uniform sampler2D picture;
uniform float alpha_test;
uniform vec3 layer_form[LAYERS];     // repetitions a metre, height it begins at, part a metre
uniform vec4 light_at[LIGHTS];       // xyz: place, or direction to it
uniform vec3 light_color[LIGHTS];
uniform vec3 light_way[LIGHTS];      // of a spot
uniform vec4 light_fade[LIGHTS];     // constant, linear, quadratic, range
uniform vec3 light_cone[LIGHTS];     // of a spot: cosines of half the angles, falloff
uniform mat4 shadow_from_view[SHADOWS];
uniform float shadow_pixel[SHADOWS];
uniform sampler2DShadow shadow0, shadow1;
uniform vec3 fog;                    // start, end, density
uniform vec3 fog_color;
""" + COLOR + """
float lightened(sampler2DShadow map, mat4 from_view, float pixel, vec3 n) {
  vec4 p = from_view * vec4(place + n * pixel * 1.5, 1.0);
  vec3 at = p.xyz / p.w * 0.5 + 0.5;
  float bright = texture(map, vec3(at.xy, at.z - 0.0004));
  bool outside = any(lessThan(at, vec3(0.0))) || any(greaterThan(at, vec3(1.0)));
  return outside ? 1.0 : bright;
}
void main() {
  vec3 albedo = out_diffuse.rgb;
  float opacity = out_diffuse.a;
"""

_SURROUNDED = """  vec3 n = normalize(out_normal), eye = -normalize(place);
  n = dot(n, eye) < 0.0 ? -n : n;
"""

_FALLEN = """  vec3 fallen = ambient * mix(0.6, 1.0, 0.5 * dot(n, up) + 0.5), shine = vec3(0.0);
"""


# How much is seen through fog at distance d.
_CLEAR = {"linear": "clamp((fog.y - d) / max(fog.y - fog.x, 1e-6), 0.0, 1.0)",
          "exp": "exp(-fog.z * d)", "exp2": "exp(-fog.z * fog.z * d * d)"}


def lit_fragment(kind: LitKind) -> str:
    """The program of a surface under some lights."""
    samplers = "".join(f"uniform sampler2D layer{n}, bumps{n};\n"
                       for n in range(len(kind.layers)))
    parts = [_UNIFORMS.replace("void main", f"{samplers}void main")]
    if kind.textured:
        parts.append("  vec4 t = texture(picture, out_uv); albedo *= t.rgb;\n")
        if kind.cut:
            parts.append("  if (t.a < alpha_test) discard;\n")
        if kind.blended:
            parts.append("  opacity *= t.a;\n")
    parts += [_layer(n) for n in range(len(kind.layers))]
    parts.append("  vec3 color = albedo;\n")
    if kind.lit:
        parts.append(_SURROUNDED)
        if any(kind.layers):
            parts.append(_bumps(kind.layers))
        parts.append(_FALLEN)
        parts += [_light(n, *one, kind.shiny) for n, one in enumerate(kind.lights)]
        # A picture colours what glows, too, as on the page (materials.ts).
        glow = "out_emissive * t.rgb" if kind.textured else "out_emissive"
        parts.append(f"  color = albedo * fallen + shine + {glow};\n")
    if kind.fog:
        parts.append("  float d = -place.z;\n"
                     f"  color = mix(fog_color, color, {_CLEAR[kind.fog]});\n")
    return "".join([*parts, "  seen = vec4(encoded(clamp(color, 0.0, 1.0)), opacity);\n}"])


def _layer(n: int) -> str:
    """A layer of a terrain over the ones below it; see `appearance.terrain_layers`."""
    return (f"  float part{n} = {'1.0' if n == 0 else _part(n)};\n"
            f"  albedo = mix(albedo, texture(layer{n}, out_uv * layer_form[{n}].x).rgb,"
            f" part{n});\n")


def _part(n: int) -> str:
    return f"clamp((out_height - layer_form[{n}].y) * layer_form[{n}].z, 0.0, 1.0)"


def _bumps(layers: Tuple[bool, ...]) -> str:
    """Turn the normal as the normal maps of a terrain's layers say; x is eastwards, y north."""
    lines = ["vec3 bump = vec3(0.0, 0.0, 1.0);"]
    for n, bumpy in enumerate(layers):
        one = (f"texture(bumps{n}, out_uv * layer_form[{n}].x).xyz * 2.0 - 1.0" if bumpy
               else "vec3(0.0, 0.0, 1.0)")
        lines.append(f"bump = mix(bump, {one}, part{n});")
    lines += ["vec3 north = normalize(cross(n, out_east));",
              "n = normalize(mat3(cross(north, n), north, n) * bump);"]
    return "  " + "\n  ".join(lines) + "\n"


def _light(k: int, kind: str, shadow: int, shiny: bool) -> str:
    lines = []
    if kind == "directional":
        lines += [f"vec3 way = light_at[{k}].xyz;", "float strength = 1.0;"]
    else:
        lines += [f"vec3 way = light_at[{k}].xyz - place;", "float far = length(way);",
                  "way /= max(far, 1e-6);", f"vec4 fade = light_fade[{k}];",
                  "float strength = step(far, fade.w)"
                  " / max(fade.x + far * (fade.y + far * fade.z), 1e-6);"]
    if kind == "spot":
        lines += [f"vec3 cone = light_cone[{k}];",
                  f"float part = (dot(-way, light_way[{k}]) - cone.y)"
                  " / max(cone.x - cone.y, 1e-6);",
                  "strength *= part > 0.0 ? pow(min(part, 1.0), cone.z) : 0.0;"]
    lines.append("float facing = max(dot(n, way), 0.0);")
    if shadow >= 0:
        lines.append(f"strength *= lightened(shadow{shadow}, shadow_from_view[{shadow}], "
                     f"shadow_pixel[{shadow}], n);")
    lines += [f"vec3 falling = light_color[{k}] * (strength * facing);", "fallen += falling;"]
    if shiny:
        lines.append(f"shine += falling * out_specular * {(SHININESS / 2 + 1) / 4}"
                     f" * pow(max(dot(n, normalize(way + eye)), 0.0), {SHININESS});")
    return "  { " + "\n    ".join(lines) + " }\n"


def plain_programs(name: str, cut: bool) -> Tuple[str, str]:
    """Vertex and fragment program of surfaces without light.

    Args:
        name: shadow (nothing but depth for its map) or range (distance along the axis, link).
        cut: what of the picture has less alpha than `alpha_test` is left out, as in the colours.
    """
    ranged = name == "range"
    vertex = [_INSTANCE]
    fragment = ["#version 330\n"]
    if cut:
        vertex.append("uniform vec2 repeats; out vec2 out_uv;\n")
        fragment.append("in vec2 out_uv; uniform sampler2D picture; uniform float alpha_test;\n")
    if ranged:
        vertex.append("out float away; flat out int out_link;\n")
        fragment.append("in float away; flat in int out_link;\n"
                        "layout(location = 0) out float depth;\n"
                        "layout(location = 1) out int label;\n")
    vertex.append("void main() {\n  vec3 place = placed();\n"
                  "  gl_Position = clip * vec4(place, 1.0);\n")
    fragment.append("void main() {\n")
    if cut:
        vertex.append("  out_uv = uv * repeats;\n")
        fragment.append("  if (texture(picture, out_uv).a < alpha_test) discard;\n")
    if ranged:
        vertex.append("  away = -place.z; out_link = link;\n")
        fragment.append("  depth = away; label = out_link;\n")
    return "".join([*vertex, "}"]), "".join([*fragment, "}"])


SKY_VERTEX = """#version 330
in vec2 at;
uniform vec2 slope;
uniform mat3 world_from_view;
out vec3 ahead;
void main() {
  ahead = world_from_view * vec3(at * slope, -1.0);
  gl_Position = vec4(at.x, -at.y, 1.0, 1.0);
}"""

SKY_FRAGMENT = """#version 330
in vec3 ahead;
out vec4 seen;
""" + SKY_COLOR + COLOR + """
void main() {
  seen = vec4(encoded(clamp(sky(normalize(ahead)), 0.0, 1.0)), 1.0);
}"""
