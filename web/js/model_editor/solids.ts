/** The shapes that links are made of: descriptions for the ghosts. The simulator makes the real ones. */
import {shapeMaterial, shapeModel} from '../new_entities.js';
import type {Geometry, Model, SolidShape} from '../protocol.js';

/** With the height at which they stand on the ground, m. */
const SOLIDS: Record<SolidShape, {geometry: Geometry, height: number}> = {
  box: {geometry: {type: 'box', size: [1, 1, 1]}, height: 0.5},
  sphere: {geometry: {type: 'sphere', radius: 0.5}, height: 0.5},
  cylinder: {geometry: {type: 'cylinder', radius: 0.5, length: 1}, height: 0.5},
  capsule: {geometry: {type: 'capsule', radius: 0.25, length: 0.5}, height: 0.5},
  cone: {geometry: {type: 'cone', radius: 0.5, length: 1}, height: 0.5},
  ellipsoid: {geometry: {type: 'ellipsoid', radii: [0.5, 0.4, 0.3]}, height: 0.3},
};

export const SOLID_SHAPES = Object.keys(SOLIDS) as SolidShape[];

/** What follows the mouse before it becomes a link. */
export function solidModel(shape: SolidShape): Model {
  const model = shapeModel('box');
  const {geometry, height} = SOLIDS[shape];
  Object.assign(model.links[0].visuals[0], {geometry, material: shapeMaterial(shape)});
  model.pose = [0, 0, height, 0, 0, 0, 1];
  return model;
}
