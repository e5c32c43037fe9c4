/** ROS messages in the scene, each where its frame is, moving with the link that carries it. */
import {Group, InstancedMesh, Line, Matrix4, Mesh, Points, Texture} from 'three';
import {compose, inverse} from '../pose.js';
import {SimClock} from '../sim_clock.js';
import {isOver} from '../topics/marker_lives.js';
import {matrixOf, place} from './three_convert.js';
import {
  contactsShape, frameShape, mapShape, markerShape, pathShape, pointsShape, rangeShape, scanShape,
  TOPIC_COLORS, trailShape,
} from './topic_shapes.js';
import {ViewPart} from './view_part.js';
import type {Object3D} from 'three';
import type {FramePlace} from '../topics/frame_places.js';
import type {Life} from '../topics/marker_lives.js';
import type {Marker, OdometryView} from '../protocol.js';
import type {Pose7, Vec3} from '../pose.js';
import type {ViewParts} from './view.js';
import type {Topics, TopicView} from '../topics/topics.js';

/** Points of a trail, and how far apart they are at least, m. */
const TRAIL = 4000;
const STEP = 0.01;
/** Distance between two poses, m, above which the odometry was reset. */
const JUMP = 1;
const FRAME_SIZE = 0.15;

/** A shape at a frame; the place of a frame that is still unknown is null. */
type Part = {group: Group, frame: string|null, place: FramePlace|null, life: Life|null};

/** What is drawn of a topic. */
class Mark {
  color;
  group = new Group();
  parts: Part[] = [];
  trail: Vec3[] = [];
  /** The odometry's frame in the world, since it was first seen. */
  anchor: Pose7|null = null;
  /** Stamp of the last message, s. */
  stamp = -Infinity;

  constructor(color: number) {
    this.color = color;
  }

  /** @param life  null: until the next message */
  add(shape: Object3D, frame: string|null, place: FramePlace|null = null, life: Life|null = null) {
    const group = new Group();
    group.matrixAutoUpdate = false;
    group.add(shape);
    this.group.add(group);
    this.parts.push({group, frame, place, life});
  }

  /**
   * Takes away what is over; whether there was such.
   * @param now  sim time, s
   */
  expire(now: number) {
    const over = this.parts.filter(({life}) => life && isOver(life, now));
    for (const {group} of over) {
      group.traverse(free);
      this.group.remove(group);
    }
    if (over.length) this.parts = this.parts.filter((part) => !over.includes(part));
    return over.length > 0;
  }

  clear() {
    this.group.traverse(free);
    this.group.clear();
    this.parts = [];
  }
}

/** Materials, labels and small marks are shared. */
function free(object: Object3D) {
  if (object instanceof Points || object instanceof Line || object instanceof Mesh) {
    object.geometry.dispose();
    if (object instanceof InstancedMesh) object.dispose();
    const {texture} = object.userData;
    if (texture instanceof Texture) texture.dispose();
  }
}

export class TopicMarks extends ViewPart {
  #topics;
  #marks: Map<string, Mark> = new Map();
  #count = 0;
  #clock = new SimClock();

