/** Binary frames with a message of a ROS topic: a head in JSON, then plain numbers. */
import {FRAME_KINDS} from '../protocol.js';
import type {TopicHead} from '../protocol.js';

const HEAD_BYTES = 8;

/**
 * Decodes the head of a binary frame.
 * @returns null for another kind of frame; `start`: offset of the numbers, bytes, a multiple of 8
 */
export function decodeTopicFrame(buffer: ArrayBuffer): {head: TopicHead, buffer: ArrayBuffer,
    start: number}|null {
  const view = new DataView(buffer);
  if (view.getUint32(0, true) !== FRAME_KINDS.topic) return null;
  const size = view.getUint32(4, true);
  const text = new TextDecoder().decode(new Uint8Array(buffer, HEAD_BYTES, size));
  return {head: JSON.parse(text), buffer, start: HEAD_BYTES + size};
}
