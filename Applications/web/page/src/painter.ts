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
  color = vec4(base * (0.25 + 0.72 * side) + 0.12 * shine, opacity);
}`;

export class Painter {
  private readonly program: WebGLProgram;
  constructor(private readonly gl: WebGL2RenderingContext) {
    this.program = gl.createProgram();
    for (const [type, text] of [[gl.VERTEX_SHADER, kVertex], [gl.FRAGMENT_SHADER, kFragment]] as const) {
      const shader = gl.createShader(type);
      if (shader === null) throw new Error("WebGL is lost");
      gl.shaderSource(shader, text);
      gl.compileShader(shader);
      gl.attachShader(this.program, shader);
    }
    gl.linkProgram(this.program);
    if (!gl.getProgramParameter(this.program, gl.LINK_STATUS)) throw new Error(gl.getProgramInfoLog(this.program) ?? "WebGL is lost");
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
}
