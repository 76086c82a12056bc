import { json, Refused } from './api';
import type { FieldFacts, FrameArrays, PointValues, RunFacts, Side } from './api';
import { Camera } from './camera';
import { colour, el, make, save, say, show } from './dom';
import { Frames } from './frames';
import { drawLegend, paint, words } from './legend';
import { Renderer } from './renderer';
import type { Cloud } from './renderer';
import { digits, heading, prefixFor, quantity, roundTicks, tickText } from './units';

interface Shown { arrays: FrameArrays; cloud: Cloud; number: number }
interface Picked { side: Side; id: number | null; index: number; at: [number, number, number] | null }

const axisLeft = 58, axisBelow = 34, axisAbove = 14, axisRight = 14;  // [px] room for the axes

function rgb(name: string): number[] {
  const hex = colour(name).replace('#', '');
  return [0, 2, 4].map((k) => parseInt(hex.slice(k, k + 2), 16) / 255);
}

/** The picture of one frame: what is shown of it, from where, and what the reader does with it. */
export class Fields {
  readonly frames = new Frames();
  onTime: (time: number) => void = () => { /* no listener yet */ };
  private readonly canvas = el<HTMLCanvasElement>('canvas');
  private readonly overlay = el<HTMLCanvasElement>('overlay');
  private readonly camera = new Camera();
  private renderer: Renderer | null = null;
  private readonly shown: Record<Side, Shown | null> = { fluid: null, structure: null };
  private readonly widest = new Map<string, [number, number]>();
  private at = -1;             // place of the frame
  private following = true;    // the latest frame
  private playing = 0;         // timer
  private fitted = false;
  private wanted = 0;          // number of the last request for a frame: older answers are late
  private due = false;         // a drawing is
  private picked: Picked | null = null;
  private byKeyboard = false;
  private solidSpacing: number;

  constructor(private facts: RunFacts) {
    this.solidSpacing = facts.solid_spacing;
    try {
      this.renderer = new Renderer(this.canvas);
      this.renderer.setPalette(facts.palette.water, facts.palette.solid);
    } catch (error) {
      say(el('nothing'), `Fields cannot be drawn here: ${error instanceof Error ? error.message : String(error)}. Curves and log go on.`);
    }
    el<HTMLInputElement>('walls').checked = facts.dimension === 2;
    this.setDimension(facts);
    this.listen();
    new ResizeObserver(() => { this.resize(); }).observe(el('stage'));
    this.resize();
  }

  /** What is known of the run may come after its page. */
  setDimension(facts: RunFacts): void {
    const first = !this.facts.known && facts.known;
    this.facts = facts;
    this.solidSpacing = facts.solid_spacing;
    show(el('sides'), facts.dimension === 3);
    if (facts.dimension === 3 && !this.fitted) this.look(-35, 25);
    if (first) el<HTMLInputElement>('walls').checked = facts.dimension === 2;
  }

  get time(): number { return this.at < 0 ? NaN : this.frames.time(this.at); }
  get rendererName(): string { return this.renderer?.name() ?? 'none'; }

  /** New frames are there. */
  async update(): Promise<void> {
    const n = this.frames.count;
    const scrub = el<HTMLInputElement>('scrub');
    scrub.max = String(Math.max(0, n - 1));
    scrub.disabled = n === 0;
    show(el('nothing'), n === 0 || this.renderer === null);
    if (n === 0) {
      this.at = -1;
      return;
    }
    if (this.following || this.at >= n || this.at < 0) await this.go(n - 1);
    else this.sayTime();
  }

