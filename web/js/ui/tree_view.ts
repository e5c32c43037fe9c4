/**
 * A tree of rows, of which only those in sight exist as elements: thousands of models scroll as
 * lightly as ten. The tree itself has the focus, the current row is its active descendant.
 */
import {fill, h, onceAFrame} from './dom.js';
import {icon} from './icons.js';
import type {Child} from './dom.js';

export interface TreeRow {
  /** unique in the tree, stable over edits */
  id: string;
  label: string;
  icon: string;
  /** 1 for the outermost */
  level: number;
  /** for style sheets */
  kind: string;
  expandable: boolean;
  open: boolean;
  /** what a click selects */
  select?: string;
}

const ROW = 24;
const SPARE = 8;

/** px before a row's arrow. */
const indent = (row: TreeRow) => 4 + (row.level - 1) * 14;

export class Tree<Row extends TreeRow> {
  element;
  handlers;
  rows: Row[] = [];
  /** Ids of the rows that are selected. */
  selected: Set<string> = new Set();
  current = '';
  draw;

  /**
   * @param element  becomes the scrolling tree
   * @param handlers.choose  a click, or moving with the keys
   * @param handlers.activate  double click or Enter
   * @param handlers.decorate  content for the end of a row
   */
  constructor(element: HTMLElement, handlers: {label: string, choose: (row: Row,
      event: MouseEvent|KeyboardEvent) => void, toggle: (row: Row, open: boolean) => void,
      activate?: (row: Row) => void, menu?: (row: Row, x: number, y: number) => void,
      decorate?: (row: Row) => Child}) {
    this.element = element;
    this.handlers = handlers;
    element.classList.add('tree');
    element.tabIndex = 0;
    element.setAttribute('role', 'tree');
    element.setAttribute('aria-label', handlers.label);
    element.setAttribute('aria-multiselectable', 'true');
    fill(element, this.#sheet);
    const draw = onceAFrame(() => this.#draw());
    this.draw = draw;
    element.addEventListener('scroll', draw);
    new ResizeObserver(draw).observe(element);
    element.addEventListener('focus', draw);
    element.addEventListener('blur', () => {
      this.#byMouse = false;
      draw();
    });
    // Not by click: browsers send no click if the pressed row was redrawn before the release.
    element.addEventListener('pointerdown', (event) => {
      this.#byMouse = true;
      this.#pressed = event.button === 0 ? this.#rowAt(event) : null;
    });
    element.addEventListener('pointerup', (event) => {
      if (this.#pressed && this.#rowAt(event)?.id === this.#pressed.id) this.#click(event);
      this.#pressed = null;
    });
    element.addEventListener('dblclick', (event) => this.#doubleClick(event));
    element.addEventListener('contextmenu', (event) => this.#context(event));
    element.addEventListener('keydown', (event) => this.#key(event));
  }

  #prefix = `row-${Math.random().toString(36).slice(2, 8)}-`;
  #sheet = h('div', {class: 'tree-sheet', role: 'presentation'});
  /** The row where the button was pressed. */
  #pressed: Row|null = null;
  /** A row was pressed, and no key has moved on since. */
  #byMouse = false;
  #typed = {text: '', at: 0};

  /**
   * @param selected  ids
   */
  show(rows: Row[], selected: Set<string>) {
    this.rows = rows;
    this.selected = selected;
    if (!rows.some((row) => row.id === this.current)) this.current = rows[0]?.id ?? '';
    this.draw();
  }

  /** Makes a row the current one and scrolls it into sight. */
  reveal(id: string) {
    const at = this.rows.findIndex((row) => row.id === id);
    if (at < 0) return;
    this.current = id;
    const {scrollTop, clientHeight} = this.element;
    if (at * ROW < scrollTop) this.element.scrollTop = at * ROW;
    else if ((at + 1) * ROW > scrollTop + clientHeight) {
      this.element.scrollTop = (at + 1) * ROW - clientHeight;
    }
    this.draw();
  }

  #draw() {
    const {scrollTop, clientHeight} = this.element;
    const first = Math.max(0, Math.floor(scrollTop / ROW) - SPARE);
    const last = Math.min(this.rows.length, Math.ceil((scrollTop + clientHeight) / ROW) + SPARE);
    this.#sheet.style.height = `${this.rows.length * ROW}px`;
    fill(
      this.#sheet,
      ...this.rows.slice(first, last).map((row, at) => this.#rowElement(row, first + at)),
    );
    const at = this.rows.findIndex((row) => row.id === this.current);
    const inSight = at >= first && at < last;
    if (inSight) this.element.setAttribute('aria-activedescendant', this.#prefix + at);
    else this.element.removeAttribute('aria-activedescendant');
  }

  #rowElement(row: Row, at: number) {
    const classes = ['tree-row', `kind-${row.kind}`];
    if (this.selected.has(row.id)) classes.push('selected');
    if (row.id === this.current && document.activeElement === this.element) classes.push('current');
    const arrow = h(
      'span',
      {class: row.open ? 'arrow open' : 'arrow'},
      row.expandable && icon('right', 14),
    );
    return h(
      'div',
      {
        class: classes.join(' '),
        id: this.#prefix + at,
        role: 'treeitem',
        style: `top: ${at * ROW}px; padding-left: ${indent(row)}px`,
        'aria-level': row.level,
        'aria-selected': String(this.selected.has(row.id)),
        'aria-expanded': row.expandable ? String(row.open) : null,
        'aria-setsize': this.rows.length,
        'aria-posinset': at + 1,
        title: row.label,
        'aria-label': row.label,
      },
      arrow,
      row.icon && icon(row.icon, 15),
      h('span', {class: 'label', text: row.label}),
      this.handlers.decorate?.(row),
    );
  }

  /** By place, not by element: a drawing between press and release replaces the elements. */
  #rowAt(event: MouseEvent) {
    const top = this.element.getBoundingClientRect().top;
    return this.rows[Math.floor((event.clientY - top + this.element.scrollTop) / ROW)] ?? null;
  }

  #onArrow(event: MouseEvent, row: Row) {
    const left = event.clientX - this.element.getBoundingClientRect().left;
    return row.expandable && left < indent(row) + 18;
  }

  #click(event: MouseEvent) {
    const row = this.#rowAt(event);
    if (!row) return;
    this.current = row.id;
    if (this.#onArrow(event, row)) {
      this.handlers.toggle(row, !row.open);
    } else this.handlers.choose(row, event);
    this.draw();
  }

  #doubleClick(event: MouseEvent) {
    const row = this.#rowAt(event);
    if (!row || this.#onArrow(event, row)) return;
    if (row.select && this.handlers.activate) this.handlers.activate(row);
    else if (row.expandable) this.handlers.toggle(row, !row.open);
  }

  #context(event: MouseEvent) {
    event.preventDefault();
    const row = this.#rowAt(event);
    if (!row || !this.handlers.menu) return;
    this.current = row.id;
    this.handlers.menu(row, event.clientX, event.clientY);
  }

  #key(event: KeyboardEvent) {
    if (event.altKey || event.metaKey || event.target !== this.element) return;
    const at = this.rows.findIndex((row) => row.id === this.current);
    const row = this.rows[at];
    if (!row) return;
    if (this.#keyMoves(event, at, row) || this.#keyActs(event, row) || this.#keyTypes(event, at)) {
      event.preventDefault();
      event.stopPropagation();
    }
  }

  #keyMoves(event: KeyboardEvent, at: number, row: Row) {
    const page = Math.max(1, Math.floor(this.element.clientHeight / ROW) - 1);
    const last = this.rows.length - 1;
    // Who clicked a row means the view; who walks by keys means the tree.
    if (event.key === 'Home' && this.#byMouse) return false;
    const to = {
      ArrowUp: at - 1,
      ArrowDown: at + 1,
      Home: 0,
      End: last,
      PageUp: at - page,
      PageDown: at + page,
      ArrowLeft: row.expandable && row.open ? undefined : this.#parentOf(at),
      ArrowRight: row.expandable && row.open ? at + 1 : undefined,
    }[event.key];
    if (to === undefined) return false;
    this.#byMouse = false;
    const next = this.#beyondHeadings(Math.min(Math.max(to, 0), last), to < at ? -1 : 1);
    this.reveal(next.id);
    // With Ctrl the row is only looked at; Space then adds it to the selection.
    if (!event.ctrlKey) this.handlers.choose(next, event);
    return true;
  }

  /** Headings of a model's parts have nothing to show. */
  #beyondHeadings(at: number, step: number) {
    let to = at;
    while (this.rows[to]?.kind === 'heading') to += step;
    return this.rows[to] ?? this.rows[at - step];
  }

