/**
 * The messages between page and simulator. Written by tools/protocol_module.mjs from
 * web/protocol.json: edit that file, not this one.
 */

/** Grows when page and server no longer understand each other. */
export const PROTOCOL_VERSION = 1;

/** Sizes in bytes, rates in Hz. */
export const LIMITS = Object.freeze({
  request_bytes: 33554432, upload_bytes: 67108864, frames_hz: 30, drags_hz: 30, stats_hz: 5,
  watch_hz: 20, view_hz: 15
});

/** The kinds of binary frames. */
export const FRAME_KINDS = Object.freeze({poses: 1, log: 2, topic: 3});

/** Offsets of the fields of a frame's head, in bytes; little endian. */
export const FRAME_HEAD = Object.freeze({
  kind: 0, revision: 4, step: 8, sim_time: 16, real_time: 24, count: 32, zero: 36
});

export const FRAME_HEAD_BYTES = 40;

/** Offsets of the fields of a link's record, in bytes. */
export const FRAME_RECORD = Object.freeze({
  id: 0, px: 4, py: 8, pz: 12, qx: 16, qy: 20, qz: 24, qw: 28
});

export const FRAME_RECORD_BYTES = 32;

/** @typedef {number[]} vec2 */

/** @typedef {number[]} vec3 */

/** @typedef {number[]} color */

/** @typedef {number[]} pose */

/** @typedef {'error'|'warning'|'note'} severity */

/** @typedef {{
 *  severity: severity, code: string, message: string, file: string, line: number, xpath: string,
 *  hint: string
 *}} Issue */

/** @typedef {{
 *  xyz: vec3, lower: number, upper: number, effort: number, velocity: number, damping: number,
 *  friction: number, spring_reference: number, spring_stiffness: number, motor_rate: number,
 *  mimic?: Mimic|null
 *}} Axis */

/** @typedef {{joint: string, multiplier: number, offset: number}} Mimic */

/** @typedef {{
 *  name: string, type: string, parent: string, child: string, pose: pose, axis?: Axis|null,
 *  axis2?: Axis|null, thread_pitch: number, gearbox_ratio: number, gearbox_reference: string,
 *  sensors: Sensor[]
 *}} Joint */

/** @typedef {{url?: string|null, pattern?: string|null, scale: vec2}} Texture */

/** @typedef {{
 *  ambient?: color|null, diffuse?: color|null, specular?: color|null, emissive?: color|null,
 *  name: string, texture?: Texture|null, transparency: number, lighting: boolean,
 *  alpha_test?: number|null, blended?: boolean|null
 *}} Material */

/** @typedef {'box'|'sphere'|'cylinder'|'capsule'|'cone'|'ellipsoid'} SolidShape */

/** @typedef {{type: 'box', size: vec3}} Box */

/** @typedef {{type: 'sphere', radius: number}} Sphere */

/** @typedef {{type: 'cylinder', radius: number, length: number}} Cylinder */

/** @typedef {{type: 'capsule', radius: number, length: number}} Capsule */

/** @typedef {{type: 'cone', radius: number, length: number}} Cone */

/** @typedef {{type: 'ellipsoid', radii: vec3}} Ellipsoid */

/** @typedef {{type: 'plane', normal: vec3, size: vec2}} Plane */

/** @typedef {{
 *  type: 'mesh', uri: string, scale: vec3, submesh: string, center: boolean, url?: string|null,
 *  format?: string|null, problem?: string|null, fallback?: string|null
 *}} Mesh */

/** @typedef {{
 *  type: 'heightmap', uri: string, size: vec3, position: vec3, sampling: number,
 *  layers: TerrainLayer[], url?: string|null, format?: string|null
 *}} Heightmap */

/** @typedef {{
 *  url?: string|null, pattern?: string|null, normal_url?: string|null, size: number,
 *  min_height: number, fade_dist: number
 *}} TerrainLayer */

/** @typedef {{
 *  type: 'polyline', loops: vec2[][], height: number, url?: string|null, format?: string|null
 *}} Polyline */

/** @typedef {{
 *  type: 'image', uri: string, scale: number, threshold: number, height: number,
 *  granularity: number, url?: string|null, format?: string|null
 *}} ImageMap */

/** @typedef {{type: 'empty'}} Empty */

