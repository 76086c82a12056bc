import type { RunFacts, Side } from './api';
import { Camera } from './camera';
import { el } from './dom';

const roomForAxes = { left: 58, below: 34, above: 14, right: 14 };  // [px]
const noRoom = { left: 0, below: 0, above: 0, right: 0 };

/** Where the picture stands on the page, and from where the world is seen. */
export class Stage {
  readonly canvas = el<HTMLCanvasElement>('canvas');
  readonly overlay = el<HTMLCanvasElement>('overlay');
  readonly camera = new Camera();
  private readonly element = el('stage');

  constructor(public facts: RunFacts) {}

  get flat(): boolean { return this.facts.dimension === 2; }
  get margin(): typeof noRoom { return this.flat ? roomForAxes : noRoom; }
  get width(): number { return this.element.clientWidth; }
  get height(): number { return this.element.clientHeight; }
  get walls(): boolean { return el<HTMLInputElement>('walls').checked; }

  /** How many times as large the deformation is drawn. */
  get scale(): number {
    const scale = el<HTMLInputElement>('scale').valueAsNumber;
    return Number.isFinite(scale) && scale >= 0 ? scale : 1;
  }

  /** Of the points of a side [m]. */
  spacing(side: Side): number { return side === 'fluid' ? this.facts.spacing : this.facts.solid_spacing; }

  /** Turns the camera [degrees]. */
  turnTo(yaw: number, pitch: number): void {
    this.camera.yaw = yaw * Math.PI / 180;
    this.camera.pitch = pitch * Math.PI / 180;
  }

  /** Makes the stage as high as a box [m] in the plane asks for; whether its height changed. */
  heighten(low: number[], high: number[]): boolean {
    const across = high[0]! - low[0]!, over = high[1]! - low[1]!;
    const pixels = across > 0 ? 1.06 * this.camera.width * over / across + 24 : this.camera.width;
    const ideal = `${Math.round(pixels + roomForAxes.below + roomForAxes.above)}px`;
    if (this.element.style.getPropertyValue('--ideal') === ideal) return false;
    this.element.style.setProperty('--ideal', ideal);
    return true;
  }

  /** Lays the canvas into the stage; the factor by which the picture grew, nothing where it has no room. */
  layOut(): number | null {
    const { left, below, above, right } = this.margin;
    const width = this.width - left - right, height = this.height - above - below;
    if (width <= 0 || height <= 0) return null;
    const factor = this.camera.width > 1 ? width / this.camera.width : 1;
    this.camera.width = width;
    this.camera.height = height;
    this.camera.scale *= factor;
    this.canvas.style.left = `${left}px`;
    this.canvas.style.top = `${above}px`;
    this.canvas.style.width = `${width}px`;
    this.canvas.style.height = `${height}px`;
    return factor;
  }
}
