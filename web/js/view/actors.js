/**
 * Actors: figures that walk by sim time alone. They are seen, never touched: nothing picks them,
 * and no pose frame tells of them.
 */
import {AnimationClip, AnimationMixer, Group} from 'three';
import {ActorPath} from '../actor_path.js';
import {SimClock} from '../sim_clock.js';
import {place} from './three_convert.js';

/** Milliseconds between two steps, as between pose frames. */
const PERIOD = 1000 / 30;

/** The bone that carries all others, or undefined. */
function rootBone(root) {
  const bones = [];
  root.traverse((object) => { if (object.isBone) bones.push(object); });
  return bones.find((bone) => !bone.parent.isBone);
}

/**
 * Another file's movement for the bones of this name: how they turn, not how long they are.
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

class Figure {
  group = new Group();
  path;
  #actor;
  #gait = null;
  #shown = null;

  constructor(actor) {
    this.#actor = actor;
    this.path = new ActorPath(actor);
    this.group.name = actor.name;
    this.group.scale.set(...(actor.geometry.scale ?? [1, 1, 1]));
  }

  get moves() {
    return this.path.moves || this.#gait !== null;
  }

  /**
   * The file that its first animation is in, when that is not the skin's own.
   * @returns {any} a geometry or null
   */
  get foreign() {
    const [animation] = this.#actor.animations;
    return animation?.geometry.url && animation.geometry.url !== this.#actor.geometry.url
      ? animation.geometry : null;
  }

  /**
   * Gives it its body.
   * @param {import('three').Object3D} skin  a file's scene
   * @param {import('three').Object3D|null} mover  the scene of the file in `foreign`
   */
  dress(skin, mover) {
    const [clip] = (this.foreign ? mover?.animations : skin.animations) ?? [];
    const own = clip && this.foreign ? borrowed(clip, mover, skin) : clip;
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
    if (stride !== null) this.#gait.show(stride);
    return true;
  }
}

export class Actors {
  #stage;
  #store;
  #meshes;
  #clock = new SimClock();
  #figures = [];
  #known = '';
  #replaying = false;
  #timer = null;
  #told = new Set();

  constructor({stage, store, stock}) {
    this.#stage = stage;
    this.#store = store;
    this.#meshes = stock.meshes;
    store.addEventListener('document', () => this.#build());
    store.addEventListener('stats', () => { if (!this.#replaying) this.#tellLive(); });
    store.addEventListener('log', ({detail}) => this.#tellLog(detail));
    this.#tellLive();
  }

  dispose() {
    clearTimeout(this.#timer);
    this.#timer = null;
    this.#figures = [];
  }

  #tellLive() {
    const {sim_ns: sim, factor, paused} = this.#store.stats;
    this.#tell(sim / 1e9, paused ? 0 : factor);
  }

  #tellLog({state, time, rate}) {
    const before = this.#replaying;
    this.#replaying = state === 'open' || state === 'playing';
    if (this.#replaying) this.#tell(time, state === 'playing' ? rate : 0);
    else if (before) this.#tellLive();
  }

  #tell(time, rate) {
    this.#clock.tell(time, rate, performance.now());
    this.#step();
  }

  #build() {
    const {actors} = this.#store.document;
    const text = JSON.stringify(actors);
    if (text === this.#known) return;
    this.#known = text;
    this.#stage.scene.remove(...this.#figures.map(({group}) => group));
    this.#figures = actors.map((actor) => this.#made(actor));
    this.#step();
    this.#stage.shadowsChanged();
  }

  #made(actor) {
    const figure = new Figure(actor);
    const {url, problem} = actor.geometry;
    if (problem) this.#tellOnce(`The actor ${actor.name} has no skin to show: ${problem}`);
    if (url) {
      Promise.all([this.#meshes.figure(actor.geometry),
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

  #tellOnce(message) {
    if (this.#told.has(message)) return;
    this.#told.add(message);
    this.#store.addIssue({severity: 'warning', code: 'resource', message});
  }

  /** Shows all where they are now, and comes back while time goes on. */
  #step() {
    clearTimeout(this.#timer);
    this.#timer = null;
    const now = performance.now();
    const time = this.#clock.at(now);
    const changed = this.#figures.filter((figure) => figure.show(time));
    if (changed.length) this.#stage.shadowsChanged();
    if (this.#clock.runs(now) && this.#figures.some(({moves}) => moves)) {
      this.#timer = setTimeout(() => this.#step(), PERIOD);
    }
  }
}