/** @typedef {Box|Sphere|Cylinder|Capsule|Cone|Ellipsoid|Plane|Mesh|Heightmap|Polyline|ImageMap|Empty} Geometry */

/** @typedef {{
 *  mass: number, pose: pose, ixx: number, ixy: number, ixz: number, iyy: number, iyz: number,
 *  izz: number
 *}} Inertial */

/** @typedef {{
 *  mu: number, mu2: number, fdir1: vec3, slip1: number, slip2: number, torsion: number,
 *  patch_radius: number, surface_radius: number, use_patch_radius: boolean, restitution: number,
 *  bounce_threshold: number, kp: number, kd: number, max_vel: number, min_depth: number,
 *  collide_without_contact: boolean, collide_bitmask: number
 *}} Surface */

/** @typedef {{
 *  name: string, pose: pose, geometry: Geometry, surface: Surface, max_contacts: number,
 *  laser_retro: number
 *}} Collision */

/** @typedef {{
 *  name: string, pose: pose, geometry: Geometry, material?: Material|null,
 *  cast_shadows: boolean, transparency: number, laser_retro: number, layer?: number|null
 *}} Visual */

/** @typedef {{
 *  id: number, name: string, pose: pose, inertial: Inertial, gravity: boolean,
 *  kinematic: boolean, self_collide?: boolean|null, linear_decay: number, angular_decay: number,
 *  collisions: Collision[], visuals: Visual[], sensors: Sensor[]
 *}} Link */

/** @typedef {{
 *  path: string, kind: 'flag'|'integer'|'number'|'text'|'vector'|'pose', value: unknown
 *}} SensorParameter */

/** @typedef {{name: string, type: string, parameters: SensorParameter[]}} Sensor */

/** @typedef {{name: string, filename: string, xml: string}} Plugin */

/** @typedef {{
 *  name: string, pose: pose, static: boolean, self_collide: boolean,
 *  allow_auto_disable: boolean, enable_wind: boolean, canonical_link: string, links: Link[],
 *  joints: Joint[], plugins: Plugin[], uri: string, scalable: boolean, group: string
 *}} Model */

/** @typedef {{
 *  name: string, type: 'point'|'directional'|'spot', pose: pose, cast_shadows: boolean,
 *  diffuse: color, specular: color, range: number, constant: number, linear: number,
 *  quadratic: number, direction: vec3, inner_angle: number, outer_angle: number,
 *  falloff: number
 *}} Light */

/** @typedef {{time: number, pose: pose}} Waypoint */

/** @typedef {{
 *  id: number, type: string, tension: number, waypoints: Waypoint[]
 *}} Trajectory */

/** @typedef {{
 *  name: string, filename: string, interpolate_x: boolean, geometry: Geometry
 *}} Animation */

/** @typedef {{
 *  name: string, pose: pose, skin: string, geometry: Geometry, animations: Animation[],
 *  loop: boolean, delay_start: number, auto_start: boolean, trajectories: Trajectory[]
 *}} Actor */

/** @typedef {{
 *  name: string, width: number, points: vec3[], material?: Material|null
 *}} Road */

/** @typedef {{
 *  auto_disable_bodies: boolean, precon_iters: number, iters: number, sor: number,
 *  rms_error_tol: number, cfm: number, erp: number, contact_surface_layer: number,
 *  friction_model: string, contact_max_correcting_vel: number, max_contacts: number
 *}} OdePhysics */

/** @typedef {{
 *  name: string, type: string, max_step_size: number, real_time_factor: number,
 *  real_time_update_rate: number, ode: OdePhysics
 *}} Physics */

/** @typedef {{
 *  time: number, sunrise: number, sunset: number, cloud_speed: number, cloud_direction: number,
 *  cloud_humidity: number, cloud_mean_size: number, cloud_ambient: color
 *}} Sky */

/** @typedef {{
 *  type: string, color: color, start: number, end: number, density: number
 *}} Fog */

/** @typedef {{
 *  ambient: color, background: color, shadows: boolean, grid: boolean, origin_visual: boolean,
 *  sky?: Sky|null, fog?: Fog|null
 *}} Scene */

/** @typedef {{
 *  name: string, pose: pose, view_controller: string, projection_type: string, track: string,
 *  track_min_dist: number, track_max_dist: number, track_static: boolean,
 *  track_use_model_frame: boolean, track_xyz: vec3, track_inherit_yaw: boolean
 *}} GuiCamera */