  /** Shows the frame at that place. */
  async go(at: number): Promise<void> {
    const n = this.frames.count;
    if (n === 0) return;
    const place = Math.min(n - 1, Math.max(0, at));
    const moved = place !== this.at;
    this.at = place;
    this.sayTime();
    if (moved) this.onTime(this.time);
    const request = ++this.wanted;
    try {
      const parts = await Promise.all((['fluid', 'structure'] as const).map(async (side) => {
        const number = this.frames.number(side, place);
        return number === undefined ? null : { side, number, arrays: await this.frames.fetch(side, number, this.field(side)) };
      }));
      if (request !== this.wanted) return;
      for (const part of parts) if (part !== null) this.take(part.side, part.number, part.arrays);
    } catch (error) {
      if (error instanceof Refused && error.status === 404) return;  // gone with a resumed run: the next news report it
      throw error;
    }
    if (!this.fitted) this.fit();
    await this.follow();
    this.redraw();
  }

  async showTime(time: number): Promise<void> {
    this.follows(false);
    await this.go(this.frames.nearest(time));
  }

  private field(side: Side): string {
    const select = el<HTMLSelectElement>(side === 'fluid' ? 'water-field' : 'solid-field');
    return select.value === '' ? (side === 'fluid' ? 'pressure' : 'von_mises') : select.value;
  }

  private take(side: Side, number: number, arrays: FrameArrays): void {
    const before = this.shown[side];
    if (before !== null && before.arrays === arrays) return;
    this.offer(side, arrays);
    if (this.renderer === null) return;
    if (before !== null) this.renderer.unload(before.cloud);
    const cloud = this.renderer.load({
      position: arrays.f32('position') ?? new Float32Array(), value: arrays.f32('value'), bend: arrays.f32('bend'),
      kind: arrays.u8('kind'), triangle: arrays.u32('triangle'), edge: arrays.u32('edge'),
    });
    this.shown[side] = { arrays, cloud, number };
    const field = arrays.head.field;
    if (field?.shown) {
      const key = `${side} ${field.name}`, seen = this.widest.get(key);
      this.widest.set(key, seen === undefined ? field.shown : [Math.min(seen[0], field.shown[0]), Math.max(seen[1], field.shown[1])]);
    }
  }

  /** The fields of a frame as choices. */
  private offer(side: Side, arrays: FrameArrays): void {
    const select = el<HTMLSelectElement>(side === 'fluid' ? 'water-field' : 'solid-field');
    show(el(side === 'fluid' ? 'water-label' : 'solid-label'), true);
    if (side === 'structure') show(el('scale-label'), arrays.f32('bend') !== null);
    const names = arrays.head.fields.map((f) => f.name);
    if ([...select.options].map((o) => o.value).join() === [...names, '-'].join()) return;
    const chosen = select.value === '' ? this.field(side) : select.value;
    select.replaceChildren(...names.map((name) => new Option(words(name), name)), new Option('no field', '-'));
    select.value = names.includes(chosen) ? chosen : '-';
    if (select.value !== chosen && names.length > 0 && chosen !== '-') {
      select.value = names[0]!;
      void this.go(this.at);
    }
  }

  private range(side: Side): [number, number] {
    const field = this.shown[side]?.arrays.head.field;
    const shown = field?.shown;
    if (field === undefined || shown === null || shown === undefined) return [0, 0];
    const how = el<HTMLSelectElement>('colours').value;
    if (how === 'widest' || (how === 'fixed' && side === 'structure')) return this.widest.get(`${side} ${field.name}`) ?? shown;
    if (how === 'fixed') {
      const low = el<HTMLInputElement>('water-low').valueAsNumber, high = el<HTMLInputElement>('water-high').valueAsNumber;
      return Number.isFinite(low) && Number.isFinite(high) && high > low ? [low, high] : shown;
    }
    return shown;
  }

  private get scale(): number {
    const scale = el<HTMLInputElement>('scale').valueAsNumber;
    return Number.isFinite(scale) && scale >= 0 ? scale : 1;
  }

  private sayTime(): void {
    const n = this.frames.count;
    const scrub = el<HTMLInputElement>('scrub');
    scrub.value = String(this.at);
    const text = `frame ${this.at + 1} of ${n}, t = ${quantity(this.time, 's', 5)}`;
    scrub.setAttribute('aria-valuetext', text);
    say(el('when'), text);
    el('stage').dataset['frame'] = String(this.at);
  }

