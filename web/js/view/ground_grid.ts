/** The grid on the ground, antialiased and fading with distance, and the axes of the world. */
import {
  ConeGeometry, CylinderGeometry, DoubleSide, Group, Mesh, MeshBasicMaterial, PlaneGeometry, ShaderMaterial,
  Vector3,
} from 'three';

const VERTEX = `
uniform vec3 focus;
uniform float reach;
varying vec2 at;
void main() {
  at = position.xy * 2.0 * reach + focus.xy;
  gl_Position = projectionMatrix * viewMatrix * vec4(at, 0.0, 1.0);
}`;

/**
 * Lines of one to two pixels from wherever they are seen, far away fainter instead of thinner: so they
 * neither flicker nor pile up to a grey sheet, and are no beams under a small robot.
 */
const FRAGMENT = `
uniform vec3 focus;
uniform float reach, fineness;
varying vec2 at;
float lines(vec2 p, vec2 pixel, float width) {
  vec2 drawn = clamp(vec2(width), pixel, 1.7 * pixel);
  vec2 away = 1.0 - abs(fract(p) * 2.0 - 1.0);
  vec2 line = smoothstep(drawn + pixel, drawn - pixel, away) * clamp(width / drawn, 0.0, 1.0);
  line *= 1.0 - smoothstep(0.3, 0.9, pixel);
  return max(line.x, line.y);
}
// As wide in coarse pictures as in fine ones.
float axis(float across, float pixel) {
  float half_width = max(1.3 * fineness, 0.7) * pixel;
  return 1.0 - smoothstep(half_width - 0.6 * pixel, half_width + 0.6 * pixel, abs(across));
}
void main() {
  vec2 pixel = max(fwidth(at), vec2(1e-6));
  float away = length(at - focus.xy) / reach;
  if (away > 1.0) discard;
  float strength = max(0.24 * lines(at, pixel, 0.024), 0.36 * lines(at / 5.0, pixel / 5.0, 0.008));
  // From near, lines at each tenth of a metre show the scale.
  float near = 1.0 - smoothstep(0.02, 0.06, 10.0 * max(pixel.x, pixel.y));
  strength = max(strength, 0.13 * near * lines(10.0 * at, 10.0 * pixel, 0.1));
  vec4 color = vec4(0.07, 0.09, 0.12, strength);
  float x_axis = axis(at.y, pixel.y), y_axis = axis(at.x, pixel.x);
  color = mix(color, vec4(0.74, 0.06, 0.06, 0.85), x_axis);
  color = mix(color, vec4(0.06, 0.42, 0.08, 0.85), y_axis * (1.0 - x_axis));
  float fade = 1.0 - smoothstep(0.25, 1.0, away);
  gl_FragColor = vec4(color.rgb, color.a * fade * fade);
  if (gl_FragColor.a < 0.004) discard;
  #include <colorspace_fragment>
}`;

/** Lines every metre, stronger ones every five, finer ones from near, and the x and y axes in their colours. */
export class GroundGrid {
  mesh = new Mesh(new PlaneGeometry(1, 1), new ShaderMaterial({
    vertexShader: VERTEX, fragmentShader: FRAGMENT, transparent: true, depthWrite: false,
    fog: false, side: DoubleSide, uniforms: {focus: {value: new Vector3()}, reach: {value: 30},
      fineness: {value: 1}}}));

  constructor() {
    this.mesh.frustumCulled = false;
    this.mesh.renderOrder = 1;
    this.mesh.onBeforeRender = (renderer) => {
      this.mesh.material.uniforms.fineness.value = renderer.getPixelRatio();
    };
  }

  /**
   * Lays the grid about what is looked at.
   * @param centre  world, m
   * @param distance  of the eye, m
   */
  cover(centre: number[], distance: number) {
    const {uniforms} = this.mesh.material;
    uniforms.focus.value.set(centre[0], centre[1], 0);
    uniforms.reach.value = Math.min(Math.max(distance * 3.5, 12), 400);
  }
}

const AXES = [
  {color: 0xe5484d, turn: [0, 0, -Math.PI / 2]},
  {color: 0x46a758, turn: [0, 0, 0]},
  {color: 0x3e7bfa, turn: [Math.PI / 2, 0, 0]},
];

/** The axes at the world's origin: arrows 1 m long, from near shorter (`originScale`). */
export function makeOrigin() {
  const group = new Group();
  const shaft = new CylinderGeometry(0.012, 0.012, 0.9, 12).translate(0, 0.45, 0);
  const tip = new ConeGeometry(0.035, 0.12, 16).translate(0, 0.95, 0);
  for (const {color, turn} of AXES) {
    const material = new MeshBasicMaterial({color, toneMapped: false});
    const axis = new Group();
    axis.add(new Mesh(shaft, material), new Mesh(tip, material));
    axis.rotation.set(turn[0], turn[1], turn[2]);
    group.add(axis);
  }
  return group;
}