/** @typedef {{linear_velocity: vec3}} Wind */

/** @typedef {{
 *  type: string, temperature: number, pressure: number, temperature_gradient: number
 *}} Atmosphere */

/** @typedef {{
 *  surface_model: string, world_frame_orientation: string, latitude_deg: number,
 *  longitude_deg: number, elevation: number, heading_deg: number
 *}} SphericalCoordinates */

/** @typedef {{
 *  name: string, file: string, gravity: vec3, magnetic_field: vec3, physics: Physics,
 *  scene: Scene, gui_camera?: GuiCamera|null, wind: Wind, atmosphere: Atmosphere,
 *  spherical_coordinates?: SphericalCoordinates|null, plugins: Plugin[], models: Model[],
 *  lights: Light[], roads: Road[], actors: Actor[]
 *}} World */

/** @typedef {{
 *  name: string, title: string, kind: 'number'|'text'|'flag', default: unknown, unit: string,
 *  minimum: number, maximum: number
 *}} TemplateParameter */

/** @typedef {{
 *  name: string, title: string, description: string, parameters: TemplateParameter[]
 *}} Template */

/** @typedef {{
 *  uri: string, name: string, title: string, description: string, thumb: string
 *}} LibraryModel */

/** @typedef {{path: string, data: string}} ImportFile */

/** @typedef {{
 *  id: string, title: string, kind: 'built-in'|'home'|'environment'|'added'|'fuel'|'remote',
 *  path: string, models: LibraryModel[], problem?: string|null
 *}} Location */

/** @typedef {{name: string, path: string}} Folder */

/** @typedef {{
 *  name: string, path: string, size: number, modified: number
 *}} File */

/** @typedef {{state: boolean, launched: boolean}} SaveChoices */

/** @typedef {{
 *  name: string, file: string, time: number, discarded: boolean
 *}} Recoverable */

/** @typedef {{name: string, bytes: number, modified: number}} LogFile */

/** @typedef {{
 *  a: string, b: string, position: vec3, normal: vec3, depth: number, force: number
 *}} Contact */

/** @typedef {{
 *  id: number, start: vec2, end: vec2, thickness: number, height: number, color: string,
 *  texture: string
 *}} Wall */

/** @typedef {{
 *  id: number, width: number, height: number, elevation: number, depth: number,
 *  wall?: number|null, along: number, position: vec2, yaw: number
 *}} Opening */

/** @typedef {{
 *  id: number, position: vec2, yaw: number, width: number, depth: number, height: number,
 *  steps: number, color: string, texture: string
 *}} Stairs */

/** @typedef {{
 *  id: number, outline: vec2[], holes: vec2[][], thickness: number, color: string,
 *  texture: string, fit: 'none'|'walls'
 *}} Floor */

/** @typedef {{file: string, resolution: number, data: string}} FloorImage */

/** @typedef {{
 *  name: string, height: number, walls: Wall[], windows: Opening[], doors: Opening[],
 *  stairs: Stairs[], floors: Floor[], image?: FloorImage|null
 *}} Level */

/** @typedef {{
 *  kind: 'flat'|'gable', thickness: number, overhang: number, pitch: number, color: string,
 *  texture: string
 *}} Roof */

/** @typedef {{
 *  wall: number, window: number, door: number, stairs: number, floor: number
 *}} PlanCounters */

/** @typedef {{
 *  format: number, name: string, levels: Level[], roof?: Roof|null, next: PlanCounters
 *}} Plan */

/** @typedef {{
 *  version: string, description: string, author: string, email: string
 *}} BuildingAbout */

/** @typedef {{
 *  folder?: string|null, overwrite?: boolean|null, version?: string|null,
 *  description?: string|null, author?: string|null, email?: string|null
 *}} BuildingOptions */

/** @typedef {{name: string, path: string, title: string}} Building */

/** @typedef {{link: string, pose: pose}} Mount */

/** @typedef {{
 *  name: string, type: string, publishers: number, subscribers: number, model?: string|null,
 *  mount?: Mount|null, driven?: boolean|null, hz?: number|null, bytes_per_s?: number|null
 *}} Topic */

