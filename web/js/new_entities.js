/** What the tool bar adds: descriptions for the ghosts. The simulator makes the real ones. */

export const SHAPES = Object.freeze(['box', 'sphere', 'cylinder']);
export const LIGHTS = Object.freeze(['point', 'spot', 'directional']);

const GEOMETRIES = {
  box: {type: 'box', size: [1, 1, 1]},
  sphere: {type: 'sphere', radius: 0.5},
  cylinder: {type: 'cylinder', radius: 0.5, length: 1},
};

const GREY = {ambient: [0.3, 0.3, 0.3, 1], diffuse: [0.7, 0.7, 0.7, 1],
  specular: [0.01, 0.01, 0.01, 1], emissive: [0, 0, 0, 1]};

const ORIGIN = Object.freeze([0, 0, 0, 0, 0, 0, 1]);

/** A unit shape standing on the ground (Gazebo behaviour). */
export function shapeModel(shape) {
  return {
    name: `unit_${shape}`, pose: [0, 0, 0.5, 0, 0, 0, 1], static: false, joints: [],
    links: [{
      id: 0, name: 'link', pose: ORIGIN, collisions: [],
      visuals: [{name: 'visual', pose: ORIGIN, geometry: GEOMETRIES[shape], material: GREY,
        cast_shadows: true, transparency: 0}],
    }],
  };
}

const COMMON_LIGHT = {
  pose: [0, 0, 1, 0, 0, 0, 1], cast_shadows: false, diffuse: [0.5, 0.5, 0.5, 1],
  specular: [0.1, 0.1, 0.1, 1], range: 20, constant: 0.5, linear: 0.01, quadratic: 0.001,
  direction: [0, 0, -1], inner_angle: 0, outer_angle: 0, falloff: 0,
};

const LIGHT_TYPES = {
  point: {},
  spot: {inner_angle: 0.6, outer_angle: 1, falloff: 1},
  directional: {direction: [0.1, 0.1, -0.9], cast_shadows: true},
};

/**
 * A new light with Gazebo's values.
 * @param {'point'|'spot'|'directional'} type
 * @param {string[]} taken  names of the lights that are there
 */
export function newLight(type, taken) {
  let number = 0;
  while (taken.includes(`user_${type}_light_${number}`)) number++;
  return {...structuredClone(COMMON_LIGHT), ...structuredClone(LIGHT_TYPES[type]),
    name: `user_${type}_light_${number}`, type};
}
