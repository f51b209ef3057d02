/** Draws surfaces in niivue's 3-D tile. niivue's own meshes take seconds to change at half a million triangles. */
import type { Shape } from "./protocol";

export type Color = [number, number, number];
/** \param colors  of each point, RGBA; in the place of `color` */
export interface Surface { name: string; shape: Shape; color: Color; opacity: number; colors?: Uint8Array }
export interface Painted { surface: Surface; isShown: boolean; buffers: WebGLBuffer[]; array: WebGLVertexArrayObject }

const kVertex = `#version 300 es
layout(location=0) in vec3 position;
layout(location=1) in vec3 normal;
layout(location=2) in vec4 color;
uniform mat4 toScreen, turn;
out vec3 vNormal, vColor;
void main() {
  gl_Position = toScreen * vec4(position, 1.0);
  vNormal = mat3(turn) * normal;
  vColor = color.rgb;
}`;
/** Where the inside is seen it is red. To pick, the depth is packed into the colour as niivue reads it. */
const kFragment = `#version 300 es
precision highp float;
uniform float opacity;
uniform bool isPicking;
in vec3 vNormal, vColor;
out vec4 color;
void main() {
  if (isPicking) {
    vec4 depth = fract(gl_FragCoord.z * vec4(16777216.0, 65536.0, 256.0, 1.0));
    color = depth - depth.xxyz * vec4(0.0, vec3(1.0 / 256.0));
    return;
  }
  if (!gl_FrontFacing && opacity < 0.99) discard;
  vec3 n = normalize(vNormal + vec3(0.0, 0.0, 1e-9));
  float side = abs(dot(n, normalize(vec3(-0.35, 0.45, -0.9)))), shine = pow(abs(dot(n, normalize(vec3(-0.2, 0.3, -1.0)))), 24.0);
  vec3 base = gl_FrontFacing ? vColor : vec3(0.84, 0.27, 0.25);
  float dark = opacity < 0.99 ? 0.75 : 0.25;  // what is seen through keeps its colour
  color = vec4(base * mix(dark, 0.97, side) + 0.12 * shine, opacity);
}`;

/** A segment as a rectangle of the tile's plane. Noise has 100,000 of them, over which a 2-D canvas sits a minute. */
const kSegment = `#version 300 es
layout(location=0) in vec3 from;
layout(location=1) in vec3 to;
uniform ivec2 axes;
uniform vec4 toPixel;
uniform vec2 size;
uniform float halfWidth;
void main() {
  vec2 a = vec2(from[axes.x], from[axes.y]) * toPixel.xy + toPixel.zw, b = vec2(to[axes.x], to[axes.y]) * toPixel.xy + toPixel.zw;
  vec2 along = a == b ? vec2(1.0, 0.0) : normalize(b - a), side = vec2(-along.y, along.x) * (gl_VertexID % 2 == 0 ? 1.0 : -1.0);
  vec2 pixel = gl_VertexID < 2 ? a - halfWidth * along : b + halfWidth * along;
  gl_Position = vec4(2.0 * (pixel + halfWidth * side) / size - 1.0, 0.0, 1.0);
}`;
const kOneColor = `#version 300 es
precision highp float;
uniform vec3 shade;
out vec4 color;
void main() { color = vec4(shade, 1.0); }`;

/** Where a tile lies, in pixels from the lower left, and what of a point's mm runs across and up it. */
export interface TilePlace { box: number[]; axes: number[]; toPixel: number[] }
export interface Outline { array: WebGLVertexArrayObject; buffer: WebGLBuffer; segments: number }

function makeProgram(gl: WebGL2RenderingContext, vertex: string, fragment: string): WebGLProgram {
  const program = gl.createProgram();
  for (const [type, text] of [[gl.VERTEX_SHADER, vertex], [gl.FRAGMENT_SHADER, fragment]] as const) {
    const shader = gl.createShader(type);
    if (shader === null) throw new Error("WebGL is lost");
    gl.shaderSource(shader, text);
    gl.compileShader(shader);
    gl.attachShader(program, shader);
  }
  gl.linkProgram(program);
  if (!gl.getProgramParameter(program, gl.LINK_STATUS)) throw new Error(gl.getProgramInfoLog(program) ?? "WebGL is lost");
  return program;
}

export class Painter {
  private readonly program: WebGLProgram;
  private readonly lines: WebGLProgram;
  constructor(private readonly gl: WebGL2RenderingContext) {
    this.program = makeProgram(gl, kVertex, kFragment);
    this.lines = makeProgram(gl, kSegment, kOneColor);
  }

