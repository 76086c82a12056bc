// The page of `strake watch --web` in a browser: a run from its start to its end, every control, values, keyboard, contrast.
import assert from 'node:assert/strict';
import { spawnSync } from 'node:child_process';
import { readFileSync } from 'node:fs';
import { createRequire } from 'node:module';
import { join } from 'node:path';
import { after, before, describe, test } from 'node:test';
import { bin, endAll, launch, makeRun, open, output, startRun, startWatch, temporaryFolder, until, wait } from './setting.mjs';

/** @typedef {import('playwright-core').Page} Page */

const axe = readFileSync(createRequire(import.meta.url).resolve('axe-core/axe.min.js'), 'utf8');
const runs = temporaryFolder();

/** @type {import('playwright-core').Browser} */
let browser;
before(async () => { browser = await launch(); });
after(async () => {
  endAll();
  await browser.close();
});

/** @param {Page} page @param {string} id */
const text = async (page, id) => (await page.locator(`#${id}`).textContent() ?? '').trim();

/** The first cells of a table of numbers. @param {string} csv */
function table(csv) {
  const [head, ...rows] = csv.trim().split('\n');
  return { names: (head ?? '').split(','), rows: rows.map((row) => row.split(',').map((cell) => cell === '' ? null : Number(cell))) };
}

/** What the reader gets by a button that saves a file. @param {Page} page @param {string} id */
async function saved(page, id) {
  const [download] = await Promise.all([page.waitForEvent('download'), page.locator(`#${id}`).click()]);
  const path = join(output, download.suggestedFilename());
  await download.saveAs(path);
  return { name: download.suggestedFilename(), bytes: readFileSync(path) };
}

/** The picture that is drawn now, as it may be compared. @param {Page} page */
const picture = async (page) => (await page.locator('#stage').screenshot()).toString('base64');

/** The problems that axe-core finds in a page. @param {Page} page @param {string} what */
async function accessible(page, what) {
  await page.evaluate(axe);
  const violations = await page.evaluate(async () => {
    // @ts-expect-error -- put there by the line above
    const result = await window.axe.run(document, { resultTypes: ['violations'] });
    return result.violations.map((/** @type {{id: string, help: string, nodes: {html: string, failureSummary: string}[]}} */ v) =>
      `${v.id}: ${v.help}\n${v.nodes.map((n) => `   ${n.html}\n   ${n.failureSummary}`).join('\n')}`);
  });
  assert.deepEqual(violations, [], what);
}

/** @param {Page} page */
const sideways = (page) => page.evaluate(() => document.documentElement.scrollWidth - document.documentElement.clientWidth);

