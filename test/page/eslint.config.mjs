/** How the page and its tests are written. Run by tools/test from a folder that has the packages. */
import js from '@eslint/js';
import globals from 'globals';
import ts from 'typescript-eslint';

/** The folders of the page from the lowest layer up, with those that each may import; '.': modules of web/js. */
const LAYERS = {
  ui: [],
  '.': ['ui'],
  topics: ['.', 'ui'],
  view: ['.', 'ui', 'topics'],
  building: ['.', 'ui'],
  panels: ['.', 'ui', 'topics'],
  model_editor: ['.', 'ui', 'panels'],
  replay: ['.', 'ui', 'topics', 'panels', 'view'],
};

/** Types of any layer may be named, as these leave nothing in the page; the toolkit knows of none. */
const layers = Object.entries(LAYERS).map(([folder, allowed]) => {
  const others = Object.keys(LAYERS).filter((name) => name !== '.' && name !== folder && !allowed.includes(name));
  const patterns = [{
    regex: `^(\\.{1,2}/)+(${others.join('|')})/`,
    allowTypeImports: folder !== 'ui',
    message: 'This layer must not import that one: see LAYERS in test/page/eslint.config.mjs.',
  }];
  if (folder === 'ui') patterns.push({regex: '^\\.\\./\\w+\\.js$', message: 'The toolkit knows nothing of the simulator.'});
  return {
    files: [folder === '.' ? 'web/js/*.ts' : `web/js/${folder}/**/*.ts`],
    ignores: ['web/js/main.ts'],
    plugins: {ts: ts.plugin},
    rules: {'ts/no-restricted-imports': ['error', {patterns}]},
  };
});

export default [
  js.configs.recommended,
  {
    files: ['web/js/**/*.ts', 'test/page/**/*.mjs', 'tools/**/*.mjs'],
    languageOptions: {ecmaVersion: 2023, sourceType: 'module'},
    linterOptions: {reportUnusedDisableDirectives: 'error'},
    rules: {
      'array-callback-return': 'error',
      'eqeqeq': 'error',
      'max-lines': ['error', {max: 480, skipBlankLines: true, skipComments: true}],
      'no-implicit-globals': 'error',
      'no-new-wrappers': 'error',
      'no-throw-literal': 'error',
      'no-unused-vars': ['error', {argsIgnorePattern: '^_', varsIgnorePattern: '^_',
        destructuredArrayIgnorePattern: '^_'}],
      'no-useless-concat': 'error',
      'no-var': 'error',
      'object-shorthand': 'error',
      'prefer-const': ['error', {destructuring: 'all'}],
    },
  },
  {
    files: ['web/js/**/*.ts'],
    plugins: {ts: ts.plugin},
    languageOptions: {parser: ts.parser, globals: globals.browser},
    rules: {
      // TypeScript tells these itself, and knows types.
      'no-undef': 'off',
      'no-unused-vars': 'off',
      'no-redeclare': 'off',
      'ts/array-type': 'error',
      'ts/consistent-type-imports': ['error', {disallowTypeAnnotations: false}],
      'ts/no-confusing-non-null-assertion': 'error',
      'ts/no-explicit-any': 'error',
      'ts/no-inferrable-types': 'error',
      'ts/no-unnecessary-type-constraint': 'error',
    },
  },
  {
    files: ['test/page/**/*.mjs', 'tools/**/*.mjs'],
    languageOptions: {globals: globals.node},
  },
  ...layers,
];