  add(surface: Surface): Painted {
    const { gl } = this, { shape } = surface, buffers: WebGLBuffer[] = [];
    const array = gl.createVertexArray();
    gl.bindVertexArray(array);
    const put = (target: number, data: AllowSharedBufferSource): void => {
      const buffer = gl.createBuffer();
      gl.bindBuffer(target, buffer);
      gl.bufferData(target, data, gl.STATIC_DRAW);
      buffers.push(buffer);
    };
    const give = (index: number, data: AllowSharedBufferSource, type: number, count: number): void => {
      put(gl.ARRAY_BUFFER, data);
      gl.enableVertexAttribArray(index);
      gl.vertexAttribPointer(index, count, type, true, 0, 0);
    };
    give(0, shape.points as Float32Array<ArrayBuffer>, gl.FLOAT, 3);
    give(1, shape.normals as Float32Array<ArrayBuffer>, gl.FLOAT, 3);
    if (surface.colors) give(2, surface.colors as Uint8Array<ArrayBuffer>, gl.UNSIGNED_BYTE, 4);
    put(gl.ELEMENT_ARRAY_BUFFER, shape.triangles as Uint32Array<ArrayBuffer>);
    gl.bindVertexArray(null);
    return { surface, isShown: true, buffers, array };
  }

  remove(painted: Painted): void {
    for (const buffer of painted.buffers) this.gl.deleteBuffer(buffer);
    this.gl.deleteVertexArray(painted.array);
  }

  draw(all: Painted[], toScreen: Float32Array, turn: Float32Array, isPicking: boolean): void {
    const { gl, program } = this, at = (name: string): WebGLUniformLocation | null => gl.getUniformLocation(program, name);
    gl.useProgram(program);
    gl.uniformMatrix4fv(at("toScreen"), false, toScreen);
    gl.uniformMatrix4fv(at("turn"), false, turn);
    gl.uniform1i(at("isPicking"), Number(isPicking));
    gl.enable(gl.DEPTH_TEST);
    gl.depthFunc(gl.LEQUAL);
    gl.disable(gl.CULL_FACE);
    gl.blendFunc(gl.SRC_ALPHA, gl.ONE_MINUS_SRC_ALPHA);
    for (const { surface, array } of all.filter((one) => one.isShown)) {
      const isSolid = surface.opacity >= 1 || isPicking;
      gl.depthMask(isSolid);
      if (isSolid) gl.disable(gl.BLEND); else gl.enable(gl.BLEND);
      gl.uniform1f(at("opacity"), surface.opacity);
      const [red, green, blue] = surface.color;
      gl.vertexAttrib4f(2, red / 255, green / 255, blue / 255, 1);
      gl.bindVertexArray(array);
      gl.drawElements(gl.TRIANGLES, surface.shape.triangles.length, gl.UNSIGNED_INT, 0);
    }
    gl.bindVertexArray(null);
    gl.depthMask(true);
    gl.disable(gl.BLEND);
  }

  /** \param ends  pairs of points, flat */
  addOutline(ends: Float32Array<ArrayBuffer>): Outline {
    const { gl } = this, array = gl.createVertexArray(), buffer = gl.createBuffer();
    gl.bindVertexArray(array);
    gl.bindBuffer(gl.ARRAY_BUFFER, buffer);
    gl.bufferData(gl.ARRAY_BUFFER, ends, gl.STATIC_DRAW);
    for (const end of [0, 1]) {
      gl.enableVertexAttribArray(end);
      gl.vertexAttribPointer(end, 3, gl.FLOAT, false, 24, 12 * end);
      gl.vertexAttribDivisor(end, 1);
    }
    gl.bindVertexArray(null);
    return { array, buffer, segments: ends.length / 6 };
  }

  removeOutline({ array, buffer }: Outline): void {
    this.gl.deleteBuffer(buffer);
    this.gl.deleteVertexArray(array);
  }

  drawOutlines(outlines: { outline: Outline; color: Color }[], { box, axes, toPixel }: TilePlace, pixel: number): void {
    const { gl, lines } = this, at = (name: string): WebGLUniformLocation | null => gl.getUniformLocation(lines, name);
    gl.useProgram(lines);
    gl.viewport(0, 0, gl.canvas.width, gl.canvas.height);
    gl.enable(gl.SCISSOR_TEST);
    gl.scissor(box[0], box[1], box[2], box[3]);
    for (const capability of [gl.DEPTH_TEST, gl.CULL_FACE, gl.BLEND]) gl.disable(capability);
    gl.uniform2i(at("axes"), axes[0], axes[1]);
    gl.uniform4fv(at("toPixel"), toPixel);
    gl.uniform2f(at("size"), gl.canvas.width, gl.canvas.height);
    for (const isRim of [true, false]) {  // on bright tissue a line is seen by its dark rim
      gl.uniform1f(at("halfWidth"), (isRim ? 1.75 : 0.75) * pixel);
      for (const { outline, color } of outlines) {
        gl.uniform3fv(at("shade"), isRim ? [0, 0, 0] : color.map((shade) => shade / 255));
        gl.bindVertexArray(outline.array);
        gl.drawArraysInstanced(gl.TRIANGLE_STRIP, 0, 4, outline.segments);
      }
    }
    gl.bindVertexArray(null);
    gl.disable(gl.SCISSOR_TEST);
  }
}
