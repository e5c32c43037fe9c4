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

export type vec2 = number[];
export type vec3 = number[];
export type color = number[];
export type pose = number[];
export type severity = 'error'|'warning'|'note';

export type Issue = {
  severity: severity, code: string, message: string, file: string, line: number, xpath: string,
  hint: string
};

export type Axis = {
  xyz: vec3, lower: number, upper: number, effort: number, velocity: number, damping: number,
  friction: number, spring_reference: number, spring_stiffness: number, motor_rate: number,
  mimic?: Mimic|null
};

export type Mimic = {joint: string, multiplier: number, offset: number};

export type Joint = {
  name: string, type: string, parent: string, child: string, pose: pose, axis?: Axis|null,
  axis2?: Axis|null, thread_pitch: number, gearbox_ratio: number, gearbox_reference: string,
  sensors: Sensor[]
};

export type Texture = {url?: string|null, pattern?: string|null, scale: vec2};

export type Material = {
  ambient?: color|null, diffuse?: color|null, specular?: color|null, emissive?: color|null,
  name: string, texture?: Texture|null, transparency: number, lighting: boolean,
  alpha_test?: number|null, blended?: boolean|null
};

export type SolidShape = 'box'|'sphere'|'cylinder'|'capsule'|'cone'|'ellipsoid';
export type Box = {type: 'box', size: vec3};
export type Sphere = {type: 'sphere', radius: number};
export type Cylinder = {type: 'cylinder', radius: number, length: number};
export type Capsule = {type: 'capsule', radius: number, length: number};
export type Cone = {type: 'cone', radius: number, length: number};
export type Ellipsoid = {type: 'ellipsoid', radii: vec3};
export type Plane = {type: 'plane', normal: vec3, size: vec2};

export type Mesh = {
  type: 'mesh', uri: string, scale: vec3, submesh: string, center: boolean, url?: string|null,
  format?: string|null, problem?: string|null, fallback?: string|null
};

export type Heightmap = {
  type: 'heightmap', uri: string, size: vec3, position: vec3, sampling: number,
  layers: TerrainLayer[], url?: string|null, format?: string|null
};

export type TerrainLayer = {
  url?: string|null, pattern?: string|null, normal_url?: string|null, size: number,
  min_height: number, fade_dist: number
};

export type Polyline = {
  type: 'polyline', loops: vec2[][], height: number, url?: string|null, format?: string|null
};

export type ImageMap = {
  type: 'image', uri: string, scale: number, threshold: number, height: number,
  granularity: number, url?: string|null, format?: string|null
};

export type Empty = {type: 'empty'};
export type Geometry = Box|Sphere|Cylinder|Capsule|Cone|Ellipsoid|Plane|Mesh|Heightmap|Polyline|ImageMap|Empty;

export type Inertial = {
  mass: number, pose: pose, ixx: number, ixy: number, ixz: number, iyy: number, iyz: number,
  izz: number
};

export type Surface = {
  mu: number, mu2: number, fdir1: vec3, slip1: number, slip2: number, torsion: number,
  patch_radius: number, surface_radius: number, use_patch_radius: boolean, restitution: number,
  bounce_threshold: number, kp: number, kd: number, max_vel: number, min_depth: number,
  collide_without_contact: boolean, collide_bitmask: number
};

export type Collision = {
  name: string, pose: pose, geometry: Geometry, surface: Surface, max_contacts: number,
  laser_retro: number
};

export type Visual = {
  name: string, pose: pose, geometry: Geometry, material?: Material|null, cast_shadows: boolean,
  transparency: number, laser_retro: number, layer?: number|null, picture_size?: number|null
};

export type Link = {
  id: number, name: string, pose: pose, inertial: Inertial, gravity: boolean, kinematic: boolean,
  self_collide?: boolean|null, linear_decay: number, angular_decay: number,
  collisions: Collision[], visuals: Visual[], sensors: Sensor[]
};

