/** Short texts in the scene that keep their size on the screen. */
import {CanvasTexture, SRGBColorSpace, Sprite, SpriteMaterial} from 'three';

const PIXELS = 28;
const FONT = `600 ${PIXELS}px system-ui, sans-serif`;
/** Of the view's height. */
const HEIGHT = 0.028;

/** What labels look like, by text and colour. */
const looks: Map<string, SpriteMaterial> = new Map();
const KEPT = 300;

/** A text that faces the camera. */
export function label(text: string, color = '#ffffff'): Sprite {
  const key = `${color} ${text}`;
  const material = looks.get(key) ?? written(text, color);
  // The last one is the one used last.
  looks.delete(key);
  looks.set(key, material);
  if (looks.size > KEPT) forgetFirst();
  const sprite = new Sprite(material);
  sprite.scale.set(HEIGHT * material.userData.aspect, HEIGHT, 1);
  sprite.center.set(0, 0);
  sprite.renderOrder = 60;
  return sprite;
}

/** Should it still be shown somewhere, three uploads it again. */
function forgetFirst() {
  const [[key, material]] = looks;
  looks.delete(key);
  material.map?.dispose();
  material.dispose();
}

function written(text: string, color: string) {
  const canvas = document.createElement('canvas');
  const pen = canvas.getContext('2d');
  if (pen) {
    pen.font = FONT;
    canvas.width = Math.ceil(pen.measureText(text).width) + 12;
    canvas.height = PIXELS + 12;
    pen.font = FONT;
    pen.textBaseline = 'middle';
    pen.lineWidth = 5;
    pen.strokeStyle = 'rgba(0, 0, 0, .75)';
    pen.strokeText(text, 6, canvas.height / 2);
    pen.fillStyle = color;
    pen.fillText(text, 6, canvas.height / 2);
  }
  const map = new CanvasTexture(canvas);
  map.colorSpace = SRGBColorSpace;
  const material = new SpriteMaterial({map, depthTest: false, transparent: true,
    sizeAttenuation: false, fog: false});
  material.userData.aspect = canvas.width / Math.max(canvas.height, 1);
  return material;
}
