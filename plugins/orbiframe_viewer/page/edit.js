"use strict";
(() => {
  const { WARM, CLAY, $, decoded, colourOf, Pane, material, tints, clear, pairs, failed, valueOf } = Panes;
  const told = $("told");
  const shown = ["what", "step", "surface", "edges", "input", "influence", "zebra"];
  const kept = Panes.memory.load();
  const NEAR = 14; // pixels from a handle within which it is meant
  const IDLE = 350; // milliseconds without a key after which steps by keys are one step

  let scene = null, state = null, space, plane, surfaceMaterial, parts = {}, ended = false;
  let base = null; // what the server says: vertices, points, and their derivatives
  let own = null; // what is shown: the same with the way of the handle that is being moved
  let picture = 0, busy = false;
  let chosen = null, hovered = null, drag = null; // handles: {kind, number}
  const columns = new Map(); // of handles, as long as the fit is the same

  const same = (a, b) => a && b && a.kind === b.kind && a.number === b.number;
  const kind = () => $("what").value;
  const remember = () => {
    if (!space || !scene) return;
    Panes.memory.save({ ...Object.fromEntries(shown.map((id) => [id, valueOf(id)])), space: Panes.viewOf(space), plane: Panes.viewOf(plane), chosen });
  };

  // ---- the server ----

  const ask = async (name) => { const found = await fetch(name); if (!found.ok) throw new Error(await found.text()); return found; };
  const send = async (name, body) => {
    let found;
    try { found = await (await fetch(name, { method: "POST", headers: { "Content-Type": "application/json" }, body: JSON.stringify(body) })).json(); }
    catch { end(); return null; }
    if (found.error && found.ready === undefined) { say(found.error, true); return null; }
    await heard(found);
    return found;
  };
  const end = () => { ended = true; failed("the command that served this page has ended; what was not saved lies in files whose names it told"); };
  const say = (words, wrong) => { told.textContent = words; told.classList.toggle("error", Boolean(wrong)); };

  const heard = async (found) => { // a state
    const before = state;
    state = found;
    $("name").textContent = state.name;
    if (!state.ready) {
      if (state.error) failed(state.error);
      else say(`at work\n${state.stages.map(([stage, seconds]) => seconds === null ? `${stage} …` : `${stage} ${seconds} s`).join("\n")}`);
      return;
    }
    if (!before || before.fits !== state.fits || before.shape !== state.shape) columns.clear();
    $("undo").disabled = !state.undo; $("redo").disabled = !state.redo; $("save").disabled = state.saving || !state.unsaved;
    choices();
    document.title = `${state.unsaved ? "• " : ""}${state.name} – orbiframe edit`;
    Object.assign(document.body.dataset, { fitted: state.fitted, unsaved: state.unsaved, picture: state.picture });
    if (!drag && !busy && (!scene || scene.shape !== state.shape || picture !== state.picture)) await refresh();
    words();
  };
  const refresh = async () => {
    busy = true;
    try {
      if (!scene || scene.shape !== state.shape) build(await (await ask("scene.json")).json());
      const wanted = state.picture, numbers = new Float32Array(await (await ask("picture.bin")).arrayBuffer());
      if (drag) return;
      picture = wanted;
      take(numbers);
      if (chosen) influence(chosen);
    } finally { busy = false; }
  };
  const words = () => {
    told.classList.toggle("busy", state.working || state.saving);
    const at = hovered || chosen, lines = [];
    if (at) lines.push(`${at.kind === "vertex" ? "vertex" : "control point"} ${at.number} at (${placeOf(at).map((x, k) => (scene.origin[k] + scene.scale * x).toPrecision(5)).join(", ")})`);
    const stage = state.stages[state.stages.length - 1];
    if (state.saving) lines.push("saving …");
    else if (state.working) lines.push(`fitting: ${stage ? stage[0] : ""} … the picture is that of the linear fit`);
    if (state.error) lines.push(state.error); else if (!state.working) lines.push(state.said);
    if (document.activeElement === space.canvas) lines.push(chosen ? "arrow keys, Page Up, Page Down: move · Escape: let go" : "Tab: choose · arrow keys: turn");
    say(lines.join("\n"), state.error);
  };
  const poll = async () => {
    if (ended) return;
    let found;
    try { found = await (await ask("state.json")).json(); } catch { return end(); }
    try { await heard(found); }
    finally { if (document.body.dataset.state !== "failed") setTimeout(poll, state.ready && !state.working ? 250 : 150); }
  };

  // ---- the picture ----

  const ROUND = (solid) => new THREE.ShaderMaterial({
    transparent: true, depthTest: solid, depthWrite: false,
    uniforms: { size: { value: 1 }, opacity: { value: solid ? 1 : 0.3 } },
    vertexShader: "attribute vec3 color; attribute float big; varying vec3 vColor; uniform float size; void main() { vColor = color; gl_PointSize = size * big; gl_Position = projectionMatrix * modelViewMatrix * vec4(position, 1.0); gl_Position.z -= 0.0015 * gl_Position.w; }",
    fragmentShader: "varying vec3 vColor; uniform float opacity; void main() { float r = length(gl_PointCoord - 0.5); if (r > 0.5) discard; gl_FragColor = vec4(r > 0.36 ? vec3(1.0) : vColor, opacity); }",
  });

  const build = (found) => {
    scene = found; clear(space); clear(plane); hovered = null;
    scene.index = decoded(scene.index, Uint32Array); scene.controls = decoded(scene.controls, Uint32Array);
    if (chosen && chosen.number >= (chosen.kind === "vertex" ? scene.vertices : scene.controls.length)) chosen = null;
    const position = new THREE.BufferAttribute(new Float32Array(3 * scene.points), 3), vertices = new THREE.BufferAttribute(new Float32Array(3 * scene.vertices), 3);
    const geometry = new THREE.BufferGeometry().setAttribute("position", position);
    geometry.setAttribute("normal", new THREE.BufferAttribute(new Float32Array(3 * scene.points), 3));
    geometry.setIndex(new THREE.BufferAttribute(scene.index, 1));
    tints(geometry, scene.points);
    const lined = (attribute, index, colour, opacity) => {
      const shape = new THREE.BufferGeometry().setAttribute("position", attribute).setIndex(new THREE.BufferAttribute(decoded(index, Uint32Array), 1));
      return new THREE.LineSegments(shape, new THREE.LineBasicMaterial({ color: colour, transparent: opacity < 1, opacity }));
    };
    const handles = pairs(new Float32Array(0));
    const points = [false, true].map((solid) => new THREE.Points(handles, ROUND(solid)));
    parts = { surface: new THREE.Mesh(geometry, surfaceMaterial), edges: lined(position, scene.curves, 0x14202c, 0.75), input: lined(vertices, scene.lines, 0xb8450a, 0.9), ghost: points[0], solid: points[1] };
    for (const each of Object.values(parts)) each.frustumCulled = false;
    parts.solid.renderOrder = 8; parts.ghost.renderOrder = 7;
    space.mesh = parts.surface;
    space.things.add(...Object.values(parts));
    $("plane").hidden = !scene.xh;
    if (scene.xh) Panes.buildPlane(plane, scene.xh);
    if (!space.looked) { home(); Panes.recall(space, kept.space); Panes.recall(plane, kept.plane); space.looked = true; }
    else plane.fit();
    document.body.dataset.state = "ready";
  };
  const home = () => { // a little farther away than a picture alone needs: the line below takes room
    Panes.views(space, plane, scene.xh);
    space.camera.position.multiplyScalar(1.15); space.orbit.update();
  };
  const split = (numbers) => {
    const v = 3 * scene.vertices, n = 3 * scene.points, jets = (numbers.length - v) / n;
    return { vertices: numbers.subarray(0, v), jets: [...Array(jets)].map((_, k) => numbers.subarray(v + k * n, v + (k + 1) * n)) };
  };
  const take = (numbers) => { // from the server
    base = split(numbers); own = split(numbers.slice());
    put();
  };
  // The way of a handle added to the numbers of the server: one product for every point.
  const follow = (handle, way) => {
    const start = performance.now(), column = columns.get(`${handle.kind} ${handle.number}`), [x, y, z] = way;
    own.vertices.set(base.vertices);
    if (handle.kind === "vertex") way.forEach((each, k) => { own.vertices[3 * handle.number + k] += each; });
    base.jets.forEach((from, j) => {
      const to = own.jets[j], weight = column?.[j];
      if (!weight) { to.set(from); return; }
      for (let i = 0, k = 0; i < weight.length; i++, k += 3) { const w = weight[i]; to[k] = from[k] + w * x; to[k + 1] = from[k + 1] + w * y; to[k + 2] = from[k + 2] + w * z; }
    });
    put();
    return performance.now() - start;
  };
  const put = () => { // own numbers to the graphics
    const geometry = parts.surface.geometry, normal = geometry.attributes.normal;
    geometry.attributes.position.array.set(own.jets[0]); geometry.attributes.position.needsUpdate = true;
    if (own.jets.length === 3) {
      const [, a, b] = own.jets, n = normal.array;
      for (let k = 0; k < n.length; k += 3) {
        n[k] = a[k + 1] * b[k + 2] - a[k + 2] * b[k + 1]; n[k + 1] = a[k + 2] * b[k] - a[k] * b[k + 2]; n[k + 2] = a[k] * b[k + 1] - a[k + 1] * b[k];
        const size = 1 / (Math.sqrt(n[k] * n[k] + n[k + 1] * n[k + 1] + n[k + 2] * n[k + 2]) || 1);
        n[k] *= size; n[k + 1] *= size; n[k + 2] *= size;
      }
      normal.needsUpdate = true;
    } else geometry.computeVertexNormals();
    parts.input.geometry.attributes.position.array.set(own.vertices); parts.input.geometry.attributes.position.needsUpdate = true;
    geometry.boundingSphere = null;
    marks(); space.draw();
  };
  const count = () => kind() === "vertex" ? scene.vertices : scene.controls.length;
  const placeOf = (handle) => {
    const from = handle.kind === "vertex" ? own.vertices : own.jets[0], k = 3 * (handle.kind === "vertex" ? handle.number : scene.controls[handle.number]);
    return [from[k], from[k + 1], from[k + 2]];
  };
  const marks = () => { // the handles
    const n = count(), geometry = parts.solid.geometry;
    if (geometry.attributes.position?.count !== n) {
      for (const name of ["position", "color"]) geometry.setAttribute(name, new THREE.BufferAttribute(new Float32Array(3 * n), 3));
      geometry.setAttribute("big", new THREE.BufferAttribute(new Float32Array(n), 1));
    }
    const { position, color, big } = geometry.attributes, size = space.ratio();
    if (kind() === "vertex") position.array.set(own.vertices);
    else scene.controls.forEach((from, k) => { for (let j = 0; j < 3; j++) position.array[3 * k + j] = own.jets[0][3 * from + j]; });
    for (let k = 0; k < n; k++) {
      const here = { kind: kind(), number: k }, now = same(here, chosen), near = same(here, hovered);
      color.array.set(now ? [0.95, 0.2, 0.1] : near ? [0.98, 0.6, 0.1] : [0.72, 0.27, 0.04], 3 * k);
      big.array[k] = size * (now || near ? 15 : n > 1500 ? 4 : n > 120 ? 7 : 10);
    }
    for (const each of [position, color, big]) each.needsUpdate = true;
  };

  const paint = () => { // influence as colours
    const at = hovered || chosen, column = $("influence").checked && at && columns.get(`${at.kind} ${at.number}`)?.[0];
    const tint = parts.surface.geometry.attributes.tint;
    let high = 0;
    if (column) for (let i = 0; i < column.length; i++) high = Math.max(high, Math.abs(column[i]));
    for (let i = 0; i < tint.count; i++) {
      const colour = column ? colourOf(WARM, Math.abs(column[i]) / (high || 1)) : CLAY;
      for (let j = 0; j < 3; j++) tint.array[3 * i + j] = colour[j] / 255;
    }
    tint.needsUpdate = true;
    $("scale").hidden = !column; $("high").textContent = high.toPrecision(2);
    if (plane.mesh) Panes.paintPlane(plane, scene.index, tint.array);
    document.body.dataset.influence = column ? `${at.kind} ${at.number}` : "";
    space.draw(); plane.draw();
  };
  const influence = async (handle) => {
    const key = `${handle.kind} ${handle.number}`;
    if (!columns.has(key)) {
      const fits = state.fits, shape = state.shape;
      try {
        const numbers = new Float32Array(await (await ask(`influence.bin?${handle.kind}=${handle.number}`)).arrayBuffer());
        if (state.fits !== fits || state.shape !== shape || numbers.length % scene.points) return;
        columns.set(key, [...Array(numbers.length / scene.points)].map((_, k) => numbers.subarray(k * scene.points, (k + 1) * scene.points)));
      } catch { return; }
    }
    if (drag && same(drag.handle, handle)) moveTo(drag.way);
    if (same(handle, hovered || chosen)) paint();
  };
  const look = () => {
    parts.surface.visible = $("surface").checked; parts.edges.visible = $("edges").checked;
    parts.input.visible = parts.ghost.visible = parts.solid.visible = $("input").checked;
    if (kind() === "control") parts.ghost.visible = parts.solid.visible = true;
    surfaceMaterial.uniforms.zebra.value = $("zebra").checked;
    marks(); paint(); remember();
  };

  // ---- handles under the cursor, dragged, and moved by keys ----

  const cursor = (event) => { const box = space.canvas.getBoundingClientRect(); return [event.clientX - box.left, event.clientY - box.top, box.width, box.height]; };
  const under = (event) => {
    const [x, y, w, h] = cursor(event), spot = new THREE.Vector3();
    let best = null, depth = Infinity;
    for (let number = 0; number < count(); number++) {
      const handle = { kind: kind(), number };
      spot.set(...placeOf(handle)).project(space.camera);
      const away = Math.hypot((spot.x + 1) / 2 * w - x, (1 - spot.y) / 2 * h - y);
      if (away < NEAR && spot.z < depth && spot.z < 1) { best = handle; depth = spot.z; }
    }
    return parts.solid.visible ? best : null;
  };
  const hover = (handle) => {
    if (same(handle, hovered) || (!handle && !hovered)) return;
    hovered = handle; space.canvas.style.cursor = handle ? "grab" : "";
    if (handle) influence(handle);
    marks(); paint(); words();
  };
  const choose = (handle) => {
    finishKeys();
    chosen = handle;
    if (handle) influence(handle);
    marks(); paint(); words(); remember();
  };
  const ray = new THREE.Raycaster(), sheet = new THREE.Plane();
  const onSheet = (event) => {
    const [x, y, w, h] = cursor(event);
    ray.setFromCamera(new THREE.Vector2(2 * x / w - 1, 1 - 2 * y / h), space.camera);
    return ray.ray.intersectPlane(sheet, new THREE.Vector3());
  };
  const moveTo = (way) => { drag.way = way; document.body.dataset.ours = follow(drag.handle, way).toFixed(2); };
  const press = (event) => {
    if (event.button || !own || busy) return;
    const handle = under(event);
    if (!handle) return;
    event.stopPropagation(); event.preventDefault();
    space.canvas.focus(); choose(handle);
    if (handle.kind === "control" && !state.fitted) { say("the functions are being made anew; wait for the fit", true); return; }
    const place = new THREE.Vector3(...placeOf(handle));
    sheet.setFromNormalAndCoplanarPoint(space.camera.getWorldDirection(new THREE.Vector3()), place);
    drag = { handle, start: place, way: [0, 0, 0], grip: place.clone().sub(onSheet(event)) };
    space.canvas.setPointerCapture(event.pointerId); space.canvas.style.cursor = "grabbing";
  };
  const move = (event) => {
    if (!drag) { if (!event.buttons && own) hover(under(event)); return; }
    event.stopPropagation();
    const at = onSheet(event);
    if (!at) return;
    moveTo(at.add(drag.grip).sub(drag.start).toArray()); words();
    timed(event.timeStamp);
  };
  const timed = (since) => { // from the event to the picture
    if (drag.asked) return;
    drag.asked = true;
    requestAnimationFrame(() => requestAnimationFrame(() => {
      if (drag) drag.asked = false;
      document.body.dataset.frame = (performance.now() - since).toFixed(1);
    }));
  };
  const drop = (event) => {
    if (!drag) return;
    event?.stopPropagation();
    const { handle, way } = drag;
    space.canvas.style.cursor = "";
    if (way.some((each) => each)) commit(handle, way);
    else drag = null;
  };
  const commit = async (handle, way) => { // the step goes to the server; what is shown stays
    base = { vertices: own.vertices.slice(), jets: own.jets.map((each) => each.slice()) };
    drag = null; busy = true;
    const found = await send("move", { [handle.kind]: handle.number, by: way.map((each) => each * scene.scale) });
    busy = false;
    if (!found) picture = -1;
  };
  const cancel = () => { if (drag) { follow(drag.handle, [0, 0, 0]); drag = null; clearTimeout(timer); } };

  let timer = 0;
  const finishKeys = () => { if (drag?.keys) { clearTimeout(timer); drop(); } };
  const keyStep = (right, up, near) => {
    const step = Number($("step").value), m = space.camera.matrixWorld.elements;
    if (!drag) drag = { handle: chosen, way: [0, 0, 0], keys: true };
    moveTo(drag.way.map((each, k) => each + step * (right * m[k] + up * m[4 + k] + near * m[8 + k])));
    words(); clearTimeout(timer); timer = setTimeout(finishKeys, IDLE);
  };
  const KEYS = { ArrowLeft: [-1, 0, 0], ArrowRight: [1, 0, 0], ArrowUp: [0, 1, 0], ArrowDown: [0, -1, 0], PageUp: [0, 0, -1], PageDown: [0, 0, 1] };
  let leaving = false;
  const key = (event) => {
    if (!own || event.ctrlKey || event.metaKey || event.altKey) return;
    if (event.key === "Tab" && !leaving) {
      event.preventDefault(); event.stopPropagation();
      const n = count(), from = chosen?.kind === kind() ? chosen.number : event.shiftKey ? 0 : -1;
      choose({ kind: kind(), number: (from + (event.shiftKey ? n - 1 : 1)) % n });
    } else if (event.key === "Escape") {
      if (drag) cancel();
      else { choose(null); leaving = true; }
    } else if (chosen && KEYS[event.key]) {
      event.preventDefault(); event.stopPropagation();
      if (!busy && (!drag || drag.keys)) keyStep(...KEYS[event.key]);
    }
  };
  const anywhere = (event) => {
    if (!(event.ctrlKey || event.metaKey)) return;
    const name = { z: event.shiftKey ? "redo" : "undo", y: "redo", s: "save" }[event.key.toLowerCase()];
    if (!name) return;
    event.preventDefault();
    if (!$(name).disabled) act(name);
  };
  const act = async (name) => { finishKeys(); await send(name, {}); };

  // ---- how it is fitted ----

  const sized = (share) => Math.round(state.sizes[0] * (state.sizes[1] / state.sizes[0]) ** share);
  const options = (id, names) => { if ($(id).options.length !== names.length) $(id).replaceChildren(...names.map((each) => new Option(each, each))); };
  const choices = () => {
    options("basis", state.bases); options("fitter", state.fitters);
    const busyWith = document.activeElement?.id;
    if (busyWith !== "basis") $("basis").value = state.basis;
    if (busyWith !== "fitter") $("fitter").value = state.fitter;
    if (!sliding) {
      $("size").value = Math.log(state.size / state.sizes[0]) / Math.log(state.sizes[1] / state.sizes[0]);
      $("size-told").textContent = state.size ?? "";
      $("size").disabled = state.size === null;
      $("auto").checked = state.fairing === null; $("fairing").disabled = state.fairing === null;
      if (state.fairing !== null) $("fairing").value = Math.log10(Math.max(state.fairing, 1e-9));
      $("fairing-told").textContent = state.fairing === null ? "" : state.fairing.toPrecision(2);
    }
  };
  let sliding = false;
  const fairing = () => Number((10 ** Number($("fairing").value)).toPrecision(3));
  const wireFit = () => {
    for (const id of ["basis", "fitter"]) $(id).addEventListener("change", () => { $(id).blur(); send("set", { [id]: $(id).value }); });
    for (const id of ["size", "fairing"]) {
      $(id).addEventListener("input", () => { sliding = true; $(`${id}-told`).textContent = id === "size" ? sized(Number($(id).value)) : fairing().toPrecision(2); });
      $(id).addEventListener("change", async () => { await send("set", { [id]: id === "size" ? sized(Number($(id).value)) : fairing() }); sliding = false; });
    }
    $("auto").addEventListener("change", () => send("set", { fairing: $("auto").checked ? null : fairing() }));
  };

  const begin = () => {
    const link = (hit) => {
      for (const each of [space, plane]) each.dot.visible = Boolean(hit && each.mesh && !drag && !hovered);
      if (hit && own) {
        space.dot.position.copy(space.at(hit.face, hit.weights)); space.dot.scale.setScalar(0.009);
        if (plane.mesh) { plane.dot.position.copy(plane.at(hit.face, hit.weights)); plane.dot.scale.setScalar(0.016 * (plane.half || 1) / plane.camera.zoom); }
      }
      space.draw(); plane.draw();
    };
    const both = { changed: remember, hovered: link, sharpened: () => own && marks() };
    try { space = new Pane("space", false, both); plane = new Pane("plane", true, both); }
    catch { failed("this browser shows no WebGL; switch it on, or take another browser"); return; }
    surfaceMaterial = material(false);
    for (const id of shown) if (id in kept) $(id).type === "checkbox" ? $(id).checked = kept[id] : $(id).value = kept[id];
    chosen = kept.chosen || null;
    const pane = space.canvas.parentElement;
    for (const [name, act_] of [["pointerdown", press], ["pointermove", move], ["pointerup", drop], ["pointercancel", cancel], ["keydown", key]]) pane.addEventListener(name, act_, { capture: true });
    space.canvas.addEventListener("pointerleave", () => { if (!drag && own) hover(null); });
    space.canvas.addEventListener("blur", () => { leaving = false; finishKeys(); if (scene) words(); });
    space.canvas.addEventListener("focus", () => { leaving = false; if (own) words(); });
    addEventListener("keydown", anywhere);
    addEventListener("beforeunload", (event) => { if (state?.unsaved && !ended) { event.preventDefault(); event.returnValue = ""; } });
    for (const id of shown) $(id).addEventListener("input", () => { if (id === "what") choose(null); if (own) look(); });
    for (const id of ["undo", "redo", "save"]) $(id).addEventListener("click", () => act(id));
    $("home").addEventListener("click", () => { if (scene) home(); remember(); });
    $("shot").addEventListener("click", () => Panes.screenshot([space, plane].filter((each) => each.mesh), scene.name, say));
    for (const id of ["bar", "fit"]) $(id).addEventListener("submit", (event) => event.preventDefault());
    wireFit();
    const first = setInterval(() => { if (own) { clearInterval(first); look(); document.body.dataset.drawn = "true"; } }, 30);
    poll();
  };
  begin();
})();
