/** Files that take long to arrive. */

/** Smaller ones are not reported. */
const LARGE = 1e6;

/**
 * The bytes of an answer.
 * @param onBytes  receives how many more are there, and how many more are expected
 */
export async function bodyOf(response: Response, onBytes: (loaded: number, size: number) => void) {
  const size = Number(response.headers?.get('Content-Length'));
  const isPacked = response.headers?.get('Content-Encoding');
  if (!response.body || isPacked || !(size > LARGE)) return response.arrayBuffer();
  onBytes(0, size);
  const content = new Uint8Array(size);
  const reader = response.body.getReader();
  let filled = 0;
  for (;;) {
    const {done, value} = await reader.read();
    if (done) break;
    if (filled + value.length > size) throw new Error(`${response.url}: longer than announced`);
    content.set(value, filled);
    filled += value.length;
    onBytes(value.length, 0);
  }
  if (filled < size) throw new Error(`${response.url}: ended after ${filled} of ${size} bytes`);
  return content.buffer;
}
