import { json, Refused } from './api';
import type { PointValues, Side } from './api';
import { el, make, say, show } from './dom';
import { words } from './legend';
import { bothSides } from './sides';
import type { Sides } from './sides';
import type { Stage } from './stage';
import { quantity } from './units';

interface Picked { side: Side; id: number | null; index: number; at: [number, number, number] | null }

/** The point nearest to a place of the screen [px] within some pixels; in space the one in front. */
function pointAt(stage: Stage, sides: Sides, x: number, y: number): { side: Side; place: number } | null {
  let best: { side: Side; place: number } | null = null, least = Infinity;
  const near = 14, { walls, camera } = stage;
  for (const side of bothSides) {
    const shown = sides.of(side);
    const position = shown?.arrays.f32('position');
    if (shown === null || position === null || position === undefined) continue;
    const bend = shown.arrays.f32('bend'), kind = shown.arrays.u8('kind'), more = side === 'fluid' ? 0 : stage.scale - 1;
    const radius = Math.max(near, 0.5 * camera.scale * stage.spacing(side));
    for (let k = 0; 3 * k < position.length; ++k) {
      if (kind !== null && kind[k] !== 0 && !walls) continue;
      const u = (j: number): number => position[3 * k + j]! + (bend === null ? 0 : more * bend[3 * k + j]!);
      const [px, py, depth] = camera.project(u(0), u(1), u(2));
      const off = Math.hypot(px - x, py - y);
      if (off > radius) continue;
      // In the plane the nearest; the structure lies over the water. In space the one in front.
      const rank = stage.flat ? off - (side === 'structure' ? 0.5 : 0) : -depth * camera.scale + off;
      if (rank < least) { least = rank; best = { side, place: k }; }
    }
  }
  return best;
}

/** The point that the reader has picked, and the card with its values. */
export class Picking {
  private picked: Picked | null = null;

  constructor(private readonly stage: Stage, private readonly sides: Sides) {}

  /** Where it stands on the screen [px]; nothing where none is picked. */
  place(): [number, number] | null {
    if (!this.picked?.at) return null;
    const [x, y] = this.stage.camera.project(...this.picked.at);
    return [x, y];
  }

  async pick(x: number, y: number): Promise<void> {
    const found = pointAt(this.stage, this.sides, x, y);
    this.picked = null;
    if (found !== null) {
      const index = this.sides.of(found.side)?.arrays.u32('index')?.[found.place] ?? 0;
      this.picked = { side: found.side, id: null, index, at: null };
    }
    await this.follow();
  }

  letGo(): void {
    this.picked = null;
    show(el('picked'), false);
  }

  /** The values of what is picked in the frame that is shown: particles keep their number, not their place. */
  async follow(): Promise<void> {
    const card = el('picked');
    const picked = this.picked, shown = picked === null ? null : this.sides.of(picked.side);
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
    if (picked.side === 'structure' && this.stage.scale !== 1 && u.length === 3) {
      const bend = shown.arrays.f32('bend'), places = shown.arrays.u32('index');
      const k = places?.indexOf(picked.index) ?? -1;
      if (bend !== null && k >= 0) for (let j = 0; j < 3; ++j) picked.at[j]! += (this.stage.scale - 1) * bend[3 * k + j]!;
    }
    say(el('picked-h'), picked.side === 'fluid' ? `Particle ${picked.id ?? picked.index}` : this.sides.nameOf(picked.index));
    const n = this.stage.flat ? 2 : 3;
    el('picked-values').replaceChildren(...point.values.filter((v) => v.name !== 'id').map((v) => {
      const name = make('th', words(v.name));
      name.scope = 'row';
      const shownValues = v.value.length === 3 ? v.value.slice(0, n) : v.value;
      return make('tr', '', name, make('td', v.name === 'kind' ? (['water', 'wall'][v.value[0] ?? 0] ?? String(v.value[0]))
        : shownValues.map((x) => quantity(x, v.unit, 5)).join(', ')));
    }));
    show(card, true);
  }
}
