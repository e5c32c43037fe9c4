import assert from 'node:assert/strict';
import test from 'node:test';
import {layersOf} from '../../web/js/panels/layers_tab.js';
import {geometryFields, unitGeometry} from '../../web/js/panels/geometry_fields.js';
import {sectionsOf, valueAt} from '../../web/js/panels/property_sections.js';
import {defaultFields, pluginFields} from '../../web/js/panels/plugin_fields.js';
import {withSensorState, withState} from '../../web/js/panels/plugin_states.js';
import {modelOf, rowOf, worldRows} from '../../web/js/panels/world_rows.js';
import {driveHints, hintsOf} from '../../web/js/panels/hint_line.js';
import {searched} from '../../web/js/panels/insert_tab.js';
import {drivenJoints} from '../../web/js/panels/joints_panel.js';
import {box, light, world} from './fake_simulator.mjs';

const AXIS = {
  xyz: [0, 0, 1],
  lower: -1,
  upper: 1,
  effort: -1,
  velocity: -1,
  damping: 0,
  friction: 0,
  spring_reference: 0,
  spring_stiffness: 0,
  motor_rate: 0,
  mimic: null,
};
const joint = (name, type, axis = AXIS) => ({
  name,
  type,
  parent: 'world',
  child: 'link',
  pose: [0, 0, 0, 0, 0, 0, 1],
  axis,
  axis2: null,
});

const labels = (rows) => rows.map((row) => row.label);

test('rows stand in the order of Gazebo', () => {
  const rows = worldRows(world([box('a')], [light('sun')]), new Set());
  assert.deepEqual(labels(rows), [
    'GUI',
    'Scene',
    'Spherical Coordinates',
    'Physics',
    'Atmosphere',
    'Wind',
    'Models (1)',
    'Lights (1)',
    'Plugins (0)',
  ]);
});

test('an open model shows links, joints and plugins under headings', () => {
  const model = box('a', undefined, {
    joints: [joint('hinge', 'revolute')],
    plugins: [{name: 'drive', filename: 'libdrive.so', xml: '<plugin/>'}],
  });
  const rows = worldRows(world([model]), new Set(['models', 'model:a']));
  assert.deepEqual(labels(rows).slice(7, 14), [
    'a',
    'LINKS',
    'link',
    'JOINTS',
    'hinge',
    'PLUGINS',
    'drive',
  ]);
  assert.equal(rows[9].select, 'a::link');
  assert.equal(rows[11].select, undefined);
});

test('headings without anything below are left out', () => {
  const rows = worldRows(world([box('a')]), new Set(['models', 'model:a']));
  assert.deepEqual(labels(rows).slice(8), ['LINKS', 'link', 'Lights (0)', 'Plugins (0)']);
});

test('a search leaves what fits and counts it', () => {
  const rows = worldRows(world([box('table'), box('chair')]), new Set(['models']), ' CHA ');
  assert.deepEqual(labels(rows).slice(6, 8), ['Models (1 of 2)', 'chair']);
});

test('rows of different things never share an id', () => {
  const twin = box('a::b');
  const rows = worldRows(
    world([box('a'), twin], [light('l')]),
    new Set(['models', 'lights', 'model:a', 'model:a::b']),
  );
  assert.equal(new Set(rows.map((row) => row.id)).size, rows.length);
});

test('a name leads to its row and what must be open', () => {
  const document = world([box('a'), box('a::b')], [light('sun')]);
  assert.deepEqual(rowOf(document, 'sun'), {id: 'light:sun', opens: ['lights']});
  assert.deepEqual(rowOf(document, 'a'), {id: 'model:a', opens: ['models']});
  assert.deepEqual(rowOf(document, 'a::b::link'), {
    id: 'link:a::b::link',
    opens: ['models', 'model:a::b'],
  });
  assert.equal(rowOf(document, 'nobody'), null);
  assert.equal(rowOf(document, 'a::not_yet'), null);
  assert.equal(modelOf(document, 'a::b::link').name, 'a::b');
});

test('a world without a document has no rows', () => {
  assert.deepEqual(worldRows(null, new Set(['models'])), []);
});

