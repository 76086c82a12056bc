// How fast the page draws: node frames_per_second.mjs [particles …]. By hand; results depend on the machine.
import { statSync, writeFileSync } from 'node:fs';
import { join } from 'node:path';
import { launch, makeRun, open, output, startWatch, temporaryFolder, until } from './setting.mjs';

const runs = temporaryFolder(), browser = await launch(), results = [];
for (const n of process.argv.length > 2 ? process.argv.slice(2).map(Number) : [10_000, 100_000, 1_000_000]) {
  const folder = join(runs, `particles-${n}`);
  makeRun(folder, n, 2, 2);
  const watch = await startWatch(folder);
  const begin = performance.now();
  const { page, close } = await open(browser, watch.address);
  await until('a picture', async () => (await page.locator('#when').textContent() ?? '').startsWith('frame 2'));
  await page.evaluate(() => new Promise((resolve) => { requestAnimationFrame(resolve); }));
  const first = 1e-3 * (performance.now() - begin);
  // @ts-expect-error -- what the page offers for measurements
  const measured = await page.evaluate(() => window.strake.fields.measure(5));
  results.push({ particles: n, frame_bytes: statSync(join(folder, 'frames/fluid-000001.h5')).size, first_picture_s: first, ...measured });
  console.log(JSON.stringify(results.at(-1)));
  await close();
  await watch.end();
}
await browser.close();
writeFileSync(join(output, 'frames_per_second.json'), JSON.stringify(results, null, 2) + '\n');
