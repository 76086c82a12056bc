/**
 * An orthographic view of the world. It is first turned by `yaw` about the y axis, then by `pitch` about the x axis of
 * the screen. `scale`: pixels to a metre; `target`: the point in the middle.
 */
export class Camera {
  target: [number, number, number] = [0, 0, 0];
  yaw = 0;    // [rad]
  pitch = 0;  // [rad]
  scale = 100;
  width = 1;   // of the screen [px]
  height = 1;

  /** Rows of the rotation: right, up and towards the reader, in coordinates of the world. */
  axes(): [number[], number[], number[]] {
    const cy = Math.cos(this.yaw), sy = Math.sin(this.yaw), cp = Math.cos(this.pitch), sp = Math.sin(this.pitch);
    return [[cy, 0, -sy], [-sp * sy, cp, -sp * cy], [cp * sy, sp, cp * cy]];
  }

  /** World [m] → screen [px, from the upper left], and the depth towards the reader [m]. */
  project(x: number, y: number, z: number): [number, number, number] {
    const [right, up, near] = this.axes();
    const dx = x - this.target[0], dy = y - this.target[1], dz = z - this.target[2];
    const along = (a: number[]): number => a[0]! * dx + a[1]! * dy + a[2]! * dz;
    return [0.5 * this.width + this.scale * along(right), 0.5 * this.height - this.scale * along(up), along(near)];
  }

  /** Moves what is shown by so many pixels. */
  pan(dx: number, dy: number): void {
    const [right, up] = this.axes();
    for (let k = 0; k < 3; ++k) this.target[k]! += (-dx * right[k]! + dy * up[k]!) / this.scale;
  }

  /** Zooms by a factor; what lies under that place of the screen stays there. */
  zoom(factor: number, x = 0.5 * this.width, y = 0.5 * this.height): void {
    const dx = x - 0.5 * this.width, dy = y - 0.5 * this.height;
    this.pan(-dx, -dy);
    this.scale = Math.min(1e9, Math.max(1e-6, this.scale * factor));
    this.pan(dx, dy);
  }

  turn(yaw: number, pitch: number): void {
    this.yaw += yaw;
    this.pitch = Math.min(Math.PI / 2, Math.max(-Math.PI / 2, this.pitch + pitch));
  }

  /** Shows a box [m] with a margin [px]. */
  fit(low: number[], high: number[], margin: number): void {
    const [right, up] = this.axes();
    let across = 0, over = 0;
    for (let k = 0; k < 3; ++k) {
      const half = 0.5 * (high[k]! - low[k]!);
      this.target[k] = 0.5 * (high[k]! + low[k]!);
      across += Math.abs(right[k]!) * half;
      over += Math.abs(up[k]!) * half;
    }
    const room = (pixels: number): number => Math.max(20, pixels - 2 * margin);
    this.scale = Math.min(room(this.width) / Math.max(2 * across, 1e-9), room(this.height) / Math.max(2 * over, 1e-9));
  }
}
