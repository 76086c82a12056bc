import uPlot from 'uplot';
import { colour, el, make, save, say, show } from './dom';
import { firstGroups, groupsOf } from './groups';
import type { Group } from './groups';
import { chartsAsSvg } from './svg';
import { Table } from './table';
import { heading, prefixFor, quantity, roundTicks, tickText } from './units';
import type { Prefix } from './units';

const dashes = [[], [9, 3], [4, 2], [10, 3, 2, 3], [6, 2, 1, 2], [14, 3], [3, 3], [8, 2, 3, 2]];
const height = 190;

interface Chart { group: Group; plot: uPlot; box: HTMLElement; title: HTMLElement; unit: Prefix }

/** Histories of the run: one chart for each group that is chosen. */
export class Curves {
  readonly table = new Table('history');
  onTime: (time: number) => void = () => { /* no listener yet */ };
  private groups: Group[] = [];
  private chosen: string[] | null = null;
  private charts: Chart[] = [];
  private span: [number, number] | null = null;  // of time [s]; all
  private marked = NaN;                          // time of the frame that is shown [s]
  private clock: Prefix = { factor: 1, text: '' };
  private syncing = false;

  constructor(private readonly name: () => string, private readonly title: () => string) {
    el('curves-reset').addEventListener('click', () => { this.setSpan(null); });
    el('curves-csv').addEventListener('click', () => { this.saveCsv(); });
    el('curves-svg').addEventListener('click', () => { this.saveSvg(); });
    new ResizeObserver(() => { this.resize(); }).observe(el('charts'));
    matchMedia('(prefers-color-scheme: dark)').addEventListener('change', () => { this.build(); });
  }

  /** Called for new lines of the table. */
  update(): void {
    const groups = groupsOf(this.table);
    const other = groups.map((g) => g.key).join() !== this.groups.map((g) => g.key).join();
    this.groups = groups;
    if (this.table.rows === 0) {
      this.destroy();
      show(el('no-curves'), true);
      return;
    }
    show(el('no-curves'), false);
    if (this.chosen === null || !this.chosen.some((key) => groups.some((g) => g.key === key))) this.chosen = firstGroups(groups, this.table);
    const time = this.time();
    const clock = prefixFor(time[time.length - 1] ?? 0, 's');
    const prefixed = clock.text !== this.clock.text;
    this.clock = clock;
    if (other || this.charts.length === 0) {
      this.offer();
      this.build();
    } else if (prefixed) {
      this.build();
    } else {
      for (const chart of this.charts) {
        if (this.prefix(chart.group).text !== chart.unit.text) { this.build(); return; }
        this.syncing = true;
        chart.plot.setData(this.data(chart.group), false);
        this.syncing = false;
        this.setScale(chart.plot);
        this.sayLast(chart.plot);
      }
    }
  }

  /** Without a pointer on the curves, the legend shows the latest values. */
  private sayLast(plot: uPlot): void {
    if ((plot.cursor.left ?? -1) < 0) plot.setLegend({ idx: this.table.rows - 1 }, false);
  }

  /** Marks the time of the frame that is shown. */
  mark(time: number): void {
    this.marked = time;
    for (const chart of this.charts) chart.plot.redraw(false);
  }

  private time(): Float64Array { return this.table.column(this.table.find('time')); }

  private prefix(group: Group): Prefix {
    if (group.logarithmic) return { factor: 1, text: '' };
    let largest = 0;
    for (const c of group.columns) for (const v of this.table.column(c)) if (Math.abs(v) > largest) largest = Math.abs(v);
    return prefixFor(largest, group.unit);
  }

  /** Gaps are null; a residual of 0 has no logarithm. */
  private data(group: Group): uPlot.AlignedData {
    return [Array.from(this.time()), ...group.columns.map((c) =>
      Array.from(this.table.column(c), (v) => Number.isFinite(v) && !(group.logarithmic && v <= 0) ? v : null))];
  }

