/**
 * Numbers and times as texts, and back. Pure: no document, no store.
 */

/**
 * A time as Gazebo's time bar writes it.
 * @param ns  nanoseconds
 * @returns `dd hh:mm:ss.mmm`
 */
export function clockText(ns: number): string {
  const total = Math.max(0, Math.floor(ns / 1e6));
  const two = (number: number) => String(number).padStart(2, '0');
  const seconds = Math.floor(total / 1000);
  return (
    `${two(Math.floor(seconds / 86400))} ${two(Math.floor(seconds / 3600) % 24)}:` +
    `${two(Math.floor(seconds / 60) % 60)}:${two(seconds % 60)}.` +
    String(total % 1000).padStart(3, '0')
  );
}

/**
 * A number in at most seven significant digits, without trailing zeros: what a field shows while it
 * has no focus.
 */
export function numberText(value: number|null|undefined): string {
  if (value === null || value === undefined || Number.isNaN(value)) return '';
  if (Math.abs(value) >= 1e16) return value > 0 ? 'inf' : '-inf';
  if (value === 0) return '0';
  const size = Math.abs(value);
  if (size < 1e-4 || size >= 1e7) return trimmed(value.toExponential(5));
  return trimmed(value.toPrecision(7));
}

function trimmed(text: string) {
  const [mantissa, exponent] = text.split('e');
  const short = mantissa.includes('.') ? mantissa.replace(/\.?0+$/, '') : mantissa;
  return exponent === undefined ? short : `${short}e${Number(exponent)}`;
}

/** What is left to parse. */
type TokenState = {tokens: (number|string)[], at: number};

const TOKEN =
  /\s*(?:(\d+\.?\d*(?:[eE][+-]?\d+)?|\.\d+(?:[eE][+-]?\d+)?)|([a-zA-Z°]+)|([-+*/()]))/y;
const NAMES = new Map(Object.entries({pi: Math.PI, inf: 1e16, infinity: 1e16}));
const UNITS = new Map(
  Object.entries({
    deg: Math.PI / 180,
    '°': Math.PI / 180,
    rad: 1,
    cm: 0.01,
    mm: 0.001,
    m: 1,
    g: 0.001,
    kg: 1,
  }),
);

/**
 * What a person types into a number field: a number, `pi/2`, `90deg`, `25cm`, `(1+2)/3`, `inf`.
 * @returns NaN where the text is none of these
 */
export function parseNumber(text: string): number {
  const tokens = tokenize(text);
  if (!tokens || !tokens.length) return NaN;
  const state = {tokens, at: 0};
  const value = sum(state);
  return state.at === tokens.length ? value : NaN;
}

/** Splits an expression into numbers, names and operators; null for an invalid character. */
function tokenize(text: string) {
  const tokens: (number|string)[] = [];
  TOKEN.lastIndex = 0;
  const source = text.trim();
  while (TOKEN.lastIndex < source.length) {
    const found = TOKEN.exec(source);
    if (!found) return null;
    tokens.push(found[1] !== undefined ? Number(found[1]) : (found[2] ?? found[3]));
  }
  return tokens;
}

function sum(state: TokenState) {
  let value = product(state);
  while (state.tokens[state.at] === '+' || state.tokens[state.at] === '-') {
    const sign = state.tokens[state.at++] === '+' ? 1 : -1;
    value += sign * product(state);
  }
  return value;
}

function product(state: TokenState) {
  let value = factor(state);
  while (state.tokens[state.at] === '*' || state.tokens[state.at] === '/') {
    const divided = state.tokens[state.at++] === '/';
    const by = factor(state);
    value = divided ? value / by : value * by;
  }
  return value;
}

function factor(state: TokenState): number {
  const token = state.tokens[state.at++];
  if (token === '-') return -factor(state);
  if (token === '+') return factor(state);
  let value = NaN;
  if (typeof token === 'number') value = token;
  else if (token === '(') {
    value = sum(state);
    if (state.tokens[state.at++] !== ')') return NaN;
  } else value = NAMES.get(String(token).toLowerCase()) ?? NaN;
  const unit = UNITS.get(String(state.tokens[state.at]));
  if (unit !== undefined) {
    state.at += 1;
    value *= unit;
  }
  return value;
}

/**
 * A colour for `<input type=color>`.
 * @param color  r, g, b in 0..1
 * @returns `#rrggbb`
 */
export function colorText(color: number[]): string {
  const part = (value: number) =>
    Math.round(Math.min(1, Math.max(0, value ?? 0)) * 255)
      .toString(16)
      .padStart(2, '0');
  return `#${part(color[0])}${part(color[1])}${part(color[2])}`;
}

/**
 * @param text  `#rrggbb`
 * @param alpha  0..1
 * @returns r, g, b, a in 0..1
 */
export function colorOf(text: string, alpha: number): number[] {
  const part = (at: number) => Math.round((parseInt(text.slice(at, at + 2), 16) / 255) * 1e4) / 1e4;
  return [part(1), part(3), part(5), alpha];
}

/** A number of bytes in words. */
export function bytesText(bytes: number) {
  if (bytes < 1000) return `${bytes} B`;
  if (bytes < 1e6) return `${(bytes / 1e3).toFixed(0)} kB`;
  if (bytes < 1e9) return `${(bytes / 1e6).toFixed(1)} MB`;
  return `${(bytes / 1e9).toFixed(1)} GB`;
}

/** Messages a second in words. */
export const rateText = (hz: number) => `${hz < 9.95 ? hz.toFixed(1) : hz.toFixed(0)} Hz`;

/** Bytes a second in words. */
export const bandwidthText = (size: number) => `${bytesText(Math.round(size))}/s`;
