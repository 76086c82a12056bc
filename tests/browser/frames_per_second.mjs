// How fast the page draws: node frames_per_second.mjs [particles …]. By hand; results depend on the machine, and on what else
// it does: `cpu_s_per_picture`, of all of the browser's processes, depends on that least.
import { readdirSync, readFileSync, statSync, writeFileSync } from 'node:fs';
import { join } from 'node:path';
import { launch, makeRun, open, output, startWatch, temporaryFolder, until } from './setting.mjs';

/** Processor seconds of all that this program has started and that still runs. */
function cpuSeconds() {
  /** @type {Map<number, {parent: number, seconds: number}>} */
  const all = new Map();
  for (const name of readdirSync('/proc')) {
    if (!/^\d+$/.test(name)) continue;
    try {
      const field = readFileSync(`/proc/${name}/stat`, 'utf8').replace(/^.*\) /s, '').split(' ');  // from the third on
      all.set(Number(name), { parent: Number(field[1]), seconds: (Number(field[11]) + Number(field[12])) / 100 });
    } catch { /* it has just ended */ }
  }
  let sum = 0;
  for (const [pid, process_] of all) {
    let up = process_.parent;
    while (up > 1 && up !== process.pid) up = all.get(up)?.parent ?? 0;
    if (up === process.pid && pid !== process.pid) sum += process_.seconds;
  }
  return sum;
}

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
  const cpu = cpuSeconds();
  // @ts-expect-error -- what the page offers for measurements
  const measured = await page.evaluate(() => window.strake.fields.measure(5));
  const each = (cpuSeconds() - cpu) / (5 * measured.fps);
  results.push({ particles: n, frame_bytes: statSync(join(folder, 'frames/fluid-000001.h5')).size, first_picture_s: first, cpu_s_per_picture: each, ...measured });
  console.log(JSON.stringify(results.at(-1)));
  await close();
  await watch.end();
}
await browser.close();
writeFileSync(join(output, 'frames_per_second.json'), JSON.stringify(results, null, 2) + '\n');