  private offer(): void {
    const box = el('choices');
    box.replaceChildren(box.querySelector('legend') as HTMLElement, ...this.groups.map((group) => {
      const input = make('input');
      input.type = 'checkbox';
      input.checked = this.chosen?.includes(group.key) ?? false;
      input.addEventListener('change', () => {
        this.chosen = this.groups.map((g) => g.key).filter((key) => key === group.key ? input.checked : this.chosen?.includes(key));
        this.build();
      });
      const label = make('label', '', input, document.createTextNode(` ${group.title}${group.unit === '1' ? '' : ` [${group.unit}]`}`));
      label.className = 'check';
      return label;
    }));
  }

  private destroy(): void {
    for (const chart of this.charts) chart.plot.destroy();
    this.charts = [];
    el('charts').replaceChildren();
  }

  private build(): void {
    this.destroy();
    if (this.table.rows === 0) return;
    for (const group of this.groups.filter((g) => this.chosen?.includes(g.key) ?? false)) this.charts.push(this.chart(group));
    for (const chart of this.charts) {
      this.setScale(chart.plot);
      this.sayLast(chart.plot);
    }
  }

  private setScale(plot: uPlot): void {
    const time = this.time();
    const [min, max] = this.span ?? [time[0] ?? 0, time[time.length - 1] ?? 1];
    this.syncing = true;
    plot.setScale('x', { min, max: max > min ? max : min + 1e-12 + Math.abs(min) * 1e-6 });
    this.syncing = false;
  }

  private setSpan(span: [number, number] | null): void {
    this.span = span;
    for (const chart of this.charts) this.setScale(chart.plot);
  }

  private chart(group: Group): Chart {
    const unit = this.prefix(group);
    const title = make('h3', heading(group.title, group.unit, unit));
    const box = make('div');
    const figure = make('figure', '', title, box);
    el('charts').append(figure);
    const last = group.columns.map((c) => this.table.column(c).at(-1));
    figure.setAttribute('aria-label', `${group.title} over time, at last ${last.map((v) => quantity(v, group.unit)).join(', ')}`);
    figure.setAttribute('role', 'group');
    const ink = colour('--ink'), grid = colour('--grid'), clock = this.clock;
    const axis = { stroke: ink, grid: { stroke: grid, width: 1 }, ticks: { stroke: grid, width: 1 }, font: '12px system-ui, "DejaVu Sans", sans-serif' };
    const linear = (scale: Prefix) => (_: uPlot, splits: number[]): string[] =>
      splits.map((v) => tickText(v * scale.factor, (splits[1] ?? 0) * scale.factor - (splits[0] ?? 0) * scale.factor));
    const round = (scale: Prefix) => (_: uPlot, __: number, min: number, max: number, ___: number, space: number): number[] =>
      roundTicks(min * scale.factor, max * scale.factor, space).map((v) => v / scale.factor);
    const wanted = (of: (u: uPlot) => number) => (u: uPlot): number => Math.max(2, Math.floor(of(u)));
    const plot = new uPlot({
      width: Math.max(200, box.clientWidth), height,
      scales: {
        x: { time: false },
        y: group.logarithmic ? { distr: 3, log: 10 } : {
          range: (_, min, max) => {
            if (min === max) { const w = min === 0 ? 1 : 0.1 * Math.abs(min); return [min - w, max + w]; }
            return [min - 0.06 * (max - min), max + 0.06 * (max - min)];
          },
        },
      },
      axes: [
        { ...axis, values: linear(clock), splits: (u, i, a, b, c) => round(clock)(u, i, a, b, c, wanted((v) => v.width / 75)(u)), label: `time [${clock.text}s]`, labelSize: 18, size: 34, labelFont: axis.font },
        group.logarithmic
          ? { ...axis, size: 60, values: (_, splits) => splits.map((v) => Number.isInteger(Math.round(1e9 * Math.log10(v)) / 1e9) ? `1e${Math.round(Math.log10(v))}`.replace('-', '−') : '') }
          : { ...axis, size: 60, values: linear(unit), splits: (u, i, a, b, c) => round(unit)(u, i, a, b, c, 5) },
      ],
      series: [
        { label: `time [${clock.text}s]`, value: (_, v) => !Number.isFinite(v) ? '–' : String(Number((v * clock.factor).toPrecision(6))) },
        ...group.columns.map((c, k) => ({
          label: this.table.columns[c]?.name ?? '', stroke: colour(`--s${k % 8}`), width: 1.8, dash: dashes[k % dashes.length],
          points: { show: this.table.rows === 1 },
          value: (_: uPlot, v: number | null) => v === null ? '–' : quantity(v, group.unit, 5),
        })),
      ],
      legend: { live: true },
      cursor: { sync: { key: 'strake', setSeries: false }, drag: { x: true, y: false }, points: { size: 6 } },
      hooks: {
        setCursor: [(u) => { this.sayLast(u); }],
        setScale: [(u, key) => {
          if (key !== 'x' || this.syncing) return;
          const { min, max } = u.scales['x'] ?? {};
          const time = this.time();
          if (typeof min !== 'number' || typeof max !== 'number') return;
          const whole = min <= (time[0] ?? 0) && max >= (time[time.length - 1] ?? 0);
          this.setSpan(whole ? null : [min, max]);
        }],
        draw: [(u) => {
          if (!Number.isFinite(this.marked)) return;
          const x = u.valToPos(this.marked, 'x', true);
          if (x < u.bbox.left || x > u.bbox.left + u.bbox.width) return;
          u.ctx.save();
          u.ctx.strokeStyle = colour('--muted');
          u.ctx.lineWidth = window.devicePixelRatio || 1;
          u.ctx.setLineDash([4, 3]);
          u.ctx.beginPath();
          u.ctx.moveTo(x, u.bbox.top);
          u.ctx.lineTo(x, u.bbox.top + u.bbox.height);
          u.ctx.stroke();
          u.ctx.restore();
        }],
        ready: [(u) => {
          let from = NaN;
          u.over.addEventListener('pointerdown', (event) => { from = event.clientX; });
          u.over.addEventListener('click', (event) => {
            if (Math.abs(event.clientX - from) < 4) this.onTime(u.posToVal(event.offsetX, 'x'));
          });
        }],
      },
    }, this.data(group), box);
    return { group, plot, box, title, unit };
  }

