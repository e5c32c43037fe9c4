/** The camera: the user's moves, flights between views, following, the two projections. */
import {Box3, Matrix4, Vector3} from 'three';
import * as views from '../camera_math.js';
import {remembered} from '../ui/dom.js';
import {add, length, scale, subtract} from '../pose.js';
import {cornersOf} from './three_convert.js';
import {readLink} from '../view_link.js';
import {isGround} from '../selected_model.js';
import {withParts} from '../parts.js';
import type {GuiCamera} from '../protocol.js';
import type {Vec3} from '../pose.js';
import type {View} from '../camera_math.js';
import type {ViewParts} from './view.js';
import type {OverlayFlag} from '../store.js';

/** What Save Configuration has kept in this browser. */
type Configuration = View & {projection: 'perspective'|'orthographic', controller: 'orbit'|'fps',
    overlays: Partial<Record<OverlayFlag, boolean>>};

export const savedConfiguration = (): Configuration|null => remembered.get('configuration', null);

const FLIGHT = 500;
/** The least distance from a light that is flown to, m. */
const NEAR = 3;
const TURN_FLIGHT = 1000;
/** Whether the user has asked the system for less motion: views then change at once. */
const calm = () => globalThis.matchMedia?.('(prefers-reduced-motion: reduce)').matches ?? false;
const WALK_SPEED = {ahead: 1, aside: 0.8};

export class CameraRig extends withParts<Pick<ViewParts, 'stage'|'store'|'models'>>() {
  view: View = views.HOME;
  /** Resolution (pixels per meter) when orthographic. */
  zoomLevel = views.ORTHOGRAPHIC_ZOOM;
  /** Called after each move. */
  onMoved = () => {};
  /** How many of the things that move are hidden by others from a place. */
  hiddenFrom: (eye: Vec3) => number = () => 0;

  #home = views.HOME;
  #flight: {from: View, to: View, began: number, duration: number}|null = null;
  #walking = {ahead: 0, aside: 0, fast: false};
  #walkSpeed = 1;
  #lastWalk = 0;
  /** Where what is followed was. */
  #followed: Vec3|null = null;
  /** File and name of the world. */
  #world: string|null = null;
  /** Models that the first view shall show, until the user has moved the camera. */
  #toFrame: string[] = [];
  /** The first view as it was set: another one is the user's. */
  #framed: View|null = null;
  #whole = new Box3();

