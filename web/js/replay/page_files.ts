/** Takes apart the data that a replay page contains: the recording, and the files of its models. */

/** What the page contains. Offsets count from the end of the head, sizes are bytes. */
interface ReplayHead {
  name: string;
  /** offset and size of the state log */
  log: [number, number];
  /** offset, size, content type by address */
  files: Record<string, [number, number, string]>;
  /** variables that the plot shows from the start, such as `/cmd_vel.linear.x` */
  curves: string[];
}

/** The bytes of a page's data: base64 of a gzip stream. */
export async function unpacked(base64: string): Promise<Uint8Array> {
  const text = atob(base64.trim());
  const packed = Uint8Array.from(text, (letter) => letter.charCodeAt(0));
  const stream = new Blob([packed]).stream().pipeThrough(new DecompressionStream('gzip'));
  return new Uint8Array(await new Response(stream).arrayBuffer());
}

/** The parts of the unpacked data: a u32 with the size of the head, the head in JSON, then all bytes. */
export function partsOf(data: Uint8Array): {name: string, log: Uint8Array, files: Map<string, Blob>,
    curves: string[]} {
  const size = new DataView(data.buffer, data.byteOffset).getUint32(0, true);
  const head: ReplayHead = JSON.parse(new TextDecoder().decode(data.subarray(4, 4 + size)));
  const rest = data.slice(4 + size);
  const files = new Map(Object.entries(head.files).map(([address, [at, length, type]]) =>
    [address, new Blob([rest.subarray(at, at + length)], {type})]));
  return {name: head.name, log: rest.slice(head.log[0], head.log[0] + head.log[1]), files, curves: head.curves};
}

/** The path of an address as the page's files are named: decoded, from the root of the server. */
export function pathOf(url: string) {
  const path = new URL(url, 'http://replay').pathname.replace(/^\/[A-Za-z]:\//, '/');
  try {
    return decodeURIComponent(path);
  } catch {
    return path;  // a bare % in the name of a picture
  }
}

/** Returns for an address of a file the address of its content in this page. */
export function resolverOf(files: Map<string, Blob>): (url: string) => string {
  const addresses = new Map([...files].map(([path, blob]) => [path, URL.createObjectURL(blob)]));
  return (url) => (/^(blob|data):/.test(url) ? url
    : addresses.get(pathOf(url)) ?? `data:,${encodeURIComponent('not in this recording')}`);
}
