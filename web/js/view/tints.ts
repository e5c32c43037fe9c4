/**
 * Colours for plain grey things in the view alone: a world of grey boxes on a grey floor is hard to
 * read. Files, properties and camera sensors keep the grey.
 */
import {GREY} from './palette.js';
import type {Material, Model, Visual} from '../protocol.js';

/** By geometry, r, g, b as on the screen. */
const TINTS: Record<string, number[]> = {
  box: [0.93, 0.62, 0.33, 1], sphere: [0.36, 0.62, 0.87, 1], cylinder: [0.45, 0.73, 0.51, 1],
  capsule: [0.66, 0.56, 0.83, 1], cone: [0.85, 0.47, 0.50, 1], ellipsoid: [0.35, 0.70, 0.72, 1],
};

/** Returns whether a material has no chosen colour. */
function plain(material: Material|null|undefined) {
  if (!material) return true;
  const {diffuse, texture, emissive} = material;
  if (texture || emissive?.slice(0, 3).some((part) => part > 0)) return false;
  return !diffuse || diffuse.slice(0, 3).every((part, index) => Math.abs(part - GREY[index]) < 1e-3);
}

/**
 * The visual in the colour that the view gives it: another one for the only visual of a model that
 * moves, has a simple shape and no colour of its own.
 * @param built  the model is being built: all its plain shapes are tinted
 */
export function tinted(model: Model, visual: Visual, built = false): Visual {
  const tint = TINTS[visual.geometry.type];
  const alone = model.links.length === 1 && model.links[0].visuals.length === 1 && !model.static;
  if (!tint || !(alone || built) || !plain(visual.material)) return visual;
  const base = visual.material ?? {name: '', ambient: null, specular: null, emissive: null,
    texture: null, transparency: 0, lighting: true};
  return {...visual, material: {...base, diffuse: tint}};
}