  private bounds(): [number[], number[]] | null {
    let low: number[] | null = null, high: number[] | null = null;
    for (const shown of [this.shown.fluid, this.shown.structure]) {
      const a = shown?.arrays.head.low, b = shown?.arrays.head.high;
      if (a === undefined || b === undefined) continue;
      low = low === null ? [...a] : low.map((v, k) => Math.min(v, a[k]!));
      high = high === null ? [...b] : high.map((v, k) => Math.max(v, b[k]!));
    }
    return low === null || high === null ? null : [low, high];
  }

  fit(): void {
    const box = this.bounds();
    if (box === null) return;
    if (this.flat) {  // as high as its content needs
      const across = box[1][0]! - box[0][0]!, over = box[1][1]! - box[0][1]!;
      const high = across > 0 ? 1.06 * this.camera.width * over / across + 24 : this.camera.width;
      const ideal = `${Math.round(high + axisBelow + axisAbove)}px`, stage = el('stage');
      if (stage.style.getPropertyValue('--ideal') !== ideal) {
        stage.style.setProperty('--ideal', ideal);
        this.resize();
      }
    }
    const half = 0.5 * Math.max(this.facts.spacing, this.solidSpacing);
    this.camera.fit(box[0].map((v) => v - half), box[1].map((v) => v + half), this.flat ? 8 : 20);
    this.fitted = true;
    this.redraw();
  }

  private look(yaw: number, pitch: number): void {
    this.camera.yaw = yaw * Math.PI / 180;
    this.camera.pitch = pitch * Math.PI / 180;
  }

  private get flat(): boolean { return this.facts.dimension === 2; }

  // ------------------------------------------------------------ drawing

  private resize(): void {
    const stage = el('stage');
    const left = this.flat ? axisLeft : 0, below = this.flat ? axisBelow : 0, above = this.flat ? axisAbove : 0, right = this.flat ? axisRight : 0;
    const width = stage.clientWidth - left - right, height = stage.clientHeight - above - below;
    if (width <= 0 || height <= 0) return;
    const factor = this.camera.width > 1 ? width / this.camera.width : 1;
    this.camera.width = width;
    this.camera.height = height;
    this.camera.scale *= factor;
    this.canvas.style.left = `${left}px`;
    this.canvas.style.top = `${above}px`;
    this.canvas.style.width = `${width}px`;
    this.canvas.style.height = `${height}px`;
    if (factor !== 1 && !this.fitted) this.fit();
    this.drawNow();
  }

  redraw(): void {
    if (this.due) return;
    this.due = true;
    requestAnimationFrame(() => { this.due = false; this.drawNow(); });
  }

  private span(): number {
    const box = this.bounds();
    return box === null ? 1 : 2 * Math.hypot(...box[1].map((v, k) => v - box[0][k]!)) * Math.max(1, this.scale) + 1;
  }

  drawNow(): void {
    if (this.renderer === null) return;
    const ratio = window.devicePixelRatio || 1;
    this.renderer.begin(this.camera, ratio, this.span(), !this.flat, rgb('--paper'), rgb('--s7'), rgb('--ink'));
    const walls = el<HTMLInputElement>('walls').checked;
    for (const side of ['fluid', 'structure'] as const) {
      const shown = this.shown[side];
      if (shown === null) continue;
      const [low, high] = this.range(side);
      this.renderer.draw(shown.cloud, {
        palette: side === 'fluid' ? 0 : 1, low, high, walls,
        diameter: side === 'fluid' ? this.facts.spacing : this.solidSpacing,
        scale: side === 'fluid' ? 1 : this.scale,
      }, this.camera, ratio);
      drawLegend(el(side === 'fluid' ? 'water-legend' : 'solid-legend'), side, shown.arrays.head.field, low, high,
        side === 'fluid' ? this.facts.palette.water : this.facts.palette.solid);
    }
    const unit = this.shown.fluid?.arrays.head.field?.unit ?? '';
    say(el('water-unit'), unit === '1' ? '' : unit);
    this.drawOverlay(this.overlay, ratio);
  }

