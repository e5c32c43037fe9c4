/** How the page and its tests are written. Run by tools/test from a folder that has the packages. */
import js from '@eslint/js';
import globals from 'globals';

/** `any` turns the type check off for whatever it touches: JSDoc types say what is meant. */
const noAnyInTypes = {
  meta: {type: 'problem', schema: [], messages: {any: 'a JSDoc type must not be `any`'}},
  create: (context) => ({
    Program() {
      for (const comment of context.sourceCode.getAllComments()) {
        const types = comment.type === 'Block' && comment.value.startsWith('*')
          ? comment.value.match(/\{[^@]*\}/g) ?? [] : [];
        if (types.some((type) => /(?<![\w'.])any(?![\w'])/.test(type))) {
          context.report({loc: comment.loc, messageId: 'any'});
        }
      }
    },
  }),
};

export default [
  js.configs.recommended,
  {
    files: ['web/js/**/*.js', 'test/page/**/*.mjs', 'tools/**/*.mjs'],
    plugins: {page: {rules: {'no-any-in-types': noAnyInTypes}}},
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
    files: ['web/js/**/*.js'],
    languageOptions: {globals: globals.browser},
    rules: {'page/no-any-in-types': 'error'},
  },
  {
    files: ['test/page/**/*.mjs', 'tools/**/*.mjs'],
    languageOptions: {globals: globals.node},
  },
];