const row = (rows, id) => rows.find((one) => one.id === id);

test('each element of a plugin that holds only text is a field', () => {
  const xml = '<plugin name="p"><!-- <a>1</a> --><on>True</on><b><c unit="m"> 0.5 </c></b><d>x &amp; y</d></plugin>';
  const model = box('a', undefined, {plugins: [{xml: '<plugin name="o"/>'}, {xml}]});
  const {entity, fields} = pluginFields(model, 1);
  assert.deepEqual(fields.map(({label, type}) => [label, type]), [['on', 'flag'], ['c', 'number'], ['d', 'text']]);
  assert.deepEqual(Object.values(entity), [true, 0.5, 'x & y']);
  /** @param {number} at @param {unknown} value */
  const text = (at, value) => fields[at].ops(value).ops[0].text.split('\n');
  assert.deepEqual(text(2, '<z>'), ['<plugin name="o"/>', xml.replace('x &amp; y', '&lt;z&gt;')]);
  assert.equal(text(1, 2)[1], xml.replace(' 0.5 ', '2'));
});

test('plugins of the world are added, edited and removed as those of models', () => {
  const document = world([]);
  document.plugins = [{name: 'a', filename: 'liba.so', xml: '<plugin name="a"><b>1</b></plugin>'},
    {name: 'c', filename: 'libc.so', xml: '<plugin name="c"/>'}];
  const rows = worldRows(document, new Set(['plugins']));
  /** @param {string} id @param {string} path @param {unknown} value */
  const op = (id, path, value) => sectionsOf(document, row(rows, id)).sections
    .flatMap(({fields}) => fields).find((one) => one.path === path).ops(value).ops[0];
  assert.deepEqual(op('plugin::0', 'parameter0', 2), {kind: 'set_plugins', model: '',
    text: '<plugin name="a"><b>2</b></plugin>\n<plugin name="c"/>'});
  assert.equal(op('plugin::1', 'xml', '<plugin name="d"/>').text,
    '<plugin name="a"><b>1</b></plugin>\n<plugin name="d"/>');
  assert.equal(op('plugin::0', 'remove', null).text, '<plugin name="c"/>');
  const [, , added] = op('plugins', 'add', 'liba.so').text.split('\n');
  assert.equal(added, '<plugin name="a_0" filename="liba.so"/>', 'names are unique');
  const state = {model: '', name: 'a', filename: 'liba.so', state: 'running', reason: '',
    parameters: [{name: 'e', type: 'number', default: '3', choices: []}]};
  const found = withState(sectionsOf(document, row(rows, 'plugin::0')), state, {name: '', plugins: document.plugins}, 0);
  const [field] = found.sections.find(({key}) => key === 'defaults').fields;
  assert.equal(field.ops(4).ops[0].text.split('\n<plugin name="c')[0], '<plugin name="a"><b>1</b>  <e>4</e>\n</plugin>');
});

test('parameters that the XML of a plugin leaves out are fields with their defaults', () => {
  const declared = [
    {name: 'a', type: 'number', default: '0.5', choices: []}, {name: 'on', type: 'flag', default: 'true', choices: []},
    {name: 'from', type: 'choice', default: 'world', choices: ['world', 'encoder']}, {name: 'b', type: 'text', default: '', choices: []}];
  const made = (xml) => defaultFields(box('m', undefined, {plugins: [{xml}]}), 0, declared);
  const {entity, fields} = made('<plugin name="p"><!-- <a>1</a> -->\n  <b/>\n</plugin>\n');
  assert.deepEqual(fields.map(({label, type, choices}) => [label, type, choices]),
    [['a', 'number', undefined], ['on', 'flag', undefined], ['from', 'choice', ['world', 'encoder']]]);
  assert.deepEqual(Object.values(entity), [0.5, true, 'world']);
  assert.equal(fields[0].ops(2).ops[0].text, '<plugin name="p"><!-- <a>1</a> -->\n  <b/>\n  <a>2</a>\n</plugin>\n');
  const {fields: [radius]} = defaultFields(box('m', undefined, {plugins: [{xml: '<plugin name="p"/>'}]}), 0,
    [{name: 'wheel_radius', type: 'number', default: '0.1', choices: []}]);
  assert.equal(radius.unit, 'm');
  const [rate, mode] = pluginFields(box('m', undefined, {plugins: [{
    xml: '<plugin name="p"><updateRate>50</updateRate><torque>all</torque></plugin>'}]}), 0).fields;
  assert.equal(rate.unit, 'Hz');
  assert.equal(mode.unit, undefined, 'a text has no unit');
  const [, , , text] = made('<plugin name="p"/>').fields;
  assert.equal(text.ops('$& <').ops[0].text, '<plugin name="p">\n  <b>$&amp; &lt;</b>\n</plugin>');
});

