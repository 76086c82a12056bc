import { colour, save } from './dom';
import { paint, words } from './legend';
import { bothSides } from './sides';
import type { Sides } from './sides';
import type { Stage } from './stage';
import { digits, heading, prefixFor, quantity } from './units';

/** Hands the picture that was just drawn to the reader as a PNG, with title, time and colour bars. */
export function exportPicture(stage: Stage, sides: Sides, time: number): void {
  const ratio = Math.max(2, window.devicePixelRatio || 1), { width, margin, camera, facts } = stage;
  const top = 34, low = 58, height = stage.height + top + low;
  const whole = document.createElement('canvas');
  whole.width = width * ratio;
  whole.height = height * ratio;
  const c = whole.getContext('2d');
  if (c === null) return;
  c.scale(ratio, ratio);
  c.fillStyle = colour('--paper');
  c.fillRect(0, 0, width, height);
  c.drawImage(stage.canvas, margin.left, top + margin.above, camera.width, camera.height);
  c.drawImage(stage.overlay, 0, top, width, stage.height);
  c.fillStyle = colour('--ink');
  c.font = 'bold 16px system-ui, "DejaVu Sans", sans-serif';
  c.fillText(facts.title, 12, 23, 0.7 * width);
  c.textAlign = 'right';
  c.fillText(`t = ${quantity(time, 's', 5)}`, width - 12, 23);
  c.textAlign = 'left';
  c.font = '12px system-ui, "DejaVu Sans", sans-serif';
  let x = 12;
  for (const side of bothSides) {
    const field = sides.facts(side);
    const [a, b] = sides.range(side);
    if (field === undefined || !(b > a)) continue;
    const wide = Math.min(320, 0.5 * width - 24), y = height - low + 20;
    const prefix = prefixFor(Math.max(Math.abs(a), Math.abs(b)), field.unit);
    c.fillText(heading(`${words(field.name)} of the ${side === 'fluid' ? 'water' : 'structure'}`, field.unit, prefix), x, y - 6);
    paint(c, side === 'fluid' ? facts.palette.water : facts.palette.solid, x, y, wide, 10);
    c.fillStyle = colour('--ink');
    c.fillText(digits(a * prefix.factor, 3), x, y + 24);
    c.textAlign = 'right';
    c.fillText(digits(b * prefix.factor, 3), x + wide, y + 24);
    c.textAlign = 'left';
    x += wide + 24;
  }
  whole.toBlob((blob) => {
    if (blob !== null) save(`${facts.name}-${sides.field('fluid')}-${time.toPrecision(6)}s.png`, blob);
  });
}