  /** Axes, the mark of what is picked, and what is said of the view. */
  private drawOverlay(canvas: HTMLCanvasElement, ratio: number): void {
    const stage = el('stage');
    const width = stage.clientWidth, height = stage.clientHeight;
    canvas.width = Math.round(width * ratio);
    canvas.height = Math.round(height * ratio);
    const c = canvas.getContext('2d');
    if (c === null) return;
    c.scale(ratio, ratio);
    c.clearRect(0, 0, width, height);
    c.font = '12px system-ui, "DejaVu Sans", sans-serif';
    c.fillStyle = colour('--ink');
    c.strokeStyle = colour('--muted');
    c.lineWidth = 1;
    if (this.flat) this.drawAxes(c, width, height); else this.drawTriad(c, height);
    if (this.scale !== 1 && this.shown.structure !== null) {
      c.textAlign = 'right';
      c.fillText(`deformation drawn ${digits(this.scale)} times as large`, width - axisRight - 6, (this.flat ? axisAbove : 0) + 16);
    }
    const left = this.flat ? axisLeft : 0, above = this.flat ? axisAbove : 0;
    c.save();
    c.beginPath();
    c.rect(left, above, this.camera.width, this.camera.height);
    c.clip();
    const ring = (x: number, y: number, r: number): void => {
      for (const [w, name] of [[5, '--paper'], [2, '--ink']] as const) {
        c.lineWidth = w;
        c.strokeStyle = colour(name);
        c.beginPath();
        c.arc(x, y, r, 0, 2 * Math.PI);
        c.stroke();
      }
    };
    if (this.picked?.at) {
      const [x, y] = this.camera.project(...this.picked.at);
      ring(left + x, above + y, 9);
    }
    if (this.byKeyboard && document.activeElement === this.canvas) {
      const x = left + 0.5 * this.camera.width, y = above + 0.5 * this.camera.height;
      ring(x, y, 4);
    }
    c.restore();
  }

  private drawAxes(c: CanvasRenderingContext2D, width: number, height: number): void {
    const right = width - axisRight, bottom = height - axisBelow;
    c.strokeRect(axisLeft + 0.5, axisAbove + 0.5, right - axisLeft - 1, bottom - axisAbove - 1);
    const [x0, y0] = this.camera.target;
    const halfX = 0.5 * this.camera.width / this.camera.scale, halfY = 0.5 * this.camera.height / this.camera.scale;
    const along = roundTicks(x0 - halfX, x0 + halfX, Math.max(2, this.camera.width / 90));
    const up = roundTicks(y0 - halfY, y0 + halfY, Math.max(2, this.camera.height / 60));
    const gap = (ticks: number[]): number => ticks.length > 1 ? ticks[1]! - ticks[0]! : 0;
    c.textAlign = 'center';
    for (const t of along) {
      const x = axisLeft + (t - x0 + halfX) * this.camera.scale;
      c.beginPath(); c.moveTo(x, bottom); c.lineTo(x, bottom + 4); c.stroke();
      if (x > axisLeft + 12 && x < right - 36) c.fillText(tickText(t, gap(along)), x, bottom + 16);
    }
    c.textAlign = 'right';
    for (const t of up) {
      const y = bottom - (t - y0 + halfY) * this.camera.scale;
      c.beginPath(); c.moveTo(axisLeft - 4, y); c.lineTo(axisLeft, y); c.stroke();
      if (y > axisAbove + 16) c.fillText(tickText(t, gap(up)), axisLeft - 7, y + 4);
    }
    c.fillText('x [m]', right, bottom + 16);
    c.fillText('y [m]', axisLeft - 7, axisAbove + 8);
  }