  #keyActs(event: KeyboardEvent, row: Row) {
    const open = {ArrowLeft: false, ArrowRight: true}[event.key];
    if (open !== undefined) {
      if (row.expandable) this.handlers.toggle(row, open);
      return true;
    }
    if (event.key === 'Enter') {
      if (row.select && this.handlers.activate) this.handlers.activate(row);
      else if (row.expandable) this.handlers.toggle(row, !row.open);
      else this.handlers.choose(row, event);
      return true;
    }
    if (event.key === ' ' && event.ctrlKey) {
      this.handlers.choose(row, event);
      return true;
    }
    if (event.key === 'ContextMenu' || (event.key === 'F10' && event.shiftKey)) {
      const box = document
        .getElementById(this.element.getAttribute('aria-activedescendant') ?? '')
        ?.getBoundingClientRect();
      if (box) this.handlers.menu?.(row, box.left + 40, box.bottom);
      return true;
    }
    return false;
  }

  /** Upper-case letters look for a row by its beginning: the plain ones are hotkeys. */
  #keyTypes(event: KeyboardEvent, at: number) {
    if (event.ctrlKey || event.key.length !== 1 || !event.shiftKey || event.key === ' ')
      return false;
    const now = performance.now();
    const fresh = now - this.#typed.at > 800;
    this.#typed = {text: (fresh ? '' : this.#typed.text) + event.key.toLowerCase(), at: now};
    const order = [...this.rows.slice(at + (fresh ? 1 : 0)), ...this.rows.slice(0, at)];
    const found = order.find((row) => row.label.toLowerCase().startsWith(this.#typed.text));
    if (found) {
      this.reveal(found.id);
      this.handlers.choose(found, event);
    }
    return true;
  }

  #parentOf(at: number) {
    const level = this.rows[at].level;
    for (let above = at - 1; above >= 0; above -= 1) {
      if (this.rows[above].level < level && this.rows[above].kind !== 'heading') return above;
    }
    return undefined;
  }
}
