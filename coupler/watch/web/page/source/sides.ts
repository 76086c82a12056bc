import type { BodyFacts, FieldFacts, FrameArrays, Side } from './api';
import { el, show } from './dom';
import { words } from './legend';
import type { Cloud, Renderer } from './renderer';

export const bothSides = ['fluid', 'structure'] as const;

/** What is shown of one side: a frame's arrays, and what lies of them on the graphics card. */
export interface Shown { arrays: FrameArrays; cloud: Cloud; number: number }

/** The frame that is shown of each side, its field and the range of its colours. */
export class Sides {
  private readonly shown: Record<Side, Shown | null> = { fluid: null, structure: null };
  private readonly widest = new Map<string, [number, number]>();

  of(side: Side): Shown | null { return this.shown[side]; }
  facts(side: Side): FieldFacts | undefined { return this.shown[side]?.arrays.head.field; }
  get points(): number { return (this.shown.fluid?.cloud.count ?? 0) + (this.shown.structure?.cloud.count ?? 0); }

  /** The bodies of the structure's frame, where there are several. */
  get bodies(): BodyFacts[] { return this.shown.structure?.arrays.head.bodies ?? []; }

  /** What a point of the structure is called: its number in its body. */
  nameOf(index: number): string {
    const body = this.bodies.filter((b) => b.first <= index).at(-1);
    return body === undefined ? `Structure, point ${index}` : `${body.name}, point ${index - body.first}`;
  }

  /** The field that the reader has chosen. */
  field(side: Side): string {
    const select = el<HTMLSelectElement>(side === 'fluid' ? 'water-field' : 'solid-field');
    return select.value === '' ? (side === 'fluid' ? 'pressure' : 'von_mises') : select.value;
  }

  /** Takes a frame of a side; whether the chosen field is not in it and another one was chosen. */
  take(renderer: Renderer | null, side: Side, number: number, arrays: FrameArrays): boolean {
    const before = this.shown[side];
    if (before !== null && before.arrays === arrays) return false;
    const other = this.offer(side, arrays);
    if (renderer === null) return other;
    if (before !== null) renderer.unload(before.cloud);
    const cloud = renderer.load({
      position: arrays.f32('position') ?? new Float32Array(), value: arrays.f32('value'), bend: arrays.f32('bend'),
      kind: arrays.u8('kind'), triangle: arrays.u32('triangle'), edge: arrays.u32('edge'),
    });
    this.shown[side] = { arrays, cloud, number };
    const field = arrays.head.field;
    if (field?.shown) {
      const key = `${side} ${field.name}`, seen = this.widest.get(key);
      this.widest.set(key, seen === undefined ? field.shown : [Math.min(seen[0], field.shown[0]), Math.max(seen[1], field.shown[1])]);
    }
    return other;
  }

  /** The fields of a frame as choices; whether the chosen one is no more among them. */
  private offer(side: Side, arrays: FrameArrays): boolean {
    const select = el<HTMLSelectElement>(side === 'fluid' ? 'water-field' : 'solid-field');
    show(el(side === 'fluid' ? 'water-label' : 'solid-label'), true);
    if (side === 'structure') show(el('scale-label'), arrays.f32('bend') !== null);
    const names = arrays.head.fields.map((f) => f.name);
    if ([...select.options].map((o) => o.value).join() === [...names, '-'].join()) return false;
    const chosen = select.value === '' ? this.field(side) : select.value;
    select.replaceChildren(...names.map((name) => new Option(words(name), name)), new Option('no field', '-'));
    select.value = names.includes(chosen) ? chosen : '-';
    if (select.value === chosen || names.length === 0 || chosen === '-') return false;
    select.value = names[0]!;
    return true;
  }

  /** Of the colours of a side; empty where it shows no field. */
  range(side: Side): [number, number] {
    const field = this.facts(side), shown = field?.shown;
    if (field === undefined || shown === null || shown === undefined) return [0, 0];
    const how = el<HTMLSelectElement>('colours').value;
    if (how === 'widest' || (how === 'fixed' && side === 'structure')) return this.widest.get(`${side} ${field.name}`) ?? shown;
    if (how === 'fixed') {
      const low = el<HTMLInputElement>('water-low').valueAsNumber, high = el<HTMLInputElement>('water-high').valueAsNumber;
      return Number.isFinite(low) && Number.isFinite(high) && high > low ? [low, high] : shown;
    }
    return shown;
  }

  /** Opens the fields for a fixed range of the water's colours, with what is shown now. */
  offerFixed(): void {
    const fixed = el<HTMLSelectElement>('colours').value === 'fixed', shown = this.facts('fluid')?.shown;
    show(el('fixed'), fixed);
    if (!fixed || !shown) return;
    el<HTMLInputElement>('water-low').value = String(Number(shown[0].toPrecision(4)));
    el<HTMLInputElement>('water-high').value = String(Number(shown[1].toPrecision(4)));
  }

  /** The box around all that is shown [m]. */
  bounds(): [number[], number[]] | null {
    let low: number[] | null = null, high: number[] | null = null;
    for (const side of bothSides) {
      const a = this.shown[side]?.arrays.head.low, b = this.shown[side]?.arrays.head.high;
      if (a === undefined || b === undefined) continue;
      low = low === null ? [...a] : low.map((v, k) => Math.min(v, a[k]!));
      high = high === null ? [...b] : high.map((v, k) => Math.max(v, b[k]!));
    }
    return low === null || high === null ? null : [low, high];
  }
}