/** @typedef {{
 *  number: number, name: string, selected: string[], held: string[]
 *}} Person */

/** @typedef {{loops: vec2[][], height: number}} Extrusion */

/** @typedef {{
 *  model: string, name: string, filename: string, state: 'waiting'|'running'|'failed'|'off',
 *  reason: string
 *}} PluginState */

/** @typedef {{parent: string, child: string, pose: pose}} Transform */

/** @typedef {{
 *  id: string, shape: string, frame: string, pose: pose, scale: vec3, color: color,
 *  points: vec3[], colors: color[], text: string, lifetime: number
 *}} Marker */

/** @typedef {{
 *  type: 'scan', angle_min: number, angle_increment: number, range_min: number,
 *  range_max: number, count: number
 *}} ScanView */

/** @typedef {{
 *  type: 'points', count: number, of: number, colored: boolean
 *}} PointsView */

/** @typedef {{
 *  type: 'image', format: string, width: number, height: number, encoding: string,
 *  near?: number|null, far?: number|null
 *}} ImageView */

/** @typedef {{
 *  type: 'odometry', child: string, pose: pose, linear: vec3, angular: vec3
 *}} OdometryView */

/** @typedef {{type: 'path', poses: pose[], line: boolean}} PathView */

/** @typedef {{
 *  type: 'range', range?: number|null, range_min: number, range_max: number,
 *  field_of_view: number
 *}} RangeView */

/** @typedef {{type: 'transforms', transforms: Transform[]}} TransformsView */

/** @typedef {{type: 'markers', markers: Marker[]}} MarkersView */

/** @typedef {{type: 'contacts', positions: vec3[], normals: vec3[]}} ContactsView */

/** @typedef {{
 *  type: 'map', width: number, height: number, resolution: number, pose: pose
 *}} MapView */

/** @typedef {{type: 'text', text: string}} TextView */

/** @typedef {ScanView|PointsView|ImageView|OdometryView|PathView|RangeView|TransformsView|MarkersView|
 *  ContactsView|MapView|TextView} View */

/** @typedef {{topic: string, frame: string, stamp: number, view: View}} TopicHead */

/** @typedef {{p?: number|null, i?: number|null, d?: number|null}} Gains */

/** @typedef {{
 *  mode: 'force'|'position'|'velocity', value: number, gains?: Gains|null
 *}} Drive */

/** @typedef {{
 *  name: string, axis: number, position: number, rate: number, drive?: Drive|null,
 *  default_gains?: Record<string, Gains>|null
 *}} JointState */

/** @typedef {{
 *  kind: 'insert', name?: string|null, sdf?: string|null, source?: string|null,
 *  uri?: string|null, shape?: 'box'|'sphere'|'cylinder'|null, pose?: pose|null,
 *  scale?: vec3|null
 *}} InsertOperation */

/** @typedef {{kind: 'insert_light', light: Partial<Light>}} InsertLightOperation */

/** @typedef {{kind: 'delete', names: string[]}} DeleteOperation */

/** @typedef {{
 *  kind: 'move', poses: Record<string, pose>, label?: string|null
 *}} MoveOperation */

/** @typedef {{kind: 'scale', name: string, scale: vec3}} ScaleOperation */

/** @typedef {{kind: 'rename', name: string, to: string}} RenameOperation */

/** @typedef {{kind: 'set', target: string, path: string, value: unknown}} SetOperation */

/** @typedef {{
 *  kind: 'paste', text: string, pose?: pose|null, name?: string|null, source?: string|null
 *}} PasteOperation */

/** @typedef {{
 *  kind: 'wrench', link: string, force: vec3, torque: vec3, point?: vec3|null,
 *  in_link_axes?: boolean|null, steps?: number|null
 *}} WrenchOperation */

/** @typedef {{kind: 'reset', what: 'time'|'poses'|'world'}} ResetOperation */

/** @typedef {{
 *  kind: 'joint', joint: string, mode: 'force'|'position'|'velocity', value: number,
 *  gains?: Gains|null
 *}} JointOperation */

/** @typedef {{
 *  kind: 'add_link', model?: string|null, shape?: SolidShape|null, uri?: string|null,
 *  polyline?: Extrusion|null, pose?: pose|null
 *}} AddLinkOperation */