  /** The directions of the world in the lower left corner, and a length. */
  private drawTriad(c: CanvasRenderingContext2D, height: number): void {
    const [right, up] = this.camera.axes();
    const x0 = 44, y0 = height - 44;
    ['x', 'y', 'z'].forEach((name, k) => {
      const x = x0 + 30 * right[k]!, y = y0 - 30 * up[k]!;
      c.lineWidth = 2;
      c.beginPath(); c.moveTo(x0, y0); c.lineTo(x, y); c.stroke();
      c.textAlign = 'center';
      c.fillText(name, x0 + 40 * right[k]!, y0 - 40 * up[k]! + 4);
    });
    const length = roundTicks(0, 0.25 * this.camera.width / this.camera.scale, 1).at(-1) ?? 0;
    if (length > 0) {
      const x = this.camera.width - 16, wide = length * this.camera.scale;
      c.beginPath(); c.moveTo(x - wide, y0 + 26); c.lineTo(x, y0 + 26); c.stroke();
      c.fillText(quantity(length, 'm', 3), x - 0.5 * wide, y0 + 20);
    }
  }

  /** Pictures in a second while everything is drawn again and again for so long; for measurements. */
  async measure(seconds: number): Promise<{ fps: number; renderer: string; points: number }> {
    const begin = performance.now();
    let n = 0;
    while (performance.now() - begin < 1000 * seconds) {
      this.camera.pan(n % 2 === 0 ? 1 : -1, 0);
      this.drawNow();
      this.renderer?.finish();
      ++n;
      await new Promise((resolve) => requestAnimationFrame(resolve));
    }
    return {
      fps: n / (1e-3 * (performance.now() - begin)), renderer: this.rendererName,
      points: (this.shown.fluid?.cloud.count ?? 0) + (this.shown.structure?.cloud.count ?? 0),
    };
  }

  private picture(): void {
    if (this.renderer === null || this.at < 0) return;
    const ratio = Math.max(2, window.devicePixelRatio || 1), stage = el('stage');
    const top = 34, low = 58, width = stage.clientWidth, height = stage.clientHeight + top + low;
    const whole = document.createElement('canvas');
    whole.width = width * ratio;
    whole.height = height * ratio;
    const c = whole.getContext('2d');
    if (c === null) return;
    this.drawNow();  // WebGL keeps a picture only until the browser has shown it
    c.scale(ratio, ratio);
    c.fillStyle = colour('--paper');
    c.fillRect(0, 0, width, height);
    const left = this.flat ? axisLeft : 0, above = this.flat ? axisAbove : 0;
    c.drawImage(this.canvas, left, top + above, this.camera.width, this.camera.height);
    c.drawImage(this.overlay, 0, top, width, stage.clientHeight);
    c.fillStyle = colour('--ink');
    c.font = 'bold 16px system-ui, "DejaVu Sans", sans-serif';
    c.fillText(this.facts.title, 12, 23, 0.7 * width);
    c.textAlign = 'right';
    c.fillText(`t = ${quantity(this.time, 's', 5)}`, width - 12, 23);
    c.textAlign = 'left';
    c.font = '12px system-ui, "DejaVu Sans", sans-serif';
    let x = 12;
    for (const side of ['fluid', 'structure'] as const) {
      const field = this.shown[side]?.arrays.head.field;
      const [a, b] = this.range(side);
      if (field === undefined || !(b > a)) continue;
      const wide = Math.min(320, 0.5 * width - 24), y = height - low + 20;
      const prefix = prefixFor(Math.max(Math.abs(a), Math.abs(b)), field.unit);
      c.fillText(heading(`${words(field.name)} of the ${side === 'fluid' ? 'water' : 'structure'}`, field.unit, prefix), x, y - 6);
      paint(c, side === 'fluid' ? this.facts.palette.water : this.facts.palette.solid, x, y, wide, 10);
      c.fillStyle = colour('--ink');
      c.fillText(digits(a * prefix.factor, 3), x, y + 24);
      c.textAlign = 'right';
      c.fillText(digits(b * prefix.factor, 3), x + wide, y + 24);
      c.textAlign = 'left';
      x += wide + 24;
    }
    whole.toBlob((blob) => {
      if (blob !== null) save(`${this.facts.name}-${this.field('fluid')}-${this.time.toPrecision(6)}s.png`, blob);
    });
  }

