"use strict";
(() => {
  const { RISING, DIVERGING, CLAY, $, decoded, floats, colourOf, Pane, cornersOf, material, lines, tints, clear, pairs, failed, valueOf } = Panes;
  const told = $("told");
  const controls = ["part", "colour", "surface", "edges", "input", "zebra", "axis", "depth"];
  const kept = Panes.memory.load();
  let scenes = [], scene = null, space, plane, surfaceMaterial, inputMaterial, parts = {}, lineMaterials = [];

  const remember = () => {
    if (!space || !scene) return;
    Panes.memory.save({ ...Object.fromEntries(controls.map((id) => [id, valueOf(id)])), space: Panes.viewOf(space), plane: Panes.viewOf(plane) });
  };
  const cuttable = (found) => { lineMaterials.push(found.material); return found; };

  const build = (chosen) => {
    scene = chosen; lineMaterials = []; clear(space); clear(plane);
    const geometry = pairs(floats(scene.position));
    geometry.setIndex(new THREE.BufferAttribute(decoded(scene.index, Uint32Array), 1));
    if (scene.normal) geometry.setAttribute("normal", new THREE.BufferAttribute(floats(scene.normal), 3));
    else geometry.computeVertexNormals();
    tints(geometry, geometry.attributes.position.count);
    parts = { surface: new THREE.Mesh(geometry, surfaceMaterial) };
    space.mesh = parts.surface;
    if (scene.edges) parts.edges = cuttable(lines(scene.edges, 0x14202c, 0.75));
    const input = pairs(floats(scene.input.position));
    input.computeVertexNormals();
    tints(input, input.attributes.position.count).attributes.tint.array.fill(0.82);
    parts.input = new THREE.Group();
    parts.input.add(new THREE.Mesh(input, inputMaterial), cuttable(lines(scene.input.lines, 0xb8450a, 1)));
    space.things.add(...Object.values(parts));
    $("plane").hidden = !scene.xh;
    if (scene.xh) Panes.buildPlane(plane, scene.xh);
    $("colour").replaceChildren(new Option("plain", ""), ...scene.values.map((value) => new Option(value.name, value.name)));
    views();
  };
  const views = () => Panes.views(space, plane, scene.xh);

  const paint = () => {
    const value = scene.values.find((each) => each.name === $("colour").value);
    const numbers = value && floats(value.data), stops = value?.kind === "diverging" ? DIVERGING : RISING;
    const tint = (v, target, at) => {
      let colour = CLAY;
      if (numbers && !Number.isFinite(numbers[v])) colour = [150, 150, 150];
      else if (numbers) colour = colourOf(stops, (numbers[v] - value.low) / (value.high - value.low || 1));
      for (let j = 0; j < 3; j++) target[at + j] = colour[j] / 255;
    };
    const own = parts.surface.geometry.attributes.tint;
    for (let v = 0; v < own.count; v++) tint(v, own.array, 3 * v);
    own.needsUpdate = true;
    if (plane.mesh) Panes.paintPlane(plane, parts.surface.geometry.index.array, own.array);
    $("scale").hidden = !value;
    if (value) {
      $("scale").className = value.kind; $("scale-title").textContent = value.title;
      $("low").textContent = value.low.toPrecision(3); $("high").textContent = value.high.toPrecision(3);
    }
  };

  const show = () => {
    paint();
    parts.surface.visible = $("surface").checked;
    if (parts.edges) parts.edges.visible = $("edges").checked;
    parts.input.visible = $("input").checked;
    surfaceMaterial.uniforms.zebra.value = $("zebra").checked;
    const axis = "xyz".indexOf($("axis").value || "-"), depth = Number($("depth").value);
    $("depth").disabled = axis < 0;
    const way = [0, 1, 2].map((k) => k === axis ? 1 : 0);
    for (const each of [surfaceMaterial, inputMaterial]) Object.assign(each.uniforms.cut.value.set(...way), { w: axis < 0 ? 9 : depth });
    const planes = axis < 0 ? [] : [new THREE.Plane(new THREE.Vector3(...way).negate(), depth)];
    for (const each of lineMaterials) each.clippingPlanes = planes;
    space.renderer.localClippingEnabled = true;
    space.draw(); plane.draw(); remember();
  };

  const link = (hit) => {
    for (const pane of [space, plane]) pane.dot.visible = Boolean(hit && pane.mesh);
    if (hit) {
      const place = space.at(hit.face, hit.weights);
      space.dot.position.copy(place); space.dot.scale.setScalar(0.009);
      let words = "";
      if (plane.mesh) {
        plane.dot.position.copy(plane.at(hit.face, hit.weights)); plane.dot.scale.setScalar(0.016 * (plane.half || 1) / plane.camera.zoom);
      }
      const corners = cornersOf(parts.surface.geometry, hit.face);
      for (const value of scene.values) {
        value.numbers ??= floats(value.data);
        words += `\n${value.name} ${corners.reduce((sum, v, k) => sum + hit.weights[k] * value.numbers[v], 0).toPrecision(4)}`;
      }
      told.textContent = `(${[...place].map((x, k) => (scene.origin[k] + scene.scale * x).toPrecision(5)).join(", ")})${words}`;
    } else told.textContent = about();
    space.draw(); plane.draw();
  };
  const about = () => `input: ${scene.input.words}`;
  const screenshot = () => Panes.screenshot([space, plane].filter((pane) => pane.mesh), scene.name, (words) => { told.textContent = words; });

  const begin = (found) => {
    scenes = found;
    const heard = { changed: remember, hovered: link };
    try { space = new Pane("space", false, heard); plane = new Pane("plane", true, heard); }
    catch { failed("this browser shows no WebGL; switch it on, or take another browser"); return; }
    surfaceMaterial = material(false); inputMaterial = material(true);
    space.cut = surfaceMaterial.uniforms.cut.value;
    $("part").replaceChildren(...scenes.map((each, k) => new Option(String(k + 1), String(k))));
    $("part-label").hidden = scenes.length < 2;
    const first = scenes[Number(kept.part) || 0] || scenes[0];
    build(first); $("name").textContent = first.name;
    for (const id of controls) if (id in kept) $(id).type === "checkbox" ? $(id).checked = kept[id] : $(id).value = kept[id];
    Panes.recall(space, kept.space); Panes.recall(plane, kept.plane);
    told.textContent = about(); show();
    $("part").addEventListener("change", () => { build(scenes[Number($("part").value)]); $("name").textContent = scene.name; told.textContent = about(); show(); });
    for (const id of controls.slice(1)) $(id).addEventListener("input", show);
    $("home").addEventListener("click", () => { views(); remember(); });
    $("shot").addEventListener("click", screenshot);
    $("bar").addEventListener("submit", (event) => event.preventDefault());
    document.body.dataset.state = "ready";
  };

  const wait = async () => {
    try {
      const state = await (await fetch("state.json")).json();
      $("name").textContent = state.name;
      if (state.error) return failed(state.error);
      if (state.ready) return begin(await (await fetch("scenes.json")).json());
      told.textContent = `at work\n${state.stages.map(([stage, seconds]) => seconds === null ? `${stage} …` : `${stage} ${seconds} s`).join("\n")}`;
    } catch { return failed("the command that served this page has ended; run it again"); }
    setTimeout(wait, 300);
  };
  if (window.SCENES) begin(window.SCENES); else wait();
})();