/** @typedef {{
 *  kind: 'add_shape', link: string, part: 'visual'|'collision'|'both', shape?: SolidShape|null,
 *  uri?: string|null
 *}} AddShapeOperation */

/** @typedef {{kind: 'rename_link', link: string, to: string}} RenameLinkOperation */

/** @typedef {{kind: 'add_joint', model: string, joint: Partial<Joint>}} AddJointOperation */

/** @typedef {{kind: 'edit_joint', joint: string, values: Partial<Joint>}} EditJointOperation */

/** @typedef {{
 *  kind: 'add_model', model: string, uri: string, pose?: pose|null
 *}} AddModelOperation */

/** @typedef {{kind: 'set_plugins', model: string, text: string}} SetPluginsOperation */

/** @typedef {{
 *  kind: 'add_sensor', link: string, sensor: 'camera'|'laser'|'imu'
 *}} AddSensorOperation */

/** @typedef {{kind: 'set_group', names: string[], group?: string|null}} SetGroupOperation */

/** @typedef {{kind: 'remove_part', target: string}} RemovePartOperation */

/** @typedef {{
 *  kind: 'compute_inertial', target: string, density?: number|null
 *}} ComputeInertialOperation */

/** @typedef {{kind: 'group', ops: Operation[], label?: string|null}} GroupOperation */

/** @typedef {InsertOperation|InsertLightOperation|DeleteOperation|MoveOperation|ScaleOperation|
 *  RenameOperation|SetOperation|PasteOperation|WrenchOperation|ResetOperation|JointOperation|
 *  AddLinkOperation|AddShapeOperation|RenameLinkOperation|AddJointOperation|EditJointOperation|
 *  AddModelOperation|SetPluginsOperation|AddSensorOperation|SetGroupOperation|
 *  RemovePartOperation|ComputeInertialOperation|GroupOperation} Operation */

/** @typedef {{
 *  type: 'reply', id: number, ok: boolean, value?: unknown|null, issues?: Issue[]|null
 *}} ReplyPush */

/** @typedef {{type: 'world', revision: number, document: World}} WorldPush */

/** @typedef {{
 *  type: 'change', revision: number, models?: Record<string, Model|null>|null,
 *  lights?: Record<string, Light|null>|null, world?: Partial<World>|null, order?: string[]|null
 *}} ChangePush */

/** @typedef {{
 *  type: 'stats', sim_ns: number, real_ns: number, factor: number, iterations: number,
 *  paused: boolean
 *}} StatsPush */

/** @typedef {{
 *  type: 'history', undo: string[], redo: string[], undoable: number, depth: number,
 *  state: number, undo_by: string[], redo_by: string[], dirty: boolean, file: string
 *}} HistoryPush */

/** @typedef {{type: 'people', people: Person[]}} PeoplePush */

/** @typedef {{type: 'plugins', states: PluginState[]}} PluginsPush */

/** @typedef {{
 *  type: 'loading', title: string, text: string, done: number, of: number
 *}} LoadingPush */

/** @typedef {{type: 'issue', issue: Issue}} IssuePush */

/** @typedef {{type: 'library', locations: Location[]}} LibraryPush */

/** @typedef {{
 *  type: 'download', name: string, done: number, expected: number
 *}} DownloadPush */

/** @typedef {{
 *  type: 'watch', topic: string, time: number, contacts?: Contact[]|null,
 *  joints?: JointState[]|null, value?: number|null, problem?: string|null
 *}} WatchPush */

/** @typedef {{
 *  type: 'autosave', found: boolean, file: string, time: number, others: number
 *}} AutosavePush */

/** @typedef {{
 *  type: 'log', state: 'idle'|'recording'|'open'|'playing', name: string, begin: number,
 *  end: number, time: number, rate: number, contacts?: boolean|null
 *}} LogPush */

/** @typedef {{type: 'shutdown', reason: string}} ShutdownPush */

/** @typedef {ReplyPush|WorldPush|ChangePush|StatsPush|HistoryPush|PeoplePush|PluginsPush|LoadingPush|
 *  IssuePush|LibraryPush|DownloadPush|WatchPush|AutosavePush|LogPush|ShutdownPush} Push */