test('parameters that the plugin of a sensor reads and its XML leaves out are fields with their defaults', () => {
  const sensor = {name: 'eye', type: 'camera', parameters: [
    {path: 'plugin:p/topic', kind: 'text', value: 'x'}, {path: 'update_rate', kind: 'number', value: 10}]};
  const state = {model: 'm', name: 'p', filename: 'l.so', state: 'failed', reason: 'no topic', parameters: [
    {name: 'topic', type: 'text', default: '', choices: []}, {name: 'gain', type: 'number', default: '2', choices: []}]};
  const document = world([box('m', undefined, {links: [{name: 'l', collisions: [], visuals: [], sensors: [sensor]}]})]);
  const found = withSensorState({title: 'eye', sections: []}, {document, pluginStates: [state]},
    {kind: 'sensor', model: 'm', owner: 'l', name: 'eye'});
  const [told, defaults] = found.sections;
  assert.deepEqual(told.fields.map(({path}) => told.entity[path]), ['failed', 'no topic']);
  assert.deepEqual(defaults.fields.map(({label, path}) => [label, defaults.entity[path]]), [['gain', 2]]);
  assert.deepEqual(defaults.fields[0].ops(3).ops,
    [{kind: 'set', target: 'm::l::sensor:eye', path: 'plugin:p/gain', value: '3'}]);
});

test('every field of every row finds a value in the document', () => {
  const model = box('a', undefined, {
    joints: [joint('hinge', 'revolute'), joint('weld', 'fixed', null)],
    plugins: [{name: 'p', filename: 'libp.so', xml: '<plugin/>'}],
  });
  const document = world([model], [light('sun'), light('cone', {type: 'spot'})]);
  document.gui_camera = {
    name: 'user_camera',
    pose: [0, 0, 0, 0, 0, 0, 1],
    view_controller: 'orbit',
  };
  document.scene.sky = {time: 10};
  const rows = worldRows(document, new Set(['models', 'lights', 'model:a']));
  let fields = 0;
  for (const one of rows.filter(({kind}) => !['models', 'lights', 'heading'].includes(kind))) {
    const found = sectionsOf(document, one);
    assert.ok(found && found.sections.length, one.id);
    for (const section of found.sections) {
      for (const field of section.fields) {
        assert.notEqual(valueAt(section.entity, field.local), undefined, `${one.id} ${field.path}`);
        fields += 1;
      }
    }
  }
  assert.ok(fields > 100, `only ${fields} fields`);
});

test('paths begin at the target of the operation', () => {
  const document = world([box('a')], []);
  const rows = worldRows(document, new Set(['models', 'model:a']));
  const physics = sectionsOf(document, row(rows, 'physics')).sections;
  assert.ok(
    physics.some(
      (section) =>
        section.target === '' && section.fields.some((field) => field.path === 'physics.ode.iters'),
    ),
  );
  assert.ok(physics.some((section) => section.fields.some((field) => field.path === 'gravity')));
  const link = sectionsOf(document, row(rows, 'link:a::link')).sections;
  const paths = link.flatMap((section) =>
    section.fields.map((field) => `${section.target} ${field.path}`),
  );
  for (const wanted of [
    'a::link inertial.mass',
    'a::link::collision:collision geometry.size',
    'a::link::collision:collision surface.mu',
    'a::link::visual:visual material.diffuse',
    'a::link gravity',
  ]) {
    assert.ok(paths.includes(wanted), wanted);
  }
});

