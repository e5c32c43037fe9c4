/** How the page and its tests are written. Run by tools/test from a folder that has the packages. */
import js from '@eslint/js';
import globals from 'globals';
import ts from 'typescript-eslint';
import {layerRule} from './layers.mjs';

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
    plugins: {page: {rules: {layers: layerRule}}, ts: ts.plugin},
    languageOptions: {parser: ts.parser, globals: globals.browser},
    rules: {
      'page/layers': 'error',
      // TypeScript checks these itself, and has the types.
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
];
