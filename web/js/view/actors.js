/**
 * Actors: figures that walk by sim time alone. They are seen, never touched: nothing picks them,
 * and no pose frame tells of them.
 */
import {AnimationClip, AnimationMixer, Bone, Group} from 'three';
import {ActorPath} from '../actor_path.js';
import {LIMITS} from '../protocol.js';
import {SimClock} from '../sim_clock.js';
import {sourceOf} from './mesh_files.js';
import {place} from './three_convert.js';
/** @import {Actor, LogPush} from '../protocol.js' */
/** @import {MeshSource} from './mesh_files.js' */
/** @import {Object3D} from 'three' */
/** @import {ViewParts} from './view.js' */

/** Milliseconds between two steps, as between pose frames. */
const PERIOD = 1000 / LIMITS.frames_hz;

/** The bone that carries all others, or undefined. @param {Object3D} root */
function rootBone(root) {
  /** @type {Bone[]} */
  const bones = [];
  root.traverse((object) => { if (object instanceof Bone) bones.push(object); });
  return bones.find((bone) => !(bone.parent instanceof Bone));
}

/**
 * Another file's movement for the bones of this name: how they turn, not how long they are.
 * @param {AnimationClip} clip
 * @param {Object3D} owner
 * @param {Object3D} figure
 * @returns {AnimationClip|null} null where no bone has a name in common
 */
function borrowed(clip, owner, figure) {
  const tracks = [];
  for (const track of clip.tracks) {
    const [uuid, property] = track.name.split('.');
    const {name} = owner.getObjectByProperty('uuid', uuid) ?? {};
    const bone = name && figure.getObjectByName(name);
    if (property !== 'quaternion' || !bone) continue;
    const copy = track.clone();
    copy.name = `${bone.uuid}.${property}`;
    tracks.push(copy);
  }
  return tracks.length ? new AnimationClip(clip.name, clip.duration, tracks) : null;
}

/** The movement of a skin's bones. */
class Gait {
  #mixer;
  #root;
  #onTheSpot;

  /**
   * @param {Object3D} figure
   * @param {AnimationClip} clip
   * @param {boolean} onTheSpot
   */
  constructor(figure, clip, onTheSpot) {
    this.#mixer = new AnimationMixer(figure);
    this.#mixer.clipAction(clip).play();
    this.#root = rootBone(figure);
    this.#onTheSpot = onTheSpot;
  }

  /** @param {number} time  s since the script began */
  show(time) {
    this.#mixer.setTime(time);
    // Where there is a path, it says how far the figure has come (Gazebo behaviour).
    if (this.#onTheSpot && this.#root) this.#root.position.x = 0;
  }
}

/** An actor as it is drawn. */
export class Figure {
  group = new Group();
  path;
  #actor;
  /** @type {Gait|null} */
  #gait = null;
  /** What it looks like: its pose and the time of its stride. @type {(number|null)[]|null} */
  #shown = null;

  /** @param {Actor} actor */
  constructor(actor) {
    this.#actor = actor;
    this.path = new ActorPath(actor);
    this.group.name = actor.name;
    if (actor.geometry.type === 'mesh') this.group.scale.fromArray(actor.geometry.scale);
  }

  get moves() {
    return this.path.moves || this.#gait !== null;
  }

