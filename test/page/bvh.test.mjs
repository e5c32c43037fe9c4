import {test} from 'node:test';
import './with_plain_three.mjs';
import {near, sameTurn} from './near.mjs';

const {parsed, placed} = await import('../../web/js/view/bvh.js');

const HALF = Math.sqrt(0.5);
const FILE = `HIERARCHY
ROOT hip
{
  OFFSET 1 2 3
  CHANNELS 7 Xposition Wposition Zrotation Wrotation Zscale Xrotation zrotation
}
MOTION
Frames: 1
Frame Time: 0.5
9 8 90 50 7 90 30
`;

test('turns follow each other in the order of their channels, and unknown channels say nothing', () => {
  const {joints: [hip], frames: [values]} = parsed(FILE);
  const {place, turn} = placed(hip, values);
  near(place, [9, 2, 3]);
  sameTurn(turn, [0.5, 0.5, 0.5, 0.5]);
  sameTurn(placed({...hip, channels: ['Yrotation']}, [90]).turn, [0, HALF, 0, HALF]);
});
