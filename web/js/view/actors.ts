/**
 * Actors: figures whose motion depends on sim time alone. They are visible only: they cannot be
 * picked, and pose frames do not contain them.
 */
import {
  AnimationClip, AnimationMixer, Bone, Group, QuaternionKeyframeTrack, VectorKeyframeTrack,
} from 'three';
import {ActorPath} from '../actor_path.js';
import {LIMITS} from '../protocol.js';
import {SimClock} from '../sim_clock.js';
import {sourceOf} from './mesh_files.js';
import {place} from './three_convert.js';
import {ViewPart} from './view_part.js';
import type {Actor, Geometry, Pushes} from '../protocol.js';
import type {MeshSource} from './mesh_files.js';
import type {AnimationAction, Object3D} from 'three';
import type {Stride} from '../actor_path.js';
import type {ViewParts} from './view.js';

/** Milliseconds between two steps, as between pose frames. */
const PERIOD = 1000 / LIMITS.frames_hz;

/** The bone that carries all others, or undefined. */
function rootBone(root: Object3D) {
  const bones: Bone[] = [];
  root.traverse((object) => { if (object instanceof Bone) bones.push(object); });
  return bones.find((bone) => !(bone.parent instanceof Bone));
}

/** @returns those that hang on it */
const bonesBelow = (bone: Bone): Bone[] => bone.children.filter((child) => child instanceof Bone);

/** @returns it and all below, each after the one that it hangs on */
const skeletonOf = (bone: Bone): Bone[] => [bone, ...bonesBelow(bone).flatMap(skeletonOf)];

/**
 * What of a figure moves as each bone of another file. Bones are paired by their order where both
 * skeletons branch alike, whatever they are called (Gazebo behaviour), else all by their names.
 */
function paired(owner: Object3D, figure: Object3D): Map<Object3D, Object3D> {
  const [theirs, ours] = [owner, figure].map((root) => {
    const bone = rootBone(root);
    return bone ? skeletonOf(bone) : [];
  });
  if (ours.length && ours.length === theirs.length &&
      ours.every((bone, index) => bonesBelow(bone).length === bonesBelow(theirs[index]).length)) {
    return new Map(theirs.map((bone, index) => [bone, ours[index]]));
  }
  const named: Map<Object3D, Object3D> = new Map();
  owner.traverse((object) => {
    const own = object.name && figure.getObjectByName(object.name);
    if (own) named.set(object, own);
  });
  return named;
}

/**
 * Another file's movement for a figure: it places and turns the bones, as long as they are there
 * (Gazebo behaviour).
 * @param ratio  a length in the figure from one in the file
 * @returns null where it moves nothing of the figure
 */
function borrowed(clip: AnimationClip, owner: Object3D, figure: Object3D, ratio: number):
    AnimationClip|null {
  const pairs = paired(owner, figure);
  const moved = new Map(clip.tracks.map((track) => [track.name, track]));
  const tracks = [...pairs].flatMap(([bone, own]) => {
    const [place, turn] = ['position', 'quaternion'].map((name) => moved.get(`${bone.uuid}.${name}`));
    if (!place && !turn) return [];
    const places = place ? [...place.values] : bone.position.toArray();
    return [
      new VectorKeyframeTrack(`${own.uuid}.position`, place?.times ?? [0],
        places.map((value) => value * ratio)),
      new QuaternionKeyframeTrack(`${own.uuid}.quaternion`, turn?.times ?? [0],
        turn?.values ?? bone.quaternion.toArray()),
    ];
  });
  return tracks.length ? new AnimationClip(clip.name, clip.duration, tracks) : null;
}

const scaleOf = ({geometry}: {geometry: Geometry}) =>
    (geometry.type === 'mesh' ? geometry.scale[0] : 1);

/** The movements of a skin's bones, of which one goes on at a time. */
class Gaits {
  #mixer;
  #root;
  /** Where the movement has the root along x. */
  #rootX;
  #unit;
  #actions: Map<string, AnimationAction|null>;
  #current: AnimationAction|null = null;

