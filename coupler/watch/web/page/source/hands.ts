import type { Stage } from './stage';

/** What the reader's pointer and keys ask for. */
export interface Hands {
  moved: (byKeyboard: boolean) => void;  // the camera did
  pick: (x: number, y: number) => void;  // [px]
  letGo: () => void;
}

/** Moves the camera by pointer, wheel and keys. */
export function listen(stage: Stage, hands: Hands): void {
  stage.canvas.addEventListener('keydown', (event) => { key(stage, hands, event); });
  stage.canvas.addEventListener('wheel', (event) => {
    event.preventDefault();
    stage.camera.zoom(Math.exp(-0.0015 * event.deltaY * (event.deltaMode === 1 ? 16 : 1)), event.offsetX, event.offsetY);
    hands.moved(false);
  }, { passive: false });
  pointers(stage, hands);
}

function pointers(stage: Stage, hands: Hands): void {
  const { canvas, camera } = stage;
  const down = new Map<number, { x: number; y: number }>();
  let travel = 0;
  canvas.addEventListener('contextmenu', (event) => { event.preventDefault(); });
  canvas.addEventListener('pointerdown', (event) => {
    canvas.setPointerCapture(event.pointerId);
    canvas.focus({ preventScroll: true });
    if (down.size === 0) travel = 0;
    down.set(event.pointerId, { x: event.offsetX, y: event.offsetY });
  });
  canvas.addEventListener('pointermove', (event) => {
    const before = down.get(event.pointerId);
    if (before === undefined) return;
    const dx = event.offsetX - before.x, dy = event.offsetY - before.y;
    travel += Math.abs(dx) + Math.abs(dy);
    if (down.size === 2) {
      const other = [...down.entries()].find(([id]) => id !== event.pointerId)?.[1] ?? before;
      const was = Math.hypot(before.x - other.x, before.y - other.y), is = Math.hypot(event.offsetX - other.x, event.offsetY - other.y);
      camera.pan(0.5 * dx, 0.5 * dy);
      if (was > 0 && is > 0) camera.zoom(is / was, 0.5 * (event.offsetX + other.x), 0.5 * (event.offsetY + other.y));
    } else if (!stage.flat && event.buttons === 1 && !event.shiftKey) {
      camera.turn(-0.008 * dx, 0.008 * dy);
    } else {
      camera.pan(dx, dy);
    }
    down.set(event.pointerId, { x: event.offsetX, y: event.offsetY });
    hands.moved(false);
  });
  const up = (event: PointerEvent): void => {
    const was = down.delete(event.pointerId);
    if (was && event.type === 'pointerup' && down.size === 0 && travel < 5) hands.pick(event.offsetX, event.offsetY);
  };
  canvas.addEventListener('pointerup', up);
  canvas.addEventListener('pointercancel', up);
}

function key(stage: Stage, hands: Hands, event: KeyboardEvent): void {
  const { camera } = stage;
  if (event.ctrlKey || event.altKey || event.metaKey) return;
  const step = 40, angle = Math.PI / 24;
  const move: Record<string, [number, number]> = { ArrowLeft: [1, 0], ArrowRight: [-1, 0], ArrowUp: [0, 1], ArrowDown: [0, -1] };
  const by = move[event.key];
  if (by !== undefined) {
    if (!stage.flat && !event.shiftKey) camera.turn(angle * by[0], angle * by[1]);
    else camera.pan(step * by[0], step * by[1]);
  } else if (event.key === '+' || event.key === '=') camera.zoom(1.25);
  else if (event.key === '-') camera.zoom(0.8);
  else if (event.key === 'Enter') hands.pick(0.5 * camera.width, 0.5 * camera.height);
  else if (event.key === 'Escape') hands.letGo();
  else return;
  event.preventDefault();
  hands.moved(true);
}
