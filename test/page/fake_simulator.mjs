/**
 * A simulator small enough to be a test double: it has a document, a history and a clock that
 * stands still, and speaks the protocol over a fake web socket. Works in node and in a browser.
 */

const IDENTITY = [0, 0, 0, 0, 0, 0, 1];

/** A model of one link. */
export function box(name, pose = [0, 0, 0.5, 0, 0, 0, 1], more = {}) {
  const geometry = {type: 'box', size: [1, 1, 1]};
  return {
    name,
    pose,
    static: false,
    self_collide: false,
    allow_auto_disable: true,
    enable_wind: false,
    canonical_link: '',
    joints: [],
    plugins: [],
    uri: '',
    scalable: true,
    scale: [1, 1, 1],
    links: [
      {
        id: 0,
        name: 'link',
        pose: IDENTITY,
        gravity: true,
        kinematic: false,
        self_collide: null,
        linear_decay: 0,
        angular_decay: 0,
        inertial: {
          mass: 1,
          pose: IDENTITY,
          ixx: 1 / 6,
          ixy: 0,
          ixz: 0,
          iyy: 1 / 6,
          iyz: 0,
          izz: 1 / 6,
        },
        collisions: [
          {
            name: 'collision',
            pose: IDENTITY,
            geometry,
            max_contacts: 10,
            laser_retro: 0,
            surface: {
              mu: 1,
              mu2: 1,
              fdir1: [0, 0, 0],
              slip1: 0,
              slip2: 0,
              restitution: 0,
              bounce_threshold: 1e5,
              kp: 1e12,
              kd: 1,
              max_vel: 0.01,
              min_depth: 0,
              collide_without_contact: false,
              collide_bitmask: 65535,
            },
          },
        ],
        visuals: [
          {
            name: 'visual',
            pose: IDENTITY,
            geometry,
            cast_shadows: true,
            transparency: 0,
            laser_retro: 0,
            layer: null,
            material: {
              ambient: [0.3, 0.3, 0.3, 1],
              diffuse: [0.7, 0.7, 0.7, 1],
              specular: null,
              emissive: null,
              name: 'Gazebo/Grey',
              texture: null,
              transparency: 0,
              lighting: true,
            },
          },
        ],
      },
    ],
    ...more,
  };
}

export function light(name, more = {}) {
  return {
    name,
    type: 'point',
    pose: [0, 0, 1, 0, 0, 0, 1],
    cast_shadows: false,
    diffuse: [0.5, 0.5, 0.5, 1],
    specular: [0.1, 0.1, 0.1, 1],
    range: 20,
    constant: 0.5,
    linear: 0.01,
    quadratic: 0.001,
    direction: [0, 0, -1],
    inner_angle: 0,
    outer_angle: 0,
    falloff: 0,
    group: '',
    ...more,
  };
}

export function world(models = [], lights = []) {
  return {
    name: 'default',
    file: '',
    gravity: [0, 0, -9.8],
    magnetic_field: [5.5e-6, 2.2e-5, -4.2e-5],
    physics: {
      name: 'default_physics',
      type: 'ode',
      max_step_size: 0.001,
      real_time_factor: 1,
      real_time_update_rate: 1000,
      ode: {
        auto_disable_bodies: false,
        precon_iters: 0,
        iters: 50,
        sor: 1.3,
        rms_error_tol: 0,
        cfm: 0,
        erp: 0.2,
        contact_surface_layer: 0.001,
        contact_max_correcting_vel: 100,
        max_contacts: 20,
      },
    },
    scene: {
      ambient: [0.4, 0.4, 0.4, 1],
      background: [0.7, 0.7, 0.7, 1],
      shadows: true,
      grid: true,
      origin_visual: true,
      sky: null,
      fog: null,
    },
    gui_camera: null,
    wind: {linear_velocity: [0, 0, 0]},
    atmosphere: {
      type: 'adiabatic',
      temperature: 288.15,
      pressure: 101325,
      temperature_gradient: -0.0065,
    },
    spherical_coordinates: null,
    plugins: [],
    models,
    lights,
    roads: [],
    actors: [],
  };
}

