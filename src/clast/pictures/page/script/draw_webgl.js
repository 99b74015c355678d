// Blocks by WebGL2: start vertices stay on the card, a frame sends six numbers and a colour a block.

const BLOCKS = `#version 300 es
precision highp float;
precision highp int;
precision highp sampler2D;
in vec2 arm;
in float block;
uniform sampler2D maps;
uniform sampler2D colours;
uniform vec2 centre;
uniform vec2 scale;
uniform vec4 line;
out vec4 colour;
void main() {
  ivec2 size = textureSize(colours, 0);
  int number = int(block);
  ivec2 at = ivec2(number % size.x, number / size.x);
  vec4 turn = texelFetch(maps, ivec2(2 * at.x, at.y), 0);
  vec4 move = texelFetch(maps, ivec2(2 * at.x + 1, at.y), 0);
  vec2 place = vec2(dot(turn.xy, arm), dot(turn.zw, arm)) + move.xy;
  gl_Position = vec4((place - centre) * scale, 0.0, 1.0);
  vec4 own = texelFetch(colours, at, 0);
  if (own.a == 0.0) gl_Position = vec4(2.0, 2.0, 2.0, 1.0);
  colour = line.a > 0.0 ? line : vec4(own.rgb, 1.0);
}`;
const FRAGMENT = `#version 300 es
precision mediump float;
in vec4 colour;
out vec4 pixel;
void main() { pixel = vec4(colour.rgb * colour.a, colour.a); }`;

/**
 * Return the triangles of a simple outline by cutting ears: three numbers of corners each.
 * @param {Float32Array} points x and y by turns, counter-clockwise
 */
export function triangles(points) {
  const left = Array.from({ length: points.length / 2 }, (_, k) => k);
  const found = [];
  const turn = (a, b, c) =>
    (points[2 * b] - points[2 * a]) * (points[2 * c + 1] - points[2 * a + 1]) -
    (points[2 * b + 1] - points[2 * a + 1]) * (points[2 * c] - points[2 * a]);
  while (left.length > 3) {
    let ear = -1;
    for (let k = 0; k < left.length && ear < 0; k++) {
      const a = left[(k + left.length - 1) % left.length];
      const b = left[k];
      const c = left[(k + 1) % left.length];
      if (turn(a, b, c) <= 0) continue;
      const clear = left.every(
        (p) =>
          p === a || p === b || p === c ||
          !(turn(a, b, p) >= 0 && turn(b, c, p) >= 0 && turn(c, a, p) >= 0),
      );
      if (clear) ear = k;
    }
    if (ear < 0) ear = 0; // an outline that crosses itself: some triangles are better than none
    const count = left.length;
    found.push(left[(ear + count - 1) % count], left[ear], left[(ear + 1) % count]);
    left.splice(ear, 1);
  }
  found.push(...left);
  return found;
}

/** Return whether a context is drawn by software, which a 2D canvas does better. */
export function isSoftware(gl) {
  const more = gl.getExtension("WEBGL_debug_renderer_info");
  const name = String(gl.getParameter(more ? more.UNMASKED_RENDERER_WEBGL : gl.RENDERER));
  return /swiftshader|llvmpipe|softpipe|software|basic render/i.test(name);
}

/** Draws blocks on the graphics card. */
export class WebglDrawing {
  name = "webgl2";

  /** @param {WebGL2RenderingContext} gl @param {import("./data.js").RunData} run */
  constructor(gl, run) {
    this.gl = gl;
    this.run = run;
    this.program = this.link();
    this.place = Object.fromEntries(
      ["maps", "colours", "centre", "scale", "line"].map((name) => [
        name,
        gl.getUniformLocation(this.program, name),
      ]),
    );
    this.wide = Math.min(1024, run.blockCount);
    this.tall = Math.ceil(run.blockCount / this.wide);
    this.maps = new Float32Array(8 * this.wide * this.tall);
    this.colours = new Uint8Array(4 * this.wide * this.tall);
    this.textures = [gl.createTexture(), gl.createTexture()];
    for (const texture of this.textures) {
      gl.bindTexture(gl.TEXTURE_2D, texture);
      gl.texParameteri(gl.TEXTURE_2D, gl.TEXTURE_MIN_FILTER, gl.NEAREST);
      gl.texParameteri(gl.TEXTURE_2D, gl.TEXTURE_MAG_FILTER, gl.NEAREST);
    }
    this.load();
  }

  link() {
    const { gl } = this;
    const program = gl.createProgram();
    for (const [kind, text] of [
      [gl.VERTEX_SHADER, BLOCKS],
      [gl.FRAGMENT_SHADER, FRAGMENT],
    ]) {
      const shader = gl.createShader(kind);
      gl.shaderSource(shader, text);
      gl.compileShader(shader);
      gl.attachShader(program, shader);
    }
    gl.linkProgram(program);
    if (!gl.getProgramParameter(program, gl.LINK_STATUS)) {
      throw new Error(gl.getProgramInfoLog(program) ?? "the shaders cannot be linked");
    }
    return program;
  }

