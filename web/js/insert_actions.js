/** What is added to the world: shapes, lights, models of the library, files of the desktop. */
import {LIGHTS, newLight, shapeModel, SHAPES} from './new_entities.js';
import {NOTHING} from './nothing.js';
/** @import {ActionParts} from './actions.js' */
/** @import {Dropped} from './dropped_files.js' */
/** @import {LightType, ShapeName} from './new_entities.js' */
/** @import {Model, Operation, Requests} from './protocol.js' */
/** @import {Pose7, Vec3} from './pose.js' */

/** @param {ActionParts} parts */
export function insertActions({store, ask, edit, dialog, view}) {
  const inserts = {
    /** @param {ShapeName} shape */
    insertShape(shape) {
      if (!SHAPES.includes(shape)) throw new RangeError(`no shape ${shape}`);
      store.setPlacing({
        kind: 'model', document: shapeModel(shape), shape,
        op: (pose) => store.modelEditing ? {kind: 'add_link', model: store.modelEditing.name, shape, pose}
          : {kind: 'insert', shape, pose},
      });
    },
    /** @param {LightType} type */
    insertLight(type) {
      if (!LIGHTS.includes(type)) throw new RangeError(`no light ${type}`);
      const light = newLight(type, store.document?.lights.map((one) => one.name) ?? []);
      store.setPlacing({
        kind: 'light', document: light,
        op: (pose) => ({kind: 'insert_light', light: {...light, pose}}),
      });
    },
    /**
     * Fetches a model of the library, from afar when need be; it then follows the mouse.
     * @param {string} uri
     */
    async insertModel(uri) {
      const outcome = await ask('library_get', {uri});
      if (!outcome.ok) return outcome;
      const {model, light} = outcome.value;
      /** @type {(pose: Pose7) => Operation} */
      const op = (pose) => store.modelEditing?.name
        ? {kind: 'add_model', model: store.modelEditing.name, uri, pose} : {kind: 'insert', uri, pose};
      if (model) store.setPlacing({kind: 'model', document: model, uri, op});
      else if (light) store.setPlacing({kind: 'light', document: light, uri, op});
      return outcome;
    },
    /**
     * Makes a robot of a template.
     * @param {string} name  of the template
     * @param {Record<string, unknown>} values  of its parameters
     */
    fromTemplate: (name, values) => ask('template', {name, values}, {quiet: true}),
    /** Attaches a robot to the mouse pointer for placing. @param {{sdf: string, model: Model}} made */
    insertMade({sdf, model}) {
      store.setPlacing({kind: 'model', document: model, op: (pose) => ({kind: 'insert', sdf, pose})});
    },
    /** Places the pending entity in the middle of the view. */
    placeInMiddle: () => view()?.placeInMiddle(),
    /**
     * Inserts the entity that follows the mouse.
     * @param {Pose7} pose  in the world
     * @returns {Promise<import('./actions.js').Outcome>}
     */
    async place(pose) {
      const {placing} = store;
      if (!placing) return NOTHING;
      store.setPlacing(null);
      const outcome = await edit(placing.op(pose));
      const {name, names} = outcome.value ?? {};
      if (names) store.select(names);
      else if (name) inserts.placed(name);
      return outcome;
    },
    /** What has come is selected; the model editor's first link begins its model. @param {string} name */
    placed(name) {
      const owner = name.split('::')[0];
      if (store.modelEditing && !store.modelEditing.name && owner !== name) store.setModelEditing({name: owner});
      store.select([name]);
    },
    /**
     * Files or folders of the desktop that were dropped on the ground; a dialog asks.
     * @param {Dropped[]} entries
     * @param {Vec3} place
     */
    dropFiles: (entries, place) => dialog('importFiles', {entries, place}),
    /** @param {Requests['import_model']['fields']} fields */
    importModel: (fields) => ask('import_model', fields, {quiet: true}),
    library: () => ask('library'),
    /** @param {string} path */
    libraryAdd: (path) => ask('library_add', {path}),
  };
  return inserts;
}
