// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
// Plays the evolution in the report page.  Needs THREE, inlined before it.
async function inflate(text) {
  const binary = atob(text);
  const bytes = new Uint8Array(binary.length);
  for (let i = 0; i < bytes.length; ++i) bytes[i] = binary.charCodeAt(i);
  const stream = new Blob([bytes]).stream().pipeThrough(new DecompressionStream('deflate'));
  return new Uint8Array(await new Response(stream).arrayBuffer());
}

// The inverse of packIntegers in Encoding.cpp.
async function unpackIntegers(packed) {
  const bytes = await inflate(packed.d);
  const values = new Int32Array(packed.n);
  for (let p = 0; p < packed.p; ++p) {
    const offset = p * packed.n;
    for (let i = 0; i < packed.n; ++i) values[i] |= bytes[offset + i] << (8 * p);
  }
  for (let i = 0; i < packed.n; ++i) values[i] = (values[i] >>> 1) ^ -(values[i] & 1);
  if (packed.s > 0) for (let i = packed.s; i < packed.n; ++i) values[i] += values[i - packed.s];
  return values;
}
(function () {
  'use strict';
  // On a phone figures are folded, but for the slices to step through.
  if (window.matchMedia('(max-width: 600px)').matches) {
    for (const details of document.querySelectorAll('figure > details[open]')) {
      details.open = details.querySelector('#cuts') !== null;
    }
  }
  // A link into what is folded unfolds it.
  const unfold = () => {
    const place = location.hash.length > 1 && document.getElementById(decodeURIComponent(location.hash.slice(1)));
    if (!place) return;
    for (const inside of place.querySelectorAll(':scope > details')) inside.open = true;
    for (let fold = place.closest('details'); fold; fold = fold.parentElement.closest('details')) fold.open = true;
    place.scrollIntoView();
  };
  window.addEventListener('hashchange', unfold);
  unfold();
  window.addEventListener('beforeprint', () => { for (const fold of document.querySelectorAll('figure > details')) fold.open = true; });
  for (const box of document.querySelectorAll('input.outlines')) {
    box.addEventListener('change', () => box.closest('figure').classList.toggle('no-outlines', !box.checked));
  }
  // Two images of the same slices: one or the other, or both in turn.
  const flickerMilliseconds = 600;
  for (const states of document.querySelectorAll('.states')) {
    const box = states.querySelector('.to-other'), button = states.querySelector('.flicker');
    const figure = states.closest('figure');
    const show = () => figure.classList.toggle('show-other', box.checked);
    let timer = null;
    const stop = () => { clearInterval(timer); timer = null; button.setAttribute('aria-pressed', 'false'); };
    box.addEventListener('change', () => { stop(); show(); });
    button.addEventListener('click', () => {
      if (timer !== null) { stop(); return; }
      button.setAttribute('aria-pressed', 'true');
      timer = setInterval(() => { box.checked = !box.checked; show(); }, flickerMilliseconds);
    });
  }
})();
// A hemisphere or patch of the page, unpacked once: its faces, its shapes in millimetres, its maps.
const parts = new Map();
function partOf(source) {
  if (!parts.has(source)) parts.set(source, unpackPart(source));
  return parts.get(source);
}
async function unpackPart(source) {
  const data = JSON.parse(source.textContent);
  const start = await unpackIntegers(data.positions);
  const given = await unpackIntegers(data.faces);
  const region = await unpackIntegers(data.region);
  const count = start.length / 3;
  const inRegion = new Uint8Array(count);
  for (const v of region) inRegion[v] = 1;
  // A face that is not of the region has its last corner outside: it is painted by that corner.
  const faces = given.slice();
  const partFaces = [];
  for (let f = 0; f < faces.length; f += 3) {
    const k = [0, 1, 2].find((i) => !inRegion[given[f + i]]);
    if (k === undefined) partFaces.push(given[f], given[f + 1], given[f + 2]);
    else for (let i = 0; i < 3; ++i) faces[f + i] = given[f + (k + 1 + i) % 3];
  }
  const inMillimetres = (steps) => Float32Array.from(steps, (s, i) => data.low[i % 3] + data.unit * s);
  const shapes = [];
  for (const shape of data.shapes) {
    const shift = await unpackIntegers(shape.shift);
    for (let i = 0; i < shift.length; ++i) shift[i] += start[i];
    shapes.push({ name: shape.name, at: inMillimetres(shift.length > 0 ? shift : start) });
  }
  const base = Math.max(0, data.shapes.findIndex((shape) => shape.shift.n === 0));
  if (shapes.length === 0) shapes.push({ name: '', at: inMillimetres(start) });
  const moved = await unpackIntegers(data.moved);
  const frames = [];
  let before = new Int32Array(moved.length * 3);
  for (let m = 0; m < moved.length; ++m) for (let c = 0; c < 3; ++c) before[3 * m + c] = start[3 * moved[m] + c];
  for (const packed of data.frames) {
    before = (await unpackIntegers(packed)).map((change, i) => change + before[i]);
    frames.push(before);
  }
  const bytesOf = (text) => Uint8Array.from(atob(text), (c) => c.charCodeAt(0));
  const maps = [], labels = [];
  for (const map of data.maps) maps.push({ ...map, values: await unpackIntegers(map.values), colours: bytesOf(map.colours) });
  for (const map of data.labels) labels.push({ ...map, entries: await unpackIntegers(map.entries), colours: bytesOf(map.colours) });
  const isWhole = region.length > 0 && partFaces.length === faces.length;
  return { title: source.dataset.title, data, count, faces, partFaces, region, inRegion, isWhole, shapes, base, moved, frames,
           titles: data.titles, maps, labels, openness: await unpackIntegers(data.openness), viewpoint: data.viewpoint };
}
function boxOf(at, filter = () => true) {
  const low = [Infinity, Infinity, Infinity], high = [-Infinity, -Infinity, -Infinity];
  for (let i = 0; i < at.length; ++i) {
    if (!filter(Math.floor(i / 3))) continue;
    low[i % 3] = Math.min(low[i % 3], at[i]);
    high[i % 3] = Math.max(high[i % 3], at[i]);
  }
  return { low, high, middle: low.map((x, c) => 0.5 * (x + high[c])), size: Math.hypot(...low.map((x, c) => high[c] - x)) };
}
const joined = (boxes) => boxOf(boxes.flatMap((box) => [...box.low, ...box.high]));
// Of all vertices, or of those of a mask in the normals given, from all faces about them.
function normalsOf(at, faces, normals = new Float32Array(at.length), mask = null) {
  if (mask) for (let v = 0; v < mask.length; ++v) if (mask[v]) normals.fill(0, 3 * v, 3 * v + 3);
  for (let f = 0; f < faces.length; f += 3) {
    const a = 3 * faces[f], b = 3 * faces[f + 1], c = 3 * faces[f + 2];
    const ux = at[b] - at[a], uy = at[b + 1] - at[a + 1], uz = at[b + 2] - at[a + 2];
    const vx = at[c] - at[a], vy = at[c + 1] - at[a + 1], vz = at[c + 2] - at[a + 2];
    const nx = uy * vz - uz * vy, ny = uz * vx - ux * vz, nz = ux * vy - uy * vx;
    for (const v of [a, b, c]) {
      if (mask && !mask[v / 3]) continue;
      normals[v] += nx; normals[v + 1] += ny; normals[v + 2] += nz;
    }
  }
  for (let v = 0; v < normals.length; v += 3) {
    if (mask && !mask[v / 3]) continue;
    const length = Math.hypot(normals[v], normals[v + 1], normals[v + 2]) || 1;
    for (let c = 0; c < 3; ++c) normals[v + c] /= length;
  }
  return normals;
}
// Fewer faces of the same vertices: each vertex joins a neighbour that stands for those about it.
function fewer(faces, count) {
  const leader = new Int32Array(count).fill(-1), kept = [];
  for (let f = 0; f < faces.length; f += 3) {
    const corners = [faces[f], faces[f + 1], faces[f + 2]];
    const own = corners.find((v) => leader[v] === v) ?? (corners.every((v) => leader[v] < 0) ? corners[0] : undefined);
    if (own !== undefined) for (const v of corners) if (leader[v] < 0) leader[v] = own;
  }
  for (let f = 0; f < faces.length; f += 3) {
    const [a, b, c] = [0, 1, 2].map((k) => (leader[faces[f + k]] < 0 ? faces[f + k] : leader[faces[f + k]]));
    if (a !== b && b !== c && c !== a) kept.push(a, b, c);
  }
  return Uint32Array.from(kept);
}
const openShapes = ['inflated', 'sphere', 'flat'];
// Shapes that are no anatomy get a place of their own: a sphere has the area of the first shape, the flat map is that
// sphere's equal-area projection (Lambert's, azimuthal) about the side away from the other hemisphere, and hemispheres
// are moved apart.
function placeShapes(scene) {
  for (const part of scene) {
    const sphere = part.shapes.find((shape) => shape.name === 'sphere');
    if (!sphere) continue;
    let area = 0;
    const at = part.shapes[0].at;
    for (let f = 0; f < part.faces.length; f += 3) {
      const [a, b, c] = [0, 1, 2].map((i) => 3 * part.faces[f + i]);
      const [ux, uy, uz, vx, vy, vz] = [at[b] - at[a], at[b + 1] - at[a + 1], at[b + 2] - at[a + 2],
        at[c] - at[a], at[c + 1] - at[a + 1], at[c + 2] - at[a + 2]];
      area += 0.5 * Math.hypot(uy * vz - uz * vy, uz * vx - ux * vz, ux * vy - uy * vx);
    }
    const radius = Math.sqrt(area / (4 * Math.PI)), middle = boxOf(part.shapes[part.base].at).middle;
    const out = part.title.toLowerCase().includes('right') ? 1 : -1;
    const flat = { name: 'flat', at: new Float32Array(sphere.at.length) };
    part.far = new Uint8Array(part.count);  // of the flat map: beside the point from which all directions lead away
    for (let i = 0; i < sphere.at.length; i += 3) {
      const length = Math.hypot(sphere.at[i], sphere.at[i + 1], sphere.at[i + 2]) || 1;
      const [x, y, z] = [0, 1, 2].map((c) => sphere.at[i + c] / length);
      const stretch = radius * Math.sqrt(2 / Math.max(1e-6, 1 + out * x));
      flat.at.set([out * y * stretch + middle[0], z * stretch + middle[1], middle[2]], i);
      sphere.at.set([x * radius + middle[0], y * radius + middle[1], z * radius + middle[2]], i);
      part.far[i / 3] = out * x < -0.97 ? 1 : 0;
    }
    part.shapes.push(flat);
    part.flatFaces = [];
    for (let f = 0; f < part.faces.length; f += 3) {
      const corners = [0, 1, 2].map((i) => part.faces[f + i]);
      if (!corners.some((v) => part.far[v])) part.flatFaces.push(...corners);
    }
  }
  if (scene.length !== 2) return;
  const [left, right] = boxOf(scene[0].shapes[0].at).middle[0] < boxOf(scene[1].shapes[0].at).middle[0] ? scene : [scene[1], scene[0]];
  left.shapes.forEach((shape, n) => {
    const other = right.shapes[n];
    if (!openShapes.includes(shape.name) || !other) return;
    const gap = 6;  // mm
    const overlap = boxOf(shape.at).high[0] + gap - boxOf(other.at).low[0];
    if (overlap <= 0) return;
    for (let i = 0; i < shape.at.length; i += 3) shape.at[i] -= 0.5 * overlap;
    for (let i = 0; i < other.at.length; i += 3) other.at[i] += 0.5 * overlap;
  });
}
(function () {
  'use strict';
  const sources = [...document.querySelectorAll('script.evolution')];
  if (sources.length === 0) return;
  // Those of one scene are shown together; one without is a scene by itself.
  const scenes = [];
  for (const source of sources) {
    const name = source.dataset.scene || source.dataset.title;
    const known = source.dataset.scene && scenes.find((scene) => scene.name === name);
    if (known) known.sources.push(source); else scenes.push({ name, sources: [source] });
  }
  const fresh = document.getElementById('view3d').cloneNode(true);
  let stop = () => {};
  // Another scene gets elements of its own: nothing of the former listens to them.
  function open(number) {
    stop();
    document.getElementById('view3d').replaceWith(fresh.cloneNode(true));
    const which = document.getElementById('which');
    document.getElementById('which-label').hidden = scenes.length < 2;
    scenes.forEach((scene, n) => which.add(new Option(scene.name || 'surface ' + (n + 1), String(n))));
    which.value = String(number);
    which.addEventListener('change', () => open(Number(which.value)));
    let stopped = false;
    let dispose = () => {};
    stop = () => { stopped = true; dispose(); };
    showScene(scenes[number], () => stopped, (work) => { const before = dispose; dispose = () => { before(); work(); }; });
  }
  open(0);

async function showScene({ sources: ofScene }, isStopped, onStop) {
  const byId = (id) => document.getElementById(id);
  const message = byId('stage-message');
  const canvas = byId('canvas');
  let renderer, scene;
  try {
    const context = canvas.getContext('webgl2', { antialias: true, preserveDrawingBuffer: true });
    if (!context) throw new Error('no WebGL 2');
    renderer = new THREE.WebGLRenderer({ canvas, context });
    onStop(() => renderer.dispose());
    scene = await Promise.all(ofScene.map(partOf));
  } catch (fault) {
    message.textContent = 'This browser cannot show the surface (' + fault.message + '); explica figure draws it.';
    byId('controls').style.display = 'none';
    return;
  }
  if (isStopped()) return;
  if (!scene[0].isPlaced) placeShapes(scene);
  scene[0].isPlaced = true;

  const names = scene[0].shapes.map((shape) => shape.name);
  const hasShapes = names.length > 1;
  const base = scene[0].base;
  const folded = (name) => !openShapes.includes(name);
  const patches = scene.filter((part) => part.region.length > 0 && !part.isWhole);
  const isWhole = scene.length === 1 && scene[0].isWhole;
  // Where there is no patch, nothing speaks of one.
  const shown = (selector, is) => { for (const element of document.querySelectorAll('#view3d ' + selector)) element.style.display = is ? '' : 'none'; };
  shown('.of-part', patches.length > 0);
  shown('.of-shapes', hasShapes);
  shown('.of-sides', scene.length > 1);
  shown('.of-views', hasShapes && !isWhole);
  shown('.of-frames', scene.some((part) => part.frames.length > 1));
  byId('reset').textContent = patches.length > 0 ? 'To the patch' : 'Reset the view';

  // One mesh a part, which the graphics card morphs between two of its shapes.
  const stage = new THREE.Scene();
  stage.background = new THREE.Color(0xeef1f4);
  const uniforms = { share: { value: 0 }, foldedNow: { value: 1 }, byFace: { value: 0 } };
  const material = new THREE.ShaderMaterial({
    side: THREE.DoubleSide, polygonOffset: true, polygonOffsetFactor: 1, polygonOffsetUnits: 1, uniforms,
    vertexShader: 'attribute vec3 next; attribute vec3 nextNormal; attribute vec3 tone; attribute float open; uniform float share;' +
      'varying vec3 vTone; flat varying vec3 fTone; varying float vOpen; varying vec3 vNormal;' +
      'void main() { vTone = tone; fTone = tone; vOpen = open; vNormal = normalMatrix * mix(normal, nextNormal, share);' +
      'gl_Position = projectionMatrix * modelViewMatrix * vec4(mix(position, next, share), 1.0); }',
    fragmentShader: 'uniform float foldedNow; uniform float byFace; varying vec3 vTone; flat varying vec3 fTone; varying float vOpen; varying vec3 vNormal;' +
      'void main() { vec3 n = normalize(vNormal); float inside = gl_FrontFacing ? 0.0 : 1.0; n = gl_FrontFacing ? n : -n;' +
      'float light = 0.18 + 0.47 * max(0.0, dot(n, normalize(vec3(-0.45, 0.45, 1.0)))) + 0.40 * max(0.0, n.z);' +
      'float isOpen = mix(1.0, min(1.0, 1.25 * vOpen), foldedNow);' +
      'float dark = mix(1.0 - 0.9 * (1.0 - isOpen), 0.5, inside);' +
      'vec3 c = mix(vTone, fTone, byFace) * light * dark * mix(vec3(1.0), vec3(0.5, 0.5, 0.75), inside);' +
      'gl_FragColor = vec4(pow(c, vec3(1.0 / 2.2)), 1.0); }'
  });
  const attribute = (values, size) => new THREE.BufferAttribute(values, size);
  for (const part of scene) {
    const geometry = part.geometry = new THREE.BufferGeometry();
    part.at = part.shapes[base].at.slice();  // as frames and shapes have it now
    for (const [name, size] of [['position', 3], ['normal', 3], ['next', 3], ['nextNormal', 3], ['tone', 3], ['open', 1]]) {
      geometry.setAttribute(name, attribute(new Float32Array(size * part.count), size));
    }
    part.index = { all: attribute(Uint32Array.from(part.faces), 1), alone: attribute(Uint32Array.from(part.partFaces), 1),
                   flat: part.flatFaces && attribute(Uint32Array.from(part.flatFaces), 1) };
    part.mesh = new THREE.Mesh(geometry, material);
    part.mesh.frustumCulled = false;
    stage.add(part.mesh);
    // The region's rim: edges of its faces that no other face of it has.
    const moves = new Uint8Array(part.count);
    for (const v of part.moved) moves[v] = 1;
    part.turns = new Uint8Array(part.count);  // its normal changes from frame to frame
    const touched = (mask) => { const found = []; for (let f = 0; f < part.faces.length; f += 3) if (mask[part.faces[f]] || mask[part.faces[f + 1]] || mask[part.faces[f + 2]]) found.push(part.faces[f], part.faces[f + 1], part.faces[f + 2]); return found; };
    for (const v of touched(moves)) part.turns[v] = 1;
    part.turning = touched(part.turns);
    const edges = new Map();
    for (let f = 0; f < part.partFaces.length && !part.isWhole; f += 3) {
      for (let k = 0; k < 3; ++k) {
        const a = part.partFaces[f + k], b = part.partFaces[f + (k + 1) % 3];
        const key = Math.min(a, b) * part.count + Math.max(a, b);
        edges.set(key, (edges.get(key) || 0) + 1);
      }
    }
    part.rimEnds = [];
    for (const [key, times] of edges) if (times === 1) part.rimEnds.push(Math.floor(key / part.count), key % part.count);
    part.rim = new THREE.LineSegments(new THREE.BufferGeometry(), new THREE.LineBasicMaterial({ color: 0x101418 }));
    part.rim.geometry.setAttribute('position', attribute(new Float32Array(3 * part.rimEnds.length), 3));
    part.rim.frustumCulled = false;
    stage.add(part.rim);
  }
  // The place where the slices are, marked on the surface.
  const mark = new THREE.Points(new THREE.BufferGeometry(),
    new THREE.PointsMaterial({ color: 0x00a5cf, size: 11, sizeAttenuation: false, depthTest: false }));
  mark.geometry.setAttribute('position', attribute(new Float32Array(3), 3));
  mark.frustumCulled = false;
  mark.visible = false;
  mark.renderOrder = 1;
  stage.add(mark);
  let marked = null;

  const frameSlider = byId('frame'), shapeSlider = byId('shape'), chooser = byId('map'), alone = byId('alone'), sides = byId('sides');
  const play = byId('play');
  const isShown = (part) => sides.value === 'all' || sides.value === part.title;
  let frame = 0, place = base, playing = null;
  const last = Math.max(0, ...scene.map((part) => part.frames.length - 1));

  const set = (part, name, values) => { part.geometry.attributes[name].array.set(values); part.geometry.attributes[name].needsUpdate = true; };
  const shapeNormals = (part, n) => part.shapes[n].normals || (part.shapes[n].normals = normalsOf(part.shapes[n].at, part.faces));
  // What lines, marks and the pointer follow.
  function follow() {
    const share = uniforms.share.value;
    for (const part of scene) {
      const now = part.geometry.attributes.position.array, next = part.geometry.attributes.next.array;
      for (let i = 0; i < part.at.length; ++i) part.at[i] = now[i] + share * (next[i] - now[i]);
      const rim = part.rim.geometry.attributes.position;
      part.rimEnds.forEach((v, i) => { for (let c = 0; c < 3; ++c) rim.array[3 * i + c] = part.at[3 * v + c]; });
      rim.needsUpdate = true;
      part.mesh.visible = isShown(part);
      part.rim.visible = isShown(part);
    }
    mark.visible = marked !== null && isShown(marked.part);
    if (marked) for (let c = 0; c < 3; ++c) mark.geometry.attributes.position.array[c] = marked.part.at[3 * marked.vertex + c];
    mark.geometry.attributes.position.needsUpdate = true;
  }
  let from = -1;
  function morph(to) {
    place = Math.max(0, Math.min(names.length - 1, to));
    const n = Math.min(Math.floor(place), Math.max(0, names.length - 2)), m = Math.min(n + 1, names.length - 1);
    frame = 0;
    if (from !== n) {
      for (const part of scene) {
        set(part, 'position', part.shapes[n].at);
        set(part, 'normal', shapeNormals(part, n));
        set(part, 'next', part.shapes[m].at);
        set(part, 'nextNormal', shapeNormals(part, m));
        set(part, 'open', Float32Array.from(part.openness, (o) => o / 255));
      }
      from = n;
    }
    uniforms.share.value = place - n;
    uniforms.foldedNow.value = (folded(names[n]) ? 1 - (place - n) : 0) + (folded(names[m]) ? place - n : 0);
    shapeSlider.value = String(place);
    const near = Math.abs(place - Math.round(place)) < 0.02;
    byId('shape-title').textContent = near ? names[Math.round(place)] : names[n] + ' to ' + names[m];
    frameSlider.value = String(frame);
    titleFrames();
    follow();
    if (chooser.value === 'facing') paint(); else draw();
  }
  // Where a patch opens, its surface has the shape from which it does.
  function show(number) {
    if (place !== base) toShape(base); else if (from === -1) morph(base);
    const n = Math.min(base, Math.max(0, names.length - 2));
    if (n !== base) {  // the base is the last shape: it is what is drawn
      for (const part of scene) { set(part, 'position', part.shapes[base].at); set(part, 'normal', shapeNormals(part, base)); }
      uniforms.share.value = 0;
      uniforms.foldedNow.value = 1;
      from = -2;
    }
    frame = Math.max(0, Math.min(last, number));
    for (const part of scene) {
      if (part.frames.length === 0) continue;
      const f = Math.round(frame / Math.max(1, last) * (part.frames.length - 1));
      const share = part.frames.length > 1 ? f / (part.frames.length - 1) : 0;
      const { position, normal, open } = part.geometry.attributes;
      part.moved.forEach((v, m) => {
        for (let c = 0; c < 3; ++c) position.array[3 * v + c] = part.data.low[c] + part.data.unit * part.frames[f][3 * m + c];
        const shade = part.openness[v] / 255;
        open.array[v] = shade + share * (1 - shade);  // what unfolds comes out of the shade
      });
      normalsOf(position.array, part.turning, normal.array, part.turns);
      position.needsUpdate = normal.needsUpdate = open.needsUpdate = true;
    }
    from = frame === 0 ? from : -2;
    frameSlider.value = String(frame);
    titleFrames();
    follow();
    if (chooser.value === 'facing') paint(); else draw();
  }
  function titleFrames() {
    const words = scene.filter((part) => part.frames.length > 1 && isShown(part)).map((part) =>
      (patches.length > 1 ? part.title + ': ' : '') + (part.titles[Math.round(frame / Math.max(1, last) * (part.frames.length - 1))] || ''));
    byId('frame-title').textContent = words.join('; ');
  }

  // The eye turns about `target`: parallel projection, a quaternion for the turn.
  const camera = new THREE.OrthographicCamera(-1, 1, 1, -1, 0.1, 10000);
  const eye = { target: new THREE.Vector3(), turn: new THREE.Quaternion(), half: 100 };
  const whole = joined(scene.map((part) => boxOf(part.shapes[base].at)));
  const boxNow = () => joined(scene.filter(isShown).map((part) => boxOf(part.at)));
  // Half the height of the picture that holds a box as it is turned now.
  function halfFor(box) {
    const back = eye.turn.clone().conjugate();
    let wide = 0, high = 0;
    for (let n = 0; n < 8; ++n) {
      const corner = new THREE.Vector3(...[0, 1, 2].map((c) => (n >> c & 1 ? 0.5 : -0.5) * (box.high[c] - box.low[c]))).applyQuaternion(back);
      wide = Math.max(wide, Math.abs(corner.x));
      high = Math.max(high, Math.abs(corner.y));
    }
    return 1.05 * Math.max(high, wide * canvas.clientHeight / canvas.clientWidth);
  }
  function lookAt(box, direction) {
    eye.target.set(...box.middle);
    const up = Math.abs(direction.clone().normalize().z) > 0.9 ? new THREE.Vector3(0, 1, 0) : new THREE.Vector3(0, 0, 1);
    eye.turn.setFromRotationMatrix(new THREE.Matrix4().lookAt(direction, new THREE.Vector3(), up));
    eye.half = halfFor(box);
    draw();
  }
  const directions = { above: [0, 0, 1], left: [-1, 0, 0], right: [1, 0, 0], front: [0, 1, 0], back: [0, -1, 0], below: [0, 0, -1] };
  function wholeView() {
    const viewpoint = (!hasShapes || isWhole) && scene[0].viewpoint;
    const box = boxNow();
    const direction = viewpoint ? new THREE.Vector3(...viewpoint).sub(new THREE.Vector3(...box.middle))
      : new THREE.Vector3(...directions[hasShapes ? byId('from').value : 'left']);
    lookAt(box, direction);
  }
  let patchAt = -1;
  // The patch from its viewpoint, as large as its box in the first and the last frame; of several the next.
  function resetView() {
    const seen = patches.filter(isShown);
    if (seen.length === 0) { wholeView(); return; }
    patchAt = (patchAt + 1) % seen.length;
    const part = seen[patchAt], filter = (v) => part.inRegion[v] === 1;
    const here = frame;
    const boxes = [0, last].map((f) => { show(f); return boxOf(part.at, filter); });
    show(here);
    const box = joined(boxes);
    const direction = part.viewpoint ? new THREE.Vector3(...part.viewpoint).sub(new THREE.Vector3(...box.middle)) : new THREE.Vector3(-1, 0, 0);
    lookAt(box, direction);
  }
  // Where a picture takes too long, less is drawn while the view moves: `less` times fewer faces, and a quarter of the pixels.
  const longest = 40, mostLess = 3;  // ms
  let pending = false, less = 0, isMoving = false, stands = null;
  function move() {
    clearTimeout(stands);
    isMoving = true;
    draw();
  }
  function indexOf(part) {
    let index = alone.checked && part.partFaces.length > 0 ? part.index.alone
      : part.index.flat && place > names.length - 2 ? part.index.flat : part.index.all;
    for (let n = 0; isMoving && n < less; ++n) index = index.fewer || (index.fewer = attribute(fewer(index.array, part.count), 1));
    return index;
  }
  function draw() {
    if (pending) return;
    pending = true;
    requestAnimationFrame((time) => {
      pending = false;
      const width = canvas.clientWidth, height = canvas.clientHeight;
      const isLess = isMoving && less > 0;
      const ratio = Math.min(window.devicePixelRatio || 1, 2) * (isLess ? 0.5 : 1);
      for (const part of scene) part.geometry.setIndex(indexOf(part));
      if (canvas.width !== Math.round(width * ratio) || canvas.height !== Math.round(height * ratio)) {
        renderer.setPixelRatio(ratio);
        renderer.setSize(width, height, false);
      }
      const aspect = width / height;
      camera.left = -eye.half * aspect; camera.right = eye.half * aspect;
      camera.top = eye.half; camera.bottom = -eye.half;
      camera.quaternion.copy(eye.turn);
      camera.position.set(0, 0, 5 * whole.size).applyQuaternion(eye.turn).add(eye.target);
      camera.far = 10 * whole.size;
      camera.updateProjectionMatrix();
      camera.updateMatrixWorld();
      renderer.render(stage, camera);
      canvas.dataset.drawn = String(Number(canvas.dataset.drawn || 0) + 1);
      canvas.dataset.less = isLess ? String(less) : '';
      if (isMoving) requestAnimationFrame((next) => {
        if (next - time > longest) less = Math.min(less + 1, mostLess);
        clearTimeout(stands);
        stands = setTimeout(() => { isMoving = false; draw(); }, 200);
      });
    });
  }
  function rotate(dx, dy) {
    eye.turn.multiply(new THREE.Quaternion().setFromEuler(new THREE.Euler(-dy, -dx, 0)));
    move();
  }
  function zoom(factor) {
    eye.half = Math.min(Math.max(eye.half * factor, 0.005 * whole.size), 3 * whole.size);
    move();
  }
  function shift(dx, dy) {
    const step = 2 * eye.half / canvas.clientHeight;
    eye.target.add(new THREE.Vector3(-dx * step, dy * step, 0).applyQuaternion(eye.turn));
    move();
  }

  // Maps by their names: one colour bar for all parts.
  const facingMap = { name: 'facing the viewpoint (1 = directly)', unit: '', low: -1, high: 1, colours: new Uint8Array(3 * 256) };
  for (let e = 0; e < 256; ++e) {
    const t = e / 254;
    const mix = (a, b, s) => Math.round(a + (b - a) * s);
    const ends = t < 0.5 ? [[30, 70, 150], [236, 236, 236], 2 * t] : [[236, 236, 236], [150, 75, 10], 2 * t - 1];
    for (let c = 0; c < 3; ++c) facingMap.colours[3 * e + c] = mix(ends[0][c], ends[1][c], Math.min(1, ends[2]));
  }
  const addChoice = (value, text) => chooser.add(new Option(text, value));
  addChoice('none', patches.length > 0 ? 'patch' : 'plain');
  if (patches.length > 0 || !hasShapes) addChoice('facing', facingMap.name);
  const kinds = (kind) => [...new Set(scene.flatMap((part) => part[kind].map((map) => map.name)))];
  const mapNames = kinds('maps'), labelNames = kinds('labels');
  mapNames.forEach((name, m) => addChoice(String(m), name));
  labelNames.forEach((name, m) => addChoice('label' + m, name));
  const mapOf = (part, choice) => part.maps.find((map) => map.name === mapNames[Number(choice)]);
  const labelOf = (part, choice) => part.labels.find((map) => map.name === labelNames[Number(choice.slice(5))]);
  function barOf(choice) {
    const found = scene.map((part) => mapOf(part, choice)).filter(Boolean);
    return { ...found[0], low: Math.min(...found.map((map) => map.low)), high: Math.max(...found.map((map) => map.high)) };
  }
  const valueOf = (map, v) => (map.values[v] > 65534 ? NaN : map.least + map.step * map.values[v]);
  const linear = Float32Array.from({ length: 256 }, (_, byte) => Math.pow(byte / 255, 2.2));
  const plain = [0.60, 0.58, 0.56];
  // Sulci dark and gyri light where the folds are no longer seen.
  function foldTones(part) {
    const folds = part.maps.find((map) => map.name.includes('curvature'));
    return (v) => (folds && hasShapes ? (valueOf(folds, v) > 0 ? [0.30, 0.29, 0.28] : [0.62, 0.60, 0.58]) : plain);
  }
  function paint() {
    const choice = chooser.value, isLabel = choice.startsWith('label');
    uniforms.byFace.value = choice === 'none' || isLabel ? 1 : 0;
    const shownMap = choice === 'none' || isLabel ? null : choice === 'facing' ? facingMap : barOf(choice);
    for (const part of scene) {
      const tone = part.geometry.attributes.tone.array;
      const put = (v, colours, entry) => { for (let c = 0; c < 3; ++c) tone[3 * v + c] = linear[colours[entry + c]]; };
      const map = isLabel ? labelOf(part, choice) : shownMap === facingMap ? facingMap : mapOf(part, choice);
      const folds = foldTones(part);
      if (choice === 'none' || !map) {
        for (let v = 0; v < part.count; ++v) tone.set(part.inRegion[v] && !part.isWhole && choice === 'none' ? [0.80, 0.50, 0.28] : folds(v), 3 * v);
      } else if (isLabel) {
        for (let v = 0; v < part.count; ++v) if (map.entries[v] < 0) tone.set(folds(v), 3 * v); else put(v, map.colours, 3 * map.entries[v]);
      } else if (map === facingMap) {
        // Cosine between the outward normal and the direction to the viewpoint: the flux density now.
        const eyeAt = part.viewpoint || [whole.middle[0] - 1e4, whole.middle[1], whole.middle[2]];
        const normals = part.geometry.attributes.normal.array;
        for (let v = 0; v < part.count; ++v) {
          const [x, y, z] = [0, 1, 2].map((c) => eyeAt[c] - part.at[3 * v + c]);
          const cosine = (x * normals[3 * v] + y * normals[3 * v + 1] + z * normals[3 * v + 2]) / Math.hypot(x, y, z);
          put(v, map.colours, 3 * Math.round(127 * (1 + Math.max(-1, Math.min(1, cosine)))));
        }
      } else {
        for (let v = 0; v < part.count; ++v) {
          const value = valueOf(map, v), share = (value - shownMap.low) / (shownMap.high - shownMap.low);
          if (Number.isNaN(value) && hasShapes) tone.set(folds(v), 3 * v);
          else put(v, map.colours, Number.isNaN(value) ? 3 * 255 : 3 * Math.round(254 * Math.max(0, Math.min(1, share))));
        }
      }
      part.geometry.attributes.tone.needsUpdate = true;
    }
    const bar = byId('bar');
    bar.style.display = shownMap ? 'block' : 'none';
    if (shownMap) {
      byId('bar-title').textContent = shownMap.name + (shownMap.unit ? ' [' + shownMap.unit + ']' : '');
      byId('bar-high').textContent = String(Number(shownMap.high.toPrecision(3)));
      byId('bar-low').textContent = String(Number(shownMap.low.toPrecision(3)));
      const pen = byId('bar-colours').getContext('2d');
      for (let y = 0; y < 128; ++y) {
        const entry = 3 * Math.round(254 * (1 - y / 127));
        pen.fillStyle = 'rgb(' + shownMap.colours.slice(entry, entry + 3).join(',') + ')';
        pen.fillRect(0, y, 14, 1);
      }
    }
    draw();
  }

  function pause() {
    clearInterval(playing);
    playing = null;
    play.textContent = '\u25b6';
  }
  function togglePlay() {
    if (playing !== null) { pause(); return; }
    if (frame >= last) show(0);
    play.textContent = '\u23f8';
    playing = setInterval(() => { if (frame >= last) pause(); else show(frame + 1); }, 100);
  }
  frameSlider.max = String(last);
  shapeSlider.max = String(names.length - 1);
  sides.add(new Option('both', 'all'));
  for (const part of scene) sides.add(new Option(part.title, part.title));
  // A step of the slider that changes how large the whole is keeps it in sight.
  function toShape(to) {
    if (frame !== 0) show(0);
    const before = halfFor(boxNow());
    morph(to);
    const now = boxNow();
    eye.half *= halfFor(now) / before;
    if (!alone.checked) eye.target.set(...now.middle);
    draw();
  }
  frameSlider.addEventListener('input', () => { pause(); show(Number(frameSlider.value)); });
  shapeSlider.addEventListener('input', () => { pause(); toShape(Number(shapeSlider.value)); });
  play.addEventListener('click', togglePlay);
  chooser.addEventListener('change', paint);
  sides.addEventListener('change', () => { titleFrames(); follow(); wholeView(); });
  byId('from').addEventListener('change', wholeView);
  byId('before-after').addEventListener('click', () => { pause(); show(frame === 0 ? last : 0); });
  byId('reset').addEventListener('click', resetView);
  byId('whole').addEventListener('click', wholeView);
  alone.addEventListener('change', () => { follow(); if (alone.checked) resetView(); else wholeView(); });

  // The nearest face under the pointer by the projection of all vertices, and its corner nearest to the pointer.
  const readable = (x) => String(Number(x.toPrecision(3)));
  function wordsAt(part, v) {
    const choice = chooser.value, words = [];
    if (scene.length > 1) words.push(part.title);
    for (const map of part.labels) if (map.entries[v] >= 0) words.push(map.names[map.entries[v]]);
    if (choice === 'none' && patches.length > 0) words.push(part.inRegion[v] ? 'in the patch' : 'outside the patch');
    const map = !choice.startsWith('label') && choice !== 'none' && choice !== 'facing' && mapOf(part, choice);
    if (map) {
      const value = valueOf(map, v);
      words.push(map.name + ': ' + (Number.isNaN(value) ? 'not known' : readable(value) + (map.unit ? ' ' + map.unit : '')));
    }
    return [...new Set(words)].join(', ') + ' (vertex ' + v + ')';
  }
  function under(x, y) {
    const box = canvas.getBoundingClientRect();
    const toX = 2 * (x - box.left) / box.width - 1, toY = 1 - 2 * (y - box.top) / box.height;
    const e = new THREE.Matrix4().multiplyMatrices(camera.projectionMatrix, camera.matrixWorldInverse).elements;
    let found = null, least = Infinity;
    for (const part of scene.filter(isShown)) {
      const px = new Float32Array(part.count), py = new Float32Array(part.count), at = part.at;
      for (let v = 0, i = 0; v < part.count; ++v, i += 3) {
        px[v] = e[0] * at[i] + e[4] * at[i + 1] + e[8] * at[i + 2] + e[12] - toX;
        py[v] = e[1] * at[i] + e[5] * at[i + 1] + e[9] * at[i + 2] + e[13] - toY;
      }
      const faces = part.geometry.index.array;
      for (let f = 0; f < faces.length; f += 3) {
        const a = faces[f], b = faces[f + 1], c = faces[f + 2];
        const s = px[a] * py[b] - px[b] * py[a], t = px[b] * py[c] - px[c] * py[b], u = px[c] * py[a] - px[a] * py[c];
        if ((s < 0 || t < 0 || u < 0) && (s > 0 || t > 0 || u > 0)) continue;
        const sum = s + t + u;
        if (sum === 0) continue;
        let depth = 0;
        for (const [v, share] of [[a, t / sum], [b, u / sum], [c, s / sum]]) {
          depth += share * (e[2] * at[3 * v] + e[6] * at[3 * v + 1] + e[10] * at[3 * v + 2]);
        }
        if (depth >= least) continue;
        least = depth;
        const vertex = [a, b, c].reduce((best, v) => (px[v] ** 2 + py[v] ** 2 < px[best] ** 2 + py[best] ** 2 ? v : best));
        found = { part, vertex };
      }
    }
    return found;
  }
  let asked = false, pointedAt = null;
  function readUnder(x, y) {
    if (asked) return;
    asked = true;
    requestAnimationFrame(() => {
      asked = false;
      pointedAt = under(x, y);
      byId('under-pointer').textContent = pointedAt ? wordsAt(pointedAt.part, pointedAt.vertex) : '';
    });
  }
  const firstPlace = ({ part, vertex }) => [0, 1, 2].map((c) => part.shapes[base].at[3 * vertex + c]);
  function markPlace(event) {
    let least = 15;  // mm; beyond, the slices are off these surfaces
    marked = null;
    for (const part of scene) {
      const at = part.shapes[base].at;
      for (let v = 0; v < part.count; ++v) {
        const far = Math.hypot(at[3 * v] - event.detail.at[0], at[3 * v + 1] - event.detail.at[1], at[3 * v + 2] - event.detail.at[2]);
        if (far < least) { least = far; marked = { part, vertex: v }; }
      }
    }
    follow();
    draw();
  }
  document.addEventListener('place', markPlace);
  const pointers = new Map();
  let wasDragged = false;
  canvas.addEventListener('pointerdown', (event) => {
    canvas.setPointerCapture(event.pointerId);
    pointers.set(event.pointerId, { x: event.clientX, y: event.clientY, button: event.button });
    wasDragged = false;
  });
  canvas.addEventListener('pointermove', (event) => {
    const before = pointers.get(event.pointerId);
    if (!before) { readUnder(event.clientX, event.clientY); return; }
    const dx = event.clientX - before.x, dy = event.clientY - before.y;
    wasDragged = wasDragged || Math.hypot(dx, dy) > 2;
    if (pointers.size === 2) {
      const other = [...pointers.entries()].find(([id]) => id !== event.pointerId)[1];
      const was = Math.hypot(before.x - other.x, before.y - other.y) || 1;
      const is = Math.hypot(event.clientX - other.x, event.clientY - other.y) || 1;
      zoom(was / is);
    } else if (before.button === 2 || event.shiftKey) {
      shift(dx, dy);
    } else {
      rotate(0.008 * dx, 0.008 * dy);
    }
    before.x = event.clientX;
    before.y = event.clientY;
  });
  for (const name of ['pointerup', 'pointercancel']) canvas.addEventListener(name, (event) => pointers.delete(event.pointerId));
  canvas.addEventListener('click', () => {
    if (wasDragged || !pointedAt) return;
    document.dispatchEvent(new CustomEvent('place', { detail: { at: firstPlace(pointedAt), from: 'surface', view: pointedAt.part.title, vertex: pointedAt.vertex } }));
  });
  canvas.addEventListener('contextmenu', (event) => event.preventDefault());
  canvas.addEventListener('wheel', (event) => { event.preventDefault(); zoom(Math.exp(0.001 * event.deltaY)); }, { passive: false });
  canvas.addEventListener('keydown', (event) => {
    const actions = {
      ArrowLeft: () => rotate(-0.1, 0), ArrowRight: () => rotate(0.1, 0), ArrowUp: () => rotate(0, -0.1), ArrowDown: () => rotate(0, 0.1),
      '+': () => zoom(0.9), '=': () => zoom(0.9), '-': () => zoom(1.1), ' ': togglePlay,
      ',': () => { pause(); show(frame - 1); }, '.': () => { pause(); show(frame + 1); },
      '[': () => { pause(); toShape(Math.ceil(place) - 1); }, ']': () => { pause(); toShape(Math.floor(place) + 1); },
      b: () => byId('before-after').click(), r: resetView, w: wholeView
    };
    const action = actions[event.key] || actions[event.key.toLowerCase()];
    if (!action || event.ctrlKey || event.metaKey) return;
    event.preventDefault();
    action();
  });
  window.addEventListener('resize', draw);
  onStop(() => {
    clearInterval(playing);
    window.removeEventListener('resize', draw);
    document.removeEventListener('place', markPlace);
    renderer.forceContextLoss();
  });

  message.textContent = '';
  if (hasShapes && mapNames.length > 0) chooser.value = '0';
  alone.checked = scene.some((part) => part.data.detached);
  show(0);
  paint();
  if (alone.checked) resetView(); else wholeView();
  canvas.dataset.ready = 'true';
}
})();
// Slices through a volume with the surfaces' cut lines, linked with each other and with the view in
// three dimensions by the event "place" (RAS mm) of the document.
(function () {
  'use strict';
  const source = document.getElementById('slice-data');
  if (!source) return;
  const byId = (id) => document.getElementById(id);
  showSlices(JSON.parse(source.textContent));

async function showSlices(data) {
  const [nx, ny] = data.size;
  const grey = Uint8Array.from(await unpackIntegers(data.grey));
  const surfaces = [];
  for (const { part: title, shape: name, colour } of data.surfaces) {
    const source = [...document.querySelectorAll('script.evolution')].find((one) => one.dataset.title === title);
    const part = source && await partOf(source), shape = part && part.shapes.find((one) => one.name === name);
    if (shape) surfaces.push({ faces: part.faces, colour, at: shape.at });
  }
  const side = data.leftOnRight ? -1 : 1;
  // Axes across, up and through, and which way the first goes.
  const views = [[0, 1, 2, side], [0, 2, 1, side], [1, 2, 0, -1]].map(([h, v, n, sign], i) =>
    ({ h, v, n, sign, canvas: byId('cut-' + i), image: document.createElement('canvas'), shown: NaN, lines: [] }));
  const high = data.size.map((size, a) => data.low[a] + data.voxel * (size - 1));
  const middle = data.low.map((low, a) => 0.5 * (low + high[a]));
  const snapped = (at) => at.map((x, a) => data.low[a] + data.voxel *
    Math.min(data.size[a] - 1, Math.max(0, Math.round((x - data.low[a]) / data.voxel))));
  let at = snapped(middle), centre = middle.slice(), zoom = 1;
  const outlines = byId('cut-outlines'), darkest = byId('cut-dark'), brightest = byId('cut-bright');

  // Millimetres to pixels of the screen: of one size in all views.
  const scale = () => zoom * Math.min(...views.map((view) => Math.min(
    view.canvas.width / (data.voxel * data.size[view.h]), view.canvas.height / (data.voxel * data.size[view.v]))));
  function cut(view) {
    const index = at.map((x, a) => Math.round((x - data.low[a]) / data.voxel));
    const width = data.size[view.h], height = data.size[view.v];
    const stride = [1, nx, nx * ny], pen = view.image.getContext('2d');
    view.image.width = width;
    view.image.height = height;
    const pixels = pen.createImageData(width, height);
    const low = Number(darkest.value), range = Math.max(1, Number(brightest.value) - low);
    for (let y = 0; y < height; ++y) {
      for (let x = 0; x < width; ++x) {
        const i = view.sign > 0 ? x : width - 1 - x;
        const value = grey[index[view.n] * stride[view.n] + i * stride[view.h] + (height - 1 - y) * stride[view.v]];
        const shown = 255 * (value - low) / range, to = 4 * (y * width + x);
        pixels.data[to] = pixels.data[to + 1] = pixels.data[to + 2] = shown;
        pixels.data[to + 3] = 255;
      }
    }
    pen.putImageData(pixels, 0, 0);
    if (view.shown === at[view.n]) return;
    view.shown = at[view.n];
    view.lines = surfaces.map((surface) => linesOf(surface, view));
  }
  // Where a surface's faces meet the plane: ends of lines, in millimetres.
  function linesOf(surface, view) {
    const lines = [], p = surface.at, f = surface.faces, plane = view.shown + 1e-4;
    for (let k = 0; k < f.length; k += 3) {
      const a = 3 * f[k], b = 3 * f[k + 1], c = 3 * f[k + 2];
      const x = p[a + view.n] - plane, y = p[b + view.n] - plane, z = p[c + view.n] - plane;
      if ((x >= 0) === (y >= 0) && (y >= 0) === (z >= 0)) continue;
      for (const [i, j, s, t] of [[a, b, x, y], [b, c, y, z], [c, a, z, x]]) {
        if ((s >= 0) === (t >= 0)) continue;
        const share = s / (s - t);
        for (const axis of [view.h, view.v]) lines.push(p[i + axis] + share * (p[j + axis] - p[i + axis]));
      }
    }
    return lines;
  }
  function paint(view) {
    const { canvas, h, v, sign } = view, pen = canvas.getContext('2d');
    const k = scale(), half = 0.5 * data.voxel;
    const toX = (x) => 0.5 * canvas.width + k * sign * (x - centre[h]);
    const toY = (y) => 0.5 * canvas.height - k * (y - centre[v]);
    pen.fillStyle = '#000';
    pen.fillRect(0, 0, canvas.width, canvas.height);
    pen.drawImage(view.image, toX(sign > 0 ? data.low[h] - half : high[h] + half), toY(high[v] + half),
                  k * data.voxel * data.size[h], k * data.voxel * data.size[v]);
    if (outlines.checked) {
      pen.lineWidth = Math.max(1, 1.2 * (window.devicePixelRatio || 1));
      view.lines.forEach((lines, s) => {
        pen.strokeStyle = surfaces[s].colour;
        pen.beginPath();
        for (let i = 0; i < lines.length; i += 4) {
          pen.moveTo(toX(lines[i]), toY(lines[i + 1]));
          pen.lineTo(toX(lines[i + 2]), toY(lines[i + 3]));
        }
        pen.stroke();
      });
    }
    const x = toX(at[h]), y = toY(at[v]), gap = 12 * (window.devicePixelRatio || 1);
    pen.strokeStyle = '#32d7ff';
    pen.lineWidth = 1;
    pen.beginPath();
    for (const [x0, y0, x1, y1] of [[0, y, x - gap, y], [x + gap, y, canvas.width, y], [x, 0, x, y - gap], [x, y + gap, x, canvas.height]]) {
      pen.moveTo(x0, y0);
      pen.lineTo(x1, y1);
    }
    pen.stroke();
  }
  let pending = false;
  function draw() {
    if (pending) return;
    pending = true;
    requestAnimationFrame(() => {
      pending = false;
      for (const { canvas } of views) {
        const ratio = window.devicePixelRatio || 1;
        const width = Math.round(canvas.clientWidth * ratio), height = Math.round(canvas.clientHeight * ratio);
        if (canvas.width !== width) canvas.width = width;
        if (canvas.height !== height) canvas.height = height;
      }
      for (const view of views) { cut(view); paint(view); }
      byId('cut-at').textContent = at.map((x, a) => 'xyz'[a] + ' = ' + x.toFixed(1)).join(', ') + ' mm';
      byId('cuts').dataset.ready = 'true';
    });
  }
  // `tell` is false where the place comes from the view in three dimensions.
  function go(place, tell = true) {
    at = snapped(place);
    if (zoom > 1) centre = at.slice();
    if (tell) document.dispatchEvent(new CustomEvent('place', { detail: { at, from: 'slices' } }));
    draw();
  }
  const moved = (axis, by) => go(at.map((x, a) => a === axis ? x + by * data.voxel : x));
  function enlarge(factor) {
    zoom = Math.min(20, Math.max(1, zoom * factor));
    centre = zoom > 1 ? at.slice() : middle.slice();
    draw();
  }
  document.addEventListener('place', (event) => { if (event.detail.from !== 'slices') go(event.detail.at, false); });

  // Places to judge, the whole first.
  const list = byId('cut-places'), state = byId('cut-state');
  const ratings = data.places.map(() => '');
  data.places.forEach((place, n) => list.add(new Option((n + 1) + '. ' + place.words, String(n))));
  function choose(number) {
    const count = data.places.length;
    if (count === 0) return;
    list.value = String((number + count) % count);
    if (zoom === 1) zoom = 4;
    go(data.places[list.value].at);
    state.textContent = ratings[list.value];
  }
  function rate(word) {
    if (data.places.length === 0) return;
    const n = Number(list.value);
    ratings[n] = word;
    list.options[n].text = (n + 1) + '. ' + data.places[n].words + ': ' + word;
    state.textContent = word;
  }
  function save() {
    const rated = data.places.map((place, n) => ({ what: place.words, place_mm: place.at, rating: ratings[n] || null }));
    const json = { format: 'explica-rating', format_version: 1, person: document.title, ratings: rated };
    const link = document.createElement('a');
    link.href = URL.createObjectURL(new Blob([JSON.stringify(json, null, 2) + '\n'], { type: 'application/json' }));
    link.download = document.title + '_rating.json';
    link.click();
    URL.revokeObjectURL(link.href);
  }
  list.addEventListener('change', () => choose(Number(list.value)));
  byId('cut-next').addEventListener('click', () => choose(Number(list.value) + 1));
  byId('cut-back').addEventListener('click', () => choose(Number(list.value) - 1));
  for (const button of document.querySelectorAll('#cut-controls [data-rating]')) {
    button.addEventListener('click', () => rate(button.dataset.rating));
  }
  byId('cut-save').addEventListener('click', save);
  for (const input of [outlines, darkest, brightest]) input.addEventListener('input', draw);
  window.addEventListener('resize', draw);

  for (const view of views) {
    const { canvas, h, v, n, sign } = view;
    const placeOf = (event) => {
      const box = canvas.getBoundingClientRect(), k = scale() / (canvas.width / box.width);
      const place = at.slice();
      place[h] = centre[h] + sign * (event.clientX - box.left - 0.5 * box.width) / k;
      place[v] = centre[v] - (event.clientY - box.top - 0.5 * box.height) / k;
      return place;
    };
    let drag = null;
    canvas.addEventListener('pointerdown', (event) => {
      canvas.setPointerCapture(event.pointerId);
      drag = { pan: event.button === 2 || event.shiftKey, from: placeOf(event) };
      if (!drag.pan) { at = snapped(placeOf(event)); draw(); }
    });
    canvas.addEventListener('pointermove', (event) => {
      if (!drag) return;
      const place = placeOf(event);
      if (drag.pan) for (const a of [h, v]) centre[a] += drag.from[a] - place[a];
      else at = snapped(place);
      draw();
    });
    canvas.addEventListener('pointerup', () => {
      if (drag && !drag.pan) document.dispatchEvent(new CustomEvent('place', { detail: { at, from: 'slices' } }));
      drag = null;
    });
    canvas.addEventListener('contextmenu', (event) => event.preventDefault());
    canvas.addEventListener('dblclick', () => enlarge(0));
    canvas.addEventListener('wheel', (event) => {
      event.preventDefault();
      if (event.ctrlKey || event.metaKey) enlarge(Math.exp(-0.002 * event.deltaY));
      else moved(n, event.deltaY < 0 ? 1 : -1);
    }, { passive: false });
    canvas.addEventListener('keydown', (event) => {
      const actions = {
        PageUp: () => moved(n, 1), PageDown: () => moved(n, -1),
        ArrowUp: () => moved(v, 1), ArrowDown: () => moved(v, -1),
        ArrowRight: () => moved(h, sign), ArrowLeft: () => moved(h, -sign),
        '+': () => enlarge(1.25), '=': () => enlarge(1.25), '-': () => enlarge(0.8),
        o: () => { outlines.checked = !outlines.checked; draw(); },
        n: () => choose(Number(list.value) + 1), p: () => choose(Number(list.value) - 1),
        1: () => rate('right'), 2: () => rate('unsure'), 3: () => rate('wrong'), s: save
      };
      const action = actions[event.key] || actions[event.key.toLowerCase()];
      if (!action || event.ctrlKey || event.metaKey) return;
      event.preventDefault();
      action();
    });
  }
  draw();
}
})();
