/** Draws curves with their axes onto a canvas. */
import {h, themeColor} from './dom.js';
import {closeButton} from './icons.js';
import {numberText} from './text_format.js';
import {extent, ticks} from './plot_data.js';
import type {Series} from './plot_data.js';

/** Told apart by eyes that see no red or green as well; readable on dark and light. */
const CURVE_COLORS = [
  '#e8812a',
  '#3f93e0',
  '#36a869',
  '#c765c4',
  '#d9534f',
  '#8a7be0',
  '#b09a1f',
  '#2fa7a7',
];

export type Curve = {series: Series, color: string};
/** Where the curves are drawn, px. */
type PlotBox = {left: number, top: number, width: number, height: number};
/** What the axes show. */
type Range = {from: number, to: number, low: number, high: number};
export type Drawn = {box: PlotBox, range: Range};

/** A color that no curve has; the first one if all are taken. */
export const freeColor = (curves: Curve[]) =>
  CURVE_COLORS.find((color) => curves.every((curve) => curve.color !== color)) ?? CURVE_COLORS[0];

/** An entry of a legend. @param remove  called when the curve is to be removed */
export function legendEntry({series: {variable}, color}: Curve, remove: () => void) {
  return h('span', {class: 'plot-key'}, h('i', {style: `background:${color}`}), variable,
    closeButton(`Remove ${variable}`, remove, 10));
}

const LEFT = 62;
const BOTTOM = 22;
const TOP = 8;
const RIGHT = 10;

/**
 * @param options  `cursor`: px from the
 * left, where the values are read off; `mark`: sim time, s, where they are read off without a cursor;
 * `now`: sim time, s
 * @returns null without samples
 */
export function drawPlot(canvas: HTMLCanvasElement, curves: Curve[], {span, cursor,
    mark = NaN, now}: {span: number|null, cursor: number|null, mark?: number, now: number}): Drawn|null {
  const {clientWidth: width, clientHeight: height} = canvas;
  const ratio = window.devicePixelRatio || 1;
  if (!width || !height) return null;
  canvas.width = Math.round(width * ratio);
  canvas.height = Math.round(height * ratio);
  const pen = canvas.getContext('2d');
  if (!pen) return null;
  pen.scale(ratio, ratio);
  pen.fillStyle = themeColor('panel-2');
  pen.fillRect(0, 0, width, height);
  pen.font = '11px system-ui, "DejaVu Sans", sans-serif';
  const range = extent(
    curves.map((curve) => curve.series),
    span,
    now,
  );
  if (!range) {
    pen.fillStyle = themeColor('text-faint');
    pen.textAlign = 'center';
    pen.fillText(curves.length ? 'No data yet' : 'Drop a variable here', width / 2, height / 2);
    return null;
  }
  const box = {left: LEFT, top: TOP, width: width - LEFT - RIGHT, height: height - TOP - BOTTOM};
  const across = (time: number) => box.left + ((time - range.from) / (range.to - range.from)) * box.width;
  const down = (value: number) => box.top + ((range.high - value) / (range.high - range.low)) * box.height;
  drawAxes(pen, box, range, across, down);
  pen.save();
  pen.beginPath();
  pen.rect(box.left, box.top, box.width, box.height);
  pen.clip();
  for (const curve of curves) drawCurve(pen, curve, range, across, down, box.width);
  pen.restore();
  const time = cursor === null ? mark : range.from + ((cursor - box.left) / box.width) * (range.to - range.from);
  if (time >= range.from && time <= range.to) drawCursor(pen, box, curves, time, across, down);
  return {box, range};
}

function drawAxes(pen: CanvasRenderingContext2D, box: PlotBox, range: Range,
    across: (value: number) => number, down: (value: number) => number) {
  pen.strokeStyle = themeColor('line');
  pen.fillStyle = themeColor('text-soft');
  pen.lineWidth = 1;
  pen.textAlign = 'center';
  pen.textBaseline = 'top';
  const line = (fromX: number, fromY: number, toX: number, toY: number) => {
    pen.beginPath();
    pen.moveTo(fromX, fromY);
    pen.lineTo(toX, toY);
    pen.stroke();
  };
  for (const time of ticks(range.from, range.to, Math.max(2, box.width / 90))) {
    const x = Math.round(across(time)) + 0.5;
    line(x, box.top, x, box.top + box.height);
    pen.fillText(numberText(time), x, box.top + box.height + 6);
  }
  pen.textAlign = 'right';
  pen.textBaseline = 'middle';
  for (const value of ticks(range.low, range.high, Math.max(2, box.height / 34))) {
    const y = Math.round(down(value)) + 0.5;
    line(box.left, y, box.left + box.width, y);
    pen.fillText(numberText(value), box.left - 6, y);
  }
}

/** One point for each pixel column's lowest and highest value: long curves stay quick to draw. */
function drawCurve(pen: CanvasRenderingContext2D, {series, color}: Curve, range: Range,
    across: (value: number) => number, down: (value: number) => number, width: number) {
  const {times, values} = series;
  const step = (range.to - range.from) / Math.max(1, width);
  pen.strokeStyle = color;
  pen.lineWidth = 1.6;
  pen.lineJoin = 'round';
  pen.beginPath();
  let column = -Infinity;
  let low = 0;
  let high = 0;
  for (let at = 0; at < times.length; at += 1) {
    if (times[at + 1] < range.from) continue;
    const place = Math.floor((times[at] - range.from) / step);
    if (place === column && at < times.length - 1) {
      low = Math.min(low, values[at]);
      high = Math.max(high, values[at]);
      continue;
    }
    if (high > low) {
      pen.lineTo(across(times[at - 1]), down(low));
      pen.lineTo(across(times[at - 1]), down(high));
    }
    pen.lineTo(across(times[at]), down(values[at]));
    column = place;
    low = high = values[at];
  }
  // What has not changed since is still what it was.
  if (times.length && !series.ended) pen.lineTo(across(range.to), down(values[values.length - 1]));
  pen.stroke();
}

function drawCursor(pen: CanvasRenderingContext2D, box: PlotBox, curves: Curve[], time: number,
    across: (value: number) => number, down: (value: number) => number) {
  const x = across(time);
  pen.strokeStyle = themeColor('text-soft');
  pen.beginPath();
  pen.moveTo(x, box.top);
  pen.lineTo(x, box.top + box.height);
  pen.stroke();
  const lines = [`${time.toFixed(3)} s`];
  for (const {series, color} of curves) {
    const value = series.at(time);
    if (value === undefined) continue;
    pen.fillStyle = color;
    pen.beginPath();
    pen.arc(x, down(value), 3, 0, 2 * Math.PI);
    pen.fill();
    lines.push(`${series.variable}  ${numberText(value)}`);
  }
  const wide = Math.max(...lines.map((text) => pen.measureText(text).width)) + 12;
  const left = x + 8 + wide < box.left + box.width ? x + 8 : x - 8 - wide;
  pen.fillStyle = themeColor('raised');
  pen.fillRect(left, box.top + 4, wide, lines.length * 15 + 6);
  pen.fillStyle = themeColor('text');
  pen.textAlign = 'left';
  pen.textBaseline = 'top';
  lines.forEach((text, at) => pen.fillText(text, left + 6, box.top + 8 + at * 15));
}
