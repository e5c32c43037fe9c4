/**
 * Built-in textures drawn by the page: no image files are needed for them.
 * @param {number} seed
 */

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

/** @param {CanvasRenderingContext2D} paint @param {number} size */
function bricks(paint, size) {
  const next = random(3);
  paint.fillStyle = '#b9b2a6';
  paint.fillRect(0, 0, size, size);
  const rows = 8;
  const height = size / rows;
  const width = size / 4;
  for (let row = 0; row < rows; row++) {
    for (let column = -1; column < 4; column++) {
      const shade = 0.85 + next() * 0.3;
      paint.fillStyle = `rgb(${150 * shade}, ${74 * shade}, ${56 * shade})`;
      const x = (column + (row % 2) / 2) * width;
      paint.fillRect(x + 1.5, row * height + 1.5, width - 3, height - 3);
    }
  }
}

/**
 * @param {CanvasRenderingContext2D} paint
 * @param {number} size
 * @param {string} face
 * @param {string} joint
 * @param {number} count
 */
function tiles(paint, size, face, joint, count) {
  paint.fillStyle = joint;
  paint.fillRect(0, 0, size, size);
  paint.fillStyle = face;
  const step = size / count;
  for (let x = 0; x < count; x++) {
    for (let y = 0; y < count; y++) paint.fillRect(x * step + 1, y * step + 1, step - 2, step - 2);
  }
}

/**
 * @param {CanvasRenderingContext2D} paint
 * @param {number} size
 * @param {string} color
 */
function plain(paint, size, color) {
  paint.fillStyle = color;
  paint.fillRect(0, 0, size, size);
}

/**
 * @param {CanvasRenderingContext2D} paint
 * @param {number} size
 * @param {number} lanes
 */
function road(paint, size, lanes) {
  plain(paint, size, '#4b4b4d');
  paint.fillStyle = '#e9e7dd';
  for (let line = 0; line <= lanes; line++) {
    const x = 4 + (size - 12) * line / lanes;
    const whole = line === 0 || line === lanes;
    paint.fillRect(x, 0, 4, whole ? size : size / 2);
  }
}

/** @param {CanvasRenderingContext2D} paint @param {number} size */
function checker(paint, size) {
  plain(paint, size, '#f4d616');
  paint.fillStyle = '#111';
  paint.fillRect(0, 0, size / 2, size / 2);
  paint.fillRect(size / 2, size / 2, size / 2, size / 2);
}

/**
 * Draws a square of `size` px.
 * @typedef {(paint: CanvasRenderingContext2D, size: number) => void} Painter
 */

/** How each pattern is drawn: painter, then the strength of the grain put over it. */
/** @type {Record<string, [Painter, number]>} */
const PATTERNS = {
  wood: [(paint, size) => planks(paint, size, ['#a9743f', '#9e6a37'], 4), 14],
  hardwood_floor: [(paint, size) => planks(paint, size, ['#b98a54', '#a97b47', '#c2935c'], 8), 12],
  wood_pallet: [(paint, size) => planks(paint, size, ['#c8a36b', '#b9935c'], 5), 18],
  bricks: [bricks, 22],
  ceiling_tiled: [(paint, size) => tiles(paint, size, '#e9e8e2', '#a5a39b', 2), 16],
  painted_wall: [(paint, size) => plain(paint, size, '#e6e0cf'), 8],
  pioneer_body: [(paint, size) => plain(paint, size, '#f2f2f2'), 6],
  building_frame: [(paint, size) => tiles(paint, size, '#8fa9bd', '#d8d4c8', 4), 6],
  runway: [(paint, size) => road(paint, size, 2), 16],
  grass: [(paint, size) => plain(paint, size, '#5f8a3a'), 60],
  road: [(paint, size) => road(paint, size, 2), 16],
  sidewalk: [(paint, size) => tiles(paint, size, '#b5b1a8', '#8f8b83', 4), 18],
  steps: [(paint, size) => tiles(paint, size, '#a8a39a', '#7c7870', 3), 18],
  granite: [(paint, size) => plain(paint, size, '#77726d'), 90],
  grey_gradient: [(paint, size) => {
    const ramp = paint.createLinearGradient(0, 0, 0, size);
    ramp.addColorStop(0, '#8a8f96');
    ramp.addColorStop(1, '#e2e4e6');
    paint.fillStyle = ramp;
    paint.fillRect(0, 0, size, size);
  }, 0],
  com: [checker, 0],
};

/** @type {Record<string, string>} */
const OTHER_NAMES = {
  woodfloor: 'hardwood_floor', hardwood: 'hardwood_floor', ceilingtiled: 'ceiling_tiled',
  tiles: 'ceiling_tiled', paintedwall: 'painted_wall', wall: 'painted_wall',
  beigewall: 'painted_wall', pioneerbody: 'pioneer_body', woodpallet: 'wood_pallet',
  buildingframe: 'building_frame', asphalt: 'road', road1: 'road', residential: 'road',
  motorway: 'road', trunk: 'road', primary: 'road', secondary: 'road', pedestrian: 'sidewalk',
  granite2: 'granite', clouds: 'grey_gradient',
};

const SIZE = 256;

/**
 * Draws a built-in pattern.
 * @param {string} name  as the document's material.texture.pattern
 * @returns {HTMLCanvasElement|null} null for a name without a picture
 */
export function patternCanvas(name) {
  const key = name.toLowerCase();
  const pattern = PATTERNS[key] ?? PATTERNS[OTHER_NAMES[key.replace(/[^a-z0-9]/g, '')]];
  if (!pattern) return null;
  const canvas = document.createElement('canvas');
  canvas.width = canvas.height = SIZE;
  const paint = canvas.getContext('2d', {willReadFrequently: true});
  if (!paint) return null;
  const [draw, grain] = pattern;
  draw(paint, SIZE);
  if (grain) speckle(paint, SIZE, grain, 11);
  return canvas;
}
