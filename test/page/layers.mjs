/** Which folder of the page may import which, and the ESLint rule that checks it. Needs no packages. */
import {posix} from 'node:path';

/** The folders of web/js from the lowest layer up, with those that each may import; '.': modules of web/js itself. */
export const LAYERS = {
  ui: [],
  '.': ['ui'],
  topics: ['.', 'ui'],
  view: ['.', 'ui', 'topics'],
  building: ['.', 'ui'],
  panels: ['.', 'ui', 'topics'],
  model_editor: ['.', 'ui', 'panels'],
  replay: ['.', 'ui', 'topics', 'panels', 'view'],
};
/** The module that starts the page; no other module imports it. */
const MAIN = 'main';
const MAIN_IMPORTS = ['.', 'ui', 'topics', 'view', 'panels'];
/** What a layer loads by import() when the user opens it. */
const LOADED_LATER = {panels: ['building', 'model_editor']};

const folderOf = (path) => (path.includes('/') ? path.split('/')[0] : '.');
const moduleOf = (path) => path.replace(/\.[jt]s$/, '');

/**
 * @param file  the importing module, relative to web/js: `panels/windows.ts`
 * @param name  as written: `../ui/dom.js`
 * @param kind  'value'; 'type', which leaves nothing in the built page; 'dynamic', import()
 * @returns what is wrong; '' for nothing
 */
export function importFault(file, name, kind) {
  if (!name.startsWith('.')) return '';
  const target = posix.join(posix.dirname(file), name);
  if (moduleOf(target) === MAIN) return 'main.ts starts the page: no module may import it.';
  const isMain = moduleOf(file) === MAIN, from = folderOf(file), to = folderOf(target);
  const allowed = [...isMain ? MAIN_IMPORTS : [from, ...LAYERS[from]],
    ...kind === 'dynamic' ? LOADED_LATER[from] ?? [] : []];
  if (allowed.includes(to) || (kind === 'type' && from !== 'ui')) return '';
  return `${isMain ? file : from} must not import ${to === '.' ? target : to}: see LAYERS in test/page/layers.mjs.`;
}

const SOURCES = '/web/js/';
const isType = (node) => [node.importKind, node.exportKind].includes('type') ||
  (node.specifiers?.length > 0 && node.specifiers.every(({importKind}) => importKind === 'type'));

/** The rule for ESLint. */
export const layerRule = {
  create(context) {
    const path = context.filename.replaceAll('\\', '/');
    const file = path.slice(path.lastIndexOf(SOURCES) + SOURCES.length);
    const check = (node, source, kind) => {
      const message = typeof source?.value === 'string' ? importFault(file, source.value, kind)
        : 'The name of the module must be a literal, so that its layer can be checked.';
      if (message) context.report({node, message});
    };
    const statement = (node) => node.source && check(node, node.source, isType(node) ? 'type' : 'value');
    return {
      ImportDeclaration: statement, ExportNamedDeclaration: statement, ExportAllDeclaration: statement,
      ImportExpression: (node) => check(node, node.source, 'dynamic'),
      TSImportType: (node) => check(node, node.source ?? node.argument.literal, 'type'),
    };
  },
};