  private resize(): void {
    for (const chart of this.charts) {
      const width = Math.max(200, chart.box.clientWidth);
      if (Math.abs(chart.plot.width - width) > 1) chart.plot.setSize({ width, height });
    }
  }

  private shownGroups(): Group[] { return this.charts.map((chart) => chart.group); }

  /** As history.csv: the shortest text that reads back to the same number; what is not known is empty. */
  csv(): string {
    const columns = [this.table.find('window'), this.table.find('time'), ...this.shownGroups().flatMap((g) => g.columns)].filter((c) => c >= 0);
    const lines = [columns.map((c) => `${this.table.columns[c]?.name ?? ''} [${this.table.columns[c]?.unit ?? ''}]`).join(',')];
    const time = this.time();
    for (let row = 0; row < this.table.rows; ++row) {
      if (this.span !== null && !(time[row]! >= this.span[0] && time[row]! <= this.span[1])) continue;
      lines.push(columns.map((c) => { const v = this.table.column(c)[row]!; return Number.isNaN(v) ? '' : String(v); }).join(','));
    }
    return lines.join('\n') + '\n';
  }

  private saveCsv(): void {
    save(`${this.name()}-curves.csv`, new Blob([this.csv()], { type: 'text/csv' }));
  }

  private saveSvg(): void {
    const light = ['#0b62c4', '#c2410c', '#11734b', '#8b2fb0', '#8a5a00', '#0e7490', '#b4235f', '#57606a'];  // colours.css on white
    save(`${this.name()}-curves.svg`, new Blob([chartsAsSvg(this.title(), this.table, this.shownGroups(), light, this.span)], { type: 'image/svg+xml' }));
  }

  /** How much is shown, in words. */
  sayRows(to: HTMLElement): void { say(to, `${this.table.rows} rows`); }
}