test('a directional light has no range, a spot light has its cone', () => {
  const document = world([], [light('sun', {type: 'directional'}), light('cone', {type: 'spot'})]);
  const rows = worldRows(document, new Set(['lights']));
  const paths = (id) =>
    sectionsOf(document, row(rows, id)).sections[0].fields.map((field) => field.path);
  assert.ok(!paths('light:sun').includes('range'));
  assert.ok(paths('light:cone').includes('inner_angle'));
});

test('a row whose entity has gone has no properties', () => {
  const document = world([box('a')]);
  const rows = worldRows(document, new Set(['models', 'model:a']));
  document.models = [];
  assert.equal(sectionsOf(document, row(rows, 'link:a::link')), null);
  assert.equal(sectionsOf(document, null), null);
});

test('a shape of a file keeps its type, a simple one may become another', () => {
  assert.equal(geometryFields({type: 'mesh'})[0].fixed, true);
  const [type] = geometryFields({type: 'box'});
  assert.equal(type.fixed, false);
  for (const choice of type.choices) {
    const fields = geometryFields(unitGeometry(choice)).slice(1);
    assert.ok(fields.length, choice);
    for (const field of fields) {
      assert.notEqual(valueAt({geometry: unitGeometry(choice)}, field.path), undefined, field.path);
    }
  }
});

test('layers are those that occur, in order', () => {
  const model = box('a');
  model.links[0].visuals = [2, 0, null, 2].map((layer) => ({name: 'v', layer}));
  assert.deepEqual(layersOf(world([model])), [0, 2]);
  assert.deepEqual(layersOf(null), []);
});

test('a search of the library looks at titles and descriptions and drops empty locations', () => {
  const locations = [
    {id: 'a', models: [{uri: 'u', name: 'x', title: 'Chair', description: ''}]},
    {id: 'b', models: [{uri: 'v', name: 'y', title: 'Table', description: 'like a chair'}]},
    {id: 'c', models: [{uri: 'w', name: 'z', title: 'Lamp', description: ''}]},
  ];
  assert.deepEqual(
    searched(locations, 'CHAIR').map(({id}) => id),
    ['a', 'b'],
  );
  assert.equal(searched(locations, ' '), locations);
});

test('joints that cannot move are not driven; units follow the type', () => {
  const model = box('a', undefined, {
    joints: [joint('weld', 'fixed', null), joint('slide', 'prismatic'), joint('hinge', 'revolute')],
  });
  const driven = drivenJoints(model);
  assert.deepEqual(
    driven.map(({joint: {name}}) => name),
    ['slide', 'hinge'],
  );
  assert.deepEqual(
    driven.map(({units}) => units.force),
    ['N', 'N m'],
  );
  assert.deepEqual(drivenJoints(null), []);
});

test('the hints of a selected robot that the arrow keys drive begin with them', () => {
  const robot = {name: 'taxi', plugins: [{name: 'd', filename: 'libgazebo_ros_diff_drive.so', xml: ''}]};
  assert.deepEqual(driveHints(robot, true).map(([keys]) => keys), ['Space', '↑ ↓ ← →']);
  assert.deepEqual(driveHints(robot, false)[0], ['↑ ↓ ← →', 'drive taxi']);
  assert.deepEqual(driveHints({name: 'box', plugins: []}, false), []);
  assert.deepEqual(driveHints(undefined, true), []);
});

test('the hints name each key once, and the space bar by what it does now', () => {
  const drive = [['Space', 'play, then'], ['↑ ↓ ← →', 'drive car']];
  const standing = hintsOf('select', drive, true);
  assert.deepEqual(standing.filter(([keys]) => keys === 'Space'), [['Space', 'play, then']]);
  assert.ok(hintsOf('select', [], false).some(([keys, what]) => keys === 'Space' && what === 'pause'));
  assert.ok(hintsOf('select', [], true).some(([keys, what]) => keys === 'Space' && what === 'play'));
});