  /**
   * @param clips  by name; of an unknown one the first
   * @param unit  m for a length in the figure
   */
  constructor(figure: Object3D, clips: Map<string, AnimationClip|null>, unit: number) {
    this.#mixer = new AnimationMixer(figure);
    this.#actions = new Map([...clips].map(([name, clip]) =>
      [name, clip && this.#mixer.clipAction(clip)]));
    this.#root = rootBone(figure);
    this.#rootX = this.#root?.position.x ?? 0;
    this.#unit = unit;
  }

  show({type, time, distance, onPath}: Stride) {
    const [first = null] = this.#actions.values();
    const action = this.#actions.has(type) ? this.#actions.get(type) ?? null : first;
    // The mixer writes only what has changed since it wrote last.
    if (this.#root) this.#root.position.x = this.#rootX;
    if (action !== this.#current) {
      this.#current?.stop();
      action?.play();
      this.#current = action;
    }
    if (action) {
      const clip = action.getClip();
      const byPath = distance === null ? null : this.#timeAt(clip, distance);
      action.time = byPath ?? (time <= clip.duration ? time : time % clip.duration || 0);
      this.#mixer.update(0);
    }
    if (!this.#root) return;
    this.#rootX = this.#root.position.x;
    // Where there is a path, it says how far the figure has come (Gazebo behaviour).
    if (onPath && action) this.#root.position.x = 0;
  }

  /**
   * Returns the time in an animation, s, at which the root has moved that far along x, m. The
   * animation restarts at its end (Gazebo behaviour). Null if the animation does not move the root
   * forward.
   */
  #timeAt(clip: AnimationClip, distance: number) {
    const track = clip.tracks.find(({name}) => name === `${this.#root?.uuid}.position`);
    if (!track) return null;
    const {times, values} = track;
    const places = [...times].map((_, n) => values[3 * n] * this.#unit);
    const last = places[places.length - 1];
    if (!(last > 0)) return null;
    const far = Math.max(distance, places[0]);
    const gone = far <= last ? far : far % last || last;
    const after = places.findIndex((place) => place >= gone);
    const before = Math.max(after - 1, 0);
    const part = after > before ? (gone - places[before]) / (places[after] - places[before]) : 0;
    return times[before] + (times[after] - times[before]) * part;
  }
}

/** An actor as it is drawn. */
export class Figure {
  group = new Group();
  path;
  #actor;
  #gaits: Gaits|null = null;
  /** What it looks like: its pose and its stride. */
  #shown: unknown[]|null = null;

  constructor(actor: Actor) {
    this.#actor = actor;
    this.path = new ActorPath(actor, new Map());
    this.group.name = actor.name;
    if (actor.geometry.type === 'mesh') this.group.scale.fromArray(actor.geometry.scale);
  }

  get moves() {
    return this.path.moves || this.#gaits !== null;
  }

  /** The file of each animation, null for the skin's own. */
  get foreign(): (MeshSource|null)[] {
    const own = sourceOf(this.#actor.geometry);
    return this.#actor.animations.map(({geometry}) => {
      const source = sourceOf(geometry);
      return source && source.url !== own?.url ? source : null;
    });
  }

  /**
   * Gives it its body.
   * @param skin  a file's scene
   * @param movers  the scenes of the files in `foreign`
   */
  dress(skin: Object3D, movers: (Object3D|null)[]) {
    const clips = this.#clips(skin, movers);
    this.path = new ActorPath(this.#actor,
      new Map([...clips].map(([name, clip]) => [name, clip?.duration ?? 0])));
    if (this.#actor.auto_start && [...clips.values()].some(Boolean)) {
      this.#gaits = new Gaits(skin, clips, skin.scale.x * scaleOf(this.#actor));
    }
    this.group.add(skin);
    this.#shown = null;
  }

  /** By name; the skin's own movement for an actor without animations. */
  #clips(skin: Object3D, movers: (Object3D|null)[]): Map<string, AnimationClip|null> {
    const own = skin.animations[0] ?? null;
    const {foreign} = this;
    if (!foreign.length) return new Map([['', own]]);
    const length = skin.scale.x * scaleOf(this.#actor);
    return new Map(this.#actor.animations.map((animation, index) => {
      const {name} = animation;
      if (!foreign[index]) return [name, own];
      const mover = movers[index];
      const clip = mover?.animations[0];
      const ratio = (mover?.scale.x ?? 1) * scaleOf(animation) / (length || 1);
      return [name, mover && clip ? borrowed(clip, mover, skin, ratio) : null];
    }));
  }

