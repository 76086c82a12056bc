// What the tests of the page stand on: a run, its page, and a browser.
import { chromium } from 'playwright-core';
import { spawn, spawnSync } from 'node:child_process';
import { existsSync, mkdirSync, mkdtempSync, rmSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { join } from 'node:path';
import { fileURLToPath } from 'node:url';

export const root = fileURLToPath(new URL('../..', import.meta.url));
export const bin = process.env['STRAKE_BIN'] ?? join(root, 'build/bin');
export const output = process.env['STRAKE_BROWSER_OUTPUT'] ?? join(root, 'build/browser');
mkdirSync(output, { recursive: true });

export const wait = (/** @type {number} */ ms) => new Promise((resolve) => { setTimeout(resolve, ms); });

/** Waits until something is so; a test that waits in vain says for what.
 * @param {string} what @param {() => unknown} so @param {number} limit [ms] */
export async function until(what, so, limit = 120_000) {
  const end = Date.now() + limit;
  while (!await so()) {
    if (Date.now() > end) throw new Error(`waited in vain for ${what}`);
    await wait(100);
  }
}

/** A folder for runs, gone with the tests. */
export function temporaryFolder() {
  const path = mkdtempSync(join(tmpdir(), 'strake-browser-'));
  process.on('exit', () => { rmSync(path, { recursive: true, force: true }); });
  return path;
}

/** @type {import('node:child_process').ChildProcess[]} */
const started = [];
/** Ends what a test that failed has left behind, or Node would wait for it. */
export function endAll() {
  for (const child of started) child.kill('SIGKILL');
}

const environment = { ...process.env, OMP_WAIT_POLICY: 'passive', OPENBLAS_NUM_THREADS: '1' };

/** Starts a run; its folder, and a promise of its exit code.
 * @param {string} runs @param {string[]} words */
export function startRun(runs, words) {
  const child = spawn(join(bin, 'strake'), ['run', ...words, '--runs', runs, '--quiet'], { cwd: root, env: environment, stdio: 'inherit' });
  const ended = new Promise((resolve) => { child.on('exit', (code, signal) => { resolve(code ?? signal); }); });
  started.push(child);
  return { child, ended };
}

/** Serves the page of a run; its address once that is printed.
 * @param {string} folder @param {string[]} more */
export async function startWatch(folder, more = []) {
  await until(`${folder}/run.json`, () => existsSync(join(folder, 'run.json')));
  const child = spawn(join(bin, 'strake'), ['watch', folder, '--web', ...more], { cwd: root, env: environment });
  started.push(child);
  let said = '';
  child.stdout.on('data', (/** @type {Buffer} */ data) => { said += data.toString(); });
  child.stderr.on('data', (/** @type {Buffer} */ data) => { said += data.toString(); });
  await until('the address of the page', () => /http:\/\/\S+\//.test(said) || child.exitCode !== null);
  const address = /http:\/\/\S+\//.exec(said)?.[0];
  if (address === undefined) throw new Error(`strake watch says: ${said}`);
  const ended = new Promise((resolve) => { child.on('exit', resolve); });
  return { child, address, end: async () => { child.kill('SIGINT'); await ended; } };
}

/** A run as make_run.py makes it.
 * @param {string} folder @param {...(string | number)} words */
export function makeRun(folder, ...words) {
  const made = spawnSync('/usr/bin/python3', [join(root, 'tests/browser/make_run.py'), folder, ...words.map(String)], { encoding: 'utf8' });
  if (made.status !== 0) throw new Error(made.stderr);
}

/** Debian's Chromium, drawing WebGL by software, connected only to the page's server. */
export function launch() {
  return chromium.launch({
    executablePath: process.env['STRAKE_CHROMIUM'] ?? '/usr/bin/chromium',
    args: ['--no-sandbox', '--disable-gpu-sandbox', '--use-gl=angle', '--use-angle=swiftshader', '--enable-unsafe-swiftshader',
      '--disable-background-networking', '--disable-component-update', '--disable-domain-reliability', '--disable-sync',
      '--disable-default-apps', '--disable-extensions', '--metrics-recording-only', '--no-first-run', '--no-default-browser-check',
      '--host-resolver-rules=MAP * ~NOTFOUND, EXCLUDE 127.0.0.1'],
  });
}

/** A page, and all that it complains of.
 * @param {import('playwright-core').Browser} browser @param {string} address
 * @param {import('playwright-core').BrowserContextOptions} options */
export async function open(browser, address, options = {}) {
  const context = await browser.newContext({ viewport: { width: 1440, height: 1000 }, colorScheme: 'light', acceptDownloads: true, ...options });
  const page = await context.newPage();
  /** @type {string[]} */
  const complaints = [];
  page.on('console', (message) => { if (['error', 'warning'].includes(message.type())) complaints.push(message.text()); });
  page.on('pageerror', (error) => { complaints.push(error.message); });
  page.on('request', (request) => {
    if (!request.url().startsWith(new URL(address).origin) && !/^(data|blob):/.test(request.url())) complaints.push(`asks ${request.url()}`);
  });
  await page.goto(address);
  return { page, complaints, close: () => context.close() };
}