  constructor(parts: ViewParts & {topics: Topics}) {
    super(parts);
    const {store, topics} = parts;
    this.#topics = topics;
    topics.listen('view', ({detail}) => this.#show(detail));
    topics.listen('shown', () => this.#drop());
    topics.listen('transforms', () => this.#placeAll());
    topics.listen('list', () => this.#placeAll());
    store.listen('stats', () => this.#tick());
    store.listen('document', () => {
      for (const mark of this.#marks.values()) Object.assign(mark, {trail: [], anchor: null});
      this.#placeAll();
    });
  }

  /** Names of the topics that are drawn, for tests. */
  get drawn() {
    return [...this.#marks].flatMap(([name, mark]) => (mark.parts.some(({place: found}) => found) ? [name] : []));
  }

  /**
   * Moves what links carry.
   * @param ids  null: all
   */
  follow(ids: Set<number>|null) {
    for (const {parts} of this.#marks.values()) {
      for (const part of parts) {
        const link = part.place?.link ?? null;
        if (link !== null && (!ids || ids.has(link))) this.#put(part);
      }
    }
  }

  /** Takes away markers whose time is over. */
  #tick() {
    const {sim_ns: sim, factor, paused} = this.store.stats;
    this.#clock.tell(sim / 1e9, paused ? 0 : factor, performance.now());
    const changed = [...this.#marks.values()].filter((mark) => mark.expire(sim / 1e9));
    if (changed.length) this.stage.invalidate();
  }

  #drop() {
    const shown = new Set(this.#topics.shown);
    for (const [name, mark] of this.#marks) {
      if (shown.has(name)) continue;
      mark.clear();
      this.stage.scene.remove(mark.group);
      this.#marks.delete(name);
      this.stage.invalidate();
    }
  }

  /** Puts everything where its frame is by now. */
  #placeAll() {
    for (const [topic, mark] of this.#marks) this.#placeParts(topic, mark);
    if (this.#marks.size) this.stage.invalidate();
  }

  #placeParts(topic: string, mark: Mark) {
    for (const part of mark.parts) {
      if (part.frame !== null) part.place = this.#topics.placeOf(topic, part.frame);
      this.#put(part);
    }
  }

  #show(view: TopicView) {
    const {topic, view: {type}} = view.head;
    if (type === 'image' || type === 'text' || !this.#topics.shown.includes(topic)) return;
    let mark = this.#marks.get(topic);
    if (!mark) {
      mark = new Mark(TOPIC_COLORS[this.#count++ % TOPIC_COLORS.length]);
      this.#marks.set(topic, mark);
      this.stage.scene.add(mark.group);
    }
    if (type !== 'transforms') mark.clear();
    this.#fill(mark, view);
    mark.group.traverse((object) => { object.frustumCulled = false; });
    this.#placeParts(topic, mark);
    this.stage.invalidate();
  }

  #fill(mark: Mark, {head, buffer, start}: TopicView) {
    const {topic, frame, view} = head;
    const inFrame = (shape: Object3D) => mark.add(shape, frame);
    switch (view.type) {
      case 'scan':
        return inFrame(scanShape(view, new Float32Array(buffer, start, view.count), mark.color));
      case 'points': return inFrame(pointsShape(view, buffer, start, mark.color));
      case 'range': return inFrame(rangeShape(view, mark.color));
      case 'path': return inFrame(pathShape(view, mark.color));
      case 'contacts': return inFrame(contactsShape(view));
      case 'map':
        return inFrame(mapShape(view, new Uint8Array(buffer, start, view.width * view.height)));
      case 'odometry': return this.#addTrail(mark, topic, head.stamp, view);
      case 'transforms': return this.#addFrames(mark);
      case 'markers': {
        const now = this.#clock.at(performance.now());
        return view.markers.forEach((marker) => addMarker(mark, marker, now));
      }
      default: return undefined;
    }
  }

  /**
   * Odometry is drawn from where the robot was when it was first seen, so that its drift shows.
   * @param stamp  s
   */
  #addTrail(mark: Mark, topic: string, stamp: number, {child, pose}: OdometryView) {
    const last = mark.trail.at(-1);
    const [x, y, z] = pose;
    const way = last ? Math.hypot(x - last[0], y - last[1], z - last[2]) : 0;
    if (way > JUMP || stamp < mark.stamp) Object.assign(mark, {trail: [], anchor: null});
    mark.stamp = stamp;
    mark.anchor ??= this.#anchor(topic, child, pose);
    if (!mark.anchor) return;
    if (!mark.trail.length || way > STEP) mark.trail.push([x, y, z]);
    if (mark.trail.length > TRAIL) mark.trail.shift();
    const group = new Group();
    const axes = frameShape('', FRAME_SIZE);
    place(axes, pose);
    group.add(trailShape([...mark.trail, [x, y, z]], mark.color), axes);
    mark.add(group, null, {link: null, pose: mark.anchor});
  }

  #anchor(topic: string, child: string, pose: Pose7): Pose7|null {
    const where = this.#topics.placeOf(topic, child);
    const model = this.#topics.topic(topic)?.model;
    const now = where ? this.#worldPose(where) : (model && this.store.worldPose(model)) || null;
    return now ? compose(now, inverse(pose)) : null;
  }

  #worldPose({link, pose}: FramePlace) {
    if (link === null) return pose;
    const carrier = this.store.poses.get(link);
    return carrier ? compose(carrier, pose) : null;
  }

  #addFrames(mark: Mark) {
    const there = new Set(mark.parts.map(({frame}) => frame));
    for (const frame of this.#frames()) {
      if (!there.has(frame)) mark.add(frameShape(frame, FRAME_SIZE), frame);
    }
  }

  #frames() {
    const {transforms} = this.#topics;
    return new Set([...transforms].flatMap(([child, {parent}]) => [parent, child]));
  }

  #put({group, place: where}: Part) {
    const carrier = where && where.link !== null ? this.models.linkMatrix(where.link) : null;
    group.visible = where !== null && carrier !== undefined;
    if (!where || carrier === undefined) return;
    const own = matrixOf(where.pose, new Matrix4());
    group.matrix.copy(carrier ? own.premultiply(carrier) : own);
    group.matrixWorldNeedsUpdate = true;
  }
}

/** @param now  sim time, s */
function addMarker(mark: Mark, marker: Marker, now: number) {
  const group = new Group();
  place(group, marker.pose);
  group.add(markerShape(marker));
  mark.add(group, marker.frame, null, {from: now, lifetime: marker.lifetime});
}
