import { make, say, show } from './dom';
import { heading, prefixFor, quantity, roundTicks, tickText } from './units';
import type { FieldFacts, Side } from './api';

/** "von_mises" → "von Mises stress". */
export function words(field: string): string {
  return field === 'von_mises' ? 'von Mises stress' : field.replace(/_/g, ' ');
}

/** A bar of the palette's colours with their range. */
export function drawLegend(figure: HTMLElement, side: Side, field: FieldFacts | undefined, low: number, high: number, palette: number[]): void {
  const told = field === undefined ? '' : [side, field.name, field.unit, low, high, String(field.all)].join();
  if (figure.dataset['told'] === told) return;  // drawn as it is: a picture may be drawn many times a second
  figure.dataset['told'] = told;
  const seen = field !== undefined && high > low;
  show(figure, seen);
  if (!seen) return;
  const largest = Math.max(Math.abs(low), Math.abs(high));
  const prefix = prefixFor(largest, field.unit);
  let caption = heading(`${words(field.name)} of the ${side === 'fluid' ? 'water' : 'structure'}`, field.unit, prefix);
  if (field.all !== null && (field.all[0] < low - 1e-9 * largest || field.all[1] > high + 1e-9 * largest))
    caption += `, extremes ${quantity(field.all[0], field.unit, 3)} and ${quantity(field.all[1], field.unit, 3)}`;
  say(figure.querySelector('figcaption') as HTMLElement, caption);
  const canvas = figure.querySelector('canvas') as HTMLCanvasElement;
  const context = canvas.getContext('2d');
  if (context !== null) paint(context, palette, 0, 0, canvas.width, canvas.height);
  const bar = figure.querySelector('.ticks') as HTMLElement;
  const [a, b] = [low * prefix.factor, high * prefix.factor];
  const ticks = roundTicks(a, b, 5);
  bar.replaceChildren(...ticks.map((t) => {
    const mark = make('span', tickText(t, ticks.length > 1 ? ticks[1]! - ticks[0]! : 0));
    mark.style.left = `${100 * (t - a) / (b - a)}%`;
    return mark;
  }));
}

/** The palette from left to right. */
export function paint(context: CanvasRenderingContext2D, palette: number[], x: number, y: number, width: number, height: number): void {
  const n = palette.length / 3;
  for (let k = 0; k < n; ++k) {
    context.fillStyle = `rgb(${palette[3 * k]!}, ${palette[3 * k + 1]!}, ${palette[3 * k + 2]!})`;
    context.fillRect(x + width * k / n, y, width / n + 1, height);
  }
}
