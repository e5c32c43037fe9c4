/** Binary pose frames: the links that moved since the last frame. */
import {
  FRAME_HEAD, FRAME_HEAD_BYTES, FRAME_KINDS, FRAME_RECORD, FRAME_RECORD_BYTES,
} from './protocol.js';

export const LIVE = FRAME_KINDS.poses;
const REPLAY = FRAME_KINDS.log;

interface Frame {
  /** LIVE, or REPLAY of a log */
  kind: number;
  /** of the document that the link ids belong to */
  revision: number;
  /** iterations since the world began */
  step: number;
  /** s */
  simTime: number;
  /** s */
  realTime: number;
  /** of links */
  count: number;
  id: (index: number) => number;
  /** writes the world pose of the link frame: x y z in m, quaternion x y z w */
  read: (index: number, pose: Float64Array|number[]) => void;
}

/**
 * @returns null for a kind that this page does not know
 * @throws {RangeError} when the buffer is shorter than it says
 */
export function decodeFrame(buffer: ArrayBuffer): Frame|null {
  const view = new DataView(buffer);
  const kind = view.getUint32(FRAME_HEAD.kind, true);
  if (kind !== LIVE && kind !== REPLAY) return null;
  const count = view.getUint32(FRAME_HEAD.count, true);
  if (buffer.byteLength < FRAME_HEAD_BYTES + count * FRAME_RECORD_BYTES) {
    throw new RangeError(`a frame of ${count} links in ${buffer.byteLength} bytes`);
  }
  return {
    kind,
    revision: view.getUint32(FRAME_HEAD.revision, true),
    step: Number(view.getBigUint64(FRAME_HEAD.step, true)),
    simTime: view.getFloat64(FRAME_HEAD.sim_time, true),
    realTime: view.getFloat64(FRAME_HEAD.real_time, true),
    count,
    id: (index) => view.getUint32(recordAt(index) + FRAME_RECORD.id, true),
    read: (index, pose) => {
      const start = recordAt(index) + FRAME_RECORD.px;
      for (let part = 0; part < 7; part++) pose[part] = view.getFloat32(start + 4 * part, true);
    },
  };
}

const recordAt = (index: number) => FRAME_HEAD_BYTES + index * FRAME_RECORD_BYTES;
