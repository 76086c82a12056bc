import { json } from './api';
import type { LogPart, News, ProcessFacts } from './api';
import { el, make, say, show } from './dom';
import { bytes, duration, grouped, quantity } from './units';

const badges: Record<string, string> = {
  starting: 'open', running: 'good', silent: 'open', finished: 'good', stopped: 'open', failed: 'bad', killed: 'bad', elsewhere: 'open',
};

/** State, clocks and progress. */
export function showState(news: News): void {
  const state = el('state');
  say(state, news.state);
  state.className = `badge ${badges[news.state] ?? 'open'}`;
  const words = news.words.startsWith(news.state) ? news.words.slice(news.state.length).replace(/^[ ,:]+/, '') : news.words;
  say(el('words'), words);
  const progress = el<HTMLProgressElement>('progress');
  const share = news.end_time !== null && news.end_time > 0 ? Math.min(1, news.time / news.end_time) : 0;
  show(progress, news.end_time !== null);
  progress.value = share;
  let text = `window ${grouped(news.window)}, t = ${quantity(news.time, 's')}`;
  if (news.end_time !== null) text += ` of ${quantity(news.end_time, 's')} (${(100 * share).toFixed(1)} %)`;
  text += `, ${duration(news.elapsed)}`;
  if (news.left !== null) text += `, about ${duration(news.left)} left`;
  say(el('clocks'), text);
  say(el('error'), news.error);
  show(el('error'), news.error !== '');
}

/** Seconds of each stage, as bars. */
export function showStages(news: News): void {
  const total = news.stages.reduce((sum, stage) => sum + stage.seconds, 0);
  show(el('stages'), total > 0);
  show(el('no-stages'), !(total > 0));
  if (!(total > 0)) return;
  const body = el('stages').querySelector('tbody') as HTMLElement;
  while (body.children.length > news.stages.length) body.lastElementChild?.remove();
  news.stages.forEach((stage, k) => {
    let row = body.children[k] as HTMLTableRowElement | undefined;
    if (row === undefined) {
      const name = make('th');
      name.scope = 'row';
      const bar = make('div');
      bar.className = 'bar';
      const cell = make('td', '', bar);
      cell.className = 'bars';
      row = make('tr', '', name, make('td'), make('td'), cell);
      body.append(row);
    }
    const share = stage.seconds / total;
    say(row.children[0] as HTMLElement, stage.name);
    say(row.children[1] as HTMLElement, duration(stage.seconds));
    say(row.children[2] as HTMLElement, `${(100 * share).toFixed(1)} %`);
    (row.querySelector('.bar') as HTMLElement).style.width = `${100 * share}%`;
  });
}

let before: { at: number; seconds: Map<number, number> } | null = null;

/** State of the run's processes; the load since the last update. */
export function showProcesses(news: News): void {
  const now = performance.now();
  const load = (p: ProcessFacts): string => {
    const was = before?.seconds.get(p.pid);
    return was === undefined || before === null || now - before.at < 300
      ? duration(p.cpu_seconds)
      : `${Math.max(0, 100 * (p.cpu_seconds - was) / (1e-3 * (now - before.at))).toFixed(0)} %, ${duration(p.cpu_seconds)}`;
  };
  show(el('processes'), news.processes.length > 0);
  show(el('no-processes'), news.processes.length === 0);
  say(el('no-processes'), news.open ? 'No process of this run is found on this machine.' : 'The run has ended: it has no processes.');
  (el('processes').querySelector('tbody') as HTMLElement).replaceChildren(...news.processes.map((p) => {
    const name = make('th', p.name);
    name.scope = 'row';
    return make('tr', '', name, ...[String(p.pid), p.state, load(p), bytes(p.memory)].map((text) => make('td', text)));
  }));
  if (before === null || now - before.at >= 1500) before = { at: now, seconds: new Map(news.processes.map((p) => [p.pid, p.cpu_seconds])) };
}

/** The log of one program, as it grows. */
export class Log {
  private to = -1;
  private name = '';
  private busy = false;
  private static readonly most = 200_000;  // [characters]

  constructor() {
    el('log-name').addEventListener('change', () => { this.restart(); });
  }

  private restart(): void {
    this.name = el<HTMLSelectElement>('log-name').value;
    this.to = -1;
    el('log').replaceChildren();
  }

  async update(news: News): Promise<void> {
    const names = Object.keys(news.logs ?? {});
    const select = el<HTMLSelectElement>('log-name');
    if ([...select.options].map((o) => o.value).join() !== names.join()) {
      select.replaceChildren(...names.map((name) => new Option(name, name)));
      if (names.includes(this.name)) select.value = this.name; else this.restart();
    }
    const size = news.logs?.[this.name];
    if (size === undefined || size === this.to || this.busy || this.name === '') return;
    this.busy = true;
    const asked = this.name;
    try {
      const part = await json<LogPart>(`api/log?name=${asked}&from=${this.to}`);
      if (asked === this.name) this.add(part);
    } finally {
      this.busy = false;
    }
  }

  private add(part: LogPart): void {
    const log = el('log');
    const below = log.scrollHeight - log.scrollTop - log.clientHeight < 8;
    if (part.begins) log.replaceChildren();
    this.to = part.to;
    if (part.text === '') return;
    const lines = part.text.replace(/\n$/, '').split('\n');
    log.append(...lines.map((line) => {
      const made = make('span', line + '\n');
      if (/\] \[(warn\w*)\]| warn\w* /.test(line)) made.className = 'warn';
      if (/\] \[(error|critical)\]| (error|critical) /.test(line)) made.className = 'fail';
      return made;
    }));
    for (let length = log.textContent.length; length > Log.most && log.firstElementChild !== null;) {
      length -= log.firstElementChild.textContent.length;
      log.firstElementChild.remove();
    }
    if (below) log.scrollTop = log.scrollHeight;
  }
}
