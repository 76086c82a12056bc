import js from '@eslint/js';
import { defineConfig } from 'eslint/config';
import tseslint from 'typescript-eslint';
import { fileURLToPath } from 'node:url';

const root = fileURLToPath(new URL('../..', import.meta.url));

export default defineConfig(
  { ignores: ['**/vendor/**', '**/bundle/**', '**/node_modules/**', '**/output/**', 'build*/**'] },
  js.configs.recommended,
  ...tseslint.configs.strictTypeChecked,
  {
    languageOptions: {
      parserOptions: {
        project: [`${root}coupler/watch/page/tsconfig.json`, `${root}tests/browser/tsconfig.json`],
      },
    },
    rules: {
      'no-undef': 'off',  // the type checker knows better
      eqeqeq: 'error',
      'no-console': 'off',
      // Numbers in texts are what this page is about; indices are checked by noUncheckedIndexedAccess.
      '@typescript-eslint/restrict-template-expressions': ['error', { allowNumber: true }],
      '@typescript-eslint/no-non-null-assertion': 'off',
    },
  },
);
