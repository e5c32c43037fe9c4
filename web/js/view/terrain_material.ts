/**
 * Terrains under several textures, one above the other, as Gazebo draws them: each is repeated by its
 * size and begins at a height. Source: appearance/terrain_layers.py.
 */
import {Color, DoubleSide, MeshLambertMaterial} from 'three';
import {GREY} from '../palette.js';
import {colorOf} from './three_convert.js';
import type {Texture} from 'three';
import type {TerrainLayer} from '../protocol.js';

/** A layer and its pictures, null for none. */
type CoveredLayer = {layer: TerrainLayer, map: Texture|null, bumps: Texture|null};

/**
 * @param layers  lowest first
 * @param base  height of the terrain's black, m, in the frame of the geometry
 */
export function terrainMaterial(layers: CoveredLayer[], base: number, {opacity = 1,
    wireframe = false}: {opacity?: number, wireframe?: boolean}) {
  const material = new MeshLambertMaterial({color: new Color(1, 1, 1), side: DoubleSide, opacity,
    transparent: opacity < 1, depthWrite: opacity >= 1, wireframe});
  const uniforms = uniformsOf(layers, base);
  const bumpy = layers.some(({bumps}) => bumps);
  material.onBeforeCompile = (shader) => {
    Object.assign(shader.uniforms, uniforms);
    shader.vertexShader = `varying vec2 ground_at;
      varying float ground_height;
      varying vec3 eastwards;
      ${shader.vertexShader}`.replace('#include <begin_vertex>', `#include <begin_vertex>
        ground_at = uv;
        ground_height = position.z;
        eastwards = normalMatrix * vec3(1.0, 0.0, 0.0);`);
    shader.fragmentShader = `${declarations(layers)}
      ${shader.fragmentShader}`
      .replace('#include <map_fragment>', `#include <map_fragment>
        ${colors(layers)}
        diffuseColor.rgb *= ground;`)
      .replace('#include <normal_fragment_maps>', `#include <normal_fragment_maps>
        ${bumpy ? bumps(layers) : ''}`);
  };
  material.customProgramCacheKey = () => `terrain ${layers.map((one) =>
    `${one.map ? 'm' : '-'}${one.bumps ? 'b' : '-'}`).join('')}`;
  return material;
}

function uniformsOf(layers: CoveredLayer[], base: number) {
  const found: Record<string, {value: unknown}> = {ground_base: {value: base},
      ground_grey: {value: colorOf(GREY)}};
  layers.forEach(({layer, map, bumps: normals}, n) => {
    found[`ground_${n}`] = {value: [layer.size, layer.min_height, layer.fade_dist]};
    if (map) found[`ground_map_${n}`] = {value: map};
    if (normals) found[`ground_bumps_${n}`] = {value: normals};
  });
  return found;
}

function declarations(layers: CoveredLayer[]) {
  return `uniform float ground_base;
    uniform vec3 ground_grey;
    varying vec2 ground_at;
    varying float ground_height;
    varying vec3 eastwards;
    ${layers.map(({map, bumps: normals}, n) => `uniform float ground_${n}[3];
      ${map ? `uniform sampler2D ground_map_${n};` : ''}
      ${normals ? `uniform sampler2D ground_bumps_${n};` : ''}`).join('\n')}
    float groundPart(float lowest, float fade) {
      return clamp((ground_height - ground_base - lowest) / fade, 0.0, 1.0);
    }`;
}

/** @param n  of a layer that is not the first */
const part = (n: number) => `groundPart(ground_${n}[1], ground_${n}[2])`;

function colors(layers: CoveredLayer[]) {
  const of = layers.map(({map}, n) => (map
    ? `texture2D(ground_map_${n}, ground_at / ground_${n}[0]).rgb` : 'ground_grey'));
  return [`vec3 ground = ${of[0]};`,
    ...of.slice(1).map((color, n) => `ground = mix(ground, ${color}, ${part(n + 1)});`)].join('\n');
}

function bumps(layers: CoveredLayer[]) {
  const of = layers.map(({bumps: normals}, n) => (normals
    ? `texture2D(ground_bumps_${n}, ground_at / ground_${n}[0]).xyz * 2.0 - 1.0` : 'vec3(0.0, 0.0, 1.0)'));
  return [`vec3 bump = ${of[0]};`,
    ...of.slice(1).map((one, n) => `bump = mix(bump, ${one}, ${part(n + 1)});`),
    'vec3 northwards = normalize(cross(normal, eastwards));',
    'normal = normalize(mat3(cross(northwards, normal), northwards, normal) * bump);'].join('\n');
}
