"use strict";
// Shows the scene in #data: orthographic, one draw call for each run of faces of one colour, picking by drawing
// numbers instead of colours.

const scene = JSON.parse(document.getElementById("data").textContent);
const canvas = document.getElementById("canvas");
const gl = canvas.getContext("webgl", { antialias: true, preserveDrawingBuffer: true });

const PLAIN = [0.72, 0.74, 0.77];
const INSIDE = [0.75, 0.1, 0.6]; // The inner side of a solid is never seen, unless a face is turned or missing.
const CHOSEN = [1, 0.55, 0.05];
const EDGE_REACH = 3; // Pixels around the pointer in which an edge is preferred to the face below.

// ---- Data -------------------------------------------------------------------------------------------------

function floats(text) {
  const bytes = Uint8Array.from(atob(text), (letter) => letter.charCodeAt(0));
  return new Float32Array(bytes.buffer);
}

function parseColour(text) {
  return [1, 3, 5].map((at) => parseInt(text.slice(at, at + 2), 16) / 255);
}

function buffer(numbers) {
  const made = gl.createBuffer();
  gl.bindBuffer(gl.ARRAY_BUFFER, made);
  gl.bufferData(gl.ARRAY_BUFFER, numbers, gl.STATIC_DRAW);
  return made;
}

// Numbers of the faces (or edges) of a body, repeated for each vertex: what picking draws.
function numbered(items, perItem) {
  const total = items.reduce((sum, item) => sum + item.count * perItem, 0);
  const numbers = new Float32Array(total);
  let at = 0;
  items.forEach((item, index) => {
    item.first = at;
    numbers.fill(index, at, at + item.count * perItem);
    at += item.count * perItem;
  });
  return numbers;
}

for (const body of scene.bodies) {
  body.points = floats(body.positions);
  body.ends = floats(body.segments);
  if (!gl) continue;
  body.position = buffer(body.points);
  body.normal = buffer(floats(body.normals));
  body.number = buffer(numbered(body.faces, 3));
  body.value = body.values && buffer(floats(body.values));
  body.segment = buffer(body.ends);
  body.edgeNumber = buffer(numbered(body.edges, 2));
}

let numbers = 1; // 0 is the background.
for (const placed of scene.placed) {
  const body = scene.bodies[placed.body];
  const m = placed.matrix;
  placed.model = [m[0], m[1], m[2], 0, m[3], m[4], m[5], 0, m[6], m[7], m[8], 0, m[9], m[10], m[11], 1];
  const determinant = m[0] * (m[4] * m[8] - m[5] * m[7]) - m[3] * (m[1] * m[8] - m[2] * m[7])
    + m[6] * (m[1] * m[5] - m[2] * m[4]);
  placed.mirrored = determinant < 0;
  placed.shown = true;
  placed.base = numbers;
  numbers += body.faces.length + body.edges.length;
  placed.runs = runs(body, placed);
}

// Consecutive faces of one look, drawn at once.
function runs(body, placed) {
  const found = [];
  body.faces.forEach((face, index) => {
    if (face.hidden) return;
    const colour = placed.colours[index];
    const last = found[found.length - 1];
    if (last && last.colour === colour && last.alpha === face.alpha && last.first + last.count === face.first) {
      last.count += face.count * 3;
    } else {
      found.push({ colour, alpha: face.alpha, first: face.first, count: face.count * 3 });
    }
  });
  for (const run of found) run.rgb = run.colour === null ? PLAIN : parseColour(scene.colours[run.colour]);
  return found;
}

// ---- Drawing ----------------------------------------------------------------------------------------------