describe('a run that goes on', () => {
  const folder = join(runs, 'plate_entry-live');
  /** @type {Awaited<ReturnType<typeof startWatch>>} */ let watch;
  /** @type {Awaited<ReturnType<typeof open>>} */ let opened;
  /** @type {Page} */ let page;
  /** @type {ReturnType<typeof startRun>} */ let run;

  before(async () => {
    run = startRun(runs, ['cases/plate_entry.toml', '--tag', 'live', '--set', 'end_time=0.0024', '--set', 'fluid.spacing=0.02']);
    watch = await startWatch(folder);
    opened = await open(browser, watch.address);
    page = opened.page;
  });
  after(async () => {
    await opened.close();
    await watch.end();
    run.child.kill('SIGKILL');
  });

  test('is shown from its start to its end', async () => {
    await until('its title', async () => await text(page, 'title') === 'flat-plate entry');
    await until('its state', async () => /starting|running/.test(await text(page, 'state')));  // its status comes after its title
    await until('the first frame', async () => (await text(page, 'when')).startsWith('frame'));
    assert.match(await text(page, 'state'), /starting|running/, 'a frame is shown before the run has ended');
    const early = await page.locator('#progress').evaluate((p) => /** @type {HTMLProgressElement} */ (p).value);
    assert.ok(early < 1);
    await until('its processes', async () => await page.locator('#processes tbody tr').count() === 3);
    await page.screenshot({ path: join(output, 'live.png'), fullPage: true });
    await until('more of it', async () => await page.locator('#progress').evaluate((p) => /** @type {HTMLProgressElement} */ (p).value) > early);
    assert.equal(await run.ended, 0);
    await until('its end', async () => await text(page, 'state') === 'finished', 20_000);
    assert.match(await text(page, 'clocks'), /^window 240, t = 2\.4 ms of 2\.4 ms \(100\.0 %\)/);
    await until('the last frame', async () => /^frame 25 of 25, t = 2\.4 ms$/.test(await text(page, 'when')), 20_000);
    assert.match(await text(page, 'no-processes'), /has ended/);
    assert.match(await page.title(), /^finished: flat-plate entry$/);
  });

  test('shows the values of history.csv', async () => {
    await page.locator('#choose summary').click();
    for (const box of await page.locator('#choices input').all()) if (!await box.isChecked()) await box.check();
    const here = table((await saved(page, 'curves-csv')).bytes.toString()), there = table(readFileSync(join(folder, 'history.csv'), 'utf8'));
    assert.deepEqual([...here.names].sort(), [...there.names].sort());
    assert.equal(here.rows.length, there.rows.length);
    const order = here.names.map((name) => there.names.indexOf(name));
    assert.deepEqual(here.rows, there.rows.map((row) => order.map((c) => row[c])));
    // And in words: the last value of the deflection in the label of its chart.
    const last = there.rows.at(-1)?.[there.names.indexOf('mid.y [m]')] ?? NaN;
    assert.match(await page.locator('#charts figure[aria-label^="mid "]').getAttribute('aria-label') ?? '',
      new RegExp(`${Number((1e3 * last).toPrecision(4))} mm$`));
  });

  test('draws curves with units, chosen by boxes, as an SVG file', async () => {
    const titles = await page.locator('#charts h3').allTextContents();
    for (const title of ['mid [mm]', 'residual [m]', 'iterations', 'force [MN/m]']) assert.ok(titles.includes(title), `${title} in ${titles.join()}`);
    await page.locator('#choices label', { hasText: 'force' }).locator('input').uncheck();
    assert.ok(!(await page.locator('#charts h3').allTextContents()).includes('force [MN/m]'));
    const svg = (await saved(page, 'curves-svg')).bytes.toString();
    assert.match(svg, /^<svg .*<title>flat-plate entry/s);
    assert.match(svg, />mid \[mm\]<.*>time \[ms\]</s);
    assert.doesNotMatch(svg, /force|NaN|undefined/);
  });

  test('chooses a span of time by dragging, and gives all of it back', async () => {
    const over = page.locator('#charts .u-over').first();
    const box = await over.boundingBox();
    assert.ok(box);
    await over.scrollIntoViewIfNeeded();
    const at = await over.boundingBox() ?? box;
    await page.mouse.move(at.x + 0.3 * at.width, at.y + 40);
    await page.mouse.down();
    await page.mouse.move(at.x + 0.6 * at.width, at.y + 40, { steps: 4 });
    await page.mouse.up();
    const part = table((await saved(page, 'curves-csv')).bytes.toString()).rows.length;
    assert.ok(part > 30 && part < 110, `${part} rows`);
    await page.locator('#curves-reset').click();
    assert.equal(table((await saved(page, 'curves-csv')).bytes.toString()).rows.length, 240);
  });

  test('shows the frame of a time that is clicked on a curve', async () => {
    const over = page.locator('#charts .u-over').first();
    await over.scrollIntoViewIfNeeded();
    const box = await over.boundingBox();
    assert.ok(box);
    await page.mouse.click(box.x + 0.5 * box.width, box.y + 30);
    await until('a frame of the middle', async () => /^frame 1[234] of 25/.test(await text(page, 'when')), 10_000);
  });

  test('goes through the frames', async () => {
    await page.locator('#first').click();
    await until('the first', async () => await text(page, 'when') === 'frame 1 of 25, t = 0 s', 10_000);
    const first = await picture(page);
    await page.locator('#next').click();
    await until('the second', async () => (await text(page, 'when')).startsWith('frame 2 of 25'), 10_000);
    await page.locator('#back').click();
    await until('the first again', async () => (await text(page, 'when')).startsWith('frame 1 of 25'), 10_000);
    await page.locator('#scrub').fill('19');
    await until('the twentieth', async () => (await text(page, 'when')).startsWith('frame 20 of 25'), 10_000);
    await until('its picture', async () => await picture(page) !== first, 10_000);
    assert.equal(await page.locator('#live').getAttribute('aria-pressed'), 'false');
    await page.locator('#play').click();
    assert.equal(await text(page, 'play'), 'Stop');
    await until('the end of playing', async () => await text(page, 'play') === 'Play', 20_000);
    assert.match(await text(page, 'when'), /^frame 25 of 25/);
    await page.locator('#first').click();
    await page.locator('#live').click();
    await until('the last', async () => (await text(page, 'when')).startsWith('frame 25 of 25'), 10_000);
    assert.equal(await page.locator('#live').getAttribute('aria-pressed'), 'true');
  });

  test('colours by the field that is asked for, with its range and unit', async () => {
    assert.match(await text(page, 'water-legend'), /^pressure of the water \[[kM]?Pa\]/);
    assert.match(await text(page, 'solid-legend'), /^von Mises stress of the structure \[[kM]?Pa\]/);
    const before = await picture(page);
    await page.locator('#water-field').selectOption('speed');
    await until('the speed', async () => (await text(page, 'water-legend')).startsWith('speed of the water [m/s]'), 10_000);
    await page.locator('#solid-field').selectOption('displacement');
    await until('the displacement', async () => (await text(page, 'solid-legend')).startsWith('displacement of the structure'), 10_000);
    await wait(200);
    assert.notEqual(await picture(page), before);
    await page.locator('#water-field').selectOption('pressure');
    await page.locator('#solid-field').selectOption('von_mises');
    await page.locator('#colours').selectOption('fixed');
    await page.locator('#water-low').fill('0');
    await page.locator('#water-high').fill('4e6');
    await until('the fixed range', async () => /pressure of the water \[MPa\].*4$/s.test(await text(page, 'water-legend')), 10_000);
    await page.locator('#colours').selectOption('widest');
    await page.locator('#colours').selectOption('frame');
  });

  test('draws the deformation larger, and hides the walls', async () => {
    await page.locator('#fit').click();
    await wait(200);
    const before = await picture(page);
    await page.locator('#scale').fill('30');
    await wait(300);
    const bent = await picture(page);
    assert.notEqual(bent, before);
    await page.locator('#walls').uncheck();
    await wait(300);
    assert.notEqual(await picture(page), bent);
    await page.locator('#stage').screenshot({ path: join(output, 'deformation-30.png') });
    await page.locator('#walls').check();
    await page.locator('#scale').fill('1');
    await wait(300);
    assert.equal(await picture(page), before);
  });

  test('moves and zooms by mouse and keys', async () => {
    const canvas = page.locator('#canvas');
    await page.locator('#fit').click();
    await wait(200);
    const whole = await picture(page);
    const box = await canvas.boundingBox();
    assert.ok(box);
    await page.mouse.move(box.x + 0.5 * box.width, box.y + 0.5 * box.height);
    await page.mouse.wheel(0, -600);
    await wait(200);
    const zoomed = await picture(page);
    assert.notEqual(zoomed, whole);
    await page.mouse.down();
    await page.mouse.move(box.x + 0.7 * box.width, box.y + 0.6 * box.height, { steps: 3 });
    await page.mouse.up();
    await wait(200);
    const moved = await picture(page);
    assert.notEqual(moved, zoomed);
    await canvas.focus();
    for (const key of ['ArrowLeft', 'ArrowUp', '+', '-', '-']) await page.keyboard.press(key);
    await wait(200);
    assert.notEqual(await picture(page), moved);
    await page.keyboard.press('f');
    await canvas.blur();
    await wait(200);
    assert.equal(await picture(page), whole);
  });

  test('says the values of a particle that is picked, and follows it', async () => {
    const canvas = page.locator('#canvas');
    const box = await canvas.boundingBox();
    assert.ok(box);
    await page.mouse.click(box.x + 0.3 * box.width, box.y + 0.62 * box.height);
    await page.locator('#picked').waitFor({ state: 'visible' });
    const name = await text(page, 'picked-h');
    assert.match(name, /^Particle \d+$/);
    const values = await text(page, 'picked-values');
    assert.match(values, /position[−\d.]+ m?m, [−\d.]+ m?m/);
    assert.match(values, /pressure[−\d.e]+ [kM]?Pa/);
    assert.match(values, /kindwater/);
    await page.screenshot({ path: join(output, 'picked.png') });
    await page.locator('#back').click();
    await until('its values a frame before', async () => await text(page, 'picked-values') !== values, 10_000);
    assert.equal(await text(page, 'picked-h'), name);
    await page.locator('#picked-close').click();
    assert.ok(await page.locator('#picked').isHidden());
    await page.keyboard.press('Enter');  // the canvas has the focus; the plate stands near the middle
    await page.locator('#picked').waitFor({ state: 'visible' });
    await page.keyboard.press('Escape');
    assert.ok(await page.locator('#picked').isHidden());
    await page.locator('#live').click();
  });

  test('saves its picture', async () => {
    const png = await saved(page, 'picture');
    assert.match(png.name, /^plate_entry-live-pressure-0\.00240\d*s\.png$/);
    assert.equal(png.bytes.subarray(1, 4).toString(), 'PNG');
    assert.ok(png.bytes.length > 20_000, `${png.bytes.length} bytes`);
  });

  test('says where the time goes, and shows the logs', async () => {
    assert.match(await text(page, 'stages'), /fluid\.pressure.*%/s);
    assert.match(await text(page, 'log'), /exit code 0/);
    await page.locator('#log-name').selectOption('fluid');
    await until('the log of the fluid', async () => (await text(page, 'log')).includes('as fluid, process'), 10_000);
    await page.locator('#log-name').selectOption('coupler');
  });

  test('can be held and goes on', async () => {
    await page.locator('#pause').click();
    assert.equal(await text(page, 'pause'), 'Go on');
    await wait(2000);  // earlier requests are answered
    let asked = 0;
    page.on('request', () => { ++asked; });
    await wait(6000);
    assert.equal(asked, 0);
    await page.locator('#pause').click();
    await until('news', () => asked > 0, 10_000);
  });

  test('is used by keys alone', async () => {
    await page.keyboard.press('?');
    assert.ok(await page.locator('#keys').isVisible());
    await accessible(page, 'the keys');
    await page.keyboard.press('Escape');
    assert.ok(await page.locator('#keys').isHidden());
    await page.locator('#keys-open').click();
    await page.locator('#keys-close').click();
    await page.evaluate(() => { /** @type {HTMLElement} */ (document.activeElement).blur(); });
    for (const [key, said] of [['Home', /^frame 1 of/], ['.', /^frame 2 of/], [',', /^frame 1 of/], ['l', /^frame 25 of/]]) {
      await page.keyboard.press(String(key));
      await until(`what ${String(key)} does`, async () => /** @type {RegExp} */ (said).test(await text(page, 'when')), 10_000);
    }
    await page.keyboard.press(' ');
    assert.equal(await text(page, 'pause'), 'Go on');
    await page.keyboard.press(' ');
    assert.equal(await text(page, 'pause'), 'Pause');
    // Tab comes to everything that can be used, and shows where it is.
    const usable = await page.evaluate(() => {
      const all = [...document.querySelectorAll('a[href], button, input, select, summary, [tabindex="0"]')];
      const seen = all.filter((e) => /** @type {HTMLElement} */ (e).offsetParent !== null && !(/** @type {HTMLButtonElement} */ (e).disabled));
      seen.forEach((e, k) => { e.setAttribute('data-use', String(k)); });
      return seen.length;
    });
    const reached = new Set();
    await page.evaluate(() => { window.scrollTo(0, 0); /** @type {HTMLElement} */ (document.activeElement).blur(); });
    for (let k = 0; k < usable + 5; ++k) {
      await page.keyboard.press('Tab');
      const at = await page.evaluate(() => {
        const e = document.activeElement;
        if (e === null || e === document.body) return null;
        const style = getComputedStyle(e);
        return { use: e.getAttribute('data-use'), what: e.outerHTML.slice(0, 80), outline: style.outlineStyle !== 'none' && parseFloat(style.outlineWidth) >= 2 };
      });
      if (at === null) continue;
      assert.ok(at.outline, `the focus does not show on ${at.what}`);
      if (at.use !== null) reached.add(at.use);
    }
    assert.equal(reached.size, usable);
  });

  test('has contrast, names and order in light and dark, on a desk and on a phone', async () => {
    for (const [what, colorScheme, width, height] of /** @type {const} */ ([['desk-light', 'light', 1440, 1000], ['desk-dark', 'dark', 1440, 1000],
      ['phone-light', 'light', 390, 844], ['phone-dark', 'dark', 390, 844]])) {
      const other = await open(browser, watch.address, { colorScheme, viewport: { width, height } });
      await until('a picture', async () => (await text(other.page, 'when')).startsWith('frame 25'), 30_000);
      await until('the curves', async () => await other.page.locator('#charts figure').count() > 3, 30_000);
      await wait(500);
      await accessible(other.page, what);
      assert.ok(await sideways(other.page) <= 0, `${what}: the page is wider than the screen`);
      await other.page.screenshot({ path: join(output, `${what}.png`), fullPage: true });
      assert.deepEqual(other.complaints, [], what);
      await other.close();
    }
  });

  test('can be closed and opened again, and says when its server is gone', async () => {
    assert.deepEqual(opened.complaints, []);
    await watch.end();
    await page.locator('#live').click();
    await until('the notice', async () => /does not answer/.test(await text(page, 'notice')) && await page.locator('#notice').isVisible(), 20_000);
    const port = new URL(watch.address).port;
    watch = await startWatch(folder, ['--port', port]);  // with another token
    await until('what to do', async () => /not valid any more/.test(await text(page, 'notice')), 20_000);
    await opened.close();
    opened = await open(browser, watch.address);
    page = opened.page;
    await until('the run again', async () => (await text(page, 'when')).startsWith('frame 25 of 25'), 20_000);
  });
});