export type SensorParameter = {
  path: string, kind: 'flag'|'integer'|'number'|'text'|'vector'|'pose', value: unknown
};

export type Sensor = {name: string, type: string, parameters: SensorParameter[]};
export type Plugin = {name: string, filename: string, xml: string};

export type Model = {
  name: string, pose: pose, static: boolean, self_collide: boolean, allow_auto_disable: boolean,
  enable_wind: boolean, canonical_link: string, links: Link[], joints: Joint[],
  plugins: Plugin[], uri: string, scalable: boolean, group: string
};

export type Light = {
  name: string, type: 'point'|'directional'|'spot', pose: pose, cast_shadows: boolean,
  diffuse: color, specular: color, range: number, constant: number, linear: number,
  quadratic: number, direction: vec3, inner_angle: number, outer_angle: number, falloff: number,
  group: string
};

export type Waypoint = {time: number, pose: pose};

export type Trajectory = {
  id: number, type: string, tension: number, waypoints: Waypoint[]
};

export type Animation = {
  name: string, filename: string, interpolate_x: boolean, geometry: Geometry
};

export type Actor = {
  name: string, pose: pose, skin: string, geometry: Geometry, animations: Animation[],
  loop: boolean, delay_start: number, auto_start: boolean, trajectories: Trajectory[]
};

export type Road = {
  name: string, width: number, points: vec3[], material?: Material|null
};

export type OdePhysics = {
  auto_disable_bodies: boolean, precon_iters: number, iters: number, sor: number,
  rms_error_tol: number, cfm: number, erp: number, contact_surface_layer: number,
  friction_model: string, contact_max_correcting_vel: number, max_contacts: number
};

export type Physics = {
  name: string, type: string, max_step_size: number, real_time_factor: number,
  real_time_update_rate: number, ode: OdePhysics
};

export type Sky = {
  time: number, sunrise: number, sunset: number, cloud_speed: number, cloud_direction: number,
  cloud_humidity: number, cloud_mean_size: number, cloud_ambient: color
};

export type Fog = {
  type: string, color: color, start: number, end: number, density: number
};

export type Scene = {
  ambient: color, background: color, shadows: boolean, grid: boolean, origin_visual: boolean,
  sky?: Sky|null, fog?: Fog|null
};

export type GuiCamera = {
  name: string, pose: pose, view_controller: string, projection_type: string, track: string,
  track_min_dist: number, track_max_dist: number, track_static: boolean,
  track_use_model_frame: boolean, track_xyz: vec3, track_inherit_yaw: boolean
};

export type Wind = {linear_velocity: vec3};

export type Atmosphere = {
  type: string, temperature: number, pressure: number, temperature_gradient: number
};

export type SphericalCoordinates = {
  surface_model: string, world_frame_orientation: string, latitude_deg: number,
  longitude_deg: number, elevation: number, heading_deg: number
};

export type World = {
  name: string, file: string, gravity: vec3, magnetic_field: vec3, physics: Physics,
  scene: Scene, gui_camera?: GuiCamera|null, wind: Wind, atmosphere: Atmosphere,
  spherical_coordinates?: SphericalCoordinates|null, plugins: Plugin[], models: Model[],
  lights: Light[], roads: Road[], actors: Actor[]
};

export type TemplateParameter = {
  name: string, title: string, kind: 'number'|'text'|'flag', default: unknown, unit: string,
  minimum: number, maximum: number
};

export type Template = {
  name: string, title: string, description: string, parameters: TemplateParameter[]
};

export type LibraryModel = {
  uri: string, name: string, title: string, description: string, thumb: string
};

export type ImportFile = {path: string, data: string};

export type Location = {
  id: string, title: string, kind: 'built-in'|'home'|'environment'|'added'|'fuel'|'remote',
  path: string, models: LibraryModel[], problem?: string|null
};

export type Folder = {name: string, path: string};