const VERTEX = `
attribute vec3 position; attribute vec3 normal; attribute float number; attribute float value;
uniform mat4 model; uniform mat4 view; uniform float pull;
varying vec3 facing; varying float item; varying float heat;
void main() {
  heat = value;
  facing = mat3(view) * (mat3(model) * normal);
  item = number;
  gl_Position = view * (model * vec4(position, 1.0));
  gl_Position.z -= pull;
}`;
const SHADE = `
precision mediump float;
uniform vec4 colour; uniform vec3 inside; uniform bool solid; uniform bool flatly; uniform vec3 stretch;
uniform float most; // The number of the full colour; 0 to show the faces' own colours.
varying vec3 facing; varying float heat;
vec3 scale(float part) {
  vec3 none = vec3(0.83, 0.84, 0.86), some = vec3(0.98, 0.85, 0.30), all = vec3(0.78, 0.10, 0.12);
  return part < 0.5 ? mix(none, some, 2.0 * part) : mix(some, all, 2.0 * part - 1.0);
}
void main() {
  if (flatly) { gl_FragColor = colour; return; }
  float light = abs(dot(normalize(facing / stretch), normalize(vec3(0.3, 0.45, -0.85))));
  vec3 shown = most <= 0.0 ? colour.rgb : heat < 0.0 ? vec3(0.15, 0.60, 0.30) : scale(min(heat / most, 1.0));
  vec3 own = solid && !gl_FrontFacing ? inside : shown;
  gl_FragColor = vec4(own * (0.35 + 0.65 * light), colour.a);
}`;
const NUMBER = `
precision highp float;
uniform float base; varying float item;
void main() {
  float n = base + floor(item + 0.5);
  gl_FragColor = vec4(mod(n, 256.0), mod(floor(n / 256.0), 256.0), mod(floor(n / 65536.0), 256.0), 255.0) / 255.0;
}`;

function program(fragment) {
  const made = gl.createProgram();
  for (const [kind, source] of [[gl.VERTEX_SHADER, VERTEX], [gl.FRAGMENT_SHADER, fragment]]) {
    const shader = gl.createShader(kind);
    gl.shaderSource(shader, source);
    gl.compileShader(shader);
    if (!gl.getShaderParameter(shader, gl.COMPILE_STATUS)) throw new Error(gl.getShaderInfoLog(shader));
    gl.attachShader(made, shader);
  }
  ["position", "normal", "number", "value"].forEach((name, at) => gl.bindAttribLocation(made, at, name));
  gl.linkProgram(made);
  const at = {};
  for (const name of ["model", "view", "pull", "colour", "inside", "solid", "flatly", "stretch", "base", "most"]) {
    at[name] = gl.getUniformLocation(made, name);
  }
  return { made, at };
}

const shading = gl && program(SHADE);
const numbering = gl && program(NUMBER);

function attribute(at, data, size) {
  gl.bindBuffer(gl.ARRAY_BUFFER, data);
  gl.enableVertexAttribArray(at);
  gl.vertexAttribPointer(at, size, gl.FLOAT, false, 0, 0);
}

function bindFaces(body) {
  attribute(0, body.position, 3);
  attribute(1, body.normal, 3);
  attribute(2, body.number, 1);
  if (body.value) attribute(3, body.value, 1);
  else gl.disableVertexAttribArray(3);
}

function bindEdges(body) {
  attribute(0, body.segment, 3);
  gl.disableVertexAttribArray(1);
  attribute(2, body.edgeNumber, 1);
  gl.disableVertexAttribArray(3);
}

// The camera looks along its third axis at a point, and sees so many units from the middle to the upper end.
const camera = { axes: [[1, 0, 0], [0, 1, 0], [0, 0, 1]], target: [0, 0, 0], half: 1, depth: 1 };
let showEdges = true;
let showValues = Boolean(scene.legend);
let chosen = null;

function size() {
  const ratio = window.devicePixelRatio || 1;
  const [width, height] = [Math.round(canvas.clientWidth * ratio), Math.round(canvas.clientHeight * ratio)];
  if (canvas.width !== width || canvas.height !== height) [canvas.width, canvas.height] = [width, height];
  return width / Math.max(height, 1);
}

