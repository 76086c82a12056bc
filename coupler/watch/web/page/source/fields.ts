import { Refused } from './api';
import type { FieldFacts, RunFacts, Side } from './api';
import { colour, el, say, show } from './dom';
import { exportPicture } from './export_picture';
import type { Frames } from './frames';
import { listen } from './hands';
import { drawLegend } from './legend';
import { drawOverlay } from './overlay';
import { Picking } from './picking';
import { Playback } from './playback';
import { Renderer } from './renderer';
import { bothSides, Sides } from './sides';
import { Stage } from './stage';

function rgb(name: string): number[] {
  const hex = colour(name).replace('#', '');
  return [0, 2, 4].map((k) => parseInt(hex.slice(k, k + 2), 16) / 255);
}

/** The picture of one frame: brings it onto the stage and draws it. */
export class Fields {
  onTime: (time: number) => void = () => { /* no listener yet */ };
  private readonly stage: Stage;
  private readonly sides = new Sides();
  private readonly picking: Picking;
  private readonly playback = new Playback((at) => this.go(at));
  private renderer: Renderer | null = null;
  private fitted = false;
  private wanted = 0;          // number of the last request for a frame: older answers are late
  private due = false;         // a drawing is
  private byKeyboard = false;

  constructor(facts: RunFacts) {
    this.stage = new Stage(facts);
    this.picking = new Picking(this.stage, this.sides);
    try {
      this.renderer = new Renderer(this.stage.canvas);
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
    const first = !this.stage.facts.known && facts.known;
    this.stage.facts = facts;
    show(el('sides'), facts.dimension === 3);
    if (facts.dimension === 3 && !this.fitted) this.stage.turnTo(-35, 25);
    if (first) el<HTMLInputElement>('walls').checked = facts.dimension === 2;
  }

  get frames(): Frames { return this.playback.frames; }
  get rendererName(): string { return this.renderer?.name() ?? 'none'; }
  step(by: number): void { this.playback.step(by); }
  first(): void { this.playback.first(); }
  latest(): void { this.playback.latest(); }
  togglePlay(): void { this.playback.togglePlay(); }

  /** New frames are there. */
  async update(): Promise<void> {
    const n = this.frames.count;
    const scrub = el<HTMLInputElement>('scrub');
    scrub.max = String(Math.max(0, n - 1));
    scrub.disabled = n === 0;
    show(el('nothing'), n === 0 || this.renderer === null);
    if (n === 0) {
      this.playback.at = -1;
      return;
    }
    const place = this.playback.wanted();
    if (place !== null) await this.go(place);
    else this.playback.sayTime();
  }

  /** Shows the frame at that place. */
  async go(at: number): Promise<void> {
    const n = this.frames.count;
    if (n === 0) return;
    const place = Math.min(n - 1, Math.max(0, at));
    const moved = place !== this.playback.at;
    this.playback.at = place;
    this.playback.sayTime();
    if (moved) this.onTime(this.playback.time);
    const request = ++this.wanted;
    try {
      const parts = await Promise.all(bothSides.map(async (side) => {
        const number = this.frames.number(side, place);
        return number === undefined ? null : { side, number, arrays: await this.frames.fetch(side, number, this.sides.field(side)) };
      }));
      if (request !== this.wanted) return;
      for (const part of parts)
        if (part !== null && this.sides.take(this.renderer, part.side, part.number, part.arrays)) void this.go(this.playback.at);
    } catch (error) {
      if (error instanceof Refused && error.status === 404) return;  // gone with a resumed run: the next news report it
      throw error;
    }
    if (!this.fitted) this.fit();
    await this.picking.follow();
    this.redraw();
  }

  async showTime(time: number): Promise<void> {
    this.playback.follows(false);
    await this.go(this.frames.nearest(time));
  }

  fit(): void {
    const { stage } = this, box = this.sides.bounds();
    if (box === null) return;
    if (stage.flat && stage.heighten(...box)) this.resize();
    const half = 0.5 * Math.max(stage.facts.spacing, stage.facts.solid_spacing);
    stage.camera.fit(box[0].map((v) => v - half), box[1].map((v) => v + half), stage.flat ? 8 : 20);
    this.fitted = true;
    this.redraw();
  }

  private resize(): void {
    const factor = this.stage.layOut();
    if (factor === null) return;
    if (factor !== 1 && !this.fitted) this.fit();
    this.drawNow();
  }

  redraw(): void {
    if (this.due) return;
    this.due = true;
    requestAnimationFrame(() => { this.due = false; this.drawNow(); });
  }

  /** Of the depth that is drawn [m]. */
  private span(): number {
    const box = this.sides.bounds();
    return box === null ? 1 : 2 * Math.hypot(...box[1].map((v, k) => v - box[0][k]!)) * Math.max(1, this.stage.scale) + 1;
  }

  drawNow(): void {
    if (this.renderer === null) return;
    const { stage, sides } = this, { camera, facts, walls } = stage;
    const ratio = window.devicePixelRatio || 1;
    this.renderer.begin(camera, ratio, this.span(), !stage.flat, rgb('--paper'), rgb('--s7'), rgb('--ink'));
    for (const side of bothSides) {
      const shown = sides.of(side);
      if (shown === null) continue;
      const [low, high] = sides.range(side), water = side === 'fluid';
      this.renderer.draw(shown.cloud, {
        palette: water ? 0 : 1, low, high, walls, diameter: stage.spacing(side), scale: water ? 1 : stage.scale,
      }, camera, ratio);
      drawLegend(el(water ? 'water-legend' : 'solid-legend'), side, sides.facts(side), low, high, water ? facts.palette.water : facts.palette.solid);
    }
    const unit = sides.facts('fluid')?.unit ?? '';
    say(el('water-unit'), unit === '1' ? '' : unit);
    const marks: [number, number, number][] = [], picked = this.picking.place();
    if (picked !== null) marks.push([...picked, 9]);
    if (this.byKeyboard && document.activeElement === stage.canvas) marks.push([0.5 * camera.width, 0.5 * camera.height, 4]);
    drawOverlay(stage, ratio, sides.of('structure') !== null, marks, sides.bodies);
  }

  /** Pictures in a second while everything is drawn again and again for so long; for measurements. */
  async measure(seconds: number): Promise<{ fps: number; renderer: string; points: number }> {
    const begin = performance.now();
    let n = 0;
    while (performance.now() - begin < 1000 * seconds) {
      this.stage.camera.pan(n % 2 === 0 ? 1 : -1, 0);
      this.drawNow();
      this.renderer?.finish();
      ++n;
      await new Promise((resolve) => requestAnimationFrame(resolve));
    }
    return { fps: n / (1e-3 * (performance.now() - begin)), renderer: this.rendererName, points: this.sides.points };
  }

  private picture(): void {
    if (this.renderer === null || this.playback.at < 0) return;
    this.drawNow();  // WebGL keeps a picture only until the browser has shown it
    exportPicture(this.stage, this.sides, this.playback.time);
  }

  private letGo(): void {
    this.picking.letGo();
    this.redraw();
  }

  private listen(): void {
    const { canvas } = this.stage;
    el('fit').addEventListener('click', () => { this.fit(); });
    for (const button of el('sides').querySelectorAll('button'))
      button.addEventListener('click', () => {
        this.stage.turnTo(Number(button.dataset['yaw']), Number(button.dataset['pitch']));
        this.fit();
      });
    el('picture').addEventListener('click', () => { this.picture(); });
    for (const id of ['water-field', 'solid-field']) el(id).addEventListener('change', () => { void this.go(this.playback.at); });
    el('colours').addEventListener('change', () => { this.sides.offerFixed(); this.redraw(); });
    for (const id of ['water-low', 'water-high', 'walls']) el(id).addEventListener('input', () => { this.redraw(); });
    el('scale').addEventListener('input', () => { void this.picking.follow().then(() => { this.redraw(); }); this.redraw(); });
    el('picked-close').addEventListener('click', () => { this.letGo(); canvas.focus(); });
    canvas.addEventListener('webglcontextlost', (event) => {
      event.preventDefault();
      show(el('nothing'), true);
      say(el('nothing'), 'The graphics card has given up this picture: load the page again.');
      this.renderer = null;
    });
    canvas.addEventListener('focus', () => { this.redraw(); });
    canvas.addEventListener('blur', () => { this.byKeyboard = false; this.redraw(); });
    canvas.addEventListener('pointerdown', () => { this.byKeyboard = false; });
    listen(this.stage, {
      moved: (byKeyboard) => { this.byKeyboard ||= byKeyboard; this.redraw(); },
      pick: (x, y) => { void this.picking.pick(x, y).then(() => { this.redraw(); }); },
      letGo: () => { this.letGo(); },
    });
  }

  /** Field that is drawn of a side, for tests and the reader of the page's state. */
  facing(side: Side): FieldFacts | undefined { return this.sides.facts(side); }
}
