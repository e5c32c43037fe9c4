/** What the tool bar adds: descriptions for the ghosts. The simulator makes the real ones. */
import {SHAPE_COLORS} from './palette.js';
import type {Geometry, Light, Material, Model} from './protocol.js';

export type ShapeName = 'box'|'sphere'|'cylinder';
export type LightType = 'point'|'spot'|'directional';

export const SHAPES: readonly ShapeName[] = Object.freeze(['box', 'sphere', 'cylinder']);
export const LIGHTS: readonly LightType[] = Object.freeze(['point', 'spot', 'directional']);

const GEOMETRIES: Record<ShapeName, Geometry> = {
  box: {type: 'box', size: [1, 1, 1]},
  sphere: {type: 'sphere', radius: 0.5},
  cylinder: {type: 'cylinder', radius: 0.5, length: 1},
};

/** The material that the simulator gives to a new shape. */
export const shapeMaterial = (shape: string): Material => ({name: '', ambient: SHAPE_COLORS[shape],
  diffuse: SHAPE_COLORS[shape], specular: null, emissive: null, texture: null, transparency: 0, lighting: true});

const origin = () => [0, 0, 0, 0, 0, 0, 1];

/** Solid bodies of 1 kg (Gazebo behaviour). */
const MOMENTS: Record<ShapeName, [number, number, number]> = {
  box: [1 / 6, 1 / 6, 1 / 6], sphere: [0.1, 0.1, 0.1], cylinder: [0.1458, 0.1458, 0.125],
};

/** A unit shape standing on the ground (Gazebo behaviour). */
export function shapeModel(shape: ShapeName): Model {
  const [ixx, iyy, izz] = MOMENTS[shape];
  return {
    name: `unit_${shape}`, pose: [0, 0, 0.5, 0, 0, 0, 1], static: false, self_collide: false,
    allow_auto_disable: true, enable_wind: false, canonical_link: 'link', joints: [], plugins: [],
    uri: '', scalable: true, group: '',
    links: [{
      id: 0, name: 'link', pose: origin(), gravity: true, kinematic: false, linear_decay: 0,
      angular_decay: 0, collisions: [], sensors: [],
      inertial: {mass: 1, pose: origin(), ixx, ixy: 0, ixz: 0, iyy, iyz: 0, izz},
      visuals: [{name: 'visual', pose: origin(), geometry: GEOMETRIES[shape], material: shapeMaterial(shape),
        cast_shadows: true, transparency: 0, laser_retro: 0}],
    }],
  };
}

const COMMON_LIGHT = {
  pose: [0, 0, 1, 0, 0, 0, 1], cast_shadows: false, diffuse: [0.5, 0.5, 0.5, 1],
  specular: [0.1, 0.1, 0.1, 1], range: 20, constant: 0.5, linear: 0.01, quadratic: 0.001,
  direction: [0, 0, -1], inner_angle: 0, outer_angle: 0, falloff: 0, group: '',
};

const LIGHT_TYPES: Record<LightType, Partial<Light>> = {
  point: {},
  spot: {inner_angle: 0.6, outer_angle: 1, falloff: 1},
  directional: {direction: [0.1, 0.1, -0.9], cast_shadows: true},
};

/**
 * A new light with Gazebo's values.
 * @param taken  names of the lights that are there
 */
export function newLight(type: LightType, taken: string[]): Light {
  let number = 0;
  while (taken.includes(`user_${type}_light_${number}`)) number++;
  return {...structuredClone(COMMON_LIGHT), ...structuredClone(LIGHT_TYPES[type]),
    name: `user_${type}_light_${number}`, type};
}