export type File = {
  name: string, path: string, size: number, modified: number
};

export type SaveChoices = {state: boolean, launched: boolean};

export type Recoverable = {
  name: string, file: string, time: number, discarded: boolean
};

export type LogFile = {name: string, bytes: number, modified: number};

export type Contact = {
  a: string, b: string, position: vec3, normal: vec3, depth: number, force: number
};

export type Wall = {
  id: number, start: vec2, end: vec2, thickness: number, height: number, color: string,
  texture: string
};

export type Opening = {
  id: number, width: number, height: number, elevation: number, depth: number,
  wall?: number|null, along: number, position: vec2, yaw: number
};

export type Stairs = {
  id: number, position: vec2, yaw: number, width: number, depth: number, height: number,
  steps: number, color: string, texture: string
};

export type Floor = {
  id: number, outline: vec2[], holes: vec2[][], thickness: number, color: string,
  texture: string, fit: 'none'|'walls'
};

export type FloorImage = {file: string, resolution: number, data: string};

export type Level = {
  name: string, height: number, walls: Wall[], windows: Opening[], doors: Opening[],
  stairs: Stairs[], floors: Floor[], image?: FloorImage|null
};

export type Roof = {
  kind: 'flat'|'gable', thickness: number, overhang: number, pitch: number, color: string,
  texture: string
};

export type PlanCounters = {
  wall: number, window: number, door: number, stairs: number, floor: number
};

export type Plan = {
  format: number, name: string, levels: Level[], roof?: Roof|null, next: PlanCounters
};

export type BuildingAbout = {
  version: string, description: string, author: string, email: string
};

export type BuildingOptions = {
  folder?: string|null, overwrite?: boolean|null, version?: string|null,
  description?: string|null, author?: string|null, email?: string|null
};

export type Building = {name: string, path: string, title: string};
export type Mount = {link: string, pose: pose};

export type Topic = {
  name: string, type: string, publishers: number, subscribers: number, model?: string|null,
  mount?: Mount|null, driven?: boolean|null, hz?: number|null, bytes_per_s?: number|null
};

export type Person = {
  number: number, name: string, selected: string[], held: string[]
};

export type Extrusion = {loops: vec2[][], height: number};

export type PluginParameter = {
  name: string, type: 'number'|'integer'|'flag'|'text'|'choice', default: string,
  choices: string[]
};

export type PluginState = {
  model: string, name: string, filename: string, state: 'waiting'|'running'|'failed'|'off',
  reason: string, parameters: PluginParameter[]
};

export type Transform = {parent: string, child: string, pose: pose};

export type Marker = {
  id: string, shape: string, frame: string, pose: pose, scale: vec3, color: color,
  points: vec3[], colors: color[], text: string, lifetime: number
};

export type ScanView = {
  type: 'scan', angle_min: number, angle_increment: number, range_min: number, range_max: number,
  count: number
};

export type PointsView = {
  type: 'points', count: number, of: number, colored: boolean
};

export type ImageView = {
  type: 'image', format: string, width: number, height: number, encoding: string,
  near?: number|null, far?: number|null
};

export type OdometryView = {
  type: 'odometry', child: string, pose: pose, linear: vec3, angular: vec3
};

export type PathView = {type: 'path', poses: pose[], line: boolean};

export type RangeView = {
  type: 'range', range?: number|null, range_min: number, range_max: number,
  field_of_view: number
};

export type TransformsView = {type: 'transforms', transforms: Transform[]};
export type MarkersView = {type: 'markers', markers: Marker[]};
export type ContactsView = {type: 'contacts', positions: vec3[], normals: vec3[]};

export type MapView = {
  type: 'map', width: number, height: number, resolution: number, pose: pose
};

export type TextView = {type: 'text', text: string};

export type View = ScanView|PointsView|ImageView|OdometryView|PathView|RangeView|TransformsView|MarkersView|
  ContactsView|MapView|TextView;

