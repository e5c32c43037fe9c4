/**
 * Curves of numbers over sim time: kept samples, divisions of the axes, export. Pure functions.
 */
/** The most samples of a curve that are kept; the oldest half goes when there are more. */
export const KEPT = 20000;

/** The samples of one variable, in the order of time. */
export class Series {
  variable;
  times: number[] = [];
  values: number[] = [];
  /** Sim time when it was last told, s. */
  told = -Infinity;
  /** Whether what it was of has gone. */
  ended = false;

  constructor(variable: string) {
    this.variable = variable;
  }

  /**
   * Adds a sample. If time runs back (a reset), the curve is cleared first. A sample of the same time
   * replaces the last.
   */
  add(time: number, value: number) {
    const last = this.times.length - 1;
    if (time < this.times[last]) this.clear();
    else if (time === this.times[last]) {
      this.values[last] = value;
      return;
    }
    this.times.push(time);
    this.values.push(value);
    if (this.times.length > KEPT) {
      this.times.splice(0, KEPT / 2);
      this.values.splice(0, KEPT / 2);
    }
  }

  clear() {
    this.times.length = 0;
    this.values.length = 0;
    this.told = -Infinity;
  }

  /** The value at a time, or the last one before it; undefined before the first. */
  at(time: number) {
    const index = upper(this.times, time) - 1;
    return index >= 0 ? this.values[index] : undefined;
  }
}

/**
 * Adds a pushed value to its curve. If time runs back (a reset), all curves are cleared, also those
 * of deleted entities, because all curves share one time axis.
 */
export function take(all: Series[], series: Series, {time, value, problem}: {time: number,
    value?: number|null, problem?: string|null}) {
  if (all.some(({told}) => told > time)) for (const one of all) one.clear();
  if (value !== undefined && value !== null) series.add(time, value);
  series.told = time;
  series.ended = Boolean(problem);
}

/** How many of the ascending numbers are at most `limit`. */
function upper(numbers: number[], limit: number) {
  let low = 0;
  let high = numbers.length;
  while (low < high) {
    const middle = (low + high) >> 1;
    if (numbers[middle] <= limit) low = middle + 1;
    else high = middle;
  }
  return low;
}

/**
 * What the axes show.
 * @param span  s before the newest sample; null for all
 * @param now  sim time, s: values that do not change are told once
 * @returns null without samples
 */
export function extent(series: Series[], span: number|null, now = -Infinity): {from: number,
    to: number, low: number, high: number}|null {
  const filled = series.filter(({times}) => times.length);
  if (!filled.length) return null;
  const to = Math.max(now, ...filled.map(({times}) => times[times.length - 1]));
  const first = Math.min(...filled.map(({times}) => times[0]));
  const from = span === null ? first : Math.max(first, to - span);
  let low = Infinity;
  let high = -Infinity;
  for (const {times, values} of filled) {
    for (let at = Math.max(0, upper(times, from) - 1); at < values.length; at += 1) {
      low = Math.min(low, values[at]);
      high = Math.max(high, values[at]);
    }
  }
  // A curve that does not change lies in the middle of a range that shows its size.
  const spare = high > low ? (high - low) * 0.06 : Math.max(Math.abs(high) * 0.1, 1e-3);
  return {from, to: Math.max(to, from + 1e-3), low: low - spare, high: high + spare};
}

/**
 * Round numbers to write at an axis.
 * @param most  how many there is room for
 */
export function ticks(low: number, high: number, most: number): number[] {
  const rough = (high - low) / Math.max(1, most);
  const power = 10 ** Math.floor(Math.log10(rough));
  const step = [1, 2, 5, 10].map((factor) => factor * power).find((one) => one >= rough * 0.999) ?? 10 * power;
  const result = [];
  for (let at = Math.ceil(low / step - 1e-9); at * step <= high + step * 1e-9; at += 1) {
    result.push(Number((at * step).toPrecision(12)));
  }
  return result;
}

/** The curves as comma-separated values: a row for each time that any of them has. */
export function csvOf(series: Series[]): string {
  const times = [...new Set(series.flatMap((one) => one.times))].sort((a, b) => a - b);
  const cell = (text: string) => (/[",\n]/.test(text) ? `"${text.replaceAll('"', '""')}"` : text);
  const maps = series.map((one) => new Map(one.times.map((time, at) => [time, one.values[at]])));
  const rows = times.map((time) => [time, ...maps.map((map) => map.get(time) ?? '')].join(','));
  const head = ['time', ...series.map((one) => cell(one.variable))].join(',');
  return `${[head, ...rows].join('\n')}\n`;
}
