/** Built-in textures drawn by the page: no image files are needed for them. */
import {PATTERNS} from '../palette.js';

function random(seed: number) {
  let state = seed;
  return () => {
    state = (state * 1664525 + 1013904223) >>> 0;
    return state / 2 ** 32;
  };
}

function speckle(paint: CanvasRenderingContext2D, size: number, amount: number, seed: number) {
  const image = paint.getImageData(0, 0, size, size);
  const next = random(seed);
  for (let at = 0; at < image.data.length; at += 4) {
    const shade = (next() - 0.5) * amount;
    for (let part = 0; part < 3; part++) image.data[at + part] += shade;
  }
  paint.putImageData(image, 0, 0);
}

function planks(paint: CanvasRenderingContext2D, size: number, colors: string[], rows: number) {
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

function bricks(paint: CanvasRenderingContext2D, size: number, [joint, brick]: string[], rows: number) {
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

function tiles(paint: CanvasRenderingContext2D, size: number, [face, joint]: string[], count: number) {
  plain(paint, size, [joint]);
  paint.fillStyle = face;
  const step = size / count;
  for (let x = 0; x < count; x++) {
    for (let y = 0; y < count; y++) paint.fillRect(x * step + 1, y * step + 1, step - 2, step - 2);
  }
}

function plain(paint: CanvasRenderingContext2D, size: number, [color]: string[]) {
  paint.fillStyle = color;
  paint.fillRect(0, 0, size, size);
}

function road(paint: CanvasRenderingContext2D, size: number, [ground, paintedLine]: string[],
    lanes: number) {
  plain(paint, size, [ground]);
  paint.fillStyle = paintedLine;
  for (let line = 0; line <= lanes; line++) {
    const x = 4 + (size - 12) * line / lanes;
    const whole = line === 0 || line === lanes;
    paint.fillRect(x, 0, 4, whole ? size : size / 2);
  }
}

function checker(paint: CanvasRenderingContext2D, size: number, [ground, squares]: string[]) {
  plain(paint, size, [ground]);
  paint.fillStyle = squares;
  paint.fillRect(0, 0, size / 2, size / 2);
  paint.fillRect(size / 2, size / 2, size / 2, size / 2);
}

/** Draws a square of `size` px. */
type Painter = (paint: CanvasRenderingContext2D, size: number, colors: string[],
    count: number) => void;

const PAINTERS: Record<string, Painter> = {plain, planks, bricks, tiles, road, checker};

const SIZE = 256;

/**
 * Draws a built-in pattern.
 * @param name  as the document's material.texture.pattern
 * @returns null for a name without a picture
 */
export function patternCanvas(name: string): HTMLCanvasElement|null {
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
