/** Files and folders that were dropped on the page: read, and what they can become. */
import type {ImportFile} from './protocol.js';

/** path: with the folder that was dropped */
export type DroppedFile = {path: string, file: File};
/** What browsers give of a drop: folders and files, or files alone. */
export type Dropped = FileSystemEntry|File;
/** text: an SDF or URDF that is inserted as it is */
type DropKind = 'text'|'world'|'model'|'mesh';

export const MOST_BYTES = 20 * 2 ** 20;
const MOST_FILES = 500;
const MESHES = /\.(dae|stl|obj|glb)$/i;

/** All files of what was dropped. */
export async function filesOf(entries: Dropped[]): Promise<DroppedFile[]> {
  const found: DroppedFile[] = [];
  for (const queue = [...entries]; queue.length;) {
    const entry = queue.shift() as Dropped;
    if (entry instanceof File) {
      found.push({path: entry.name, file: entry});
      continue;
    }
    if (entry.name.startsWith('.')) continue;
    if (entry.isFile) {
      const own = entry as FileSystemFileEntry;
      const file: File = await new Promise((resolve, reject) => own.file(resolve, reject));
      found.push({path: entry.fullPath.replace(/^\//, ''), file});
    } else queue.push(...await listed(entry as FileSystemDirectoryEntry));
    if (found.length > MOST_FILES) throw new Error(`More than ${MOST_FILES} files were dropped.`);
  }
  const size = found.reduce((sum, {file}) => sum + file.size, 0);
  if (size > MOST_BYTES) {
    throw new Error(`The files have ${(size / 1e6).toFixed(0)} MB; at most 20 MB can be dropped. ` +
      'Put larger models into ~/.gazebo/models.');
  }
  return found;
}

/** A reader gives a hundred entries at a time. */
async function listed(folder: FileSystemDirectoryEntry) {
  const reader = folder.createReader();
  const found: FileSystemEntry[] = [];
  for (;;) {
    const some: FileSystemEntry[] = await new Promise((resolve, reject) =>
        reader.readEntries(resolve, reject));
    if (!some.length) return found;
    found.push(...some);
  }
}

/** What files become; null for files that are no model. */
export function kindOf(files: {path: string}[]): {kind: DropKind, name: string}|null {
  const paths = files.map(({path}) => path);
  const folder = paths.length && paths.every((path) => path.includes('/')) ? paths[0].split('/')[0] : '';
  const [only] = paths;
  if (paths.length === 1 && /\.(sdf|urdf)$/i.test(only)) return {kind: 'text', name: stem(only)};
  if (paths.length === 1 && /\.world$/i.test(only)) return {kind: 'world', name: stem(only)};
  if (paths.some((path) => /(^|\/)model\.config$|\.sdf$/i.test(path))) {
    return {kind: 'model', name: folder || stem(only)};
  }
  const meshes = paths.filter((path) => MESHES.test(path));
  return meshes.length === 1 ? {kind: 'mesh', name: stem(meshes[0])} : null;
}

/** The models of a world file: its sun and ground are in the world already. */
export function modelsOfWorld(text: string) {
  const parsed = new DOMParser().parseFromString(text, 'text/xml');
  for (const element of parsed.querySelectorAll('world > light, world > include')) {
    const uri = element.querySelector('uri')?.textContent?.trim();
    if (element.tagName === 'light' || /^model:\/\/(sun|ground_plane)$/.test(uri ?? '')) element.remove();
  }
  // What is no XML goes to the simulator, which says where the fault is.
  return parsed.querySelector('parsererror') ? text : new XMLSerializer().serializeToString(parsed);
}

const stem = (path: string) => (path.split('/').pop() ?? '').replace(/\.[^.]*$/, '');

export function encoded(files: DroppedFile[]): Promise<ImportFile[]> {
  return Promise.all(files.map(async ({path, file}) => {
    const bytes = new Uint8Array(await file.arrayBuffer());
    let text = '';
    for (let at = 0; at < bytes.length; at += 8192) {
      text += String.fromCharCode(...bytes.subarray(at, at + 8192));
    }
    return {path, data: btoa(text)};
  }));
}