  // ------------------------------------------------------------ picking

  /** The point nearest to a place of the screen [px] within some pixels; in space the one in front. */
  private pointAt(x: number, y: number): { side: Side; place: number } | null {
    let best: { side: Side; place: number } | null = null, least = Infinity;
    const near = 14, walls = el<HTMLInputElement>('walls').checked;
    for (const side of ['fluid', 'structure'] as const) {
      const shown = this.shown[side];
      const position = shown?.arrays.f32('position');
      if (shown === null || position === null || position === undefined) continue;
      const bend = shown.arrays.f32('bend'), kind = shown.arrays.u8('kind'), more = side === 'fluid' ? 0 : this.scale - 1;
      const radius = Math.max(near, 0.5 * this.camera.scale * (side === 'fluid' ? this.facts.spacing : this.solidSpacing));
      for (let k = 0; 3 * k < position.length; ++k) {
        if (kind !== null && kind[k] !== 0 && !walls) continue;
        const u = (j: number): number => position[3 * k + j]! + (bend === null ? 0 : more * bend[3 * k + j]!);
        const [px, py, depth] = this.camera.project(u(0), u(1), u(2));
        const off = Math.hypot(px - x, py - y);
        if (off > radius) continue;
        // In the plane the nearest; the structure lies over the water. In space the one in front.
        const rank = this.flat ? off - (side === 'structure' ? 0.5 : 0) : -depth * this.camera.scale + off;
        if (rank < least) { least = rank; best = { side, place: k }; }
      }
    }
    return best;
  }

  private async pick(x: number, y: number): Promise<void> {
    const found = this.pointAt(x, y);
    this.picked = null;
    if (found !== null) {
      const index = this.shown[found.side]?.arrays.u32('index')?.[found.place] ?? 0;
      this.picked = { side: found.side, id: null, index, at: null };
    }
    await this.follow();
    this.redraw();
  }

  /** The values of what is picked in the frame that is shown: particles keep their number, not their place. */
  private async follow(): Promise<void> {
    const card = el('picked');
    const picked = this.picked, shown = picked === null ? null : this.shown[picked.side];
    if (picked === null || shown === null) {
      show(card, false);
      return;
    }
    const which = picked.id === null ? `index=${picked.index}` : `id=${picked.id}`;
    let point: PointValues;
    try {
      point = await json<PointValues>(`api/point?side=${picked.side}&number=${shown.number}&${which}`);
    } catch (error) {
      if (!(error instanceof Refused)) throw error;
      this.picked = null;  // it is no more
      show(card, false);
      return;
    }
    if (this.picked !== picked) return;
    const value = (name: string): (number | null)[] => point.values.find((v) => v.name === name)?.value ?? [];
    const id = value('id')[0];
    if (picked.side === 'fluid' && id !== null && id !== undefined) picked.id = id;
    const position = value('position').map((v) => v ?? NaN), u = value('displacement').map((v) => v ?? 0);
    picked.at = [position[0] ?? 0, position[1] ?? 0, position[2] ?? 0];
    if (picked.side === 'structure' && this.scale !== 1 && u.length === 3) {
      const bend = shown.arrays.f32('bend'), places = shown.arrays.u32('index');
      const k = places?.indexOf(picked.index) ?? -1;
      if (bend !== null && k >= 0) for (let j = 0; j < 3; ++j) picked.at[j]! += (this.scale - 1) * bend[3 * k + j]!;
    }
    say(el('picked-h'), picked.side === 'fluid' ? `Particle ${picked.id ?? picked.index}` : `Structure, point ${picked.index}`);
    const n = this.flat ? 2 : 3;
    el('picked-values').replaceChildren(...point.values.filter((v) => v.name !== 'id').map((v) => {
      const name = make('th', words(v.name));
      name.scope = 'row';
      const shownValues = v.value.length === 3 ? v.value.slice(0, n) : v.value;
      return make('tr', '', name, make('td', v.name === 'kind' ? (['water', 'wall'][v.value[0] ?? 0] ?? String(v.value[0]))
        : shownValues.map((x) => quantity(x, v.unit, 5)).join(', ')));
    }));
    show(card, true);
  }

