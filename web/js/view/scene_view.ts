/** The 3D view of a world: puts its parts together and answers what the rest of the page asks of it. */
import {Vector3} from 'three';
import {hullOf} from '../convex_hull.js';
import {remembered} from '../ui/dom.js';
import {cornersOf} from './three_convert.js';
import {subtract, transform} from '../pose.js';
import {Actors} from './actors.js';
import {Batches} from './batches.js';
import {BoxSelect} from './box_select.js';
import {CameraRig, savedConfiguration} from './camera_rig.js';
import {FaceSnap} from './face_snap.js';
import {hiddenFrom} from './first_look.js';
import {Forces} from './force_arrows.js';
import {Lights} from './light_views.js';
import {mountLookSwitch} from './look_switch.js';
import {Manipulator} from './manipulator.js';
import {Materials} from './materials.js';
import {Measure} from './measure.js';
import {Meshes} from './mesh_files.js';
import {Models} from './model_views.js';
import {Overlays} from './overlays.js';
import {OrientationCube} from './orientation_cube.js';
import {PeopleMarks} from './people_marks.js';
import {Picker} from './picking.js';
import {Placer} from './insert_ghost.js';
import {PivotMark} from './markers.js';
import {Pointer} from './pointer.js';
import {Preview} from './preview_model.js';
import {counted, readout} from './readouts.js';
import {SelectionBoxes} from './selection_boxes.js';
import {Selector} from './selector.js';
import {Stage} from './stage.js';
import {Surroundings} from './environment.js';
import {Gallery} from './thumbnails.js';
import {TopicMarks} from './topic_marks.js';
import type {Outcome, ShownWrench} from '../actions.js';
import type {Pose7} from '../pose.js';
import type {Turned} from './force_arrows.js';
import type {ViewOptions} from './view.js';

/**
 * Lets menus, fields and panels be seen before the next slow picture.
 * @param element  the view's
 * @param signal  ends it
 */
function giveWayTo(element: HTMLElement, stage: Stage, signal: AbortSignal) {
  const hands: [string, 'press'|'move'][] = [['pointerdown', 'press'], ['pointerup', 'press'],
      ['keydown', 'press'],
    ['input', 'press'], ['wheel', 'move'], ['pointermove', 'move']];
  for (const [type, hand] of hands) {
    window.addEventListener(type, ({target}) => {
      if (!(target instanceof Node && element.contains(target))) stage.giveWay(hand);
    }, {capture: true, passive: true, signal});
  }
}

export class SceneView {
  available = true;
  rig;
  placer;
  #store;
  #stage;
  #stock;
  #gallery;
  #models;
  #lights;
  #manipulator;
  #forces;
  #boxes;
  #overlays;
  #actors;
  #surroundings;
  #marks;
  #people;
  #measure;
  #snap;
  #cube;
  #readout;
  #preview;
  /** Names of the models that are shown elsewhere. */
  #shifted: string[] = [];
  #pictured = false;
  #ended = new AbortController();

