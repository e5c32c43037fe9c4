/** A small world's document, and a connection that notes what is asked of it. */
import {createActions} from '../../web/js/actions.js';
import {Emitter} from '../../web/js/emitter.js';
import {shapeModel, newLight} from '../../web/js/new_entities.js';
import {Store} from '../../web/js/store.js';

export function model(name, id, pose) {
  const made = shapeModel('box');
  return {...made, name, pose, links: [{...made.links[0], id}]};
}

export function world() {
  return {
    name: 'default', file: '', roads: [], scene: {},
    models: [model('a', 1, [0, 0, 0.5, 0, 0, 0, 1]), model('b', 2, [3, 0, 0.5, 0, 0, 0, 1])],
    lights: [{...newLight('point', []), name: 'lamp'}],
  };
}

/** A pose frame as the simulator sends it. @param {[number, number[]][]} links */
export function frameOf(links, {kind = 1, length} = {}) {
  const buffer = new ArrayBuffer(length ?? 40 + 32 * links.length);
  const view = new DataView(buffer);
  view.setUint32(0, kind, true);
  view.setUint32(4, 7, true);
  view.setBigUint64(8, 1234n, true);
  view.setFloat64(16, 1.25, true);
  view.setFloat64(24, 2.5, true);
  view.setUint32(32, links.length, true);
  links.forEach(([id, pose], index) => {
    const start = 40 + 32 * index;
    if (start + 32 > buffer.byteLength) return;
    view.setUint32(start, id, true);
    pose.forEach((part, place) => view.setFloat32(start + 4 + 4 * place, part, true));
  });
  return buffer;
}

export class NotingConnection extends Emitter {
  requests = [];
  answers = {};

  async request(type, fields = {}) {
    this.requests.push([type, fields]);
    const answer = this.answers[type];
    if (answer instanceof Error) throw answer;
    return answer ?? {};
  }
}

/** The actions of a page on the small world, with answers of a connection by type of request. */
export function actionsPage(answers = {}) {
  const connection = new NotingConnection();
  Object.assign(connection.answers, answers);
  const store = new Store(connection);
  const actions = createActions({store, connection});
  store.receive({type: 'world', revision: 1, document: world()});
  return {connection, store, actions};
}