export type TopicHead = {topic: string, frame: string, stamp: number, view: View};
export type Gains = {p?: number|null, i?: number|null, d?: number|null};

export type Drive = {
  mode: 'force'|'position'|'velocity', value: number, gains?: Gains|null
};

export type JointState = {
  name: string, axis: number, position: number, rate: number, drive?: Drive|null,
  default_gains?: Record<string, Gains>|null
};

export type Operations = {
  insert: {
    name?: string|null, sdf?: string|null, source?: string|null, uri?: string|null,
    shape?: 'box'|'sphere'|'cylinder'|null, pose?: pose|null, scale?: vec3|null
  },
  insert_light: {light: Partial<Light>},
  delete: {names: string[]},
  move: {poses: Record<string, pose>, label?: string|null},
  scale: {name: string, scale: vec3},
  rename: {name: string, to: string},
  set: {target: string, path: string, value: unknown},
  paste: {
    text: string, poses?: pose[]|null, name?: string|null, source?: string|null
  },
  wrench: {
    link: string, force: vec3, torque: vec3, point?: vec3|null, in_link_axes?: boolean|null,
    steps?: number|null
  },
  reset: {what: 'time'|'poses'|'world'},
  joint: {
    joint: string, mode: 'force'|'position'|'velocity', value: number, gains?: Gains|null
  },
  add_link: {
    model?: string|null, shape?: SolidShape|null, uri?: string|null, polyline?: Extrusion|null,
    pose?: pose|null
  },
  add_shape: {
    link: string, part: 'visual'|'collision'|'both', shape?: SolidShape|null, uri?: string|null
  },
  copy_link: {link: string, pose: pose},
  rename_link: {link: string, to: string},
  add_joint: {model: string, joint: Partial<Joint>},
  edit_joint: {joint: string, values: Partial<Joint>},
  add_model: {model: string, uri: string, pose?: pose|null},
  set_plugins: {model: string, text: string},
  add_sensor: {link: string, sensor: 'camera'|'laser'|'imu'},
  set_group: {names: string[], group?: string|null},
  remove_part: {target: string},
  compute_inertial: {target: string, density?: number|null},
  group: {ops: Operation[], label?: string|null},
};

export type Operation = {[Name in keyof Operations]: {kind: Name} & Operations[Name]}[keyof Operations];

export type Pushes = {
  reply: {
    id: number, ok: boolean, value?: unknown|null, issues?: Issue[]|null
  },
  world: {revision: number, document: World},
  change: {
    revision: number, models?: Record<string, Model|null>|null,
    lights?: Record<string, Light|null>|null, world?: Partial<World>|null, order?: string[]|null
  },
  stats: {
    sim_ns: number, real_ns: number, factor: number, iterations: number, paused: boolean
  },
  history: {
    undo: string[], redo: string[], undoable: number, depth: number, state: number,
    undo_by: string[], redo_by: string[], dirty: boolean, file: string
  },
  people: {people: Person[]},
  plugins: {states: PluginState[]},
  loading: {title: string, text: string, done: number, of: number},
  issue: {issue: Issue, time?: number|null},
  library: {locations: Location[]},
  download: {name: string, done: number, expected: number},
  watch: {
    topic: string, time: number, contacts?: Contact[]|null, joints?: JointState[]|null,
    value?: number|null, problem?: string|null
  },
  autosave: {
    found: boolean, file: string, time: number, others: number
  },
  log: {
    state: 'idle'|'recording'|'open'|'playing', name: string, begin: number, end: number,
    time: number, rate: number, contacts?: boolean|null
  },
  shutdown: {reason: string},
};

export type Push = {[Name in keyof Pushes]: {type: Name} & Pushes[Name]}[keyof Pushes];

