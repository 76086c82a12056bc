import type { Camera } from './camera';

/** Points or a surface of one side of a frame, as they lie on the graphics card. */
export interface Cloud {
  count: number;       // of points
  position: WebGLBuffer; value: WebGLBuffer | null; bend: WebGLBuffer | null; kind: WebGLBuffer | null;
  triangles: WebGLBuffer | null; nTriangles: number;
  edges: WebGLBuffer | null; nEdges: number;
  edgeLength: number;  // [m] of the cells, on average
}
export interface CloudData {
  position: Float32Array; value: Float32Array | null; bend: Float32Array | null; kind: Uint8Array | null;
  triangle: Uint32Array | null; edge: Uint32Array | null;
}
export interface Look {
  palette: 0 | 1;           // water, structure
  low: number; high: number; // of the colours
  diameter: number;          // of a point [m]
  scale: number;             // of the deformation
  walls: boolean;
}

const place = `#version 300 es
precision highp float;
in vec3 position; in float value; in vec3 bend; in float kind;
uniform mat3 axes; uniform vec3 target; uniform vec2 zoom; uniform float depth, scale;
vec4 placed() {
  vec3 seen = (position + (scale - 1.0) * bend - target) * axes;
  return vec4(zoom * seen.xy, -seen.z * depth, 1.0);
}`;

const pointVertex = `${place}
uniform float size; uniform bool walls;
out float v; flat out float wall;
void main() {
  gl_Position = placed();
  v = value; wall = kind;
  // Small ones are squares that overlap a little, so that no pattern of gaps shows between them.
  gl_PointSize = max(1.5, kind > 0.5 ? 0.5 * size : size > 7.0 ? size : 1.15 * size + 0.5);
  if (kind > 0.5 && !walls) gl_Position = vec4(2.0, 2.0, 2.0, 1.0);
}`;

const colouring = `
uniform sampler2D palette; uniform float row, low, high; uniform vec3 grey;
vec3 coloured(float v) {
  if (isnan(v) || high <= low) return grey;
  return texture(palette, vec2(clamp((v - low) / (high - low), 0.0, 1.0) * 63.0 / 64.0 + 0.5 / 64.0, row)).rgb;
}`;

const pointFragment = `#version 300 es
precision highp float;
in float v; flat in float wall; out vec4 colour;
uniform float size; uniform bool solid;
${colouring}
void main() {
  vec2 at = 2.0 * gl_PointCoord - 1.0;
  float off = dot(at, at);
  if (size > 7.0 && wall < 0.5 && off > 1.0) discard;
  vec3 c = wall > 0.5 ? grey : coloured(v);
  if (solid && size > 2.5) c *= 0.6 + 0.4 * sqrt(max(0.0, 1.0 - off));
  colour = vec4(c, 1.0);
}`;

const surfaceVertex = `${place}
out float v; out vec3 seen;
void main() { gl_Position = placed(); v = value; seen = (position + (scale - 1.0) * bend) * axes; }`;

const surfaceFragment = `#version 300 es
precision highp float;
in float v; in vec3 seen; out vec4 colour;
uniform bool solid;
${colouring}
void main() {
  vec3 c = coloured(v);
  if (solid) c *= 0.55 + 0.45 * abs(normalize(cross(dFdx(seen), dFdy(seen))).z);
  colour = vec4(c, 1.0);
}`;

const lineFragment = `#version 300 es
precision highp float;
out vec4 colour;
uniform vec4 ink;
void main() { colour = vec4(ink.rgb, 0.55); }`;

const leastEdge = 7;  // [px] of cells whose edges are drawn

function averageLength(position: Float32Array, edge: Uint32Array | null): number {
  if (edge === null || edge.length < 2) return 0;
  let sum = 0, n = 0;
  for (let k = 0; k + 1 < edge.length; k += 2) {
    const a = 3 * edge[k]!, b = 3 * edge[k + 1]!;
    sum += Math.hypot(position[a]! - position[b]!, position[a + 1]! - position[b + 1]!, position[a + 2]! - position[b + 2]!);
    ++n;
  }
  return sum / n;
}

const locations = { position: 0, value: 1, bend: 2, kind: 3 };

/** Draws points and surfaces by WebGL 2. Throws where a browser has none. */
export class Renderer {
  private readonly gl: WebGL2RenderingContext;
  private readonly points: WebGLProgram;
  private readonly surface: WebGLProgram;
  private readonly lines: WebGLProgram;
  private readonly palette: WebGLTexture;
  lost = false;

