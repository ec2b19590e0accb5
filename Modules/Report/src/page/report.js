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
(function () {
  'use strict';
  const sources = [...document.querySelectorAll('script.evolution')];
  if (sources.length === 0) return;
  const fresh = document.getElementById('view3d').cloneNode(true);
  let stop = () => {};
  // Another patch gets elements of its own: nothing of the former listens to them.
  function open(number) {
    stop();
    document.getElementById('view3d').replaceWith(fresh.cloneNode(true));
    const which = document.getElementById('which');
    document.getElementById('which-label').hidden = sources.length < 2;
    sources.forEach((source, n) => which.add(new Option(source.dataset.title || 'patch ' + (n + 1), String(n))));
    which.value = String(number);
    which.addEventListener('change', () => open(Number(which.value)));
    let stopped = false;
    let dispose = () => {};
    stop = () => { stopped = true; dispose(); };
    showEvolution(sources[number], () => stopped, (work) => { dispose = work; });
  }
  open(0);

async function showEvolution(source, isStopped, onStop) {
  const byId = (id) => document.getElementById(id);
  const message = byId('stage-message');
  const canvas = byId('canvas');

  let data;
  let renderer;
  try {
    data = JSON.parse(source.textContent);
    renderer = new THREE.WebGLRenderer({ canvas, antialias: true, preserveDrawingBuffer: true });
  } catch (fault) {
    message.textContent = 'This browser cannot show the surface (' + fault.message + '); the pictures below show its views.';
    byId('controls').style.display = 'none';
    return;
  }
  onStop(() => renderer.dispose());

  const start = await unpackIntegers(data.positions);
  const faces = await unpackIntegers(data.faces);
  const openness = await unpackIntegers(data.openness);
  const moved = await unpackIntegers(data.moved);
  const vertexCount = start.length / 3;
  const frames = [];
  {
    let before = new Int32Array(moved.length * 3);
    for (let m = 0; m < moved.length; ++m) for (let c = 0; c < 3; ++c) before[3 * m + c] = start[3 * moved[m] + c];
    for (const packed of data.frames) {
      const change = await unpackIntegers(packed);
      const now = new Int32Array(before.length);
      for (let i = 0; i < now.length; ++i) now[i] = before[i] + change[i];
      frames.push(now);
      before = now;
    }
  }
  const bytesOf = (text) => Uint8Array.from(atob(text), (c) => c.charCodeAt(0));
  const maps = [];
  for (const map of data.maps) {
    maps.push({ name: map.name, unit: map.unit, low: map.low, high: map.high, least: map.least, step: map.step,
                values: await unpackIntegers(map.values), colours: bytesOf(map.colours) });
  }
  const labelMaps = [];
  for (const map of data.labels) {
    labelMaps.push({ name: map.name, names: map.names, entries: await unpackIntegers(map.entries), colours: bytesOf(map.colours) });
  }
  const region = await unpackIntegers(data.region);

  if (isStopped()) return;

  // Geometry in millimetres about the middle of what moves, or of everything.
  const positions = new Float32Array(vertexCount * 3);
  for (let i = 0; i < positions.length; ++i) positions[i] = data.low[i % 3] + data.unit * start[i];
  const isMoved = new Uint8Array(vertexCount);
  for (const v of moved) isMoved[v] = 1;
  const inRegion = new Uint8Array(vertexCount);
  for (const v of region) inRegion[v] = 1;
  const faceInRegion = (f) => inRegion[faces[f]] && inRegion[faces[f + 1]] && inRegion[faces[f + 2]];
  let isWhole = region.length > 0;
  for (let f = 0; f < faces.length && isWhole; f += 3) isWhole = faceInRegion(f);
  // Where there is no patch, nothing speaks of one.
  for (const element of document.querySelectorAll('#view3d .of-part')) element.style.display = isWhole ? 'none' : '';
  byId('reset').textContent = isWhole ? 'Reset the view' : 'Back to the patch';
  function boxOf(filter) {
    const low = [Infinity, Infinity, Infinity];
    const high = [-Infinity, -Infinity, -Infinity];
    for (let v = 0; v < vertexCount; ++v) {
      if (!filter(v)) continue;
      for (let c = 0; c < 3; ++c) {
        low[c] = Math.min(low[c], positions[3 * v + c]);
        high[c] = Math.max(high[c], positions[3 * v + c]);
      }
    }
    return { middle: low.map((x, c) => 0.5 * (x + high[c])), size: Math.hypot(...low.map((x, c) => high[c] - x)) };
  }
  const whole = boxOf(() => true);

  const normals = new Float32Array(vertexCount * 3);
  function computeNormals() {
    normals.fill(0);
    for (let f = 0; f < faces.length; f += 3) {
      const a = 3 * faces[f], b = 3 * faces[f + 1], c = 3 * faces[f + 2];
      const ux = positions[b] - positions[a], uy = positions[b + 1] - positions[a + 1], uz = positions[b + 2] - positions[a + 2];
      const vx = positions[c] - positions[a], vy = positions[c + 1] - positions[a + 1], vz = positions[c + 2] - positions[a + 2];
      const nx = uy * vz - uz * vy, ny = uz * vx - ux * vz, nz = ux * vy - uy * vx;
      for (const v of [a, b, c]) { normals[v] += nx; normals[v + 1] += ny; normals[v + 2] += nz; }
    }
    for (let v = 0; v < normals.length; v += 3) {
      const length = Math.hypot(normals[v], normals[v + 1], normals[v + 2]) || 1;
      normals[v] /= length; normals[v + 1] /= length; normals[v + 2] /= length;
    }
  }

  const colours = new Float32Array(vertexCount * 3);
  const open = new Float32Array(vertexCount);
  const geometry = new THREE.BufferGeometry();
  geometry.setAttribute('position', new THREE.BufferAttribute(positions, 3));
  geometry.setAttribute('normal', new THREE.BufferAttribute(normals, 3));
  geometry.setAttribute('tone', new THREE.BufferAttribute(colours, 3));
  geometry.setAttribute('open', new THREE.BufferAttribute(open, 1));
  const allFaces = new THREE.BufferAttribute(Uint32Array.from(faces), 1);
  const partFaces = [];
  for (let f = 0; f < faces.length; f += 3) {
    if (faceInRegion(f)) partFaces.push(faces[f], faces[f + 1], faces[f + 2]);
  }
  const someFaces = new THREE.BufferAttribute(Uint32Array.from(partFaces), 1);
  geometry.setIndex(allFaces);
  const material = new THREE.ShaderMaterial({
    side: THREE.DoubleSide, polygonOffset: true, polygonOffsetFactor: 1, polygonOffsetUnits: 1,
    vertexShader: 'attribute vec3 tone; attribute float open; varying vec3 vTone; varying float vOpen; varying vec3 vNormal;' +
      'void main() { vTone = tone; vOpen = open; vNormal = normalMatrix * normal;' +
      'gl_Position = projectionMatrix * modelViewMatrix * vec4(position, 1.0); }',
    fragmentShader: 'varying vec3 vTone; varying float vOpen; varying vec3 vNormal;' +
      'void main() { vec3 n = normalize(vNormal); float inside = gl_FrontFacing ? 0.0 : 1.0; n = gl_FrontFacing ? n : -n;' +
      'float light = 0.18 + 0.47 * max(0.0, dot(n, normalize(vec3(-0.45, 0.45, 1.0)))) + 0.40 * max(0.0, n.z);' +
      'float dark = mix(1.0 - 0.9 * (1.0 - min(1.0, 1.25 * vOpen)), 0.5, inside);' +
      'vec3 c = vTone * light * dark * mix(vec3(1.0), vec3(0.5, 0.5, 0.75), inside);' +
      'gl_FragColor = vec4(pow(c, vec3(1.0 / 2.2)), 1.0); }'
  });
  const scene = new THREE.Scene();
  scene.background = new THREE.Color(0xeef1f4);
  const mesh = new THREE.Mesh(geometry, material);
  mesh.frustumCulled = false;
  scene.add(mesh);

  // Labels fill whole faces, so that no colour lies between two of them: corners of its own for each face.
  const corners = faces.length;
  const flatGeometry = new THREE.BufferGeometry();
  const flat = { position: new Float32Array(3 * corners), normal: new Float32Array(3 * corners),
                 tone: new Float32Array(3 * corners), open: new Float32Array(corners) };
  flatGeometry.setAttribute('position', new THREE.BufferAttribute(flat.position, 3));
  flatGeometry.setAttribute('normal', new THREE.BufferAttribute(flat.normal, 3));
  flatGeometry.setAttribute('tone', new THREE.BufferAttribute(flat.tone, 3));
  flatGeometry.setAttribute('open', new THREE.BufferAttribute(flat.open, 1));
  const flatWhole = new THREE.BufferAttribute(Uint32Array.from({ length: corners }, (_, i) => i), 1);
  const flatPart = [];
  for (let f = 0; f < faces.length; f += 3) if (faceInRegion(f)) flatPart.push(f, f + 1, f + 2);
  const flatSome = new THREE.BufferAttribute(Uint32Array.from(flatPart), 1);
  flatGeometry.setIndex(flatWhole);
  const flatMesh = new THREE.Mesh(flatGeometry, material);
  flatMesh.frustumCulled = false;
  flatMesh.visible = false;
  scene.add(flatMesh);
  function followFlat() {
    for (let i = 0; i < corners; ++i) {
      const v = faces[i];
      for (let c = 0; c < 3; ++c) {
        flat.position[3 * i + c] = positions[3 * v + c];
        flat.normal[3 * i + c] = normals[3 * v + c];
      }
      flat.open[i] = open[v];
    }
    for (const name of ['position', 'normal', 'open']) flatGeometry.attributes[name].needsUpdate = true;
  }
  // The colour of a face is that of two of its corners, else of the first.
  function paintFaces(entryOf, colourOf) {
    paintEach((f) => {
      const a = entryOf(faces[f]), b = entryOf(faces[f + 1]), c = entryOf(faces[f + 2]);
      return colourOf(b === c ? b : a);
    });
  }
  function paintEach(colourOf) {
    for (let f = 0; f < faces.length; f += 3) {
      const colour = colourOf(f);
      for (let k = 0; k < 3; ++k) for (let i = 0; i < 3; ++i) flat.tone[3 * (f + k) + i] = colour[i];
    }
    flatGeometry.attributes.tone.needsUpdate = true;
  }

  // The region's rim: edges of its faces that no other face of it has.
  const rimEnds = [];
  {
    const edges = new Map();
    for (let f = 0; f < faces.length; f += 3) {
      if (!faceInRegion(f)) continue;
      for (let k = 0; k < 3; ++k) {
        const a = faces[f + k], b = faces[f + (k + 1) % 3];
        const key = Math.min(a, b) * vertexCount + Math.max(a, b);
        edges.set(key, (edges.get(key) || 0) + 1);
      }
    }
    for (const [key, count] of edges) if (count === 1) rimEnds.push(Math.floor(key / vertexCount), key % vertexCount);
  }
  const rimPositions = new Float32Array(3 * rimEnds.length);
  const rimGeometry = new THREE.BufferGeometry();
  rimGeometry.setAttribute('position', new THREE.BufferAttribute(rimPositions, 3));
  const rim = new THREE.LineSegments(rimGeometry, new THREE.LineBasicMaterial({ color: 0x101418 }));
  rim.frustumCulled = false;
  scene.add(rim);
  function followRim() {
    rimEnds.forEach((v, i) => { for (let c = 0; c < 3; ++c) rimPositions[3 * i + c] = positions[3 * v + c]; });
    rimGeometry.attributes.position.needsUpdate = true;
  }

  // The eye turns about `target`: parallel projection, a quaternion for the turn.
  const camera = new THREE.OrthographicCamera(-1, 1, 1, -1, 0.1, 10000);
  const eye = { target: new THREE.Vector3(), turn: new THREE.Quaternion(), half: 100 };
  // The box of the region in the first and the last frame.
  function regionBox() {
    const now = boxOf((v) => inRegion[v] === 1);
    if (frames.length < 2) return now;
    const shown = frame;
    show(shown === 0 ? frames.length - 1 : 0);
    const other = boxOf((v) => inRegion[v] === 1);
    show(shown);
    return { middle: now.middle.map((x, c) => 0.5 * (x + other.middle[c])), size: Math.max(now.size, other.size) };
  }
  function lookAt(focus, share) {
    eye.target.set(...focus.middle);
    eye.half = share * focus.size * Math.max(1, canvas.clientHeight / canvas.clientWidth);
    const from = data.viewpoint ? new THREE.Vector3(...data.viewpoint).sub(eye.target) : new THREE.Vector3(-1, 0, 0);
    const up = Math.abs(from.clone().normalize().z) > 0.9 ? new THREE.Vector3(0, 1, 0) : new THREE.Vector3(0, 0, 1);
    const matrix = new THREE.Matrix4().lookAt(from, new THREE.Vector3(), up);
    eye.turn.setFromRotationMatrix(matrix);
    draw();
  }
  const resetView = () => lookAt(region.length > 0 ? regionBox() : whole, region.length > 0 ? 0.4 : 0.36);
  const wholeView = () => lookAt(whole, 0.36);
  let pending = false;
  function draw() {
    if (pending) return;
    pending = true;
    requestAnimationFrame(() => {
      pending = false;
      const width = canvas.clientWidth, height = canvas.clientHeight;
      const ratio = Math.min(window.devicePixelRatio || 1, 2);
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
      renderer.render(scene, camera);
    });
  }
  function rotate(dx, dy) {
    const turn = new THREE.Quaternion().setFromEuler(new THREE.Euler(-dy, -dx, 0));
    eye.turn.multiply(turn);
    draw();
  }
  function zoom(factor) {
    eye.half = Math.min(Math.max(eye.half * factor, 0.005 * whole.size), 3 * whole.size);
    draw();
  }
  function shift(dx, dy) {
    const step = 2 * eye.half / canvas.clientHeight;
    eye.target.add(new THREE.Vector3(-dx * step, dy * step, 0).applyQuaternion(eye.turn));
    draw();
  }

  const slider = byId('frame');
  const title = byId('frame-title');
  const play = byId('play');
  const chooser = byId('map');
  const alone = byId('alone');
  let frame = 0;
  let playing = null;
  let followMark = () => {};

  const linear = (byte) => Math.pow(byte / 255, 2.2);
  function paint() {
    const choice = chooser.value;
    const bar = byId('bar');
    if (choice === 'facing') {
      // Cosine between the outward normal and the direction to the viewpoint: the flux density now.
      const eyeAt = data.viewpoint || [whole.middle[0] - 1e4, whole.middle[1], whole.middle[2]];
      const ramp = facingMap.colours;
      for (let v = 0; v < vertexCount; ++v) {
        let x = eyeAt[0] - positions[3 * v], y = eyeAt[1] - positions[3 * v + 1], z = eyeAt[2] - positions[3 * v + 2];
        const cosine = (x * normals[3 * v] + y * normals[3 * v + 1] + z * normals[3 * v + 2]) / Math.hypot(x, y, z);
        const entry = 3 * Math.round(127 * (1 + Math.max(-1, Math.min(1, cosine))));
        for (let c = 0; c < 3; ++c) colours[3 * v + c] = linear(ramp[entry + c]);
      }
    } else if (choice === 'none') {
      // The region is made of the faces with all corners in it: its colour ends at its rim.
      paintEach((f) => (faceInRegion(f) ? [0.80, 0.50, 0.28] : [0.60, 0.58, 0.56]));
    } else if (choice.startsWith('label')) {
      const map = labelMaps[Number(choice.slice(5))];
      paintFaces((v) => map.entries[v], (entry) => (entry < 0 ? [0.60, 0.58, 0.56]
        : [0, 1, 2].map((c) => linear(map.colours[3 * entry + c]))));
    } else {
      const map = maps[Number(choice)];
      for (let v = 0; v < vertexCount; ++v) {
        const value = map.values[v] > 65534 ? NaN : map.least + map.step * map.values[v];
        const share = Math.max(0, Math.min(1, (value - map.low) / (map.high - map.low)));
        const entry = Number.isNaN(value) ? 3 * 255 : 3 * Math.round(254 * share);
        for (let c = 0; c < 3; ++c) colours[3 * v + c] = linear(map.colours[entry + c]);
      }
    }
    const byFace = choice === 'none' || choice.startsWith('label');
    mesh.visible = !byFace;
    flatMesh.visible = byFace;
    const shown = byFace ? null : (choice === 'facing' ? facingMap : maps[Number(choice)]);
    bar.style.display = shown ? 'block' : 'none';
    if (shown) {
      byId('bar-title').textContent = shown.name + (shown.unit ? ' [' + shown.unit + ']' : '');
      byId('bar-high').textContent = String(Number(shown.high.toPrecision(3)));
      byId('bar-low').textContent = String(Number(shown.low.toPrecision(3)));
      const pen = byId('bar-colours').getContext('2d');
      for (let y = 0; y < 128; ++y) {
        const entry = 3 * Math.round(254 * (1 - y / 127));
        pen.fillStyle = 'rgb(' + shown.colours[entry] + ',' + shown.colours[entry + 1] + ',' + shown.colours[entry + 2] + ')';
        pen.fillRect(0, y, 14, 1);
      }
    }
    geometry.attributes.tone.needsUpdate = true;
    draw();
  }

  function show(number) {
    frame = Math.max(0, Math.min(frames.length - 1, number));
    if (frames.length > 0) {
      const now = frames[frame];
      for (let m = 0; m < moved.length; ++m) {
        for (let c = 0; c < 3; ++c) positions[3 * moved[m] + c] = data.low[c] + data.unit * now[3 * m + c];
      }
    }
    computeNormals();
    followRim();
    followMark();
    // What unfolds comes out of the shade.
    const share = frames.length > 1 ? frame / (frames.length - 1) : 0;
    for (let v = 0; v < vertexCount; ++v) {
      const shade = openness[v] / 255;
      open[v] = isMoved[v] ? shade + share * (1 - shade) : shade;
    }
    for (const name of ['position', 'normal', 'open']) geometry.attributes[name].needsUpdate = true;
    followFlat();
    slider.value = String(frame);
    title.textContent = data.titles[frame] || '';
    if (chooser.value === 'facing') paint(); else draw();
  }
  function pause() {
    clearInterval(playing);
    playing = null;
    play.textContent = '\u25b6';
  }
  function togglePlay() {
    if (playing !== null) { pause(); return; }
    if (frame >= frames.length - 1) show(0);
    play.textContent = '\u23f8';
    playing = setInterval(() => {
      if (frame >= frames.length - 1) pause(); else show(frame + 1);
    }, 100);
  }

  const facingMap = { name: 'facing the viewpoint (1 = directly)', unit: '', low: -1, high: 1, colours: new Uint8Array(3 * 256) };
  for (let e = 0; e < 256; ++e) {
    const t = e / 254;
    const mix = (a, b, s) => Math.round(a + (b - a) * s);
    const ends = t < 0.5 ? [[30, 70, 150], [236, 236, 236], 2 * t] : [[236, 236, 236], [150, 75, 10], 2 * t - 1];
    for (let c = 0; c < 3; ++c) facingMap.colours[3 * e + c] = mix(ends[0][c], ends[1][c], Math.min(1, ends[2]));
  }
  const addChoice = (value, text) => {
    const option = document.createElement('option');
    option.value = value;
    option.textContent = text;
    chooser.appendChild(option);
  };
  addChoice('none', moved.length > 0 && !isWhole ? 'region' : 'plain');
  addChoice('facing', 'facing the viewpoint (1 = directly)');
  maps.forEach((map, m) => addChoice(String(m), map.name));
  labelMaps.forEach((map, m) => addChoice('label' + m, map.name));
  slider.max = String(Math.max(0, frames.length - 1));
  if (frames.length < 2) {
    for (const id of ['play', 'frame', 'before-after']) byId(id).disabled = true;
  }

  slider.addEventListener('input', () => { pause(); show(Number(slider.value)); });
  play.addEventListener('click', togglePlay);
  chooser.addEventListener('change', paint);
  byId('before-after').addEventListener('click', () => { pause(); show(frame === 0 ? frames.length - 1 : 0); });
  byId('reset').addEventListener('click', resetView);
  byId('whole').addEventListener('click', wholeView);
  function partOrAll() {
    geometry.setIndex(alone.checked ? someFaces : allFaces);
    flatGeometry.setIndex(alone.checked ? flatSome : flatWhole);
  }
  alone.addEventListener('change', () => { partOrAll(); resetView(); });

  // The value under the pointer: of the nearest corner of the face that it points at.
  const reading = byId('under-pointer');
  const caster = new THREE.Raycaster();
  const readable = (x) => String(Number(x.toPrecision(3)));
  function valueAt(v) {
    const choice = chooser.value;
    if (choice === 'none') return isWhole ? '' : inRegion[v] ? 'in the region' : 'outside the region';
    if (choice.startsWith('label')) {
      const map = labelMaps[Number(choice.slice(5))];
      return map.name + ': ' + (map.entries[v] < 0 ? 'none' : map.names[map.entries[v]]);
    }
    if (choice === 'facing') return '';
    const map = maps[Number(choice)];
    const known = map.values[v] <= 65534;
    return map.name + ': ' + (known ? readable(map.least + map.step * map.values[v]) + (map.unit ? ' ' + map.unit : '') : 'not known');
  }
  let asked = false, pointedAt = -1;
  function readUnder(x, y) {
    if (asked) return;
    asked = true;
    requestAnimationFrame(() => {
      asked = false;
      const box = canvas.getBoundingClientRect();
      caster.setFromCamera({ x: 2 * (x - box.left) / box.width - 1, y: 1 - 2 * (y - box.top) / box.height }, camera);
      geometry.boundingSphere = new THREE.Sphere(new THREE.Vector3(...whole.middle), 2 * whole.size);
      const wasVisible = mesh.visible;
      mesh.visible = true;
      const hit = caster.intersectObject(mesh)[0];
      mesh.visible = wasVisible;
      pointedAt = -1;
      if (!hit) { reading.textContent = ''; return; }
      let nearest = hit.face.a, least = Infinity;
      for (const v of [hit.face.a, hit.face.b, hit.face.c]) {
        const far = Math.hypot(...[0, 1, 2].map((c) => positions[3 * v + c] - hit.point.getComponent(c)));
        if (far < least) { least = far; nearest = v; }
      }
      pointedAt = nearest;
      reading.textContent = valueAt(nearest) + ' (vertex ' + nearest + ')';
    });
  }
  // The place where the slices are, marked on the surface, and the other way round.
  const mark = new THREE.Points(new THREE.BufferGeometry(),
    new THREE.PointsMaterial({ color: 0x00a5cf, size: 11, sizeAttenuation: false, depthTest: false }));
  mark.geometry.setAttribute('position', new THREE.BufferAttribute(new Float32Array(3), 3));
  mark.frustumCulled = false;
  mark.visible = false;
  mark.renderOrder = 1;
  scene.add(mark);
  let marked = -1;
  const firstPlace = (v) => [0, 1, 2].map((c) => data.low[c] + data.unit * start[3 * v + c]);
  followMark = () => {
    mark.visible = marked >= 0;
    if (marked < 0) return;
    for (let c = 0; c < 3; ++c) mark.geometry.attributes.position.array[c] = positions[3 * marked + c];
    mark.geometry.attributes.position.needsUpdate = true;
  };
  function markPlace(event) {
    const farthest = 15;  // mm; beyond, the slices are off this surface
    let least = farthest;
    marked = -1;
    for (let v = 0; v < vertexCount; ++v) {
      const far = Math.hypot(...firstPlace(v).map((x, c) => x - event.detail.at[c]));
      if (far < least) { least = far; marked = v; }
    }
    followMark();
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
    if (!wasDragged && pointedAt >= 0) document.dispatchEvent(new CustomEvent('place', { detail: { at: firstPlace(pointedAt), from: 'surface', view: source.dataset.title, vertex: pointedAt } }));
  });
  canvas.addEventListener('contextmenu', (event) => event.preventDefault());
  canvas.addEventListener('wheel', (event) => { event.preventDefault(); zoom(Math.exp(0.001 * event.deltaY)); }, { passive: false });
  canvas.addEventListener('keydown', (event) => {
    const actions = {
      ArrowLeft: () => rotate(-0.1, 0), ArrowRight: () => rotate(0.1, 0), ArrowUp: () => rotate(0, -0.1), ArrowDown: () => rotate(0, 0.1),
      '+': () => zoom(0.9), '=': () => zoom(0.9), '-': () => zoom(1.1), ' ': togglePlay,
      ',': () => { pause(); show(frame - 1); }, '.': () => { pause(); show(frame + 1); },
      b: () => byId('before-after').click(), r: resetView
    };
    const action = actions[event.key] || actions[event.key.toLowerCase()];
    if (!action) return;
    event.preventDefault();
    action();
  });
  window.addEventListener('resize', draw);
  onStop(() => {
    clearInterval(playing);
    window.removeEventListener('resize', draw);
    document.removeEventListener('place', markPlace);
    renderer.dispose();
    renderer.forceContextLoss();
  });

  message.textContent = '';
  if (data.detached) { alone.checked = true; partOrAll(); }
  show(0);
  paint();
  (alone.checked ? resetView : wholeView)();
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
  let before = null;
  for (const packed of data.surfaces) {
    const steps = await unpackIntegers(packed.positions);
    const faces = packed.faces ? await unpackIntegers(packed.faces) : before.faces;
    if (!packed.faces) for (let i = 0; i < steps.length; ++i) steps[i] += before.steps[i];
    before = { faces, steps };
    surfaces.push({ faces, colour: packed.colour, at: Float32Array.from(steps, (s, i) => data.low[i % 3] + data.step * s) });
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
