/** A power of ten that a unit is given in: as coupler/plot/ticks.cpp chooses it. */
export interface Prefix { factor: number; text: string }

const known: [number, string][] = [[9, 'G'], [6, 'M'], [3, 'k'], [0, ''], [-3, 'm'], [-6, 'µ'], [-9, 'n']];

export function prefixFor(largest: number, unit: string): Prefix {
  const plain = unit === '' || unit === '1' || unit.includes('^') || unit === 'kg' || unit === 'deg' || unit === 'rad';
  const size = Math.abs(largest);
  if (plain || size === 0 || !Number.isFinite(size)) return { factor: 1, text: '' };
  for (const [exponent, text] of known)
    if (size >= 0.9999 * 10 ** exponent) return { factor: 10 ** -exponent, text };
  return { factor: 1, text: '' };
}

export function withPrefix(prefix: Prefix, unit: string): string {
  return unit === '1' ? '' : prefix.text + unit;
}

/** Four digits; a true minus. */
export function digits(value: number, n = 4): string {
  if (!Number.isFinite(value)) return '–';
  const size = Math.abs(value);
  const text = size !== 0 && (size >= 1e5 || size < 1e-3)
    ? value.toExponential(2)
    : String(Number(value.toPrecision(n)));
  return text.replace(/-/g, '−');
}

/** "1.742 mm". */
export function quantity(value: number | null | undefined, unit: string, n = 4): string {
  if (value === null || value === undefined || !Number.isFinite(value)) return '–';
  const prefix = prefixFor(value, unit);
  const name = withPrefix(prefix, unit);
  return digits(value * prefix.factor, n) + (name === '' ? '' : ' ' + name);
}

/** "mid.y [mm]" for values up to `largest`. */
export function heading(name: string, unit: string, prefix: Prefix): string {
  const shown = withPrefix(prefix, unit);
  return shown === '' ? name : `${name} [${shown}]`;
}

/** "2 min 03 s". */
export function duration(seconds: number | null | undefined): string {
  if (seconds === null || seconds === undefined || !Number.isFinite(seconds)) return '–';
  if (seconds < 59.95) return `${seconds.toFixed(1)} s`;
  const whole = Math.round(seconds);
  const two = (n: number): string => String(n).padStart(2, '0');
  if (whole < 3600) return `${Math.floor(whole / 60)} min ${two(whole % 60)} s`;
  return `${Math.floor(whole / 3600)} h ${two(Math.floor((whole % 3600) / 60))} min`;
}

export function bytes(n: number): string {
  return quantity(n, 'B', 3);
}

/** 3000 → "3 000". */
export function grouped(n: number): string {
  return String(n).replace(/\B(?=(\d{3})+$)/g, ' ');
}

/** Round numbers (1, 2 or 5 times a power of ten apart) within [low, high], about `wanted` of them. */
export function roundTicks(low: number, high: number, wanted: number): number[] {
  if (!(high > low) || !Number.isFinite(high - low)) return [];
  const raw = (high - low) / wanted;
  const power = 10 ** Math.floor(Math.log10(raw));
  let step = 10 * power;
  for (const m of [5, 2, 1]) if (m * power >= raw * (1 - 1e-9)) step = m * power;
  const ticks: number[] = [];
  for (let k = Math.ceil(low / step - 1e-9); k * step <= high + 1e-9 * step && ticks.length < 100; ++k)
    ticks.push(k === 0 ? 0 : k * step);
  return ticks;
}

/** As many decimals as distinguish ticks of that distance. */
export function tickText(value: number, distance: number): string {
  const size = Math.max(Math.abs(value), Math.abs(distance));
  if (size >= 1e6 || (size > 0 && size < 1e-4)) return value.toExponential(1).replace(/-/g, '−');
  const places = distance > 0 ? Math.max(0, Math.ceil(-Math.log10(distance) - 1e-9)) : 0;
  return value.toFixed(Math.min(places, 9)).replace(/-/g, '−');
}