describe('a run in space', () => {
  test('can be turned', async () => {
    const folder = join(runs, 'space');
    makeRun(folder, 8000, 3, 4);
    const watch = await startWatch(folder);
    const { page, complaints, close } = await open(browser, watch.address);
    await until('a picture', async () => (await text(page, 'when')).startsWith('frame 4 of 4'), 20_000);
    await wait(300);
    const seen = new Set([await picture(page)]);
    await page.locator('#stage').screenshot({ path: join(output, 'space.png') });
    for (const name of ['Front', 'Side', 'Top', 'Oblique']) {
      await page.getByRole('button', { name, exact: true }).click();
      await wait(300);
      seen.add(await picture(page));
    }
    assert.equal(seen.size, 4);  // the first is the oblique one
    const box = await page.locator('#canvas').boundingBox();
    assert.ok(box);
    await page.mouse.move(box.x + 200, box.y + 200);
    await page.mouse.down();
    await page.mouse.move(box.x + 320, box.y + 160, { steps: 4 });
    await page.mouse.up();
    await wait(300);
    seen.add(await picture(page));
    assert.equal(seen.size, 5);
    await page.mouse.click(box.x + 0.5 * box.width, box.y + 0.55 * box.height);
    await page.locator('#picked').waitFor({ state: 'visible' });
    assert.match(await text(page, 'picked-values'), /position[−\d.]+ m?m, [−\d.]+ m?m, [−\d.]+ m?m/);
    await accessible(page, 'space');
    assert.deepEqual(complaints, []);
    await close();
    await watch.end();
  });
});

