import { arrays, json } from './api';
import type { FrameArrays, FrameHead, FrameList, News, Side } from './api';

const mostBytes = 200 * 2 ** 20;  // of frames that are kept

/** The list of a run's frames, and the last ones that were fetched. */
export class Frames {
  private readonly lists: Record<Side, FrameList> = {
    fluid: { generation: -1, from: 0, numbers: [], times: [] },
    structure: { generation: -1, from: 0, numbers: [], times: [] },
  };
  private readonly kept = new Map<string, Promise<FrameArrays>>();
  private readonly sizes = new Map<string, number>();

  /** Asks for what the news say is new; whether there was anything. */
  async learn(news: News): Promise<boolean> {
    let any = false;
    for (const side of ['fluid', 'structure'] as const) {
      const told = news.frames[side], list = this.lists[side];
      if (told.generation === list.generation && told.count === list.numbers.length) continue;
      const from = told.generation === list.generation ? Math.min(list.numbers.length, told.count) : 0;
      const more = await json<FrameList>(`api/frames?side=${side}&from=${from}`);
      if (more.generation !== list.generation && from > 0) continue;  // changed meanwhile: the next news report it
      if (from === 0) { this.kept.clear(); this.sizes.clear(); }
      list.generation = more.generation;
      list.numbers = [...list.numbers.slice(0, from), ...more.numbers];
      list.times = [...list.times.slice(0, from), ...more.times];
      any = true;
    }
    return any;
  }

  /** The side whose frames are counted: the fluid's, where it has any. */
  get leading(): Side { return this.lists.fluid.numbers.length > 0 ? 'fluid' : 'structure'; }
  get count(): number { return this.lists[this.leading].numbers.length; }
  time(at: number): number { return this.lists[this.leading].times[at] ?? NaN; }
  has(side: Side): boolean { return this.lists[side].numbers.length > 0; }

  /** The place of the frame next to a time. */
  nearest(time: number, side: Side = this.leading): number {
    const times = this.lists[side].times;
    let low = 0, high = times.length - 1;
    while (low < high) {
      const middle = (low + high) >> 1;
      if (times[middle]! < time) low = middle + 1; else high = middle;
    }
    if (low > 0 && Math.abs(times[low - 1]! - time) <= Math.abs(times[low]! - time)) return low - 1;
    return low;
  }

  /** The number of the side's frame that goes with place `at` of the leading side; undefined where it has none. */
  number(side: Side, at: number): number | undefined {
    const list = this.lists[side];
    return side === this.leading ? list.numbers[at] : list.numbers[this.nearest(this.time(at), side)];
  }

  fetch(side: Side, number: number, field: string): Promise<FrameArrays> {
    const path = `api/frame?side=${side}&number=${number}&field=${encodeURIComponent(field)}`;
    const found = this.kept.get(path);
    if (found !== undefined) {
      this.kept.delete(path);  // the latest stands last
      this.kept.set(path, found);
      return found;
    }
    const asked = arrays<FrameHead>(path);
    this.kept.set(path, asked);
    asked.then((frame) => {
      this.sizes.set(path, frame.size);
      this.forget();
    }, () => { this.kept.delete(path); });
    return asked;
  }

  private forget(): void {
    let total = 0;
    for (const path of this.kept.keys()) total += this.sizes.get(path) ?? 0;
    for (const path of [...this.kept.keys()].slice(0, -2)) {
      if (total <= mostBytes) return;
      total -= this.sizes.get(path) ?? 0;
      this.kept.delete(path);
      this.sizes.delete(path);
    }
  }
}
