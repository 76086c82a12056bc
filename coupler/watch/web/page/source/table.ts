import { arrays } from './api';
import type { TableHead } from './api';

export interface TableColumn { name: string; unit: string; logarithmic: boolean }

/** A column file of the run, as far as the page has read it. */
export class Table {
  columns: TableColumn[] = [];
  chosen: number[] = [];
  rows = 0;
  private generation = -1;
  private data: Float64Array[] = [];

  constructor(private readonly name: string) {}

  /** Asks for what is new; whether there was anything. */
  async learn(told: { rows: number; generation: number } | undefined): Promise<boolean> {
    if (told === undefined || (told.generation === this.generation && told.rows <= this.rows)) return false;
    let any = false;
    for (;;) {
      const from = told.generation === this.generation || any ? this.rows : 0;
      const answer = await arrays<TableHead>(`api/table?name=${this.name}&from=${from}`);
      const head = answer.head;
      if (head.generation !== this.generation) {
        this.generation = head.generation;
        this.columns = head.columns;
        this.rows = 0;
        this.data = head.columns.map(() => new Float64Array(1024));
        if (head.from > 0) continue;  // from its beginning
      }
      if (head.columns.length > this.columns.length) {
        this.columns = head.columns;
        this.data = head.columns.map(() => new Float64Array(1024));
      }
      if (head.chosen !== undefined) this.chosen = head.chosen;
      let added = 0;
      head.columns.forEach((_, c) => {
        const more = answer.f64(String(c));
        if (more === null) return;
        added = more.length;
        let column = this.data[c]!;
        while (column.length < this.rows + more.length) {
          const larger = new Float64Array(2 * column.length);
          larger.set(column);
          this.data[c] = column = larger;
        }
        column.set(more, this.rows);
      });
      this.rows += added;
      any = true;
      if (added === 0 || this.rows >= head.rows) return true;
    }
  }

  column(at: number): Float64Array { return (this.data[at] ?? new Float64Array()).subarray(0, this.rows); }
  find(name: string): number { return this.columns.findIndex((c) => c.name === name); }
}