describe('a run with two bodies', () => {
  test('is shown with their names', async () => {
    const made = join(runs, 'two.toml');
    spawnSync(join(bin, 'strake'), ['new', 'bodies', '-o', made], { encoding: 'utf8' });
    const run = startRun(runs, [made, '--set', 'end_time=0.0022', '--set', 'structures.right.solver=rigid']);
    assert.equal(await run.ended, 0);
    const watch = await startWatch(join(runs, 'two'));
    const { page, complaints, close } = await open(browser, watch.address);
    await until('a picture', async () => (await text(page, 'when')).startsWith('frame'), 20_000);
    await until('the curves', async () => await page.locator('#charts figure').count() > 3, 20_000);
    await wait(300);
    await page.screenshot({ path: join(output, 'two.png'), fullPage: true });
    const charts = await page.locator('#charts').innerText();
    for (const name of ['left_mid', 'right_mid']) assert.ok(charts.includes(name), name);
    const box = await page.locator('#canvas').boundingBox();
    assert.ok(box);
    const places = await page.evaluate(() => {
      // @ts-expect-error -- put there by main.ts
      const { stage, sides } = window.strake.fields;
      return sides.bodies.map((/** @type {{low: number[], high: number[]}} */ b) =>
        stage.camera.project(0.5 * (b.low[0] + b.high[0]), b.high[1], 0));
    });
    assert.equal(places.length, 2);
    for (const [k, name] of ['left', 'right'].entries()) {
      await page.mouse.click(box.x + places[k][0], box.y + places[k][1]);
      await until(`the values of ${name}`, async () => (await text(page, 'picked-h')).startsWith(`${name}, point`), 20_000);
      await page.locator('#picked-close').click();  // the card covers a part of the picture
    }
    assert.deepEqual(complaints, []);
    await close();
    await watch.end();
  });
});