export class FakeSimulator {
  constructor(document = world()) {
    this.document = document;
    this.revision = 1;
    this.clients = new Set();
    this.paused = true;
    this.sim_ns = 0;
    this.undo = [];
    this.redo = [];
    this.requests = [];
    this.files = new Set();
    this.#number();
  }

  /** A class that stands for WebSocket. */
  socketClass() {
    const simulator = this;
    return class FakeSocket {
      readyState = 0;
      bufferedAmount = 0;

      constructor() {
        queueMicrotask(() => {
          this.readyState = 1;
          simulator.clients.add(this);
          this.onopen?.();
        });
      }

      send(text) {
        const message = JSON.parse(text);
        queueMicrotask(() => simulator.answer(this, message));
      }

      close() {
        this.readyState = 3;
        simulator.clients.delete(this);
        this.onclose?.();
      }

      push(message) {
        this.onmessage?.({data: typeof message === 'string' ? message : JSON.stringify(message)});
      }
    };
  }

  push(message) {
    for (const client of this.clients) client.push(message);
  }

  answer(client, message) {
    this.requests.push(message);
    const handler = this[`on_${message.type}`];
    if (message.id === undefined) return;
    try {
      if (!handler) throw fault('unknown-request', `no request ${message.type}`);
      const value = handler.call(this, message) ?? {};
      client.push({type: 'reply', id: message.id, ok: true, value});
      if (message.type === 'hello') this.#welcome(client);
    } catch (error) {
      if (!error.issue) throw error;
      client.push({type: 'reply', id: message.id, ok: false, issues: [error.issue]});
    }
  }

  #welcome(client) {
    client.push({type: 'world', revision: this.revision, document: structuredClone(this.document)});
    client.push(this.#stats());
    client.push(this.#history());
  }

  #number() {
    let id = 0;
    for (const model of this.document.models) for (const link of model.links) link.id = id += 1;
  }