  constructor(private readonly canvas: HTMLCanvasElement) {
    const gl = canvas.getContext('webgl2', { antialias: false, alpha: false, preserveDrawingBuffer: false });
    if (gl === null) throw new Error('this browser offers no WebGL 2');
    this.gl = gl;
    this.points = this.program(pointVertex, pointFragment);
    this.surface = this.program(surfaceVertex, surfaceFragment);
    this.lines = this.program(surfaceVertex, lineFragment);
    this.palette = gl.createTexture();
  }

  /** What draws: "ANGLE (…)". */
  name(): string {
    const info = this.gl.getExtension('WEBGL_debug_renderer_info');
    return String(this.gl.getParameter(info === null ? this.gl.RENDERER : info.UNMASKED_RENDERER_WEBGL));
  }

  /** Two rows of colours, 0 to 255. */
  setPalette(water: number[], solid: number[]): void {
    const gl = this.gl, n = water.length / 3;
    const texels = new Uint8Array(2 * n * 4);
    [water, solid].forEach((colours, row) => {
      for (let k = 0; k < n; ++k) texels.set([colours[3 * k]!, colours[3 * k + 1]!, colours[3 * k + 2]!, 255], 4 * (row * n + k));
    });
    gl.bindTexture(gl.TEXTURE_2D, this.palette);
    gl.texImage2D(gl.TEXTURE_2D, 0, gl.RGBA, n, 2, 0, gl.RGBA, gl.UNSIGNED_BYTE, texels);
    for (const [key, how] of [[gl.TEXTURE_MIN_FILTER, gl.LINEAR], [gl.TEXTURE_MAG_FILTER, gl.LINEAR],
      [gl.TEXTURE_WRAP_S, gl.CLAMP_TO_EDGE], [gl.TEXTURE_WRAP_T, gl.CLAMP_TO_EDGE]] as const)
      gl.texParameteri(gl.TEXTURE_2D, key, how);
  }

  load(data: CloudData): Cloud {
    const gl = this.gl;
    const buffer = (what: number, array: ArrayBufferView | null): WebGLBuffer | null => {
      if (array === null) return null;
      const made = gl.createBuffer();
      gl.bindBuffer(what, made);
      gl.bufferData(what, array, gl.STATIC_DRAW);
      return made;
    };
    gl.bindVertexArray(null);
    return {
      count: data.position.length / 3,
      position: buffer(gl.ARRAY_BUFFER, data.position)!,
      value: buffer(gl.ARRAY_BUFFER, data.value),
      bend: buffer(gl.ARRAY_BUFFER, data.bend),
      kind: buffer(gl.ARRAY_BUFFER, data.kind),
      triangles: buffer(gl.ELEMENT_ARRAY_BUFFER, data.triangle), nTriangles: data.triangle?.length ?? 0,
      edges: buffer(gl.ELEMENT_ARRAY_BUFFER, data.edge), nEdges: data.edge?.length ?? 0,
      edgeLength: averageLength(data.position, data.edge),
    };
  }

  unload(cloud: Cloud): void {
    for (const b of [cloud.position, cloud.value, cloud.bend, cloud.kind, cloud.triangles, cloud.edges])
      if (b !== null) this.gl.deleteBuffer(b);
  }

  /** Begins a picture. ratio: pixels of the screen to one of the style sheet; span: of the depth [m]. */
  begin(camera: Camera, ratio: number, span: number, solid: boolean, paper: number[], grey: number[], ink: number[]): void {
    const gl = this.gl;
    const width = Math.max(1, Math.round(camera.width * ratio)), height = Math.max(1, Math.round(camera.height * ratio));
    if (this.canvas.width !== width || this.canvas.height !== height) {
      this.canvas.width = width;
      this.canvas.height = height;
    }
    gl.viewport(0, 0, width, height);
    gl.clearColor(paper[0]!, paper[1]!, paper[2]!, 1);
    gl.clear(gl.COLOR_BUFFER_BIT | gl.DEPTH_BUFFER_BIT);
    if (solid) gl.enable(gl.DEPTH_TEST); else gl.disable(gl.DEPTH_TEST);
    gl.depthFunc(gl.LEQUAL);
    const axes = camera.axes();
    for (const program of [this.points, this.surface, this.lines]) {
      gl.useProgram(program);
      const at = (name: string): WebGLUniformLocation | null => gl.getUniformLocation(program, name);
      // `vector * axes` takes the columns for the rows of the rotation.
      gl.uniformMatrix3fv(at('axes'), false, axes.flat());
      gl.uniform3fv(at('target'), camera.target);
      gl.uniform2f(at('zoom'), 2 * camera.scale / camera.width, 2 * camera.scale / camera.height);
      gl.uniform1f(at('depth'), 1 / Math.max(span, 1e-9));
      gl.uniform1i(at('solid'), solid ? 1 : 0);
      gl.uniform3f(at('grey'), grey[0]!, grey[1]!, grey[2]!);
      gl.uniform4f(at('ink'), ink[0]!, ink[1]!, ink[2]!, 1);
      gl.uniform1i(at('palette'), 0);
    }
    gl.activeTexture(gl.TEXTURE0);
    gl.bindTexture(gl.TEXTURE_2D, this.palette);
  }

