/**
 * The sheet on which the plan is drawn. What did not change, told by identity, is not touched, so
 * that an edit costs what it changes and not what the building holds.
 */
import {handlesOf} from './hit_test.js';
import {itemOf} from './plan.js';
import {labelsOf} from './plan_labels.js';
import {spread} from './label_places.js';
import {set, svg} from '../ui/svg.js';
import {SCALE, floorPath, onSheet, openingPaths, pathOf, stairsPaths, wallPath} from './plan_svg.js';
import type {AnyItem, ItemOf, Kind, OpeningKind} from './plan.js';
import type {FloorImage, Level, Opening, Wall} from '../protocol.js';
import type {Point} from './plane_geometry.js';
import type {Session} from './drawing_session.js';

/** From the lowest layer to the highest. */
const ORDER: readonly Kind[] = Object.freeze(['floors', 'stairs', 'walls', 'windows', 'doors']);

/** A part of a drawn item: its class, its path data, its fill. */
type Look = [string, string, string?];
/** What is drawn of an item, and from what. */
type Drawn = {element: SVGElement, item: AnyItem|null,
    state: string|null, wall: Wall|null};
/** What of the world stands on the plan. */
type Footprint = {name: string, outline: Point[]};

/** How an item is drawn: attributes of the parts of its group. */
const LOOKS: {[K in Kind]: (item: ItemOf[K], level: Level) => Look[]} = {
  floors: (item) => [['frame', floorPath(item), item.color]],
  walls: (item) => [['frame', wallPath(item), item.color]],
  stairs: (item) => {
    const {frame, lines, arrow} = stairsPaths(item);
    return [['frame', frame, item.color], ['lines', lines], ['arrow', arrow]];
  },
  windows: (item, level: Level) => sign('windows', item, level),
  doors: (item, level: Level) => sign('doors', item, level),
};

function sign(kind: OpeningKind, item: Opening, level: Level): Look[] {
  const {frame, lines} = openingPaths(kind, item, level);
  return [['frame', frame], ['lines', lines]];
}

export class Canvas {
  session;
  image;
  below;
  context;
  layers;
  draft;
  labels;
  handles;
  features;
  world;
  minor;
  major;
  element;

  constructor(session: Session) {
    this.session = session;
    this.image = svg('image', {class: 'plan-image', preserveAspectRatio: 'none'});
    this.below = svg('g', {class: 'below'});
    this.context = svg('g', {class: 'context'});
    this.layers = Object.fromEntries(
      ORDER.map((kind) => [kind, svg('g', {class: `layer ${kind}`})])) as Record<Kind, SVGElement>;
    this.draft = svg('g', {class: 'draft'});
    this.labels = svg('g', {class: 'labels'});
    this.handles = svg('g', {class: 'handles'});
    this.features = svg('g', {}, this.below, ...ORDER.map((kind) => this.layers[kind]), this.draft,
      this.handles, this.labels);
    this.world = svg('g', {}, this.image, this.axes(), this.context, this.features);
    this.minor = gridPattern('building-grid-minor', SCALE / 10, 'minor');
    this.major = gridPattern('building-grid-major', SCALE, 'major');
    this.element = svg('svg', {class: 'plan-sheet', role: 'application',
      'aria-label': 'Plan of the building: arrow keys move the cursor, Space clicks',
      tabindex: 0},
    svg('defs', {}, this.minor, this.major),
    svg('rect', {class: 'sheet', width: '100%', height: '100%'}),
    svg('rect', {class: 'grid', width: '100%', height: '100%', fill: 'url(#building-grid-minor)'}),
    svg('rect', {class: 'grid', width: '100%', height: '100%', fill: 'url(#building-grid-major)'}),
    this.world);
  }

  /** Pixels of the screen for one of the sheet, and where the origin stands on the screen. */
  view = {zoom: 1, x: 300, y: 250};
  #drawn: Map<string, Drawn> = new Map();
  #labelled = '';
  /** The level below, as it is drawn. */
  #under: Level|null = null;
  /** The floor plan that is loaded. */
  #picture: FloorImage|null = null;
  /** Outlines of the models in the world. */
  #around: Footprint[] = [];

  /** Draws the outlines and names of the world's models faintly. */
  showAround(footprints: Footprint[]) {
    this.#around = footprints;
    this.#drawAround();
  }

