import js from '@eslint/js';
import { defineConfig } from 'eslint/config';
import tseslint from 'typescript-eslint';
import { fileURLToPath } from 'node:url';

const root = fileURLToPath(new URL('../..', import.meta.url));

export default defineConfig(
  { ignores: ['**/bundle/**', '**/node_modules/**', '**/output/**', 'build*/**'] },
  js.configs.recommended,
  { rules: { 'no-undef': 'off', eqeqeq: 'error' } },  // the type checker checks names better
  {
    files: ['coupler/watch/web/page/source/*.ts'],
    extends: [tseslint.configs.strictTypeChecked],
    languageOptions: { parserOptions: { project: `${root}coupler/watch/web/page/tsconfig.json` } },
    rules: {
      // Numbers in texts are what this page is about; indices are checked by noUncheckedIndexedAccess.
      '@typescript-eslint/restrict-template-expressions': ['error', { allowNumber: true }],
      '@typescript-eslint/no-non-null-assertion': 'off',
    },
  },
);