/** @typedef {{
 *  hello: {fields: {
 *      version: number, session?: string|null, person?: string|null, name?: string|null
 *    },
 *    reply: {
 *      session: string, version: number, app: string, number: number
 *    }},
 *  edit: {fields: {op: Operation},
 *    reply: {name?: string|null, names?: string[]|null}},
 *  copy: {fields: {names: string[]},
 *    reply: {text: string}},
 *  undo: {fields: {to?: number|null},
 *    reply: {label: string, by: string[]}},
 *  redo: {fields: {to?: number|null},
 *    reply: {label: string, by: string[]}},
 *  play: {fields: {},
 *    reply: {}},
 *  pause: {fields: {},
 *    reply: {}},
 *  step: {fields: {steps: number},
 *    reply: {step: number}},
 *  save: {fields: {
 *      path?: string|null, overwrite?: boolean|null, format?: 'full'|'includes'|null,
 *      state?: boolean|null, launched?: boolean|null, copy?: boolean|null
 *    },
 *    reply: {path: string, left_out: string[]}},
 *  open: {fields: {path: string, discard?: boolean|null},
 *    reply: {file: string}},
 *  new: {fields: {discard?: boolean|null},
 *    reply: {file: string}},
 *  folders: {fields: {path?: string|null},
 *    reply: {
 *      path: string, parent?: string|null, roots: string[], folders: Folder[], files: File[],
 *      launched: string[], chosen: SaveChoices
 *    }},
 *  new_folder: {fields: {parent: string, name: string},
 *    reply: {path: string}},
 *  autosave: {fields: {action: 'restore'|'discard'|'list', name?: string|null},
 *    reply: {file?: string|null, entries?: Recoverable[]|null}},
 *  library: {fields: {},
 *    reply: {locations: Location[]}},
 *  library_add: {fields: {path: string},
 *    reply: {locations: Location[]}},
 *  library_remove: {fields: {path: string},
 *    reply: {locations: Location[]}},
 *  import_model: {fields: {
 *      name: string, files: ImportFile[], density?: number|null, overwrite?: boolean|null
 *    },
 *    reply: {uri: string, path: string}},
 *  save_model: {fields: {
 *      model: string, name: string, overwrite?: boolean|null, about?: BuildingAbout|null
 *    },
 *    reply: {uri: string, path: string}},
 *  templates: {fields: {},
 *    reply: {templates: Template[]}},
 *  template: {fields: {name: string, values: Record<string, unknown>},
 *    reply: {sdf: string, model: Model}},
 *  library_get: {fields: {uri: string, quiet?: boolean|null},
 *    reply: {model?: Model|null, light?: Light|null}},
 *  preview: {fields: {sdf: string, source?: string|null},
 *    reply: {model?: Model|null, light?: Light|null}},
 *  watch: {fields: {topics: string[]},
 *    reply: {topics: string[]}},
 *  topics: {fields: {},
 *    reply: {available: boolean, topics: Topic[]}},
 *  topic_fields: {fields: {topic: string},
 *    reply: {fields: string[]}},
 *  drive: {fields: {model: string, linear: vec3, angular: vec3},
 *    reply: {topic: string}},
 *  log_start: {fields: {name?: string|null},
 *    reply: {name: string}},
 *  log_stop: {fields: {},
 *    reply: {name: string}},
 *  log_list: {fields: {},
 *    reply: {logs: LogFile[]}},
 *  log_open: {fields: {name: string},
 *    reply: {name: string, begin: number, end: number}},
 *  log_seek: {fields: {time: number},
 *    reply: {time: number}},
 *  log_play: {fields: {rate: number},
 *    reply: {}},
 *  log_close: {fields: {},
 *    reply: {}},
 *  building_save: {fields: {plan: Plan, name: string, options?: BuildingOptions|null},
 *    reply: {path: string, name: string, uri: string, issues: Issue[]}},
 *  building_load: {fields: {name: string},
 *    reply: {
 *      plan: Plan, path: string, issues: Issue[], about: BuildingAbout
 *    }},
 *  building_list: {fields: {},
 *    reply: Building[]},
 *  building_sdf: {fields: {plan: Plan, text?: boolean|null},
 *    reply: {model: Model, sdf: string, issues: Issue[]}}}} Requests */

/** @typedef {{
 *  drag: {names: string[], poses: pose[]},
 *  drag_end: {},
 *  presence: {name?: string|null, selected?: string[]|null},
 *  viewed: {topic: string}}} Notices */