  /** Send vertices, triangles and edges to the card. */
  load() {
    const { gl, run } = this;
    const count = run.start.length / 2;
    const rows = new Float32Array(3 * count);
    const faces = [];
    const edges = new Uint32Array(2 * count);
    for (let block = 0; block < run.blockCount; block++) {
      const first = run.blockStart[block];
      const past = run.blockStart[block + 1];
      for (let v = first; v < past; v++) {
        rows[3 * v] = run.start[2 * v] - run.middle[2 * block];
        rows[3 * v + 1] = run.start[2 * v + 1] - run.middle[2 * block + 1];
        rows[3 * v + 2] = block;
        edges[2 * v] = v;
        edges[2 * v + 1] = v + 1 < past ? v + 1 : first;
      }
      for (const corner of triangles(run.start.subarray(2 * first, 2 * past))) {
        faces.push(first + corner);
      }
    }
    this.faceCount = faces.length;
    this.edgeCount = edges.length;
    this.arrays = gl.createVertexArray();
    gl.bindVertexArray(this.arrays);
    gl.bindBuffer(gl.ARRAY_BUFFER, gl.createBuffer());
    gl.bufferData(gl.ARRAY_BUFFER, rows, gl.STATIC_DRAW);
    for (const [name, size, offset] of [
      ["arm", 2, 0],
      ["block", 1, 8],
    ]) {
      const at = gl.getAttribLocation(this.program, name);
      gl.enableVertexAttribArray(at);
      gl.vertexAttribPointer(at, size, gl.FLOAT, false, 12, offset);
    }
    this.faces = gl.createBuffer();
    gl.bindBuffer(gl.ELEMENT_ARRAY_BUFFER, this.faces);
    gl.bufferData(gl.ELEMENT_ARRAY_BUFFER, new Uint32Array(faces), gl.STATIC_DRAW);
    this.edges = gl.createBuffer();
    gl.bindBuffer(gl.ELEMENT_ARRAY_BUFFER, this.edges);
    gl.bufferData(gl.ELEMENT_ARRAY_BUFFER, edges, gl.STATIC_DRAW);
  }

  /** Draw the blocks of a frame; see CanvasDrawing.draw. */
  draw(view, frame, colours, theme) {
    const { gl, run } = this;
    this.send(frame, colours);
    gl.viewport(0, 0, gl.canvas.width, gl.canvas.height);
    gl.clearColor(...parts(theme.paper), 1);
    gl.clear(gl.COLOR_BUFFER_BIT);
    gl.useProgram(this.program);
    gl.bindVertexArray(this.arrays);
    gl.uniform1i(this.place.maps, 0);
    gl.uniform1i(this.place.colours, 1);
    gl.uniform2f(this.place.centre, view.x, view.y);
    gl.uniform2f(this.place.scale, (2 * view.scale) / view.width, (2 * view.scale) / view.height);
    gl.uniform4f(this.place.line, 0, 0, 0, 0);
    gl.bindBuffer(gl.ELEMENT_ARRAY_BUFFER, this.faces);
    gl.drawElements(gl.TRIANGLES, this.faceCount, gl.UNSIGNED_INT, 0);
    gl.enable(gl.BLEND);
    gl.blendFunc(gl.ONE, gl.ONE_MINUS_SRC_ALPHA);
    const size = Math.sqrt(run.area.reduce((sum, one) => sum + one, 0) / run.blockCount);
    gl.uniform4f(this.place.line, ...parts(theme.line), Math.max(0.12, Math.min(1, 0.03 * size * view.scale)));
    gl.bindBuffer(gl.ELEMENT_ARRAY_BUFFER, this.edges);
    gl.drawElements(gl.LINES, this.edgeCount, gl.UNSIGNED_INT, 0);
    gl.disable(gl.BLEND);
  }

  /** Send the maps and colours of a frame to the card. */
  send(frame, colours) {
    const { gl, run, maps } = this;
    const map = new Float32Array(6);
    const known = new Map();
    for (let block = 0; block < run.blockCount; block++) {
      run.mapOf(frame, block, map);
      maps.set(map, 8 * block);
      let own = known.get(colours[block]);
      if (!own) known.set(colours[block], (own = parts(colours[block]).map((one) => 255 * one)));
      this.colours.set(own, 4 * block);
      this.colours[4 * block + 3] = run.isGone(frame, block) ? 0 : 255;
    }
    gl.activeTexture(gl.TEXTURE0);
    gl.bindTexture(gl.TEXTURE_2D, this.textures[0]);
    gl.texImage2D(gl.TEXTURE_2D, 0, gl.RGBA32F, 2 * this.wide, this.tall, 0, gl.RGBA, gl.FLOAT, maps);
    gl.activeTexture(gl.TEXTURE1);
    gl.bindTexture(gl.TEXTURE_2D, this.textures[1]);
    gl.texImage2D(
      gl.TEXTURE_2D, 0, gl.RGBA, this.wide, this.tall, 0, gl.RGBA, gl.UNSIGNED_BYTE, this.colours,
    );
  }
}

/** Return red, green and blue, 0 to 1, of a colour such as #e0c9a0. */
function parts(colour) {
  return [1, 3, 5].map((k) => parseInt(colour.slice(k, k + 2), 16) / 255);
}
