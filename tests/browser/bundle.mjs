// Builds coupler/watch/web/page/bundle from the page's sources and uPlot; with --check, says whether the one that is committed is it.
import { build } from 'esbuild';
import { readFile, writeFile } from 'node:fs/promises';
import { fileURLToPath } from 'node:url';

const page = fileURLToPath(new URL('../../coupler/watch/web/page/', import.meta.url));
const uplot = fileURLToPath(new URL('node_modules/uplot/', import.meta.url));
const licence = (await readFile(uplot + 'LICENSE', 'utf8')).trim();
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
const files = { 'page.js': made.outputFiles[0].text, 'uplot.css': await readFile(uplot + 'dist/uPlot.min.css', 'utf8') };
for (const [name, text] of Object.entries(files)) {
  const file = `${page}bundle/${name}`;
  if (!process.argv.includes('--check')) {
    await writeFile(file, text);
    console.log(`${file}: ${(Buffer.byteLength(text) / 1000).toFixed(1)} kB`);
  } else if (await readFile(file, 'utf8') !== text) {
    console.error(`coupler/watch/web/page/bundle/${name} is not what its sources build\n  fix: npm --prefix tests/browser run bundle`);
    process.exit(1);
  }
}
if (process.argv.includes('--check')) console.log('the committed bundle is what its sources build');
