/** The palette beside the sheet: name, walls, features, colours, textures, floor plan. */
import {fill, h} from '../ui/dom.js';
import {FloorTool, OpeningTool, StairsTool, WallTool} from './draw_tools.js';
import {SWATCHES, TEXTURES, inspectRoof} from './inspector.js';
import {PaintTool} from './select_tool.js';
import {svg} from '../ui/svg.js';
import type {Tool} from './tool.js';
import type {Session} from './drawing_session.js';

const GLYPHS = {
  wall: 'M2 14h16M2 10h16M2 6h16M6 6v4M14 6v4M10 10v4M2 6v8M18 6v8',
  window: 'M3 3h14v14H3zM10 3v14M3 10h14', door: 'M5 18V2h10v16M3 18h14M12 10h1',
  stairs: 'M2 17h4v-4h4V9h4V5h4', floor: 'M2 13l6-8h10l-6 8zM2 13v2h10l6-8',
  roof: 'M2 11l8-7 8 7M5 9v8h10V9', image: 'M2 4h16v12H2zM2 13l5-5 4 4 3-2 4 4',
};

function glyph(name: keyof typeof GLYPHS) {
  return h('span', {class: 'glyph'}, svg('svg', {viewBox: '0 0 20 20', width: 18, height: 18, fill: 'none',
    stroke: 'currentColor', 'stroke-width': 1.4, 'aria-hidden': true}, svg('path', {d: GLYPHS[name]})));
}

/** @param draw  called when a tool is taken: the sheet gets the keys */
export function mountPalette(element: HTMLElement, {session, importPlan, draw}: {session: Session,
    importPlan: () => void, draw: () => void}) {
  const tools: [string, [keyof typeof GLYPHS, string, () => Tool, string?][]][] = [
    ['Create Walls', [['wall', 'Wall', () => new WallTool(session), 'Shift suspends snapping']]],
    ['Add Features', [
      ['window', 'Window', () => new OpeningTool(session, 'windows')],
      ['door', 'Door', () => new OpeningTool(session, 'doors')],
      ['stairs', 'Stairs', () => new StairsTool(session)],
      ['floor', 'Floor', () => new FloorTool(session)]]],
  ];
  const buttons: [string, HTMLElement][] = [];
  const toggle = (id: string, attributes: Record<string, unknown>, make: () => Tool,
      ...content: (Node|string)[]) => {
    const button = h('button', {'aria-pressed': 'false', ...attributes,
      onclick: () => {
        if (button.getAttribute('aria-pressed') === 'true') session.endTool();
        else {
          active = id;
          session.tool = make();
          draw();
        }
        update();
      }}, ...content);
    buttons.push([id, button]);
    return button;
  };
  let active = '';

  const name = h('input', {placeholder: 'Untitled', 'aria-label': 'Model Name', maxlength: 100,
    onchange: () => {
      const text = name.value.trim() || 'Untitled';
      if (text !== session.history.plan.name) session.commit({...session.history.plan, name: text}, 'rename building');
    }});
  const more = h('input', {type: 'color', value: '#8fb3d9', title: 'Custom color', 'aria-label': 'More colors',
    onchange: () => {
      active = 'more';
      session.tool = new PaintTool(session, {color: more.value, texture: ''});
      update();
    }});
  const act = (id: string, title: string, glyphName: keyof typeof GLYPHS, run: () => void) =>
    h('button', {dataset: {act: id}, onclick: run}, glyph(glyphName), title);
  fill(element,
    h('label', {class: 'building-name'}, h('span', {text: 'Model Name'}), name),
    ...tools.flatMap(([title, entries]) => [h('h2', {text: title}), h('div', {class: 'tools'},
      ...entries.map(([id, text, make, hint]) =>
        toggle(id, {dataset: {tool: id}, title: hint ?? text}, make, glyph(id), text)))]),
    h('h2', {text: 'Add Color'}),
    h('div', {class: 'swatches'}, ...SWATCHES.map((color) => toggle(color,
      {class: 'swatch', title: color, 'aria-label': `Color ${color}`, style: `background: ${color}`},
      () => new PaintTool(session, {color, texture: ''}))), more),
    h('h2', {text: 'Add Texture'}),
    h('div', {class: 'tools'}, ...TEXTURES.map(([text, texture]) => toggle(texture,
      {dataset: {texture}}, () => new PaintTool(session, {texture}), text))),
    h('h2', {text: 'Building'}),
    h('div', {class: 'tools'}, act('roof', 'Roof', 'roof', () => inspectRoof(session)),
      act('import', 'Import', 'image', importPlan)));

  function update() {
    if (session.tool.name === 'select') active = '';
    for (const [id, button] of buttons) button.setAttribute('aria-pressed', String(id === active));
    if (document.activeElement !== name) name.value = session.plan.name;
  }
  session.listen('tool', update);
  session.listen('change', update);
  update();
}