  /**
   * @param time  sim time, s
   * @returns whether it looks different now
   */
  show(time: number): boolean {
    const pose = this.path.poseAt(time);
    const stride = this.#gaits ? this.path.strideAt(time) : null;
    const now = [...pose, stride?.type, stride?.time, stride?.onPath];
    if (this.#shown?.every((value, index) => value === now[index])) return false;
    this.#shown = now;
    place(this.group, pose);
    if (stride) this.#gaits?.show(stride);
    return true;
  }
}

export class Actors extends ViewPart {
  #meshes;
  #clock = new SimClock();
  #figures: Figure[] = [];
  #known = '';
  #replaying = false;
  #timer: ReturnType<typeof setTimeout>|undefined;
  #told: Set<string> = new Set();

  constructor(parts: ViewParts) {
    super(parts);
    const {store, stock} = parts;
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
    const {sim_ns: sim, factor, paused} = this.store.stats;
    this.#tell(sim / 1e9, paused ? 0 : factor);
  }

  #tellLog({state, time, rate}: Pushes['log']) {
    const before = this.#replaying;
    this.#replaying = state === 'open' || state === 'playing';
    if (this.#replaying) this.#tell(time, state === 'playing' ? rate : 0);
    else if (before) this.#tellLive();
  }

  #tell(time: number, rate: number) {
    this.#clock.tell(time, rate, performance.now());
    this.#step();
  }

  #build() {
    const {actors = []} = this.store.document ?? {};
    const text = JSON.stringify(actors);
    if (text === this.#known) return;
    this.#known = text;
    this.stage.scene.remove(...this.#figures.map(({group}) => group));
    this.#figures = actors.map((actor) => this.#made(actor));
    this.#step();
    this.stage.shadowsChanged();
  }

  #made(actor: Actor) {
    const figure = new Figure(actor);
    const source = sourceOf(actor.geometry);
    const problem = actor.geometry.type === 'mesh' ? actor.geometry.problem : null;
    if (problem) this.#tellOnce(`Actor ${actor.name}: the skin cannot be shown: ${problem}`);
    if (source) {
      Promise.all([this.#meshes.figure(source),
        ...figure.foreign.map((file) => file && this.#meshes.figure(file))]).then(([skin, ...movers]) => {
        if (!skin || !this.#figures.includes(figure)) return;
        figure.dress(skin, movers);
        this.stage.scene.add(figure.group);
        this.#step();
        this.stage.shadowsChanged();
      });
    }
    return figure;
  }

  #tellOnce(message: string) {
    if (this.#told.has(message)) return;
    this.#told.add(message);
    this.store.addIssue({severity: 'warning', code: 'resource', message});
  }

  /** Shows all where they are now, and comes back while time goes on. */
  #step() {
    clearTimeout(this.#timer);
    this.#timer = undefined;
    const now = performance.now();
    const time = this.#clock.at(now);
    const changed = this.#figures.filter((figure) => figure.show(time));
    if (changed.length) this.stage.shadowsChanged();
    if (this.#clock.runs(now) && this.#figures.some(({moves}) => moves)) {
      this.#timer = setTimeout(() => this.#step(), PERIOD);
    }
  }
}
