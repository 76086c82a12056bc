import type { Table, TableColumn } from './table';

/** Curves that share a chart: of one thing ("mid.x", "mid.y" or "left.force.x", "left.force.y") and one unit. */
export interface Group { key: string; title: string; unit: string; logarithmic: boolean; columns: number[] }

const alone = ['residual', 'iterations', 'work_gap', 'cfl', 'pressure_iterations'];

function stem(column: TableColumn): string {
  if (alone.includes(column.name)) return column.name;
  const dot = column.name.lastIndexOf('.');
  return dot < 0 ? column.name : column.name.slice(0, dot);
}

export function groupsOf(table: Table): Group[] {
  const groups = new Map<string, Group>();
  table.columns.forEach((column, at) => {
    if (column.name === 'window' || column.name === 'time') return;
    const key = `${stem(column)} [${column.unit}]`;
    const found = groups.get(key);
    if (found !== undefined) found.columns.push(at);
    else groups.set(key, { key, title: stem(column), unit: column.unit, logarithmic: column.logarithmic, columns: [at] });
  });
  // What the run's probes see comes first, then how the coupling goes, then the rest.
  const rank = (g: Group): number => {
    const place = table.chosen.findIndex((c) => g.columns.includes(c));
    if (place >= 0 && !alone.includes(stem(table.columns[g.columns[0]!]!))) return place;
    return alone.includes(g.title) ? 100 + alone.indexOf(g.title) : 200;
  };
  return [...groups.values()].sort((a, b) => rank(a) - rank(b));
}

/** Those that are shown at first: what the run's probes see, and how the coupling goes. */
export function firstGroups(groups: Group[], table: Table): string[] {
  const first = groups.filter((g) => g.columns.some((c) => table.chosen.includes(c))).map((g) => g.key);
  for (const name of ['residual', 'iterations']) {
    const group = groups.find((g) => g.columns.length === 1 && table.columns[g.columns[0]!]?.name === name);
    if (group !== undefined && !first.includes(group.key)) first.push(group.key);
  }
  return first.slice(0, 8);
}
