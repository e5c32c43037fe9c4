/** Binary pose frames: what moved since the last one. The layout is in protocol.json. */

export const LIVE = 1;
const REPLAY = 2;

const FRAME_START = 40;
const RECORD = 32;

/**
 * @typedef {object} Frame
 * @property {number} kind      LIVE, or REPLAY of a log
 * @property {number} revision  of the document that the link ids belong to
 * @property {number} step      iterations since the world began
 * @property {number} simTime   s
 * @property {number} realTime  s
 * @property {number} count     of links
 * @property {(index: number) => number} id
 * @property {(index: number, pose: Float64Array|number[]) => void} read
 *           writes the world pose of the link frame: x y z in m, quaternion x y z w
 */

/**
 * @param {ArrayBuffer} buffer
 * @returns {Frame|null} null for a kind that this page does not know
 * @throws {RangeError} when the buffer is shorter than it says
 */
export function decodeFrame(buffer) {
  const view = new DataView(buffer);
  const kind = view.getUint32(0, true);
  if (kind !== LIVE && kind !== REPLAY) return null;
  const count = view.getUint32(32, true);
  if (buffer.byteLength < FRAME_START + count * RECORD) {
    throw new RangeError(`a frame of ${count} links in ${buffer.byteLength} bytes`);
  }
  return {
    kind,
    revision: view.getUint32(4, true),
    step: Number(view.getBigUint64(8, true)),
    simTime: view.getFloat64(16, true),
    realTime: view.getFloat64(24, true),
    count,
    id: (index) => view.getUint32(FRAME_START + index * RECORD, true),
    read: (index, pose) => {
      const start = FRAME_START + index * RECORD + 4;
      for (let part = 0; part < 7; part++) pose[part] = view.getFloat32(start + 4 * part, true);
    },
  };
}
