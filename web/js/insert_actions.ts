/** What is added to the world: shapes, lights, models of the library, files of the desktop. */
import {LIGHTS, newLight, shapeModel, SHAPES} from './new_entities.js';
import {NOTHING} from './nothing.js';
import type {ActionParts, Outcome} from './actions.js';
import type {Dropped} from './dropped_files.js';
import type {LightType, ShapeName} from './new_entities.js';
import type {Model, Operation, Requests} from './protocol.js';
import type {Pose7, Vec3} from './pose.js';

/** What a key turns the pending entity by, rad. */
const STEP = Math.PI / 12;
const QUARTER = Math.PI / 2;

export function insertActions({store, ask, edit, dialog, view}: ActionParts) {
  const inserts = {
    insertShape(shape: ShapeName) {
      if (!SHAPES.includes(shape)) throw new RangeError(`no shape ${shape}`);
      store.setPlacing({
        kind: 'model', document: shapeModel(shape), shape,
        op: (pose) => store.modelEditing ? {kind: 'add_link', model: store.modelEditing.name, shape, pose}
          : {kind: 'insert', shape, pose},
      });
    },
    insertLight(type: LightType) {
      if (!LIGHTS.includes(type)) throw new RangeError(`no light ${type}`);
      const light = newLight(type, store.document?.lights.map((one) => one.name) ?? []);
      store.setPlacing({
        kind: 'light', document: light,
        op: (pose) => ({kind: 'insert_light', light: {...light, pose}}),
      });
    },
    /** Fetches a model of the library, from afar when need be; it then follows the mouse. */
    async insertModel(uri: string) {
      const outcome = await ask('library_get', {uri});
      if (!outcome.ok) return outcome;
      const {model, light} = outcome.value;
      const op: (pose: Pose7) => Operation = (pose) => store.modelEditing?.name
        ? {kind: 'add_model', model: store.modelEditing.name, uri, pose} : {kind: 'insert', uri, pose};
      if (model) store.setPlacing({kind: 'model', document: model, uri, op});
      else if (light) store.setPlacing({kind: 'light', document: light, uri, op});
      return outcome;
    },
    /**
     * Makes a robot of a template.
     * @param name  of the template
     * @param values  of its parameters
     */
    fromTemplate: (name: string, values: Record<string, unknown>) => ask('template', {name, values},
        {quiet: true}),
    /** Attaches a robot to the mouse pointer for placing. */
    insertMade({sdf, model}: {sdf: string, model: Model}) {
      store.setPlacing({kind: 'model', document: model, op: (pose) => ({kind: 'insert', sdf, pose})});
    },
    /** Places the pending entity where it is seen, or in the middle of the view for use without a mouse. */
    placeHere: () => view()?.placer.putHere(),
    turnLeft: () => view()?.placer.turn(STEP),
    turnRight: () => view()?.placer.turn(-STEP),
    quarterLeft: () => view()?.placer.turn(QUARTER),
    quarterRight: () => view()?.placer.turn(-QUARTER),
    /**
     * Inserts the entity that follows the mouse.
     * @param pose  in the world
     */
    async place(pose: Pose7): Promise<Outcome> {
      const {placing} = store;
      if (!placing) return NOTHING;
      store.setPlacing(null);
      const outcome = await edit(placing.op(pose));
      const {name, names} = outcome.value ?? {};
      if (names) store.select(names);
      else if (name) inserts.placed(name);
      return outcome;
    },
    /** What has come is selected; the model editor's first link begins its model. */
    placed(name: string) {
      const owner = name.split('::')[0];
      if (store.modelEditing && !store.modelEditing.name && owner !== name) store.setModelEditing({name: owner});
      store.select([name]);
    },
    /** Files or folders of the desktop that were dropped on the ground; a dialog asks. */
    dropFiles: (entries: Dropped[], place: Vec3) => dialog('importFiles', {entries, place}),
    importModel: (fields: Requests['import_model']['fields']) => ask('import_model', fields,
        {quiet: true}),
    library: () => ask('library'),
    libraryAdd: (path: string) => ask('library_add', {path}),
  };
  return inserts;
}