  constructor(parts: Pick<ViewParts, 'stage'|'store'|'models'>) {
    super(parts);
    const {store} = parts;
    store.listen('document', () => this.#openWorld());
    store.listen('entity', ({detail: {kind, value}}) => {
      if (kind === 'world' && value.gui_camera) this.#takeCamera(value.gui_camera);
      if (kind === 'light') this.follow();
    });
    store.listen('camera', () => this.#applyChoices());
    this.apply();
  }

  get orthographic() { return this.store.camera.projection === 'orthographic'; }
  get fov() { return views.verticalFov(this.stage.aspect); }

  /** Metres a pixel covers at a point. */
  unitAt(point: Vec3) {
    return this.orthographic ? 1 / this.zoomLevel
      : views.metresPerPixel(this.view, point, this.fov, this.stage.height);
  }

  /** The point some 10 m ahead, for moves that have nothing under the mouse. */
  get ahead() {
    return add(this.view.position, scale(views.forward(this.view), 10));
  }

  /** Takes a view at once; a flight ends. */
  set(view: View) {
    this.#flight = null;
    this.view = view;
    this.apply();
  }

  orbit(pivot: Vec3, dx: number, dy: number,
      only: 'pitch'|'yaw'|null) { this.set(views.orbit(this.view, pivot, dx, dy, only)); }
  look(dx: number, dy: number) { this.set(views.look(this.view, dx, dy)); }
  pan(dx: number, dy: number, point: Vec3, axis: 'x'|'y'|'z'|null) { this.set(views.pan(this.view,
      dx, dy, this.unitAt(point), axis)); }

  /** Zooms to or from a point, factor < 1 towards it. */
  zoom(point: Vec3, factor: number) {
    if (!this.orthographic) {
      this.set(views.zoom(this.view, point, factor));
      return;
    }
    // The point keeps its place: the camera goes beside it in the measure of the zoom.
    const lever = subtract(point, this.view.position);
    const side = views.right(this.view);
    const top = views.up(this.view);
    const part = (axis: Vec3) => axis.reduce((sum, value, index) => sum + value * lever[index], 0);
    this.zoomLevel = Math.min(Math.max(this.zoomLevel / factor, 0.5), 20000);
    this.set({...this.view, position: add(this.view.position,
      add(scale(side, part(side) * (1 - factor)), scale(top, part(top) * (1 - factor))))});
  }

  /** Faster or slower walking, with the wheel. */
  changeWalkSpeed(factor: number) {
    this.#walkSpeed = Math.min(Math.max(this.#walkSpeed * factor, 0.05), 50);
  }

  /**
   * Starts or stops walking.
   * @param ahead  -1..1
   * @param aside  -1..1
   */
  walk(ahead: number, aside: number, fast: boolean) {
    if (!this.#walking.ahead && !this.#walking.aside) this.#lastWalk = performance.now();
    this.#walking = {ahead, aside, fast};
    if (ahead || aside) this.stage.invalidate();
  }

  /** Flies to a view. */
  fly(to: View, duration = FLIGHT) {
    if (calm()) {
      this.set(to);
      return;
    }
    this.#flight = {from: this.view, to, began: performance.now(), duration};
    this.stage.invalidate();
  }

  flyTo(box: Box3) {
    if (this.orthographic) {
      const size = Math.max(length(subtract(box.max.toArray(), box.min.toArray())), 0.2);
      this.zoomLevel = Math.min(this.stage.width, this.stage.height) / size / 1.1;
    }
    this.fly(views.framing(this.view, cornersOf(box), this.fov, this.stage.aspect));
  }

  /** Flies most of the way to a point. */
  flyTowards(point: Vec3) {
    const position = add(this.view.position, scale(subtract(point, this.view.position), 0.8));
    this.fly({...views.lookAt(this.view.position, point), position});
  }

  /** Flies near a point, and looks there from the present direction. */
  flyNear(point: Vec3) {
    const distance = Math.max(0.2 * length(subtract(point, this.view.position)), NEAR);
    this.fly({...this.view, position: subtract(point, scale(views.forward(this.view), distance))});
  }

  /**
   * @param side  or "home"
   * @param centre  what it looks at
   */
  flyToSide(side: string, centre: number[]) {
    if (side !== 'home') {
      this.fly(views.fromSide(this.view, side, centre), TURN_FLIGHT);
      return;
    }
    if (this.store.camera.following) this.store.setCamera({following: null});
    if (this.#isInside(this.#home.position)) {
      this.frame();
      return;
    }
    this.zoomLevel = views.ORTHOGRAPHIC_ZOOM;
    this.fly(this.#home, TURN_FLIGHT);
  }

  /**
   * Flies to where models or links are seen as a whole.
   * @param names  all models but grounds where none is given
   */
  frame(names: string[] = []) {
    const whole = new Box3();
    for (const name of names.length ? names : this.#standing()) {
      const box = this.models.bounds(name);
      if (box) whole.union(box);
    }
    if (!whole.isEmpty()) this.flyTo(whole);
    else if (!names.length) this.fly(this.#home);
  }

  /** Flies to where the inside of a model without a roof is seen: its walls hide little of it. */
  lookInto(name: string) {
    const box = this.models.bounds(name);
    if (box) this.fly(views.first(cornersOf(box), this.fov, this.stage.aspect, views.STEEP));
  }

  /** Gives what is looked at its present size in an orthographic view. */
  keepScale() {
    const whole = new Box3();
    for (const name of this.#standing()) whole.union(this.models.bounds(name) ?? new Box3());
    const centre = whole.getCenter(new Vector3()).toArray();
    const away = subtract(centre, this.view.position);
    const depth = views.forward(this.view).reduce((sum, part, at) => sum + part * away[at], 0);
    const point = whole.isEmpty() || depth <= 0 ? this.ahead : centre;
    this.zoomLevel = 1 / views.metresPerPixel(this.view, point, this.fov, this.stage.height);
  }

  /** Whether a point is in the box around a model. */
  #isInside(point: Vec3) {
    const at = new Vector3(...point);
    return this.#standing().some((name) => this.models.bounds(name)?.containsPoint(at));
  }

  /** Models that are no grounds. */
  #standing() {
    return (this.store.document?.models ?? []).filter((model) => !isGround(model))
      .map((model) => model.name);
  }

  /**
   * Moves on with time;
   * @returns whether it goes on moving
   */
  advance(now: number): boolean {
    let moving = false;
    if (this.#flight) {
      const {from, to, began, duration} = this.#flight;
      const part = Math.min(Math.max((now - began) / duration, 0), 1);
      this.view = views.between(from, to, part);
      if (part === 1) this.#flight = null;
      moving = part < 1;
      this.apply();
    }
    const {ahead, aside, fast} = this.#walking;
    if (ahead || aside) {
      const time = Math.min(Math.max(now - this.#lastWalk, 0), 100) / 1000;
      const metres = time * this.#walkSpeed * (fast ? 2 : 1);
      this.#lastWalk = now;
      this.view = views.walk(this.view, ahead * metres * WALK_SPEED.ahead,
        aside * metres * WALK_SPEED.aside);
      this.apply();
      moving = true;
    }
    return moving;
  }

  /** Goes with what is followed. */
  follow() {
    const name = this.store.camera.following;
    if (!name) return;
    const pose = this.models.shownPose(name);
    if (!pose) {
      this.store.setCamera({following: null});
      return;
    }
    if (this.#followed) {
      const shift = subtract(pose, this.#followed);
      if (length(shift) > 0) {
        this.view = {...this.view, position: add(this.view.position, shift)};
        this.apply();
      }
    }
    this.#followed = pose.slice(0, 3);
  }

  /** Gives the view to the three camera. */
  apply() {
    const {perspective, orthographic} = this.stage;
    const camera = this.orthographic ? orthographic : perspective;
    this.stage.camera = camera;
    const ahead = new Vector3().fromArray(views.forward(this.view));
    const side = new Vector3().fromArray(views.right(this.view));
    const top = new Vector3().fromArray(views.up(this.view));
    camera.position.fromArray(this.view.position);
    camera.quaternion.setFromRotationMatrix(new Matrix4().makeBasis(side, top, ahead.negate()));
    perspective.fov = this.fov * 180 / Math.PI;
    perspective.aspect = this.stage.aspect;
    const [halfWidth, halfHeight] = [this.stage.width / 2, this.stage.height / 2];
    Object.assign(orthographic, {left: -halfWidth, right: halfWidth, top: halfHeight,
      bottom: -halfHeight, zoom: this.zoomLevel});
    camera.updateProjectionMatrix();
    camera.updateMatrixWorld();
    this.onMoved();
    this.stage.invalidate();
  }

  /** The world's camera was edited. */
  #takeCamera(camera: GuiCamera) {
    this.#home = views.fromPose(camera.pose);
    this.fly(this.#home);
  }

  /** Looks at another world, of which the address of the page says nothing. */
  resetForNewWorld() {
    this.#world = '';
    this.#openWorld('');
  }

  /** A world that comes again, after a lost line say, is looked at as before. */
  #openWorld(address = globalThis.location?.hash ?? '') {
    if (!this.store.document) return;
    const {gui_camera: camera, file, name} = this.store.document;
    const which = JSON.stringify([file, name]);
    if (which === this.#world) {
      if (this.view === this.#framed) this.#beginWithAll();
      return;
    }
    this.#world = which;
    this.zoomLevel = views.ORTHOGRAPHIC_ZOOM;
    const kept = savedConfiguration();
    if (camera) {
      this.#toFrame = [];
      this.#home = views.fromPose(camera.pose);
      this.set(this.#home);
    } else if (kept) {
      this.#toFrame = [];
      this.#home = {position: kept.position, yaw: kept.yaw, pitch: kept.pitch};
      this.set(this.#home);
    } else this.#beginWithAll();
    const link = readLink(address);
    if (link) {
      if (link.view) {
        this.#toFrame = [];
        this.set(link.view);
      }
      this.store.select(link.selection.filter((name) => this.store.entity(name)));
    }
    this.store.setCamera({
      projection: camera ? (camera.projection_type === 'orthographic' ? 'orthographic' : 'perspective')
        : kept?.projection ?? 'perspective',
      controller: camera ? (camera.view_controller === 'fps' ? 'fps' : 'orbit') : kept?.controller ?? 'orbit',
      following: camera?.track && this.store.model(camera.track) ? camera.track : null,
    });
  }

  /**
   * A world without a camera is seen as a whole, save grounds; an empty one, and one whose actors
   * walk about, as in Gazebo.
   */
  #beginWithAll() {
    const {actors = []} = this.store.document ?? {};
    this.#toFrame = actors.length ? [] : this.#standing();
    this.#home = views.HOME;
    this.set(this.#home);
    this.#framed = this.view;
    this.#whole.makeEmpty();
    this.frameAll();
  }

  /** Shows more of the world as its meshes arrive, unless the user has begun to look round. */
  frameAll() {
    if (!this.#toFrame.length || this.view !== this.#framed) return;
    const whole = new Box3();
    for (const name of this.#toFrame) {
      const box = this.models.bounds(name);
      if (box) whole.union(box);
    }
    if (whole.isEmpty() || whole.equals(this.#whole)) return;
    this.#whole.copy(whole);
    this.#home = this.#firstLook(cornersOf(whole));
    this.set(this.#home);
    this.#framed = this.view;
  }

  /** Returns a view of a box: the flattest of some directions that hides the fewest moving things. */
  #firstLook(box: {min: Vec3, max: Vec3}) {
    const looks = views.FIRST_PITCHES.map((pitch) =>
      views.first(box, this.fov, this.stage.aspect, pitch));
    let [best] = looks;
    let fewest = Infinity;
    for (const look of looks) {
      const hidden = this.hiddenFrom(look.position);
      if (hidden < fewest) [best, fewest] = [look, hidden];
      if (!hidden) break;
    }
    return best;
  }

  #applyChoices() {
    this.#followed = null;
    this.follow();
    if (this.store.camera.controller !== 'fps') this.walk(0, 0, false);
    this.apply();
  }
}
