/** The check of the page's layers: which imports it reports. */
import assert from 'node:assert/strict';
import {readdirSync} from 'node:fs';
import test from 'node:test';

import {LAYERS, importFault, layerRule} from './layers.mjs';

const SOURCES = new URL('../../web/js/', import.meta.url);

test('each folder of the page is a layer, and each layer a folder', () => {
  const folders = readdirSync(SOURCES, {withFileTypes: true}).filter((one) => one.isDirectory());
  assert.deepEqual(Object.keys(LAYERS).sort(), ['.', ...folders.map(({name}) => name)].sort());
});

test('layers import lower layers only', () => {
  const order = Object.keys(LAYERS);
  for (const [folder, allowed] of Object.entries(LAYERS)) {
    for (const other of allowed) assert.ok(order.indexOf(other) < order.indexOf(folder), `${folder}: ${other}`);
  }
});

test('an import is judged by the folder of the module that it names', () => {
  for (const [file, name, kind, allowed] of [
    ['panels/windows.ts', '../ui/dom.js', 'value', true],
    ['panels/windows.ts', './panels.js', 'value', true],
    ['panels/windows.ts', 'three', 'value', true],
    ['panels/windows.ts', '../view/view.js', 'value', false],
    ['panels/windows.ts', '../view/view.js', 'type', true],
    ['panels/windows.ts', '../view/view.js', 'dynamic', false],
    ['panels/windows.ts', '../building/building_editor.js', 'value', false],
    ['panels/windows.ts', '../building/building_editor.js', 'dynamic', true],
    ['view/view.ts', '../building/building_editor.js', 'dynamic', false],
    ['pose.ts', './ui/dom.js', 'value', true],
    ['pose.ts', './view/../panels/panels.js', 'value', false],
    ['ui/dom.ts', '../pose.js', 'value', false],
    ['ui/dom.ts', '../pose.js', 'type', false],
    ['main.ts', './panels/panels.js', 'value', true],
    ['main.ts', './view/view.js', 'dynamic', true],
    ['main.ts', './replay/replay.js', 'value', false],
    ['main.ts', './building/building_editor.js', 'dynamic', false],
    ['store.ts', './main.js', 'value', false],
    ['panels/windows.ts', '../main.js', 'dynamic', false],
  ]) {
    assert.equal(importFault(file, name, kind) === '', allowed, `${file} ${kind} ${name}`);
  }
});

/** The messages about a node of the syntax tree of a module. */
function messagesOf(filename, type, node) {
  const messages = [];
  layerRule.create({filename, report: ({message}) => messages.push(message)})[type](node);
  return messages;
}

test('the rule reads every form of an import', () => {
  const file = '/web/js/clones/web/js/panels/windows.ts';
  const wrong = {source: {value: '../view/view.js'}}, type = {importKind: 'type'};
  for (const [kind, node, count] of [
    ['ImportDeclaration', wrong, 1],
    ['ImportDeclaration', {...wrong, ...type}, 0],
    ['ImportDeclaration', {...wrong, specifiers: [type, type]}, 0],
    ['ImportDeclaration', {...wrong, specifiers: [type, {importKind: 'value'}]}, 1],
    ['ImportDeclaration', {...wrong, specifiers: []}, 1],
    ['ExportNamedDeclaration', wrong, 1],
    ['ExportNamedDeclaration', {source: null}, 0],
    ['ExportAllDeclaration', {...wrong, exportKind: 'type'}, 0],
    ['ExportAllDeclaration', wrong, 1],
    ['ImportExpression', wrong, 1],
    ['ImportExpression', {source: {type: 'TemplateLiteral'}}, 1],
    ['TSImportType', wrong, 0],
  ]) {
    assert.equal(messagesOf(file, kind, node).length, count, `${kind} ${JSON.stringify(node)}`);
  }
  assert.match(messagesOf(file, 'ImportExpression', wrong)[0], /^panels must not import view: see LAYERS/);
});
