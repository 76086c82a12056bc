import type { BodyFacts } from './api';
import { colour } from './dom';
import type { Stage } from './stage';
import { digits, quantity, roundTicks, tickText } from './units';

/** The name of each body, above the middle of its box. */
function drawNames(c: CanvasRenderingContext2D, { camera, margin }: Stage, bodies: BodyFacts[]): void {
  c.textAlign = 'center';
  c.lineWidth = 3;
  c.strokeStyle = colour('--paper');
  c.fillStyle = colour('--ink');
  for (const { name, low, high } of bodies) {
    if (low === undefined || high === undefined) continue;
    const middle = low.map((v, k) => 0.5 * (v + high[k]!));
    const [x, y] = camera.project(middle[0]!, high[1]!, middle[2]!);
    c.strokeText(name, margin.left + x, margin.above + y - 8);
    c.fillText(name, margin.left + x, margin.above + y - 8);
  }
}

/** Axes, a ring around each mark of the screen ([x, y, radius] px), names of bodies and what is said of the deformation. */
export function drawOverlay(stage: Stage, ratio: number, deformed: boolean, marks: [number, number, number][], bodies: BodyFacts[]): void {
  const { width, height, margin, overlay, camera } = stage;
  overlay.width = Math.round(width * ratio);
  overlay.height = Math.round(height * ratio);
  const c = overlay.getContext('2d');
  if (c === null) return;
  c.scale(ratio, ratio);
  c.clearRect(0, 0, width, height);
  c.font = '12px system-ui, "DejaVu Sans", sans-serif';
  c.fillStyle = colour('--ink');
  c.strokeStyle = colour('--muted');
  c.lineWidth = 1;
  if (stage.flat) drawAxes(c, stage); else drawTriad(c, stage);
  if (stage.scale !== 1 && deformed) {
    c.textAlign = 'right';
    c.fillText(`deformation drawn ${digits(stage.scale)} times as large`, width - 20, margin.above + 16);
  }
  c.save();
  c.beginPath();
  c.rect(margin.left, margin.above, camera.width, camera.height);
  c.clip();
  drawNames(c, stage, bodies);
  for (const [x, y, radius] of marks)
    for (const [w, name] of [[5, '--paper'], [2, '--ink']] as const) {
      c.lineWidth = w;
      c.strokeStyle = colour(name);
      c.beginPath();
      c.arc(margin.left + x, margin.above + y, radius, 0, 2 * Math.PI);
      c.stroke();
    }
  c.restore();
}

function drawAxes(c: CanvasRenderingContext2D, { camera, margin, width, height }: Stage): void {
  const right = width - margin.right, bottom = height - margin.below;
  c.strokeRect(margin.left + 0.5, margin.above + 0.5, right - margin.left - 1, bottom - margin.above - 1);
  const [x0, y0] = camera.target;
  const halfX = 0.5 * camera.width / camera.scale, halfY = 0.5 * camera.height / camera.scale;
  const along = roundTicks(x0 - halfX, x0 + halfX, Math.max(2, camera.width / 90));
  const up = roundTicks(y0 - halfY, y0 + halfY, Math.max(2, camera.height / 60));
  const gap = (ticks: number[]): number => ticks.length > 1 ? ticks[1]! - ticks[0]! : 0;
  c.textAlign = 'center';
  for (const t of along) {
    const x = margin.left + (t - x0 + halfX) * camera.scale;
    c.beginPath(); c.moveTo(x, bottom); c.lineTo(x, bottom + 4); c.stroke();
    if (x > margin.left + 12 && x < right - 36) c.fillText(tickText(t, gap(along)), x, bottom + 16);
  }
  c.textAlign = 'right';
  for (const t of up) {
    const y = bottom - (t - y0 + halfY) * camera.scale;
    c.beginPath(); c.moveTo(margin.left - 4, y); c.lineTo(margin.left, y); c.stroke();
    if (y > margin.above + 16) c.fillText(tickText(t, gap(up)), margin.left - 7, y + 4);
  }
  c.fillText('x [m]', right, bottom + 16);
  c.fillText('y [m]', margin.left - 7, margin.above + 8);
}

/** The directions of the world in the lower left corner, and a length. */
function drawTriad(c: CanvasRenderingContext2D, { camera, height }: Stage): void {
  const [right, up] = camera.axes();
  const x0 = 44, y0 = height - 44;
  ['x', 'y', 'z'].forEach((name, k) => {
    const x = x0 + 30 * right[k]!, y = y0 - 30 * up[k]!;
    c.lineWidth = 2;
    c.beginPath(); c.moveTo(x0, y0); c.lineTo(x, y); c.stroke();
    c.textAlign = 'center';
    c.fillText(name, x0 + 40 * right[k]!, y0 - 40 * up[k]! + 4);
  });
  const length = roundTicks(0, 0.25 * camera.width / camera.scale, 1).at(-1) ?? 0;
  if (length > 0) {
    const x = camera.width - 16, wide = length * camera.scale;
    c.beginPath(); c.moveTo(x - wide, y0 + 26); c.lineTo(x, y0 + 26); c.stroke();
    c.fillText(quantity(length, 'm', 3), x - 0.5 * wide, y0 + 20);
  }
}