  #drawAround() {
    const size = 11 / this.view.zoom;
    const names = spread(this.#around.map(({name, outline}) => {
      const [x, y] = onSheet([0, 1].map((at) =>
        outline.reduce((sum, point) => sum + point[at], 0) / outline.length));
      return {x, y, text: name};
    }), size);
    this.context.replaceChildren(
      ...this.#around.map(({name, outline}) => svg('path', {d: pathOf(outline), 'data-model': name})),
      ...names.map(({x, y, text}) => svg('text', {x, y, 'font-size': size, text})));
  }

  /** Called when the sheet was panned or zoomed. */
  onplace = () => {};

  axes() {
    return svg('g', {class: 'axes'}, svg('path', {class: 'x', d: 'M0 0H40'}),
      svg('path', {class: 'y', d: 'M0 0V-40'}));
  }

  /** Metres of the plan for a point of the window. */
  toPlan(clientX: number, clientY: number) {
    const box = this.element.getBoundingClientRect();
    return [(clientX - box.left - this.view.x) / this.view.zoom / SCALE,
      -(clientY - box.top - this.view.y) / this.view.zoom / SCALE];
  }

  /** Metres that a few pixels of the screen are. */
  get tolerance() { return 6 / this.view.zoom / SCALE; }

  zoomAt(clientX: number, clientY: number, factor: number) {
    const box = this.element.getBoundingClientRect();
    const zoom = Math.min(Math.max(this.view.zoom * factor, 0.05), 10);
    const by = zoom / this.view.zoom;
    const [x, y] = [clientX - box.left, clientY - box.top];
    this.view = {zoom, x: x - (x - this.view.x) * by, y: y - (y - this.view.y) * by};
    this.place();
  }

  pan(dx: number, dy: number) {
    this.view = {...this.view, x: this.view.x + dx, y: this.view.y + dy};
    this.place();
  }

  /** Shows all of the level, or some metres round the origin of an empty one. */
  fit() {
    const box = this.element.getBoundingClientRect();
    const extent = extentOf(this.session.level);
    if (!box.width) return;
    if (!extent) {
      this.view = {zoom: Math.min(1, box.height / (6 * SCALE)), x: box.width / 2, y: box.height / 2};
    } else {
      const [x0, y0, x1, y1] = extent;
      const zoom = Math.min(box.width / ((x1 - x0 + 2) * SCALE), box.height / ((y1 - y0 + 2) * SCALE), 1.5);
      this.view = {zoom, x: box.width / 2 - (x0 + x1) / 2 * SCALE * zoom,
        y: box.height / 2 + (y0 + y1) / 2 * SCALE * zoom};
    }
    this.place();
  }

  /** Applies the view's offset and zoom to the sheet and updates all that depends on the zoom. */
  place() {
    const {zoom, x, y} = this.view;
    set(this.world, {transform: `translate(${x} ${y}) scale(${zoom})`});
    for (const {pattern, size} of [
      {pattern: this.minor, size: SCALE / 10}, {pattern: this.major, size: SCALE}]) {
      set(pattern, {patternTransform: `translate(${x} ${y}) scale(${zoom})`});
      pattern.firstElementChild?.setAttribute('stroke-width', String(1 / zoom));
      pattern.toggleAttribute('data-dense', size * zoom < 5);
    }
    this.element.style.setProperty('--unit', String(1 / zoom));
    this.#labelled = '';
    this.#drawAround();
    this.draw();
    this.onplace();
  }

  draw() {
    const {session} = this;
    set(this.features, {class: session.shown.features ? null : 'hidden'});
    this.#drawImage();
    const faulty: Map<string, string> = new Map();
    for (const fault of session.faults()) {
      if (fault.at !== session.at) continue;
      for (const {kind, id} of fault.refs ?? []) {
        if (faulty.get(`${kind}${id}`) !== 'error') faulty.set(`${kind}${id}`, fault.severity);
      }
    }
    const seen = new Set();
    const walls = new Map(session.level.walls.map((wall) => [wall.id, wall]));
    for (const kind of ORDER) {
      for (const item of session.level[kind]) {
        const key = `${kind}${item.id}`;
        seen.add(key);
        const state = `${session.isSelected({kind, id: item.id}) ? 'selected ' : ''}${faulty.get(key) ?? ''}`;
        this.#drawItem(key, kind, item, state, 'along' in item ? walls.get(item.wall ?? -1) ?? null : null);
      }
    }
    for (const [key, {element}] of this.#drawn) {
      if (seen.has(key)) continue;
      element.remove();
      this.#drawn.delete(key);
    }
    this.#drawBelow();
    this.#drawDraft();
    this.#drawHandles();
    this.#drawLabels();
  }

  #drawItem(key: string, kind: Kind, item: AnyItem, state: string, wall: Wall|null) {
    let known = this.#drawn.get(key);
    if (!known) {
      known = {element: svg('g', {'data-key': key}), item: null, state: null, wall: null};
      this.layers[kind].append(known.element);
      this.#drawn.set(key, known);
    }
    const {element} = known;
    if (known.item !== item || known.wall !== wall) {
      const look = LOOKS[kind] as (item: AnyItem, level: Level) => Look[];
      const parts = look(item, this.session.level);
      while (element.children.length < parts.length) element.append(svg('path'));
      const texture = 'texture' in item ? item.texture : '';
      parts.forEach(([name, d, fill], at) => set(element.children[at],
        {class: name, d, fill: fill ?? null, 'data-texture': texture || null}));
    }
    if (known.state !== state) set(known.element, {class: state});
    Object.assign(known, {item, state, wall});
  }

  /** The level below, faintly: its walls, and the stairs that cut through the floor. */
  #drawBelow() {
    const {session} = this;
    const below = session.plan.levels[session.at - 1] ?? null;
    if (this.#under === below) return;
    this.#under = below;
    const parts = below ? [
      svg('path', {class: 'walls', d: below.walls.map(wallPath).join('')}),
      ...below.stairs.map((stairs) => {
        const {frame, lines} = stairsPaths(stairs);
        return svg('path', {class: 'hole', d: frame + lines});
      }),
    ] : [];
    this.below.replaceChildren(...parts);
  }

  #drawImage() {
    const {image} = this.session.level;
    const shown = image?.data && this.session.shown.image;
    this.image.toggleAttribute('hidden', !shown);
    this.image.style.display = shown ? '' : 'none';
    if (!shown || this.#picture === image) return;
    this.#picture = image;
    const source = new Image();
    source.onload = () => {
      const factor = SCALE / image.resolution;
      const [width, height] = [source.naturalWidth * factor, source.naturalHeight * factor];
      set(this.image, {href: image.data, width, height, x: -width / 2, y: -height / 2});
    };
    source.src = image.data;
  }

  #drawDraft() {
    const {segment, mark, opening, stairs, polygon, box, measure} = this.session.draft;
    const parts: SVGElement[] = [];
    const line = (d: string, name = '') => parts.push(svg('path', {d, class: name}));
    if (segment) line(wallPath(segment), 'wall');
    if (opening) {
      const {frame, lines} = openingPaths(opening.kind, opening.item, this.session.level);
      line(frame + lines, opening.fault ? 'bad' : 'opening');
    }
    if (stairs) {
      const {frame, lines, arrow} = stairsPaths(stairs);
      line(frame + lines + arrow, 'stairs');
    }
    if (polygon) line(pathOf(polygon.points, Boolean(polygon.closed)), 'polygon');
    if (box) line(pathOf([box[0], [box[1][0], box[0][1]], box[1], [box[0][0], box[1][1]]]), 'box');
    if (measure) line(pathOf(measure, false), 'measure');
    if (mark) parts.push(dot(mark, 'mark', 8 / this.view.zoom));
    this.draft.replaceChildren(...parts);
  }

  #drawHandles() {
    const {session} = this;
    const only = session.selection.length === 1 ? session.selection[0] : null;
    const item = only && itemOf(session.plan, session.at, only);
    const parts: SVGElement[] = [];
    if (item) {
      for (const {part, point} of handlesOf(item)) {
        if (part === 'rotate' && 'position' in item) {
          parts.push(svg('path', {class: 'stem', d: pathOf([item.position, point], false)}));
        }
        parts.push(dot(point, part === 'rotate' ? 'rotate' : 'grip', 5 / this.view.zoom));
      }
    }
    this.handles.replaceChildren(...parts);
  }

  #drawLabels() {
    const {session} = this;
    const words = labelsOf(session);
    const now = JSON.stringify(words);
    if (now === this.#labelled) return;
    this.#labelled = now;
    const size = 12 / this.view.zoom;
    // The length of the item that is being drawn keeps its place; other labels move aside.
    const first = words.filter(([, , name]) => name === 'live');
    const placed = spread([...first, ...words.filter(([, , name]) => name !== 'live')]
      .map(([point, text, name]) => {
        const [x, y] = onSheet(point);
        return {x, y, text, name, start: name === 'live'};
      }), size);
    this.labels.replaceChildren(...placed.map(({x, y, text, name}) =>
      svg('text', {x, y, class: name, 'font-size': size, text})));
  }
}

function dot(point: Point, name: string, r: number) {
  const [cx, cy] = onSheet(point);
  return svg('circle', {cx, cy, r, class: name});
}

function gridPattern(id: string, size: number, name: string) {
  return svg('pattern', {id, width: size, height: size, patternUnits: 'userSpaceOnUse', class: name},
    svg('path', {d: `M${size} 0H0V${size}`}));
}

/** x from, y from, x to, y to of what a level holds; null for nothing. */
export function extentOf(level: Level) {
  const points = [
    ...level.walls.flatMap(({start, end}) => [start, end]),
    ...level.floors.flatMap(({outline}) => outline),
    ...[...level.stairs, ...level.windows, ...level.doors].flatMap((item) =>
      'along' in item && item.wall !== null ? [] : [item.position]),
  ];
  if (!points.length) return null;
  const xs = points.map(([x]) => x);
  const ys = points.map(([, y]) => y);
  return [Math.min(...xs), Math.min(...ys), Math.max(...xs), Math.max(...ys)];
}
