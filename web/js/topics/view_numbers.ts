/** The numbers of a message as pages receive it, by the path of their field in the message. Pure. */
import type {View} from '../protocol.js';

/** Fields that change with every message or never, and fill lists. */
const LEFT_OUT = /^header\b|covariance/;
const AXES = ['x', 'y', 'z', 'w'];

/**
 * The numbers of a view.
 * @param payload  the numbers that follow the head of the frame
 */
export function numbersOf(view: View, payload: ArrayBuffer): Map<string, number> {
  if (view.type === 'text') return textNumbers(view.text);
  if (view.type === 'odometry') {
    return new Map([...named('pose.pose.position', view.pose.slice(0, 3)),
      ...named('pose.pose.orientation', view.pose.slice(3)), ...named('twist.twist.linear', view.linear),
      ...named('twist.twist.angular', view.angular)]);
  }
  if (view.type === 'range') return typeof view.range === 'number' ? new Map([['range', view.range]]) : new Map();
  if (view.type === 'scan') {
    const seen = new Float32Array(payload, 0, view.count).filter(Number.isFinite);
    return seen.length ? new Map([['nearest', seen.reduce((low, one) => Math.min(low, one))]]) : new Map();
  }
  if (view.type === 'path' && !view.line && view.poses.length === 1) {
    return new Map([...named('pose.position', view.poses[0].slice(0, 3)),
      ...named('pose.orientation', view.poses[0].slice(3))]);
  }
  return new Map();
}

const named = (path: string, values: number[]): [string, number][] =>
  values.map((value, at) => [`${path}.${AXES[at]}`, value]);

/** The numbers of a message as text (`editor/topics/message_views.py`). */
function textNumbers(text: string): Map<string, number> {
  const found = new Map<string, number>();
  const names: string[] = [];
  const path: string[] = [];
  const items: number[] = [];
  const add = (at: string, value: string) => {
    const number = {True: 1, False: 0}[value] ?? (value.trim() ? Number(value) : NaN);
    if (Number.isFinite(number) && !LEFT_OUT.test(at)) found.set(at, number);
  };
  for (const line of text.split('\n')) {
    const [, lead, name, value = ''] = /^((?: {2})*)(?:-|(\w+):(?: (.*))?)$/.exec(line) ?? [];
    if (lead === undefined) continue;  // a string of several lines
    const depth = lead.length / 2;
    if (depth > path.length) continue;
    path.length = depth + 1;
    if (name === undefined) {
      items[depth - 1] += 1;
      path[depth - 1] = `${names[depth - 1]}[${items[depth - 1]}]`;
      path[depth] = '';
      continue;
    }
    names[depth] = path[depth] = name;
    items[depth] = -1;
    const here = path.filter(Boolean).join('.');
    const list = /^\[(.*?)(?:, \.\.\. \(\d+\))?\]$/.exec(value);
    if (list) list[1].split(', ').forEach((one, at) => add(`${here}[${at}]`, one));
    else add(here, value);
  }
  return found;
}