  // ------------------------------------------------------------ the reader's hands

  private follows(yes: boolean): void {
    this.following = yes;
    el('live').setAttribute('aria-pressed', String(yes));
    if (yes) this.play(false);
  }

  private play(yes: boolean): void {
    window.clearTimeout(this.playing);
    this.playing = 0;
    el('play').setAttribute('aria-pressed', String(yes));
    say(el('play'), yes ? 'Stop' : 'Play');
    if (!yes) return;
    const step = async (): Promise<void> => {
      const begin = performance.now();
      if (this.at >= this.frames.count - 1) { this.play(false); return; }
      await this.go(this.at + 1);
      if (this.playing !== 0) this.playing = window.setTimeout(() => { void step(); }, Math.max(0, 66 - (performance.now() - begin)));
    };
    this.follows(false);
    el('play').setAttribute('aria-pressed', 'true');
    say(el('play'), 'Stop');
    if (this.at >= this.frames.count - 1) this.at = -1;
    this.playing = window.setTimeout(() => { void step(); }, 0);
  }

  step(by: number): void {
    this.play(false);
    this.follows(false);
    void this.go(this.at + by);
  }
  first(): void { this.step(-this.at); }
  latest(): void { this.follows(true); void this.go(this.frames.count - 1); }
  togglePlay(): void { this.play(this.playing === 0); }

  private listen(): void {
    el('fit').addEventListener('click', () => { this.fit(); });
    for (const button of el('sides').querySelectorAll('button'))
      button.addEventListener('click', () => {
        this.look(Number(button.dataset['yaw']), Number(button.dataset['pitch']));
        this.fit();
      });
    el('picture').addEventListener('click', () => { this.picture(); });
    el('first').addEventListener('click', () => { this.first(); });
    el('back').addEventListener('click', () => { this.step(-1); });
    el('next').addEventListener('click', () => { this.step(1); });
    el('live').addEventListener('click', () => { this.latest(); });
    el('play').addEventListener('click', () => { this.togglePlay(); });
    el<HTMLInputElement>('scrub').addEventListener('input', (event) => {
      this.play(false);
      this.follows(false);
      void this.go(Number((event.target as HTMLInputElement).value));
    });
    for (const id of ['water-field', 'solid-field']) el(id).addEventListener('change', () => { void this.go(this.at); });
    el('colours').addEventListener('change', () => {
      const fixed = el<HTMLSelectElement>('colours').value === 'fixed';
      show(el('fixed'), fixed);
      const shown = this.shown.fluid?.arrays.head.field?.shown;
      if (fixed && shown) {
        el<HTMLInputElement>('water-low').value = String(Number(shown[0].toPrecision(4)));
        el<HTMLInputElement>('water-high').value = String(Number(shown[1].toPrecision(4)));
      }
      this.redraw();
    });
    for (const id of ['water-low', 'water-high', 'walls']) el(id).addEventListener('input', () => { this.redraw(); });
    el('scale').addEventListener('input', () => { void this.follow().then(() => { this.redraw(); }); this.redraw(); });
    el('picked-close').addEventListener('click', () => { this.letGo(); this.canvas.focus(); });
    this.canvas.addEventListener('webglcontextlost', (event) => {
      event.preventDefault();
      show(el('nothing'), true);
      say(el('nothing'), 'The graphics card has given up this picture: load the page again.');
      this.renderer = null;
    });
    this.canvas.addEventListener('focus', () => { this.redraw(); });
    this.canvas.addEventListener('blur', () => { this.byKeyboard = false; this.redraw(); });
    this.canvas.addEventListener('keydown', (event) => { this.key(event); });
    this.canvas.addEventListener('wheel', (event) => {
      event.preventDefault();
      this.camera.zoom(Math.exp(-0.0015 * event.deltaY * (event.deltaMode === 1 ? 16 : 1)), event.offsetX, event.offsetY);
      this.redraw();
    }, { passive: false });
    this.pointers();
  }