export type Requests = {
  hello: {fields: {
      version: number, session?: string|null, person?: string|null, name?: string|null
    },
    reply: {
      session: string, version: number, app: string, number: number, read_only: boolean
    }},
  edit: {fields: {op: Operation},
    reply: {name?: string|null, names?: string[]|null}},
  copy: {fields: {names: string[]},
    reply: {text: string}},
  undo: {fields: {to?: number|null},
    reply: {label: string, by: string[]}},
  redo: {fields: {to?: number|null},
    reply: {label: string, by: string[]}},
  play: {fields: {},
    reply: {}},
  pause: {fields: {},
    reply: {}},
  step: {fields: {steps: number},
    reply: {step: number}},
  save: {fields: {
      path?: string|null, overwrite?: boolean|null, format?: 'full'|'includes'|null,
      state?: boolean|null, launched?: boolean|null, copy?: boolean|null
    },
    reply: {path: string, left_out: string[]}},
  open: {fields: {path: string, discard?: boolean|null},
    reply: {file: string}},
  new: {fields: {discard?: boolean|null},
    reply: {file: string}},
  folders: {fields: {path?: string|null},
    reply: {
      path: string, parent?: string|null, roots: string[], folders: Folder[], files: File[],
      launched: string[], chosen: SaveChoices
    }},
  new_folder: {fields: {parent: string, name: string},
    reply: {path: string}},
  autosave: {fields: {action: 'restore'|'discard'|'list', name?: string|null},
    reply: {file?: string|null, entries?: Recoverable[]|null}},
  library: {fields: {},
    reply: {locations: Location[]}},
  library_add: {fields: {path: string},
    reply: {locations: Location[]}},
  library_remove: {fields: {path: string},
    reply: {locations: Location[]}},
  import_model: {fields: {
      name: string, files: ImportFile[], density?: number|null, overwrite?: boolean|null
    },
    reply: {uri: string, path: string}},
  save_model: {fields: {
      model: string, name: string, overwrite?: boolean|null, about?: BuildingAbout|null
    },
    reply: {uri: string, path: string}},
  templates: {fields: {},
    reply: {templates: Template[]}},
  template: {fields: {name: string, values: Record<string, unknown>},
    reply: {sdf: string, model: Model}},
  library_get: {fields: {uri: string, quiet?: boolean|null},
    reply: {model?: Model|null, light?: Light|null}},
  preview: {fields: {sdf: string, source?: string|null},
    reply: {model?: Model|null, light?: Light|null}},
  watch: {fields: {topics: string[]},
    reply: {topics: string[]}},
  topics: {fields: {},
    reply: {available: boolean, topics: Topic[]}},
  topic_fields: {fields: {topic: string},
    reply: {fields: string[]}},
  drive: {fields: {model: string, linear: vec3, angular: vec3},
    reply: {topic: string}},
  log_start: {fields: {name?: string|null},
    reply: {name: string}},
  log_stop: {fields: {},
    reply: {name: string}},
  log_list: {fields: {},
    reply: {logs: LogFile[]}},
  log_open: {fields: {name: string},
    reply: {name: string, begin: number, end: number}},
  log_seek: {fields: {time: number},
    reply: {time: number}},
  log_play: {fields: {rate: number},
    reply: {}},
  log_close: {fields: {},
    reply: {}},
  building_save: {fields: {plan: Plan, name: string, options?: BuildingOptions|null},
    reply: {path: string, name: string, uri: string, issues: Issue[]}},
  building_load: {fields: {name: string},
    reply: {
      plan: Plan, path: string, issues: Issue[], about: BuildingAbout
    }},
  building_list: {fields: {},
    reply: Building[]},
  building_sdf: {fields: {plan: Plan, text?: boolean|null},
    reply: {model: Model, sdf: string, issues: Issue[]}},
};

export type Notices = {
  drag: {names: string[], poses: pose[]},
  drag_end: {},
  presence: {name?: string|null, selected?: string[]|null},
  viewed: {topic: string},
};
