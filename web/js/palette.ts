/**
 * Numbers of looks that the page and the cameras share. Written by tools/generate/page_palette.py
 * from src/my_simulations/appearance/palette.py: edit that file, not this one.
 */

export const GREY = [0.7, 0.7, 0.7, 1];
export const GROUND = 0.8;
export const DULLEST = 0.02;
export const SHININESS = 30;

/** Of the shapes that the editor inserts, r, g, b, a. */
export const SHAPE_COLORS: Record<string, number[]> = Object.freeze({
  box: [0.93, 0.62, 0.33, 1],
  sphere: [0.36, 0.62, 0.87, 1],
  cylinder: [0.45, 0.73, 0.51, 1],
  capsule: [0.66, 0.56, 0.83, 1],
  cone: [0.85, 0.47, 0.5, 1],
  ellipsoid: [0.35, 0.7, 0.72, 1],
});

export const SKY = Object.freeze({
  day_zenith: 0x3f78c0,
  day_horizon: 0xc9dcec,
  night_zenith: 0x05070f,
  night_horizon: 0x141a28,
  dusk: 0xe8a468,
});

/** GLSL: the colour of the sky, linear, in a direction. */
export const SKY_COLOR = `uniform vec3 sun, zenith, horizon, cloud_color;
uniform float cover, size, drift;
float hash(vec2 p) { return fract(sin(dot(p, vec2(127.1, 311.7))) * 43758.5453); }
float noise(vec2 p) {
  vec2 i = floor(p), f = fract(p);
  f = f * f * (3.0 - 2.0 * f);
  return mix(mix(hash(i), hash(i + vec2(1, 0)), f.x),
             mix(hash(i + vec2(0, 1)), hash(i + vec2(1, 1)), f.x), f.y);
}
vec3 sky(vec3 way) {
  vec3 color = mix(horizon, zenith, pow(max(way.z, 0.0), 0.45));
  float glow = max(dot(way, sun), 0.0);
  color += vec3(1.0, 0.85, 0.6) * (pow(glow, 900.0) + 0.18 * pow(glow, 12.0)) * step(-0.05, sun.z);
  if (way.z > 0.01) {
    vec2 at = way.xy / (way.z + 0.12) / size + vec2(drift, 0.0);
    float density = 0.0, part = 0.55;
    for (int octave = 0; octave < 5; octave++) {
      density += part * noise(at);
      at *= 2.1;
      part *= 0.5;
    }
    float cloud = smoothstep(1.0 - cover, 1.15 - 0.3 * cover, density);
    cloud *= smoothstep(0.01, 0.2, way.z);
    color = mix(color, cloud_color, cloud * 0.85);
  }
  return color;
}
`;

export interface Pattern {
  painter: string; colors: string[]; count: number; grain: number;
}

export const PATTERNS: Record<string, Pattern> = Object.freeze({
  wood: {painter: 'planks', colors: ['#a9743f', '#9e6a37'], count: 4, grain: 14},
  wood_floor: {painter: 'planks', colors: ['#b98a54', '#a97b47', '#c2935c'], count: 8, grain: 12},
  bricks: {painter: 'bricks', colors: ['#b9b2a6', '#964a38'], count: 8, grain: 22},
  ceiling_tiled: {painter: 'tiles', colors: ['#e9e8e2', '#a5a39b'], count: 2, grain: 16},
  painted_wall: {painter: 'plain', colors: ['#e6e0cf'], count: 1, grain: 8},
  concrete: {painter: 'tiles', colors: ['#8fa9bd', '#d8d4c8'], count: 4, grain: 6},
  road: {painter: 'road', colors: ['#4b4b4d', '#e9e7dd'], count: 2, grain: 16},
  sidewalk: {painter: 'tiles', colors: ['#b5b1a8', '#8f8b83'], count: 4, grain: 18},
  steps: {painter: 'tiles', colors: ['#a8a39a', '#7c7870'], count: 3, grain: 18},
  grass: {painter: 'plain', colors: ['#5f8a3a'], count: 1, grain: 60},
  dirt: {painter: 'plain', colors: ['#8f7760'], count: 1, grain: 60},
  fungus: {painter: 'plain', colors: ['#828169'], count: 1, grain: 90},
  granite: {painter: 'plain', colors: ['#77726d'], count: 1, grain: 90},
  com: {painter: 'checker', colors: ['#f4d616', '#111111'], count: 1, grain: 0},
});
