import { el, say } from './dom';
import { Frames } from './frames';
import { quantity } from './units';

/** Which frame is shown, and how the reader moves through them. */
export class Playback {
  readonly frames = new Frames();
  at = -1;                     // place of the frame
  private following = true;    // the latest frame
  private playing = 0;         // timer

  /** show: brings the frame at that place onto the stage. */
  constructor(private readonly show: (at: number) => Promise<void>) {
    el('first').addEventListener('click', () => { this.first(); });
    el('back').addEventListener('click', () => { this.step(-1); });
    el('next').addEventListener('click', () => { this.step(1); });
    el('live').addEventListener('click', () => { this.latest(); });
    el('play').addEventListener('click', () => { this.togglePlay(); });
    el<HTMLInputElement>('scrub').addEventListener('input', (event) => {
      this.play(false);
      this.follows(false);
      void this.show(Number((event.target as HTMLInputElement).value));
    });
  }

  get time(): number { return this.at < 0 ? NaN : this.frames.time(this.at); }

  /** The place that new frames ask for; nothing where the one that is shown stays. */
  wanted(): number | null {
    const n = this.frames.count;
    return this.following || this.at >= n || this.at < 0 ? n - 1 : null;
  }

  sayTime(): void {
    const scrub = el<HTMLInputElement>('scrub');
    scrub.value = String(this.at);
    const text = `frame ${this.at + 1} of ${this.frames.count}, t = ${quantity(this.time, 's', 5)}`;
    scrub.setAttribute('aria-valuetext', text);
    say(el('when'), text);
    el('stage').dataset['frame'] = String(this.at);
  }

  follows(yes: boolean): void {
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
      await this.show(this.at + 1);
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
    void this.show(this.at + by);
  }
  first(): void { this.step(-this.at); }
  latest(): void { this.follows(true); void this.show(this.frames.count - 1); }
  togglePlay(): void { this.play(this.playing === 0); }
}
