// The page of `strake watch --web`: requests news, and shows what has changed.
import { json, Refused } from './api';
import type { News, RunFacts } from './api';
import { Curves } from './curves';
import { el, say, show } from './dom';
import { Fields } from './fields';
import { Log, showProcesses, showStages, showState } from './panels';

const whileOpen = 700, whileHidden = 5000, afterEnd = 5000, afterFault = 2000;  // [ms] between two questions

let facts: RunFacts;
let fields: Fields;
let curves: Curves;
let paused = false;
let timer = 0;

function pause(yes: boolean): void {
  paused = yes;
  window.clearTimeout(timer);
  el('pause').setAttribute('aria-pressed', String(yes));
  say(el('pause'), yes ? 'Go on' : 'Pause');
  if (!yes) ask(0);
}

function ask(after: number): void {
  window.clearTimeout(timer);
  if (!paused) timer = window.setTimeout(() => { void look(); }, after);
}

async function learnFacts(): Promise<void> {
  facts = await json<RunFacts>('api/run');
  say(el('title'), facts.title);
  say(el('folder'), facts.folder + (facts.host === '' ? '' : `, on ${facts.host}`));
}

async function look(): Promise<void> {
  try {
    const news = await json<News>('api/news');
    if (!facts.known) {  // the page came before the run's own files
      await learnFacts();
      fields.setDimension(facts);
    }
    document.title = `${news.end_time !== null && news.open ? `${Math.floor(100 * Math.min(1, news.time / news.end_time))} % ` : ''}${news.state}: ${facts.title}`;
    showState(news);
    showStages(news);
    showProcesses(news);
    const log = logs.update(news);
    if (await curves.table.learn(news.tables['history'])) curves.update();
    if (await fields.frames.learn(news)) await fields.update();
    await log;
    show(el('notice'), false);
    ask(document.hidden ? whileHidden : news.open ? whileOpen : afterEnd);
  } catch (error) {
    const gone = error instanceof Refused && error.status === 403;
    say(el('notice'), gone
      ? 'This address is not valid any more: use the one that strake watch --web printed last.'
      : error instanceof TypeError
        ? 'The server of this page does not answer: strake watch --web has ended, or the connection is cut. What is shown stays; trying again …'
        : `Something went wrong: ${error instanceof Error ? error.message : String(error)}; trying again …`);
    show(el('notice'), true);
    if (!gone) ask(afterFault);
  }
}

function keyboard(event: KeyboardEvent): void {
  const target = event.target as HTMLElement;
  if (event.ctrlKey || event.altKey || event.metaKey || ['INPUT', 'SELECT', 'TEXTAREA'].includes(target.tagName)) {
    if (!(target instanceof HTMLInputElement && target.type === 'range' && /^[.,plfPLF?]$/.test(event.key))) return;
  }
  if (el<HTMLDialogElement>('keys').open) return;
  const does: Record<string, () => void> = {
    ' ': () => { pause(!paused); }, ',': () => { fields.step(-1); }, '.': () => { fields.step(1); }, Home: () => { fields.first(); },
    p: () => { fields.togglePlay(); }, l: () => { fields.latest(); }, f: () => { fields.fit(); },
    '?': () => { el<HTMLDialogElement>('keys').showModal(); },
  };
  if (event.key === ' ' && ['BUTTON', 'SUMMARY', 'A'].includes(target.tagName)) return;  // presses it
  const action = does[event.key.length === 1 ? event.key.toLowerCase() : event.key];
  if (action === undefined) return;
  event.preventDefault();
  action();
}

const logs = new Log();

async function begin(): Promise<void> {
  try {
    await learnFacts();
  } catch (error) {
    say(el('notice'), `The run cannot be read: ${error instanceof Error ? error.message : String(error)}; trying again …`);
    show(el('notice'), true);
    window.setTimeout(() => { void begin(); }, afterFault);
    return;
  }
  fields = new Fields(facts);
  curves = new Curves(() => facts.name, () => facts.title);
  fields.onTime = (time) => { curves.mark(time); };
  curves.onTime = (time) => { void fields.showTime(time); };
  el('pause').addEventListener('click', () => { pause(!paused); });
  el('keys-open').addEventListener('click', () => { el<HTMLDialogElement>('keys').showModal(); });
  el('keys-close').addEventListener('click', () => { el<HTMLDialogElement>('keys').close(); });
  document.addEventListener('keydown', keyboard);
  document.addEventListener('visibilitychange', () => { if (!document.hidden) ask(0); });
  matchMedia('(prefers-color-scheme: dark)').addEventListener('change', () => { fields.redraw(); });
  // The functions that tests and measurements call.
  Object.assign(window, { strake: { fields, curves } });
  ask(0);
}

void begin();
