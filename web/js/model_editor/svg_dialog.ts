/** Asks for an SVG drawing that becomes a link: its outline, extruded. */
import {set, svg} from '../ui/svg.js';
import {Dialog, labelled} from '../ui/dialog.js';
import {h} from '../ui/dom.js';
import {loopsOfSvg, scaledLoops} from './svg_outline.js';
import type {Loop} from './svg_outline.js';

/** @param use  rejects with what is wrong */
export function svgDialog(use: (polyline: {loops: Loop[], height: number}) => Promise<unknown>) {
  const file = h('input', {type: 'file', accept: '.svg', 'aria-label': 'SVG file'});
  const width = h('input', {type: 'number', value: 1, min: 0, step: 'any', 'aria-label': 'Width'});
  const height = h('input', {type: 'number', value: 0.1, min: 0, step: 'any', 'aria-label': 'Height'});
  const fault = h('p', {class: 'soft', role: 'status'});
  const path = svg('path', {'fill-rule': 'evenodd', 'vector-effect': 'non-scaling-stroke'});
  const preview = svg('svg', {class: 'svg-preview', role: 'img', 'aria-label': 'Outline of the drawing'}, path);
  preview.toggleAttribute('hidden', true);
  const read = async () => {
    const [chosen] = file.files ?? [];
    if (!chosen) throw new Error('Choose an SVG file.');
    return scaledLoops(await loopsOfSvg(await chosen.text()), width.valueAsNumber || 1);
  };
  const show = async () => {
    preview.toggleAttribute('hidden', true);
    try {
      const loops = await read();
      const corners = loops.flat();
      const [xs, ys] = [0, 1].map((axis) => corners.map((corner) => corner[axis]));
      const [x, y] = [Math.min(...xs), -Math.max(...ys)];
      set(preview, {viewBox: `${x} ${y} ${Math.max(...xs) - x} ${-Math.min(...ys) - y}`});
      set(path, {d: loops.map((loop) => `M${loop.map(([u, v]) => `${u} ${-v}`).join('L')}Z`).join('')});
      preview.toggleAttribute('hidden', false);
      fault.textContent = `${loops.length} ${loops.length > 1 ? 'outlines' : 'outline'}, ${corners.length} corners`;
    } catch (error) {
      fault.textContent = error instanceof Error ? error.message : String(error);
    }
  };
  file.addEventListener('change', show);
  return new Dialog({
    title: 'Add SVG', name: 'model-svg',
    content: [labelled('File', file),
      h('p', {class: 'soft', text: 'The outlines are extruded upwards; the largest is solid, outlines within it are holes.'}),
      labelled('Width (m)', width), labelled('Height (m)', height), preview, fault],
    buttons: [{title: 'Cancel'}, {title: 'Add', primary: true, run: async () => {
      if (!(width.valueAsNumber > 0 && height.valueAsNumber > 0)) throw new Error('Width and height must be greater than 0 m.');
      await use({loops: await read(), height: height.valueAsNumber});
      return true;
    }}],
  }).open();
}
