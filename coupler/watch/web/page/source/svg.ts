import type { Group } from './groups';
import type { Table } from './table';
import { heading, prefixFor, roundTicks, tickText } from './units';

const width = 720, each = 270, left = 76, right = 18, top = 46, below = 40, mostPoints = 4000;
const dashes = ['', '9 3', '4 2', '10 3 2 3', '6 2 1 2', '14 3', '3 3', '8 2 3 2'];

function escape(text: string): string {
  return text.replace(/&/g, '&amp;').replace(/</g, '&lt;').replace(/>/g, '&gt;').replace(/"/g, '&quot;');
}

/** Points of a curve, thinned so that the least and the largest of every part stay. */
function thinned(x: Float64Array, y: Float64Array, from: number, to: number): [number, number][] {
  const step = Math.max(1, Math.floor(2 * (to - from) / mostPoints));
  const points: [number, number][] = [];
  for (let k = from; k < to; k += step) {
    let low = k, high = k;
    for (let j = k; j < Math.min(to, k + step); ++j) {
      if (y[j]! < y[low]!) low = j;
      if (y[j]! > y[high]!) high = j;
    }
    for (const j of low === high ? [low] : [Math.min(low, high), Math.max(low, high)]) points.push([x[j]!, y[j]!]);
  }
  return points;
}

/** Charts as one SVG file, with axes, units and names. colours: of the curves; span: of time [s]. */
export function chartsAsSvg(title: string, table: Table, groups: Group[], colours: string[], span: [number, number] | null): string {
  const time = table.column(table.find('time'));
  let first = 0, last = time.length;
  if (span !== null) {
    first = time.findIndex((t) => t >= span[0]);
    const end = time.findIndex((t) => t > span[1]);
    if (first < 0) first = time.length;
    if (end >= 0) last = end;
  }
  const t0 = span?.[0] ?? time[0] ?? 0, t1 = span?.[1] ?? time[time.length - 1] ?? 1;
  const clock = prefixFor(Math.max(Math.abs(t0), Math.abs(t1)), 's');
  const parts: string[] = [];
  groups.forEach((group, nth) => {
    const y0 = 30 + nth * each, height = each - top - below, wide = width - left - right;
    const shown = (v: number): number => group.logarithmic ? (v > 0 ? Math.log10(v) : NaN) : v;
    const curves = group.columns.map((c) => thinned(time, table.column(c), first, last).map(([t, v]) => [t, shown(v)] as const));
    let low = Infinity, high = -Infinity;
    for (const curve of curves) for (const [, v] of curve) if (Number.isFinite(v)) { low = Math.min(low, v); high = Math.max(high, v); }
    if (!(low <= high)) return;
    if (low === high) { const w = low === 0 ? 1 : 0.5 * Math.abs(low); low -= w; high += w; }
    const prefix = group.logarithmic ? { factor: 1, text: '' } : prefixFor(Math.max(Math.abs(low), Math.abs(high)), group.unit);
    const px = (t: number): number => left + wide * (t - t0) / (t1 - t0 || 1), py = (v: number): number => y0 + top + height * (high - v) / (high - low);
    parts.push(`<text x="${left}" y="${y0 + 14}" font-weight="bold">${escape(heading(group.title, group.unit, prefix))}</text>`);
    group.columns.forEach((c, k) => {
      const x = left + 150 + 160 * (k % 3), y = y0 + 12 + 14 * Math.floor(k / 3);
      parts.push(`<path d="M${x} ${y - 3}h24" stroke="${colours[k % colours.length]!}" stroke-width="2" stroke-dasharray="${dashes[k % dashes.length]!}"/>`,
        `<text x="${x + 28}" y="${y + 1}">${escape(table.columns[c]?.name ?? '')}</text>`);
    });
    parts.push(`<rect x="${left}" y="${y0 + top}" width="${wide}" height="${height}" fill="none" stroke="#505a65"/>`);
    const along = roundTicks(t0 * clock.factor, t1 * clock.factor, 7);
    for (const t of along) parts.push(`<text x="${px(t / clock.factor).toFixed(1)}" y="${y0 + top + height + 16}" text-anchor="middle">${tickText(t, (along[1] ?? 0) - (along[0] ?? 0))}</text>`);
    parts.push(`<text x="${left + wide}" y="${y0 + top + height + 31}" text-anchor="end">time [${clock.text}s]</text>`);
    const up = roundTicks(low * prefix.factor, high * prefix.factor, 5);
    for (const v of up) {
      const y = py(v / prefix.factor).toFixed(1);
      const text = group.logarithmic ? (Number.isInteger(v) ? `1e${v}` : '') : tickText(v, (up[1] ?? 0) - (up[0] ?? 0));
      parts.push(`<path d="M${left} ${y}h${wide}" stroke="#e6eaee"/>`, `<text x="${left - 6}" y="${Number(y) + 4}" text-anchor="end">${text}</text>`);
    }
    curves.forEach((curve, k) => {
      let d = '', pen = false;
      for (const [t, v] of curve) {
        if (!Number.isFinite(v)) { pen = false; continue; }
        d += `${pen ? 'L' : 'M'}${px(t).toFixed(1)} ${py(v).toFixed(1)}`;
        pen = true;
      }
      parts.push(`<path d="${d}" fill="none" stroke="${colours[k % colours.length]!}" stroke-width="1.6" stroke-linejoin="round" stroke-dasharray="${dashes[k % dashes.length]!}"/>`);
    });
  });
  const height = 30 + groups.length * each + 10;
  return `<svg xmlns="http://www.w3.org/2000/svg" width="${width}" height="${height}" viewBox="0 0 ${width} ${height}" font-family="sans-serif" font-size="12">\n`
    + `<title>${escape(title)}</title>\n<rect width="${width}" height="${height}" fill="#ffffff"/>\n<text x="${left}" y="20" font-size="15" font-weight="bold">${escape(title)}</text>\n`
    + parts.join('\n') + '\n</svg>\n';
}