  /**
   * The file that its first animation is in, when that is not the skin's own.
   * @returns {MeshSource|null}
   */
  get foreign() {
    const own = sourceOf(this.#actor.geometry);
    const [animation] = this.#actor.animations;
    const source = animation ? sourceOf(animation.geometry) : null;
    return source && source.url !== own?.url ? source : null;
  }

  /**
   * Gives it its body.
   * @param {import('three').Object3D} skin  a file's scene
   * @param {import('three').Object3D|null} mover  the scene of the file in `foreign`
   */
  dress(skin, mover) {
    const [clip] = (this.foreign ? mover?.animations : skin.animations) ?? [];
    const own = clip && mover && this.foreign ? borrowed(clip, mover, skin) : clip;
    if (own && this.#actor.auto_start) this.#gait = new Gait(skin, own, this.path.moves);
    this.group.add(skin);
    this.#shown = null;
  }

  /** @param {number} time  sim time, s @returns {boolean} whether it looks different now */
  show(time) {
    const pose = this.path.poseAt(time);
    const stride = this.#gait ? this.path.scriptTime(time) : null;
    const now = [...pose, stride];
    if (this.#shown?.every((value, index) => value === now[index])) return false;
    this.#shown = now;
    place(this.group, pose);
    if (stride !== null) this.#gait?.show(stride);
    return true;
  }
}

export class Actors {
  #stage;
  #store;
  #meshes;
  #clock = new SimClock();
  /** @type {Figure[]} */
  #figures = [];
  #known = '';
  #replaying = false;
  /** @type {ReturnType<typeof setTimeout>|undefined} */
  #timer;
  /** @type {Set<string>} */
  #told = new Set();

  /** @param {ViewParts} viewParts */
  constructor({stage, store, stock}) {
    this.#stage = stage;
    this.#store = store;
    this.#meshes = stock.meshes;
    store.listen('document', () => this.#build());
    store.listen('stats', () => { if (!this.#replaying) this.#tellLive(); });
    store.listen('log', ({detail}) => this.#tellLog(detail));
    this.#tellLive();
  }

  dispose() {
    clearTimeout(this.#timer);
    this.#timer = undefined;
    this.#figures = [];
  }

  #tellLive() {
    const {sim_ns: sim, factor, paused} = this.#store.stats;
    this.#tell(sim / 1e9, paused ? 0 : factor);
  }

  /** @param {LogPush} logPush */
  #tellLog({state, time, rate}) {
    const before = this.#replaying;
    this.#replaying = state === 'open' || state === 'playing';
    if (this.#replaying) this.#tell(time, state === 'playing' ? rate : 0);
    else if (before) this.#tellLive();
  }

  /** @param {number} time @param {number} rate */
  #tell(time, rate) {
    this.#clock.tell(time, rate, performance.now());
    this.#step();
  }

  #build() {
    const {actors = []} = this.#store.document ?? {};
    const text = JSON.stringify(actors);
    if (text === this.#known) return;
    this.#known = text;
    this.#stage.scene.remove(...this.#figures.map(({group}) => group));
    this.#figures = actors.map((actor) => this.#made(actor));
    this.#step();
    this.#stage.shadowsChanged();
  }

  /** @param {Actor} actor */
  #made(actor) {
    const figure = new Figure(actor);
    const source = sourceOf(actor.geometry);
    const problem = actor.geometry.type === 'mesh' ? actor.geometry.problem : null;
    if (problem) this.#tellOnce(`Actor ${actor.name}: the skin cannot be shown: ${problem}`);
    if (source) {
      Promise.all([this.#meshes.figure(source),
        figure.foreign && this.#meshes.figure(figure.foreign)]).then(([skin, mover]) => {
        if (!skin || !this.#figures.includes(figure)) return;
        figure.dress(skin, mover);
        this.#stage.scene.add(figure.group);
        this.#step();
        this.#stage.shadowsChanged();
      });
    }
    return figure;
  }

  /** @param {string} message */
  #tellOnce(message) {
    if (this.#told.has(message)) return;
    this.#told.add(message);
    this.#store.addIssue({severity: 'warning', code: 'resource', message});
  }

  /** Shows all where they are now, and comes back while time goes on. */
  #step() {
    clearTimeout(this.#timer);
    this.#timer = undefined;
    const now = performance.now();
    const time = this.#clock.at(now);
    const changed = this.#figures.filter((figure) => figure.show(time));
    if (changed.length) this.#stage.shadowsChanged();
    if (this.#clock.runs(now) && this.#figures.some(({moves}) => moves)) {
      this.#timer = setTimeout(() => this.#step(), PERIOD);
    }
  }
}