  #stats() {
    return {
      type: 'stats',
      sim_ns: this.sim_ns,
      real_ns: this.sim_ns,
      factor: 1,
      iterations: Math.round(this.sim_ns / 1e6),
      paused: this.paused,
    };
  }

  #history() {
    return {
      type: 'history',
      undo: this.undo.map((one) => one.label),
      redo: this.redo.map((one) => one.label),
      undoable: this.undo.length,
      depth: this.undo.length,
      state: this.undo.length,
      undo_by: this.undo.map(() => 'Guest 1'),
      redo_by: this.redo.map(() => 'Guest 1'),
      dirty: this.undo.length > 0,
      file: this.document.file,
    };
  }

  #record(label) {
    this.undo.unshift({label, document: structuredClone(this.document)});
    this.redo = [];
  }

  #tellWorld() {
    this.revision += 1;
    this.#number();
    this.push({type: 'world', revision: this.revision, document: structuredClone(this.document)});
    this.push(this.#history());
  }

  #tell(change) {
    this.revision += 1;
    this.#number();
    this.push({type: 'change', revision: this.revision, ...structuredClone(change)});
    this.push(this.#history());
  }

  on_hello() {
    return {session: 'one', version: 1, app: 'fake', number: 1, read_only: false};
  }

  on_edit({op}) {
    return this[`op_${op.kind}`](op);
  }

  op_insert({shape, pose, name = `unit_${shape}`}) {
    let unique = name;
    for (let n = 0; this.#find(unique); n += 1) unique = `${name}_${n}`;
    this.#record(`insert ${unique}`);
    const model = box(unique, pose);
    this.document.models.push(model);
    this.#tell({models: {[unique]: model}});
    return {name: unique};
  }

  op_insert_light({light: given}) {
    this.#record(`insert ${given.name}`);
    this.document.lights.push(given);
    this.#tell({lights: {[given.name]: given}});
    return {name: given.name};
  }

  op_delete({names}) {
    this.#record(`delete ${names.join(', ')}`);
    const gone = Object.fromEntries(names.map((name) => [name, null]));
    const models = this.document.models.filter(({name}) => names.includes(name));
    this.document.models = this.document.models.filter(({name}) => !names.includes(name));
    this.document.lights = this.document.lights.filter(({name}) => !names.includes(name));
    this.#tell(models.length ? {models: gone} : {lights: gone});
  }

  op_rename({name, to}) {
    if (this.#find(to)) throw fault('name-taken', `there is a model ${to} already`);
    this.#record(`rename ${name}`);
    const entity = this.#find(name);
    entity.name = to;
    const key = entity.links ? 'models' : 'lights';
    this.#tell({[key]: {[name]: null, [to]: entity}});
  }

  op_set({target, path, value}) {
    if (value === 666) throw fault('value', `${path} cannot be ${value}`);
    this.#record(`set ${path} of ${target || 'the world'}`);
    const keys = path.split('.');
    const last = keys.pop();
    let entity = this.#target(target);
    for (const key of keys) entity = entity[key];
    entity[last] = value;
    if (!target) {
      const top = path.split('.')[0];
      this.#tell({world: {[top]: this.document[top]}});
      return;
    }
    const owner = this.#find(target.split('::')[0]);
    this.#tell(owner.links ? {models: {[owner.name]: owner}} : {lights: {[owner.name]: owner}});
  }

  #find(name) {
    return [...this.document.models, ...this.document.lights].find((one) => one.name === name);
  }

  #target(target) {
    if (!target) return this.document;
    const [owner, part, item] = target.replace(/::(collision|visual):/, '::').split('::');
    const entity = this.#find(owner);
    if (!part) return entity;
    const link =
      entity.links.find((one) => one.name === part) ??
      entity.joints.find((one) => one.name === part);
    if (!item) return link;
    return [...link.collisions, ...link.visuals].find((one) => one.name === item);
  }

  on_undo({to = 0}) {
    return this.#travel(this.undo, this.redo, to);
  }

  on_redo({to = 0}) {
    return this.#travel(this.redo, this.undo, to);
  }

  #travel(from, onto, to) {
    let label = '';
    for (let n = 0; n <= to && from.length; n += 1) {
      const step = from.shift();
      onto.unshift({label: step.label, document: structuredClone(this.document)});
      this.document = step.document;
      label = step.label;
    }
    this.#tellWorld();
    return {label};
  }

  on_play() {
    this.paused = false;
    this.push(this.#stats());
  }

  on_pause() {
    this.paused = true;
    this.push(this.#stats());
  }

  on_step({steps}) {
    this.sim_ns += steps * 1e6;
    this.push(this.#stats());
    return {step: this.sim_ns / 1e6};
  }

  on_folders({path = '/worlds'}) {
    return {
      path,
      parent: path === '/worlds' ? null : '/worlds',
      roots: ['/worlds'],
      folders: path === '/worlds' ? [{name: 'old', path: '/worlds/old'}] : [],
      files: [...this.files]
        .filter((file) => file.slice(0, file.lastIndexOf('/')) === path)
        .map((file) => ({name: file.split('/').pop(), path: file, size: 1200, modified: 0})),
      launched: [],
      chosen: {state: false, launched: false},
    };
  }

  on_save({path = this.document.file, overwrite = false}) {
    if (this.files.has(path) && !overwrite && path !== this.document.file) {
      throw fault('exists', `${path} exists already`);
    }
    this.files.add(path);
    this.document.file = path;
    this.undo = [];
    this.push(this.#history());
    return {path};
  }

  on_open({path}) {
    if (!this.files.has(path)) throw fault('not-found', `no file ${path}`);
    this.document = world();
    this.document.file = path;
    this.undo = [];
    this.redo = [];
    this.#tellWorld();
    return {file: path};
  }

  on_new() {
    this.document = world();
    this.undo = [];
    this.#tellWorld();
    return {file: ''};
  }

  on_watch({topics}) {
    this.topics = topics;
    return {topics};
  }

  on_library() {
    return {
      locations: [
        {
          id: 'own',
          title: 'Built-in',
          kind: 'built-in',
          path: '/models',
          models: [
            {
              uri: 'model://table',
              name: 'table',
              title: 'Table',
              description: 'four legs',
              thumb: '',
            },
            {
              uri: 'model://chair',
              name: 'chair',
              title: 'Chair',
              description: 'to sit on',
              thumb: '',
            },
          ],
        },
      ],
    };
  }

  on_log_list() {
    return {logs: []};
  }
}

function fault(code, message) {
  return Object.assign(new Error(message), {
    issue: {severity: 'error', code, message, file: '', line: 0, xpath: '', hint: ''},
  });
}
