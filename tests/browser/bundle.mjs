// Builds coupler/watch/web/page/bundle/page.js from its sources; with --check, says whether the one that is committed is it.
import { build } from 'esbuild';
import { readFile, writeFile } from 'node:fs/promises';
import { fileURLToPath } from 'node:url';

const page = fileURLToPath(new URL('../../coupler/watch/web/page/', import.meta.url));
const licence = (await readFile(page + 'vendor/uplot/LICENSE', 'utf8')).trim();
const made = await build({
  absWorkingDir: page,
  entryPoints: ['source/main.ts'],
  bundle: true,
  minify: true,
  format: 'iife',
  target: 'es2022',
  charset: 'utf8',
  legalComments: 'inline',
  write: false,
  banner: { js: `// Built from coupler/watch/web/page/source by tests/browser/bundle.mjs; contains uPlot:\n/*\n${licence}\n*/` },
});
const file = page + 'bundle/page.js', text = made.outputFiles[0].text;
if (process.argv.includes('--check')) {
  if (await readFile(file, 'utf8') !== text) {
    console.error('coupler/watch/web/page/bundle/page.js is not what its sources build\n  fix: npm --prefix tests/browser run bundle');
    process.exit(1);
  }
  console.log('the committed bundle is what its sources build');
} else {
  await writeFile(file, text);
  console.log(`${file}: ${(Buffer.byteLength(text) / 1000).toFixed(1)} kB`);
}
