// What the server of `strake watch --web` answers: coupler/watch/web/http_api.hpp.

export type Side = 'fluid' | 'structure';

export interface RunFacts {
  title: string; name: string; folder: string; version: string; host: string; known: boolean;
  dimension: number; spacing: number; solid_spacing: number;
  sides: Record<string, string>; probes: string[];
  palette: { water: number[]; solid: number[] };
}

export interface ProcessFacts { name: string; pid: number; state: string; cpu_seconds: number; memory: number }

export interface News {
  state: string; open: boolean; words: string; error: string; exit_code: number | null;
  time: number; end_time: number | null; window: number; elapsed: number; left: number | null; silence: number;
  processes: ProcessFacts[]; stages: { name: string; seconds: number }[];
  tables: Record<string, { rows: number; generation: number }>;
  logs?: Record<string, number>;
  frames: Record<Side, { count: number; generation: number }>;
}

export interface FrameList { generation: number; from: number; numbers: number[]; times: number[] }

export interface LogPart { from: number; to: number; begins: boolean; text: string }

export interface PointValues { time: number; values: { name: string; unit: string; value: (number | null)[] }[] }

/** Of an answer that is no answer. */
export class Refused extends Error {
  constructor(readonly status: number, message: string) { super(message); }
}

async function get(path: string): Promise<Response> {
  const response = await fetch(path, { cache: 'no-store' });
  if (!response.ok) throw new Refused(response.status, (await response.text()).trim());
  return response;
}

export async function json<T>(path: string): Promise<T> {
  return await (await get(path)).json() as T;
}

interface ArrayPlace { type: 'f32' | 'f64' | 'u32' | 'u8'; at: number; count: number }

/** coupler/watch/web/field_view.hpp: arrays that are used in place. */
export class Arrays<Head> {
  readonly head: Head;
  private readonly places: Record<string, ArrayPlace>;
  constructor(private readonly buffer: ArrayBuffer) {
    const length = new DataView(buffer).getUint32(0, true);
    const head = JSON.parse(new TextDecoder().decode(new Uint8Array(buffer, 4, length))) as Head & { arrays: Record<string, ArrayPlace> };
    this.head = head;
    this.places = head.arrays;
  }
  get size(): number { return this.buffer.byteLength; }
  private place(name: string, type: ArrayPlace['type']): ArrayPlace | null {
    const place = this.places[name];
    return place !== undefined && place.type === type ? place : null;
  }
  f32(name: string): Float32Array | null {
    const p = this.place(name, 'f32');
    return p && new Float32Array(this.buffer, p.at, p.count);
  }
  f64(name: string): Float64Array | null {
    const p = this.place(name, 'f64');
    return p && new Float64Array(this.buffer, p.at, p.count);
  }
  u32(name: string): Uint32Array | null {
    const p = this.place(name, 'u32');
    return p && new Uint32Array(this.buffer, p.at, p.count);
  }
  u8(name: string): Uint8Array | null {
    const p = this.place(name, 'u8');
    return p && new Uint8Array(this.buffer, p.at, p.count);
  }
}

export async function arrays<Head>(path: string): Promise<Arrays<Head>> {
  return new Arrays<Head>(await (await get(path)).arrayBuffer());
}

export interface FieldFacts { name: string; unit: string; shown: [number, number] | null; all: [number, number] | null }

/** One of several bodies: its name, its first point in the frame, and its box [m]. */
export interface BodyFacts { name: string; first: number; low?: number[]; high?: number[] }

export interface FrameHead {
  side: Side; time: number; fields: { name: string; unit: string }[]; bodies?: BodyFacts[];
  field?: FieldFacts; low?: number[]; high?: number[];
}
export type FrameArrays = Arrays<FrameHead>;

export interface TableHead {
  generation: number; rows: number; from: number;
  columns: { name: string; unit: string; logarithmic: boolean }[]; chosen?: number[];
}