  constructor(element: HTMLElement, {store, actions, connection, watches, topics,
      resolveUrl}: ViewOptions) {
    this.#store = store;
    const stage = new Stage(element);
    this.#stage = stage;
    const meshes = new Meshes((message) =>
      store.addIssue({severity: 'warning', code: 'resource', message}), resolveUrl);
    // Before the models are built again.
    store.listen('overlays', () => meshes.simplify(store.overlays.scene.simplifiedMeshes));
    meshes.onArrived = () => stage.invalidate();
    meshes.onCount = counted((done, of, text) => store.emit('loading', {
      title: 'Loading meshes and textures', text, done, of}));
    const materials = new Materials(meshes.manager);
    const stock = {meshes, materials};
    this.#gallery = new Gallery(stage, connection);
    const batches = new Batches(stage.scene, {merging: stage.software});
    const models = new Models({store, batches, stock, stage});
    const lights = new Lights({stage, store});
    const rig = new CameraRig({stage, store, models});
    models.unitAt = (pose) => rig.unitAt([pose[0], pose[1], pose[2]]);
    const picker = new Picker(stage);
    const shared = {store, actions, connection, watches, stage, stock, batches, models, lights, rig,
      picker};
    rig.hiddenFrom = (eye) => hiddenFrom(eye, shared);
    this.#stock = stock;
    this.#models = models;
    this.#lights = lights;
    this.rig = rig;
    this.#surroundings = new Surroundings({stage, store, materials});
    this.#actors = new Actors(shared);
    this.#overlays = new Overlays(shared);
    this.#marks = new TopicMarks({...shared, topics});
    this.#boxes = new SelectionBoxes(shared);
    this.#people = new PeopleMarks(shared);
    this.#manipulator = new Manipulator(shared);
    this.#forces = new Forces(shared);
    this.#snap = new FaceSnap(shared);
    const selector = new Selector(shared);
    this.#measure = new Measure({...shared, selector});
    this.#cube = new OrientationCube(element, actions);
    this.#readout = readout(element);
    mountLookSwitch(element, {store, actions});
    this.#preview = new Preview(shared);
    this.placer = new Placer(shared);
    new Pointer({...shared, manipulator: this.#manipulator,
      placer: this.placer, faceSnap: this.#snap, forces: this.#forces,
      selector, measure: this.#measure, pivotMark: new PivotMark(shared),
      boxSelect: new BoxSelect(element, store, (name) =>
        // The box never selects the ground.
        (this.footprint(name) ? this.pixelOf(name) : null))}, this.#ended.signal);
    this.#connect(batches);
    giveWayTo(element, stage, this.#ended.signal);
    actions.attachView(this);
    const kept = savedConfiguration();
    Object.assign(store.overlays.scene, {simplifiedMeshes: stage.software}, kept?.overlays);
    meshes.simplify(store.overlays.scene.simplifiedMeshes);
    this.rig.apply();
    // The world may have come while the view's modules were on their way.
    if (store.document) store.emit('document');
  }

  /** Names of the topics that are drawn, for tests. */
  get drawnTopics() { return this.#marks.drawn; }

  /** Where the boxes round what is selected are, for tests. */
  get selectionBoxes() { return this.#boxes.places; }

  /** How many marks of contacts are seen, for tests. */
  get contactMarks() { return this.#overlays.contacts; }

  /** Names of what others hold or have selected, for tests. */
  get sharedMarks() { return this.#people.shown; }

  /** Meshes and textures that are on their way. */
  get waiting() { return this.#stock.meshes.waiting; }

  /** Triangles of all mesh files, for tests. */
  get meshTriangles() { return this.#stock.meshes.triangles; }

  /** Pictures drawn since the page began, for the benchmark. */
  get pictures() { return this.#stage.pictures; }

  /** Triangles of the last picture, with those of its new shadows, for the benchmark. */
  get drawnTriangles() { return this.#stage.renderer.info.render.triangles; }

  /** Pictures drawn in the last second. */
  get fps() { return this.#stage.fps; }

  dispose() {
    this.#actors.dispose();
    this.#ended.abort();
    this.#stage.dispose();
  }

  #connect(batches: Batches) {
    this.#models.onArrived = () => this.rig.frameAll();
    this.#models.onMoved = (ids) => {
      this.rig.follow();
      this.#boxes.follow(ids);
      this.#overlays.follow(ids);
      this.#marks.follow(ids);
      this.#people.follow(ids);
      this.#snap.follow();
      if (!this.#manipulator.dragging) this.#manipulator.update();
    };
    this.#manipulator.onMoved = () => this.#boxes.update();
    this.#manipulator.onNumbers = (text) => this.#readout(text);
    this.rig.onMoved = () => {
      this.#manipulator.update();
      this.#measure.follow();
      this.#cube.update(this.rig.view);
    };
    this.#stage.onResize = () => this.rig.apply();
    this.#stage.onQuality = (full) => this.#lights.soften(full);
    this.#stage.onBeforeDraw = (now, full) => {
      this.#markFirstPicture();
      this.#models.catchUp();
      this.#boxes.catchUp();
      if (batches.prepare(!full)) this.#stage.owe();
      const moving = this.rig.advance(now);
      this.#forces.update();
      this.#coverWithShadow();
      return moving;
    };
  }

  /** For the benchmark: when the world could be seen, since the page was asked for. */
  #markFirstPicture() {
    if (!this.#store.document || this.#pictured) return;
    this.#pictured = true;
    performance.mark('first-picture');
  }

  /** Far-away lights throw shadows about the middle of the picture. */
  #coverWithShadow() {
    const {position} = this.rig.view;
    const [, , height] = position;
    const ahead = subtract(this.rig.ahead, position).map((part) => part / 10);
    const down = -ahead[2];
    const distance = this.rig.orthographic ? 10
      : Math.min(down > 0.05 && height > 0 ? height / down : 15, 40);
    const centre = position.map((part, index) => part + ahead[index] * distance);
    this.#lights.cover(centre, Math.max(distance * 1.3, 2));
    this.#surroundings.cover(centre, this.rig.orthographic
      ? Math.max(distance, this.#stage.width / this.rig.zoomLevel) : distance);
  }

  // ---- what actions ask

  /** Where the camera is. */
  get camera() { return this.rig.view; }

  /** What the measure tool says, for tests. */
  get measured() { return this.#measure.texts; }

  viewFrom(side: string) {
    const centres = this.#store.selection.flatMap((name) => {
      const centre = this.#centre(name);
      return centre ? [centre] : [];
    });
    const centre = centres.length
      ? [0, 1, 2].map((i) => centres.reduce((sum, one) => sum + one[i], 0) / centres.length)
      : [0, 0, 0];
    this.rig.flyToSide(side, centre);
  }

  moveTo(name: string) {
    const box = this.#models.bounds(name);
    const pose = this.#models.shownPose(name);
    if (box) this.rig.flyTo(box);
    else if (pose) this.rig.flyNear(pose.slice(0, 3));
  }

  #centre(name: string) {
    const bounds = this.bounds(name);
    if (bounds) return bounds.min.map((part, index) => (part + bounds.max[index]) / 2);
    return this.#models.shownPose(name)?.slice(0, 3) ?? null;
  }

  /** @returns in world axes, m */
  bounds(name: string): {min: number[], max: number[]}|null {
    const box = this.#models.bounds(name);
    return box && cornersOf(box);
  }

  /** The outline of a model on the ground, m; null for planes and for what is not drawn. */
  footprint(name: string) {
    const pose = this.#models.shownPose(name);
    const box = pose && this.#models.bounds(name, pose);
    const model = this.#store.model(name);
    const isPlane = model?.links.every(({visuals}) =>
      visuals.every(({geometry}) => geometry.type === 'plane'));
    if (!pose || !box || isPlane) return null;
    const corners = [box.min.x, box.max.x].flatMap((x) => [box.min.y, box.max.y].flatMap((y) =>
      [box.min.z, box.max.z].map((z) => transform(pose, [x, y, z]).slice(0, 2))));
    return hullOf(corners);
  }

  /** Where the middle of an entity is in the page, px, for tests. */
  pixelOf(name: string): number[]|null {
    const centre = this.#centre(name);
    if (!centre) return null;
    const {camera, canvas} = this.#stage;
    const at = new Vector3().fromArray(centre).project(camera);
    const box = canvas.getBoundingClientRect();
    return [box.left + (at.x + 1) / 2 * box.width, box.top + (1 - at.y) / 2 * box.height];
  }

  /** Shows models elsewhere without moving them; null ends that. */
  setPreviewPoses(poses: Record<string, Pose7>|null) {
    this.#models.release(this.#shifted);
    this.#shifted = Object.keys(poses ?? {});
    if (poses) this.#models.hold(poses);
  }

  /** Shows models elsewhere until the simulator has answered. */
  carry(poses: Record<string, Pose7>, asked: Promise<Outcome>) {
    this.setPreviewPoses(null);
    return this.#models.carry(poses, asked);
  }

  /** Remembers camera and overlays for worlds that have no camera of their own. */
  saveConfiguration() {
    const {projection, controller} = this.#store.camera;
    remembered.set('configuration', {...this.rig.view, projection, controller,
      overlays: this.#store.overlays.scene});
  }

  resetConfiguration() {
    remembered.set('configuration', null);
  }

  cancelDrag() {
    return this.#manipulator.cancel();
  }

  showForce(wrench: ShownWrench|null, onTurned?: (turned: Turned) => void) {
    this.#forces.show(wrench, onTurned);
  }

  /** @returns PNG of the view as it is */
  picture(): Promise<Blob|null> {
    return this.#stage.picture();
  }

  /** The link of the preview under a point of the page. */
  previewPick(clientX: number, clientY: number): {link: string}|null {
    return this.#preview.pick(clientX, clientY);
  }

  /** Draws the next frame although nothing has changed. */
  redraw() {
    this.#stage.invalidate();
  }

  /**
   * A small picture of a library model.
   * @param uri  of the model
   * @param address  where the picture is kept
   */
  thumbnail(uri: string, address?: string) {
    return this.#gallery.thumbnail(uri, address);
  }
}