  private letGo(): void {
    this.picked = null;
    show(el('picked'), false);
    this.redraw();
  }

  private pointers(): void {
    const down = new Map<number, { x: number; y: number }>();
    let moved = 0;
    this.canvas.addEventListener('contextmenu', (event) => { event.preventDefault(); });
    this.canvas.addEventListener('pointerdown', (event) => {
      this.canvas.setPointerCapture(event.pointerId);
      this.canvas.focus({ preventScroll: true });
      this.byKeyboard = false;
      if (down.size === 0) moved = 0;
      down.set(event.pointerId, { x: event.offsetX, y: event.offsetY });
    });
    this.canvas.addEventListener('pointermove', (event) => {
      const before = down.get(event.pointerId);
      if (before === undefined) return;
      const dx = event.offsetX - before.x, dy = event.offsetY - before.y;
      moved += Math.abs(dx) + Math.abs(dy);
      if (down.size === 2) {
        const other = [...down.entries()].find(([id]) => id !== event.pointerId)?.[1] ?? before;
        const was = Math.hypot(before.x - other.x, before.y - other.y), is = Math.hypot(event.offsetX - other.x, event.offsetY - other.y);
        this.camera.pan(0.5 * dx, 0.5 * dy);
        if (was > 0 && is > 0) this.camera.zoom(is / was, 0.5 * (event.offsetX + other.x), 0.5 * (event.offsetY + other.y));
      } else if (!this.flat && event.buttons === 1 && !event.shiftKey) {
        this.camera.turn(-0.008 * dx, 0.008 * dy);
      } else {
        this.camera.pan(dx, dy);
      }
      down.set(event.pointerId, { x: event.offsetX, y: event.offsetY });
      this.redraw();
    });
    const up = (event: PointerEvent): void => {
      const was = down.delete(event.pointerId);
      if (was && event.type === 'pointerup' && down.size === 0 && moved < 5) void this.pick(event.offsetX, event.offsetY);
    };
    this.canvas.addEventListener('pointerup', up);
    this.canvas.addEventListener('pointercancel', up);
  }

  private key(event: KeyboardEvent): void {
    if (event.ctrlKey || event.altKey || event.metaKey) return;
    const step = 40, angle = Math.PI / 24;
    const move: Record<string, [number, number]> = { ArrowLeft: [1, 0], ArrowRight: [-1, 0], ArrowUp: [0, 1], ArrowDown: [0, -1] };
    const by = move[event.key];
    if (by !== undefined) {
      if (!this.flat && !event.shiftKey) this.camera.turn(angle * by[0], angle * by[1]);
      else this.camera.pan(step * by[0], step * by[1]);
    } else if (event.key === '+' || event.key === '=') this.camera.zoom(1.25);
    else if (event.key === '-') this.camera.zoom(0.8);
    else if (event.key === 'Enter') void this.pick(0.5 * this.camera.width, 0.5 * this.camera.height);
    else if (event.key === 'Escape') this.letGo();
    else return;
    this.byKeyboard = true;
    event.preventDefault();
    this.redraw();
  }

  /** Field that is drawn of a side, for tests and the reader of the page's state. */
  facing(side: Side): FieldFacts | undefined { return this.shown[side]?.arrays.head.field; }
}