const dot = (a, b) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
const cross = (a, b) => [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
const unit = (a) => a.map((part) => part / Math.hypot(...a));

function viewMatrix() {
  const aspect = size();
  const [right, up, ahead] = camera.axes;
  const stretch = [1 / (camera.half * aspect), 1 / camera.half, 1 / camera.depth];
  const rows = [right, up, ahead].map((axis, at) => axis.map((part) => part * stretch[at]));
  const shift = rows.map((row) => -dot(row, camera.target));
  const matrix = [];
  for (let k = 0; k < 3; k++) matrix.push(rows[0][k], rows[1][k], rows[2][k], 0);
  matrix.push(...shift, 1);
  return { matrix, stretch };
}

function begin(used) {
  const { matrix, stretch } = viewMatrix();
  gl.viewport(0, 0, canvas.width, canvas.height);
  gl.useProgram(used.made);
  gl.uniformMatrix4fv(used.at.view, false, matrix);
  gl.uniform3fv(used.at.stretch, stretch);
  gl.enable(gl.DEPTH_TEST);
  gl.depthFunc(gl.LEQUAL);
}

function drawRuns(used, see) {
  for (const placed of scene.placed) {
    if (!placed.shown) continue;
    const body = scene.bodies[placed.body];
    bindFaces(body);
    gl.uniformMatrix4fv(used.at.model, false, placed.model);
    gl.uniform1i(used.at.solid, body.solid ? 1 : 0);
    gl.frontFace(placed.mirrored ? gl.CW : gl.CCW);
    for (const run of placed.runs) {
      if (see(run)) {
        gl.uniform4f(used.at.colour, ...run.rgb, run.alpha);
        gl.drawArrays(gl.TRIANGLES, run.first, run.count);
      }
    }
  }
}

function draw() {
  begin(shading);
  gl.clearColor(1, 1, 1, 1);
  gl.clear(gl.COLOR_BUFFER_BIT | gl.DEPTH_BUFFER_BIT);
  const at = shading.at;
  gl.uniform3fv(at.inside, INSIDE);
  gl.uniform1i(at.flatly, 0);
  gl.uniform1f(at.pull, 0);
  gl.disable(gl.BLEND);
  gl.uniform1f(at.most, showValues ? scene.legend.most : 0);
  drawRuns(shading, (run) => run.alpha >= 1);
  drawChosenFace(at);
  if (showEdges) drawEdges(at);
  gl.enable(gl.BLEND);
  gl.blendFunc(gl.SRC_ALPHA, gl.ONE_MINUS_SRC_ALPHA);
  gl.depthMask(false);
  gl.uniform1i(at.flatly, 0);
  gl.uniform1f(at.pull, 0);
  drawRuns(shading, (run) => run.alpha < 1);
  gl.depthMask(true);
}

function drawChosenFace(at) {
  if (!chosen || !chosen.face || !chosen.placed.shown) return;
  const { placed, face } = chosen;
  bindFaces(scene.bodies[placed.body]);
  gl.uniformMatrix4fv(at.model, false, placed.model);
  gl.uniform1i(at.solid, 0);
  gl.uniform4f(at.colour, ...CHOSEN, 1);
  gl.uniform1f(at.most, 0);
  gl.uniform1f(at.pull, 0.00005);
  gl.drawArrays(gl.TRIANGLES, face.first, face.count * 3);
  gl.uniform1f(at.pull, 0);
  gl.uniform1f(at.most, showValues ? scene.legend.most : 0);
}

function drawEdges(at) {
  gl.uniform1i(at.flatly, 1);
  gl.uniform1f(at.pull, 0.0008);
  for (const placed of scene.placed) {
    if (!placed.shown) continue;
    const body = scene.bodies[placed.body];
    bindEdges(body);
    gl.uniformMatrix4fv(at.model, false, placed.model);
    gl.uniform4f(at.colour, 0.12, 0.13, 0.15, 1);
    gl.drawArrays(gl.LINES, 0, body.ends.length / 3);
    if (chosen && chosen.edge && chosen.placed === placed) {
      gl.uniform4f(at.colour, ...CHOSEN, 1);
      gl.uniform1f(at.pull, 0.01);
      gl.drawArrays(gl.LINES, chosen.edge.first, chosen.edge.count * 2);
      gl.uniform1f(at.pull, 0.0008);
    }
  }
}

let asked = false;
function redraw() {
  if (asked || !gl) return;
  asked = true;
  requestAnimationFrame(() => { asked = false; draw(); });
}

// ---- Picking ----------------------------------------------------------------------------------------------

function pick(x, y) {
  size();
  begin(numbering);
  gl.disable(gl.BLEND);
  gl.disable(gl.DITHER);
  gl.clearColor(0, 0, 0, 0);
  const target = gl.createFramebuffer(), texture = gl.createTexture(), depth = gl.createRenderbuffer();
  gl.bindTexture(gl.TEXTURE_2D, texture);
  gl.texImage2D(gl.TEXTURE_2D, 0, gl.RGBA, canvas.width, canvas.height, 0, gl.RGBA, gl.UNSIGNED_BYTE, null);
  gl.texParameteri(gl.TEXTURE_2D, gl.TEXTURE_MIN_FILTER, gl.NEAREST);
  gl.bindFramebuffer(gl.FRAMEBUFFER, target);
  gl.framebufferTexture2D(gl.FRAMEBUFFER, gl.COLOR_ATTACHMENT0, gl.TEXTURE_2D, texture, 0);
  gl.bindRenderbuffer(gl.RENDERBUFFER, depth);
  gl.renderbufferStorage(gl.RENDERBUFFER, gl.DEPTH_COMPONENT16, canvas.width, canvas.height);
  gl.framebufferRenderbuffer(gl.FRAMEBUFFER, gl.DEPTH_ATTACHMENT, gl.RENDERBUFFER, depth);
  gl.clear(gl.COLOR_BUFFER_BIT | gl.DEPTH_BUFFER_BIT);
  for (const placed of scene.placed) {
    if (!placed.shown) continue;
    const body = scene.bodies[placed.body];
    gl.uniformMatrix4fv(numbering.at.model, false, placed.model);
    gl.uniform1f(numbering.at.base, placed.base);
    gl.uniform1f(numbering.at.pull, 0);
    bindFaces(body);
    for (const run of placed.runs) gl.drawArrays(gl.TRIANGLES, run.first, run.count);
    if (!showEdges) continue;
    gl.uniform1f(numbering.at.base, placed.base + body.faces.length);
    gl.uniform1f(numbering.at.pull, 0.0008);
    bindEdges(body);
    gl.drawArrays(gl.LINES, 0, body.ends.length / 3);
  }
  const found = nearest(x, y);
  gl.bindFramebuffer(gl.FRAMEBUFFER, null);
  gl.deleteFramebuffer(target);
  gl.deleteTexture(texture);
  gl.deleteRenderbuffer(depth);
  return found;
}

// What is under the pointer: an edge nearby, or else the face.
function nearest(x, y) {
  const ratio = canvas.width / canvas.clientWidth;
  const [column, row] = [Math.round(x * ratio), canvas.height - 1 - Math.round(y * ratio)];
  const width = 2 * EDGE_REACH + 1;
  const pixels = new Uint8Array(4 * width * width);
  gl.readPixels(column - EDGE_REACH, row - EDGE_REACH, width, width, gl.RGBA, gl.UNSIGNED_BYTE, pixels);
  let best = null, distance = Infinity;
  for (let at = 0; at < width * width; at++) {
    const item = itemOf(pixels[4 * at] + 256 * pixels[4 * at + 1] + 65536 * pixels[4 * at + 2]);
    const far = Math.hypot((at % width) - EDGE_REACH, Math.floor(at / width) - EDGE_REACH);
    if (item && item.edge && far <= EDGE_REACH && far < distance) [best, distance] = [item, far];
  }
  const middle = 4 * (EDGE_REACH * width + EDGE_REACH);
  return best || itemOf(pixels[middle] + 256 * pixels[middle + 1] + 65536 * pixels[middle + 2]);
}

function itemOf(number) {
  if (number === 0) return null;
  const placed = scene.placed.find((other) => {
    const body = scene.bodies[other.body];
    return number >= other.base && number < other.base + body.faces.length + body.edges.length;
  });
  if (!placed) return null;
  const body = scene.bodies[placed.body], index = number - placed.base;
  if (index < body.faces.length) return { placed, body, face: body.faces[index], index };
  return { placed, body, edge: body.edges[index - body.faces.length] };
}

// ---- What is told of it -----------------------------------------------------------------------------------

function element(name, text, parent) {
  const made = document.createElement(name);
  if (text !== undefined) made.textContent = text;
  if (parent) parent.append(made);
  return made;
}

const short = (number) => Number(number.toPrecision(6)).toString();

function path(placed) {
  const names = [];
  for (let at = placed.node; at !== null && at !== undefined; at = scene.nodes[at].parent) {
    names.unshift(scene.nodes[at].name || scene.nodes[at].id);
  }
  return names.join(" / ");
}

function facts(item) {
  const { placed, body, face, edge, index } = item;
  const rows = face
    ? [["Face", face.id], ["Name", face.name], ["Surface", face.kind],
       ["Area", `${short(face.area)} ${body.unit}² (of its triangles)`],
       ["Colour", placed.colours[index] === null ? "" : scene.colours[placed.colours[index]]],
       ["Transparency", face.alpha < 1 ? short(1 - face.alpha) : ""], ["Layers", face.layers],
       ...face.notes.slice(0, 12).map((note) => ["Note", note])]
    : [["Edge", edge.id], ["Curve", edge.kind], ["Length", `${short(edge.length)} ${body.unit} (of its segments)`],
       ["Faces", edge.faces]];
  rows.push(["Body", `${body.id} ${body.name}`], ["Product", path(placed)]);
  return rows.filter(([, text]) => text !== "");
}

function show(item) {
  chosen = item;
  const section = document.getElementById("picked");
  section.replaceChildren();
  if (!item) {
    element("p", "Click a face or an edge.", section).className = "quiet";
    return redraw();
  }
  const list = element("dl", undefined, section);
  for (const [name, text] of facts(item)) {
    element("dt", name, list);
    const value = element("dd", undefined, list);
    if (name === "Colour") {
      const swatch = element("span", undefined, value);
      swatch.className = "swatch";
      swatch.style.background = text;
    }
    value.append(text);
  }
  const selector = item.face ? item.face.selector : `"${item.edge.id}"`;
  const code = element("code", selector, section);
  code.id = "selector";
  element("span", " ", section);
  const button = element("button", "Copy selector", section);
  button.onclick = () => copy(selector, code, button);
  redraw();
}

// Pages from the file system may not use the clipboard everywhere: then the text is selected.
function copy(text, code, button) {
  const select = () => getSelection().selectAllChildren(code);
  if (!navigator.clipboard) return select();
  navigator.clipboard.writeText(text).then(() => { button.textContent = "Copied"; }, select);
}

// ---- Camera and controls ----------------------------------------------------------------------------------

function extents() {
  const [low, high] = [[Infinity, Infinity, Infinity], [-Infinity, -Infinity, -Infinity]];
  for (const placed of scene.placed) {
    if (!placed.shown) continue;
    const body = scene.bodies[placed.body], m = placed.matrix;
    for (const points of [body.points, body.ends]) {
      for (let at = 0; at < points.length; at += 3) {
        const [x, y, z] = [points[at], points[at + 1], points[at + 2]];
        for (let k = 0; k < 3; k++) {
          const part = m[k] * x + m[3 + k] * y + m[6 + k] * z + m[9 + k];
          if (part < low[k]) low[k] = part;
          if (part > high[k]) high[k] = part;
        }
      }
    }
  }
  return low[0] <= high[0] ? [low, high] : [[-1, -1, -1], [1, 1, 1]];
}

function fit() {
  const [low, high] = extents();
  camera.target = low.map((part, k) => (part + high[k]) / 2);
  const radius = Math.hypot(...low.map((part, k) => high[k] - part)) / 2 || 1;
  const aspect = size();
  const reach = (axis) => axis.reduce((sum, part, k) => sum + Math.abs(part) * (high[k] - low[k]) / 2, 0);
  camera.half = 1.08 * Math.max(reach(camera.axes[1]), reach(camera.axes[0]) / aspect, radius * 1e-6);
  camera.depth = 1.2 * radius;
  redraw();
}

// Directions to look along, with what is up.
const VIEWS = {
  Isometric: [[-1, 1, -0.8], [0, 0, 1]], Front: [[0, 1, 0], [0, 0, 1]], Back: [[0, -1, 0], [0, 0, 1]],
  Left: [[1, 0, 0], [0, 0, 1]], Right: [[-1, 0, 0], [0, 0, 1]], Top: [[0, 0, -1], [0, 1, 0]],
  Bottom: [[0, 0, 1], [0, -1, 0]],
};

function look(ahead, upward) {
  const forward = unit(ahead);
  const right = unit(cross(forward, upward));
  camera.axes = [right, cross(right, forward), forward];
  fit();
}

function turn(across, down) {
  const [right, up, ahead] = camera.axes;
  const rotate = (a, b, angle) => {
    const [c, s] = [Math.cos(angle), Math.sin(angle)];
    return [a.map((part, k) => c * part + s * b[k]), b.map((part, k) => c * part - s * a[k])];
  };
  let [r, f] = rotate(right, ahead, across);
  const [u, g] = rotate(up, f, -down);
  r = unit(cross(g, u));
  camera.axes = [r, cross(r, g), unit(g)];
  redraw();
}

function pan(across, down) {
  const step = 2 * camera.half / canvas.clientHeight;
  const [right, up] = camera.axes;
  camera.target = camera.target.map((part, k) => part - step * (across * right[k] - down * up[k]));
  redraw();
}

let drag = null;
canvas.addEventListener("pointerdown", (event) => {
  drag = { x: event.clientX, y: event.clientY, moved: 0, pan: event.button !== 0 || event.shiftKey };
  canvas.setPointerCapture(event.pointerId);
});
canvas.addEventListener("pointermove", (event) => {
  if (!drag) return;
  const [across, down] = [event.clientX - drag.x, event.clientY - drag.y];
  [drag.x, drag.y, drag.moved] = [event.clientX, event.clientY, drag.moved + Math.abs(across) + Math.abs(down)];
  if (drag.pan) pan(across, down); else turn(across * 0.008, down * 0.008);
});
canvas.addEventListener("pointerup", (event) => {
  if (drag && drag.moved < 4 && !drag.pan) {
    const frame = canvas.getBoundingClientRect();
    show(pick(event.clientX - frame.left, event.clientY - frame.top));
  }
  drag = null;
});
canvas.addEventListener("contextmenu", (event) => event.preventDefault());
canvas.addEventListener("wheel", (event) => {
  event.preventDefault();
  camera.half *= Math.exp(event.deltaY * 0.001);
  redraw();
}, { passive: false });
addEventListener("keydown", (event) => { if (event.key === "f") fit(); });
addEventListener("resize", redraw);

function controls() {
  const bar = document.getElementById("views");
  element("button", "Fit", bar).onclick = fit;
  for (const [name, [ahead, upward]] of Object.entries(VIEWS)) {
    element("button", name, bar).onclick = () => look(ahead, upward);
  }
  element("button", "Edges", bar).onclick = () => { showEdges = !showEdges; redraw(); };
  if (scene.legend) legend(bar);
}

// What the colours mean, and the lines about the whole.
function legend(bar) {
  element("button", "Colours", bar).onclick = () => { showValues = !showValues; redraw(); };
  const box = document.createElement("section");
  box.id = "legend";
  bar.after(box);
  element("div", scene.legend.label, box);
  element("div", undefined, box).className = "heat";
  const ends = element("div", undefined, box);
  ends.className = "ends";
  element("span", "0", ends);
  element("span", short(scene.legend.most), ends);
  for (const line of scene.legend.lines) element("div", line, box).className = "line";
}

// A node hides what is below it; a body hides itself.
function tree() {
  const root = document.getElementById("tree");
  const boxes = [], below = scene.nodes.map(() => []);
  const depth = [];
  const line = (text, level) => {
    const label = element("label", undefined, root);
    label.style.paddingLeft = `${level}em`;
    const box = element("input", undefined, label);
    box.type = "checkbox";
    box.checked = true;
    label.append(` ${text}`);
    return box;
  };
  const set = (at, shown) => {
    const ahead = [at];
    while (ahead.length) {
      const node = ahead.pop();
      boxes[node].checked = shown;
      ahead.push(...below[node]);
      scene.placed.forEach((placed) => { if (placed.node === node) showBody(placed, shown); });
    }
    redraw();
  };
  const showBody = (placed, shown) => {
    placed.shown = shown;
    placed.box.checked = shown;
  };
  const addBody = (placed, level) => {
    const body = scene.bodies[placed.body];
    placed.box = line(`${body.id} ${body.name}`, level);
    placed.box.onchange = () => { showBody(placed, placed.box.checked); redraw(); };
  };
  const ofNode = scene.nodes.map(() => []), full = scene.nodes.map(() => false);
  scene.placed.forEach((placed) => {
    if (placed.node === null) return;
    ofNode[placed.node].push(placed);
    for (let at = placed.node; at !== null && !full[at]; at = scene.nodes[at].parent) full[at] = true;
  });
  scene.nodes.forEach((node, at) => {
    if (!full[at]) return; // Nothing of it is shown: a material, or a part in another file.
    depth[at] = node.parent === null ? 0 : depth[node.parent] + 1;
    if (node.parent !== null) below[node.parent].push(at);
    boxes[at] = line(node.name || node.id, depth[at]);
    boxes[at].onchange = () => set(at, boxes[at].checked);
    ofNode[at].forEach((placed) => addBody(placed, depth[at] + 1));
  });
  scene.placed.filter((placed) => placed.node === null).forEach((placed) => addBody(placed, 0));
}

document.getElementById("title").textContent = scene.title;
controls();
tree();
if (gl) look(...VIEWS.Isometric);
else element("p", "This browser shows no WebGL.", document.getElementById("picked"));
