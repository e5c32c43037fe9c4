/** Built-in textures drawn by the page: no image files are needed for them. */
import {PATTERNS} from './palette.js';

/** @param {number} seed */
function random(seed) {
  let state = seed;
  return () => {
    state = (state * 1664525 + 1013904223) >>> 0;
    return state / 2 ** 32;
  };
}

/**
 * @param {CanvasRenderingContext2D} paint
 * @param {number} size
 * @param {number} amount
 * @param {number} seed
 */
function speckle(paint, size, amount, seed) {
  const image = paint.getImageData(0, 0, size, size);
  const next = random(seed);
  for (let at = 0; at < image.data.length; at += 4) {
    const shade = (next() - 0.5) * amount;
    for (let part = 0; part < 3; part++) image.data[at + part] += shade;
  }
  paint.putImageData(image, 0, 0);
}

/**
 * @param {CanvasRenderingContext2D} paint
 * @param {number} size
 * @param {string[]} colors
 * @param {number} rows
 */
function planks(paint, size, colors, rows) {
  const next = random(7);
  const height = size / rows;
  for (let row = 0; row < rows; row++) {
    paint.fillStyle = colors[row % colors.length];
    paint.fillRect(0, row * height, size, height);
    for (let line = 0; line < 26; line++) {
      const y = row * height + next() * height;
      paint.strokeStyle = `rgba(60, 30, 10, ${0.04 + next() * 0.12})`;
      paint.beginPath();
      paint.moveTo(0, y);
      paint.bezierCurveTo(size / 3, y + 3, 2 * size / 3, y - 3, size, y);
      paint.stroke();
    }
    paint.fillStyle = 'rgba(30, 15, 5, .55)';
    paint.fillRect(0, row * height, size, 1.5);
    paint.fillRect((row % 2 ? 0.3 : 0.75) * size, row * height, 1.5, height);
  }
}

/**
 * @param {CanvasRenderingContext2D} paint
 * @param {number} size
 * @param {string[]} colors
 * @param {number} rows
 */
function bricks(paint, size, [joint, brick], rows) {
  const next = random(3);
  plain(paint, size, [joint]);
  const parts = [1, 3, 5].map((at) => parseInt(brick.slice(at, at + 2), 16));
  const height = size / rows;
  const width = size / 4;
  for (let row = 0; row < rows; row++) {
    for (let column = -1; column < 4; column++) {
      const shade = 0.85 + next() * 0.3;
      paint.fillStyle = `rgb(${parts.map((part) => part * shade).join(', ')})`;
      const x = (column + (row % 2) / 2) * width;
      paint.fillRect(x + 1.5, row * height + 1.5, width - 3, height - 3);
    }
  }
}

/**
 * @param {CanvasRenderingContext2D} paint
 * @param {number} size
 * @param {string[]} colors
 * @param {number} count
 */
function tiles(paint, size, [face, joint], count) {
  plain(paint, size, [joint]);
  paint.fillStyle = face;
  const step = size / count;
  for (let x = 0; x < count; x++) {
    for (let y = 0; y < count; y++) paint.fillRect(x * step + 1, y * step + 1, step - 2, step - 2);
  }
}

/**
 * @param {CanvasRenderingContext2D} paint
 * @param {number} size
 * @param {string[]} colors
 */
function plain(paint, size, [color]) {
  paint.fillStyle = color;
  paint.fillRect(0, 0, size, size);
}

/**
 * @param {CanvasRenderingContext2D} paint
 * @param {number} size
 * @param {string[]} colors
 * @param {number} lanes
 */
function road(paint, size, [ground, paintedLine], lanes) {
  plain(paint, size, [ground]);
  paint.fillStyle = paintedLine;
  for (let line = 0; line <= lanes; line++) {
    const x = 4 + (size - 12) * line / lanes;
    const whole = line === 0 || line === lanes;
    paint.fillRect(x, 0, 4, whole ? size : size / 2);
  }
}

/**
 * @param {CanvasRenderingContext2D} paint
 * @param {number} size
 * @param {string[]} colors
 */
function checker(paint, size, [ground, squares]) {
  plain(paint, size, [ground]);
  paint.fillStyle = squares;
  paint.fillRect(0, 0, size / 2, size / 2);
  paint.fillRect(size / 2, size / 2, size / 2, size / 2);
}

/**
 * Draws a square of `size` px.
 * @typedef {(paint: CanvasRenderingContext2D, size: number, colors: string[], count: number) => void
 * } Painter
 */

/** @type {Record<string, Painter>} */
const PAINTERS = {plain, planks, bricks, tiles, road, checker};

const SIZE = 256;

/**
 * Draws a built-in pattern.
 * @param {string} name  as the document's material.texture.pattern
 * @returns {HTMLCanvasElement|null} null for a name without a picture
 */
export function patternCanvas(name) {
  const pattern = PATTERNS[name];
  if (!pattern) return null;
  const canvas = document.createElement('canvas');
  canvas.width = canvas.height = SIZE;
  const paint = canvas.getContext('2d', {willReadFrequently: true});
  if (!paint) return null;
  const {painter, colors, count, grain} = pattern;
  PAINTERS[painter](paint, SIZE, colors, count);
  if (grain) speckle(paint, SIZE, grain, 11);
  return canvas;
}
