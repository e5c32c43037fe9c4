/** Files and folders that were dropped on the page: read, and what they can become. */
/** @import {ImportFile} from './protocol.js' */

/** @typedef {{path: string, file: File}} DroppedFile  path: with the folder that was dropped */
/** What browsers give of a drop: folders and files, or files alone. @typedef {FileSystemEntry|File} Dropped */
/** @typedef {'text'|'world'|'model'|'mesh'} DropKind  text: an SDF or URDF that is inserted as it is */

export const MOST_BYTES = 20 * 2 ** 20;
const MOST_FILES = 500;
const MESHES = /\.(dae|stl|obj|glb)$/i;

/**
 * All files of what was dropped.
 * @param {Dropped[]} entries
 * @returns {Promise<DroppedFile[]>}
 */
export async function filesOf(entries) {
  /** @type {DroppedFile[]} */
  const found = [];
  for (const queue = [...entries]; queue.length;) {
    const entry = /** @type {Dropped} */ (queue.shift());
    if (entry instanceof File) {
      found.push({path: entry.name, file: entry});
      continue;
    }
    if (entry.name.startsWith('.')) continue;
    if (entry.isFile) {
      const own = /** @type {FileSystemFileEntry} */ (entry);
      /** @type {File} */
      const file = await new Promise((resolve, reject) => own.file(resolve, reject));
      found.push({path: entry.fullPath.replace(/^\//, ''), file});
    } else queue.push(...await listed(/** @type {FileSystemDirectoryEntry} */ (entry)));
    if (found.length > MOST_FILES) throw new Error(`More than ${MOST_FILES} files were dropped.`);
  }
  const size = found.reduce((sum, {file}) => sum + file.size, 0);
  if (size > MOST_BYTES) {
    throw new Error(`The files have ${(size / 1e6).toFixed(0)} MB; at most 20 MB can be dropped. ` +
      'Put larger models into ~/.gazebo/models.');
  }
  return found;
}

/** A reader gives a hundred entries at a time. @param {FileSystemDirectoryEntry} folder */
async function listed(folder) {
  const reader = folder.createReader();
  /** @type {FileSystemEntry[]} */
  const found = [];
  for (;;) {
    /** @type {FileSystemEntry[]} */
    const some = await new Promise((resolve, reject) => reader.readEntries(resolve, reject));
    if (!some.length) return found;
    found.push(...some);
  }
}

/**
 * What files become; null for files that are no model.
 * @param {{path: string}[]} files
 * @returns {{kind: DropKind, name: string}|null}
 */
export function kindOf(files) {
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

/**
 * The models of a world file: its sun and ground are in the world already.
 * @param {string} text
 */
export function modelsOfWorld(text) {
  const parsed = new DOMParser().parseFromString(text, 'text/xml');
  for (const element of parsed.querySelectorAll('world > light, world > include')) {
    const uri = element.querySelector('uri')?.textContent?.trim();
    if (element.tagName === 'light' || /^model:\/\/(sun|ground_plane)$/.test(uri ?? '')) element.remove();
  }
  // What is no XML goes to the simulator, which says where the fault is.
  return parsed.querySelector('parsererror') ? text : new XMLSerializer().serializeToString(parsed);
}

/** @param {string} path */
const stem = (path) => (path.split('/').pop() ?? '').replace(/\.[^.]*$/, '');

/** @param {DroppedFile[]} files @returns {Promise<ImportFile[]>} */
export function encoded(files) {
  return Promise.all(files.map(async ({path, file}) => {
    const bytes = new Uint8Array(await file.arrayBuffer());
    let text = '';
    for (let at = 0; at < bytes.length; at += 8192) {
      text += String.fromCharCode(...bytes.subarray(at, at + 8192));
    }
    return {path, data: btoa(text)};
  }));
}
