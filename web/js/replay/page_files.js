/** Takes apart the data that a replay page contains: the recording, and the files of its models. */

/**
 * What the page contains. Offsets count from the end of the head, sizes are bytes.
 * @typedef {object} ReplayHead
 * @property {string} name
 * @property {[number, number]} log  offset and size of the state log
 * @property {Record<string, [number, number, string]>} files  offset, size, content type by address
 */

/**
 * The bytes of a page's data: base64 of a gzip stream.
 * @param {string} base64
 * @returns {Promise<Uint8Array>}
 */
export async function unpacked(base64) {
  const text = atob(base64.trim());
  const packed = Uint8Array.from(text, (letter) => letter.charCodeAt(0));
  const stream = new Blob([packed]).stream().pipeThrough(new DecompressionStream('gzip'));
  return new Uint8Array(await new Response(stream).arrayBuffer());
}

/**
 * The parts of the unpacked data: a u32 with the size of the head, the head in JSON, then all bytes.
 * @param {Uint8Array} data
 * @returns {{name: string, log: Uint8Array, files: Map<string, Blob>}}
 */
export function partsOf(data) {
  const size = new DataView(data.buffer, data.byteOffset).getUint32(0, true);
  /** @type {ReplayHead} */
  const head = JSON.parse(new TextDecoder().decode(data.subarray(4, 4 + size)));
  const rest = data.slice(4 + size);
  const files = new Map(Object.entries(head.files).map(([address, [at, length, type]]) =>
    [address, new Blob([rest.subarray(at, at + length)], {type})]));
  return {name: head.name, log: rest.slice(head.log[0], head.log[0] + head.log[1]), files};
}

/**
 * The path of an address as the page's files are named: decoded, from the root of the server.
 * @param {string} url
 */
export function pathOf(url) {
  const path = new URL(url, 'http://replay').pathname.replace(/^\/[A-Za-z]:\//, '/');
  try {
    return decodeURIComponent(path);
  } catch {
    return path;  // a bare % in the name of a picture
  }
}

/**
 * Returns for an address of a file the address of its content in this page.
 * @param {Map<string, Blob>} files
 * @returns {(url: string) => string}
 */
export function resolverOf(files) {
  const addresses = new Map([...files].map(([path, blob]) => [path, URL.createObjectURL(blob)]));
  return (url) => (/^(blob|data):/.test(url) ? url
    : addresses.get(pathOf(url)) ?? `data:,${encodeURIComponent('not in this recording')}`);
}