  draw(cloud: Cloud, look: Look, camera: Camera, ratio: number): void {
    const gl = this.gl;
    const attribute = (at: number, buffer: WebGLBuffer | null, n: number, type: number, otherwise: number): void => {
      if (buffer === null) {
        gl.disableVertexAttribArray(at);
        gl.vertexAttrib4f(at, otherwise, otherwise, otherwise, 1);
        return;
      }
      gl.bindBuffer(gl.ARRAY_BUFFER, buffer);
      gl.enableVertexAttribArray(at);
      gl.vertexAttribPointer(at, n, type, false, 0, 0);
    };
    attribute(locations.position, cloud.position, 3, gl.FLOAT, 0);
    attribute(locations.value, cloud.value, 1, gl.FLOAT, NaN);
    attribute(locations.bend, cloud.bend, 3, gl.FLOAT, 0);
    attribute(locations.kind, cloud.kind, 1, gl.UNSIGNED_BYTE, 0);
    const use = (program: WebGLProgram): void => {
      gl.useProgram(program);
      const at = (name: string): WebGLUniformLocation | null => gl.getUniformLocation(program, name);
      gl.uniform1f(at('row'), look.palette === 0 ? 0.25 : 0.75);
      gl.uniform1f(at('low'), look.low);
      gl.uniform1f(at('high'), look.high);
      gl.uniform1f(at('scale'), look.scale);
      gl.uniform1f(at('size'), look.diameter * camera.scale * ratio);
      gl.uniform1i(at('walls'), look.walls ? 1 : 0);
    };
    if (cloud.nTriangles === 0 && cloud.nEdges === 0) {
      use(this.points);
      gl.drawArrays(gl.POINTS, 0, cloud.count);
      return;
    }
    if (cloud.triangles !== null && cloud.nTriangles > 0) {
      use(this.surface);
      gl.bindBuffer(gl.ELEMENT_ARRAY_BUFFER, cloud.triangles);
      gl.enable(gl.POLYGON_OFFSET_FILL);
      gl.polygonOffset(1, 1);
      gl.drawElements(gl.TRIANGLES, cloud.nTriangles, gl.UNSIGNED_INT, 0);
      gl.disable(gl.POLYGON_OFFSET_FILL);
    }
    // Lines closer than that would hide the colours between them. A line of two points is all that there is of it.
    if (cloud.edges !== null && (cloud.edgeLength * camera.scale > leastEdge || cloud.nTriangles === 0)) {
      use(this.lines);
      gl.bindBuffer(gl.ELEMENT_ARRAY_BUFFER, cloud.edges);
      gl.enable(gl.BLEND);
      gl.blendFuncSeparate(gl.SRC_ALPHA, gl.ONE_MINUS_SRC_ALPHA, gl.ZERO, gl.ONE);
      gl.drawElements(gl.LINES, cloud.nEdges, gl.UNSIGNED_INT, 0);
      gl.disable(gl.BLEND);
    }
  }

  /** Waits until all is drawn. */
  finish(): void {
    const pixel = new Uint8Array(4);
    this.gl.readPixels(0, 0, 1, 1, this.gl.RGBA, this.gl.UNSIGNED_BYTE, pixel);
  }

  private program(vertex: string, fragment: string): WebGLProgram {
    const gl = this.gl, program = gl.createProgram();
    for (const [type, text] of [[gl.VERTEX_SHADER, vertex], [gl.FRAGMENT_SHADER, fragment]] as const) {
      const shader = gl.createShader(type);
      if (shader === null) throw new Error('WebGL makes no shader');
      gl.shaderSource(shader, text);
      gl.compileShader(shader);
      if (gl.getShaderParameter(shader, gl.COMPILE_STATUS) !== true && !gl.isContextLost())
        throw new Error(`WebGL: ${gl.getShaderInfoLog(shader) ?? ''}`);
      gl.attachShader(program, shader);
    }
    for (const [name, at] of Object.entries(locations)) gl.bindAttribLocation(program, at, name);
    gl.linkProgram(program);
    if (gl.getProgramParameter(program, gl.LINK_STATUS) !== true && !gl.isContextLost())
      throw new Error(`WebGL: ${gl.getProgramInfoLog(program) ?? ''}`);
    return program;
  }
}
