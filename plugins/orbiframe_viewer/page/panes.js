"use strict";
// What the pages of the viewer and of the editor share: panes with cameras, materials, colours, numbers of the server.
const Panes = (() => {
  const RISING = [[68, 1, 84], [59, 82, 139], [33, 145, 140], [94, 201, 98], [253, 231, 37]];
  const DIVERGING = [[11, 79, 138], [120, 170, 205], [214, 217, 220], [230, 165, 110], [184, 69, 10]];
  const CLAY = [176, 196, 216];
  const WARM = [CLAY, [196, 205, 170], [243, 214, 95], [238, 140, 45], [200, 45, 20]];
  const FRAME = 34, REST = 250, COARSEST = 0.5; // milliseconds a picture, milliseconds until a movement is over, least share
  const $ = (id) => document.getElementById(id);
  const decoded = (text, kind) => {
    const bytes = Uint8Array.from(atob(text), (letter) => letter.charCodeAt(0));
    return new kind(bytes.buffer);
  };
  const floats = (text) => decoded(text, Float32Array);
  const colourOf = (stops, share) => {
    const place = 4 * Math.min(Math.max(share, 0), 1), k = Math.min(Math.floor(place), 3), t = place - k;
    return stops[k].map((each, j) => (1 - t) * each + t * stops[k + 1][j]);
  };

  // Whether the processor draws, and no graphics card. Then samples within pixels cost most of the time: pictures at rest have four
  // pixels for one instead, and those of a movement none. Chromium calls no renderer slow that was asked for by name.
  let slowly = null; // known once
  const byProcessor = () => {
    const gl = document.createElement("canvas").getContext("webgl2"), known = gl?.getExtension("WEBGL_debug_renderer_info");
    const name = known ? gl.getParameter(known.UNMASKED_RENDERER_WEBGL) : gl?.getParameter(gl.RENDERER);
    gl?.getExtension("WEBGL_lose_context")?.loseContext();
    return /swiftshader|llvmpipe|softpipe|software|basic render/i.test(name || "");
  };

  // ---- the two panes: a canvas each, with its camera ----

  const VERTEX = `
    attribute vec3 tint; varying vec3 vTint, vNormal, vView, vPlace;
    void main() {
      vTint = tint; vPlace = position; vNormal = normalMatrix * normal;
      vec4 seen = modelViewMatrix * vec4(position, 1.0); vView = seen.xyz; gl_Position = projectionMatrix * seen;
    }`;
  const FRAGMENT = `
    uniform bool zebra, flat_; uniform vec4 cut; varying vec3 vTint, vNormal, vView, vPlace;
    void main() {
      if (dot(cut.xyz, vPlace) > cut.w) discard;
      vec3 n = flat_ ? normalize(cross(dFdx(vView), dFdy(vView))) : normalize(vNormal);
      if (dot(n, vView) > 0.0) n = -n;
      float light = 0.42 + 0.62 * max(dot(n, normalize(vec3(-0.35, 0.55, 0.76))), 0.0);
      vec3 colour = vTint * light;
      if (zebra) {
        vec3 r = reflect(normalize(vView), n);
        float stripe = sin(26.0 * asin(clamp(r.y, -1.0, 1.0)));
        float width = fwidth(stripe);
        colour *= mix(0.12, 1.08, smoothstep(-width, width, stripe));
      }
      gl_FragColor = vec4(gl_FrontFacing ? colour : colour * 0.72, 1.0);
    }`;

  class Pane {
    constructor(id, flat, heard) { // heard: changed() of the view, hovered(hit or null, pane)
      this.heard = heard;
      const antialias = !(slowly ??= byProcessor());
      this.whole = antialias ? 1 : 2 / Math.min(devicePixelRatio, 2); // of the pixels along a side at rest
      this.share = this.whole; this.slow = 0; // of the pixels now; pictures in a row that took long
      this.canvas = $(id).querySelector("canvas");
      this.canvas.dataset.rest = true;
      this.renderer = new THREE.WebGLRenderer({ canvas: this.canvas, antialias, alpha: true });
      this.renderer.setClearColor(0, 0);
      this.scene = new THREE.Scene();
      this.things = new THREE.Group();
      this.scene.add(this.things);
      this.dot = new THREE.Mesh(new THREE.SphereGeometry(1, 16, 12), new THREE.MeshBasicMaterial({ color: 0xff3b1f, depthTest: false }));
      this.dot.renderOrder = 9; this.dot.visible = false;
      this.scene.add(this.dot);
      this.camera = flat ? new THREE.OrthographicCamera(-1, 1, 1, -1, -50, 50) : new THREE.PerspectiveCamera(32, 1, 0.01, 50);
      this.orbit = new THREE.OrbitControls(this.camera, this.canvas);
      this.orbit.addEventListener("change", () => { this.draw(); heard.changed(); });
      this.canvas.addEventListener("keydown", (event) => this.key(event));
      this.canvas.addEventListener("pointermove", (event) => this.pointed(event));
      this.canvas.addEventListener("pointerleave", () => heard.hovered(null, this));
      new ResizeObserver(() => this.fit()).observe(this.canvas.parentElement);
      this.ray = new THREE.Raycaster();
    }
    look(position, up, spin) {
      this.orbit.target.set(0, 0, 0);
      this.camera.up.set(...up); this.camera.position.set(...position); this.camera.zoom = 1;
      this.orbit.enableRotate = spin;
      this.orbit.mouseButtons = spin ? { LEFT: 0, MIDDLE: 1, RIGHT: 2 } : { LEFT: 2, MIDDLE: 1, RIGHT: 2 };
      this.orbit.touches = spin ? { ONE: 0, TWO: 2 } : { ONE: 1, TWO: 2 };
      this.spin = spin;
      this.fit(); this.orbit.update();
    }
    fit() {
      const { clientWidth: w, clientHeight: h } = this.canvas.parentElement;
      if (!w || !h) return;
      this.renderer.setPixelRatio(this.ratio());
      this.renderer.setSize(w, h, false);
      if (this.camera.isPerspectiveCamera) {
        this.camera.aspect = w / h;
        this.camera.fov = 360 / Math.PI * Math.atan(Math.tan(Math.PI * 16 / 180) / Math.min(w / h, 1)); // 32 for the shorter side
      }
      else {
        const half = this.half || 1.08, x = w > h ? half * w / h : half, y = w > h ? half : half * h / w;
        Object.assign(this.camera, { left: -x, right: x, top: y, bottom: -y });
      }
      this.camera.updateProjectionMatrix();
      this.draw();
    }
    ratio() { return this.share * Math.min(devicePixelRatio, 2); }
    draw() {
      if (this.asked) return;
      this.asked = requestAnimationFrame(() => { this.asked = 0; this.renderer.render(this.scene, this.camera); this.paced(); });
    }
    // Where pictures take long, those of a movement have fewer pixels, and the picture at rest has all of them.
    paced() {
      if (this.rest && this.share > 1) this.sharpen(1);
      clearTimeout(this.rest);
      this.rest = setTimeout(() => { this.rest = 0; if (this.share < this.whole) this.sharpen(this.whole); }, REST);
      const start = performance.now();
      requestAnimationFrame(() => {
        const slow = performance.now() - start > FRAME;
        this.slow = slow ? this.slow + 1 : 0;
        if (this.slow >= 2 && this.share > COARSEST) this.sharpen(Math.max(0.7 * this.share, COARSEST));
      });
    }
    sharpen(share) {
      this.share = share; this.slow = 0;
      this.canvas.dataset.rest = share === this.whole;
      this.fit(); this.heard.sharpened?.();
    }
    key(event) {
      const step = 0.12, c = this.camera, t = this.orbit.target;
      const turn = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, 1], ArrowDown: [0, -1] }[event.key];
      const zoom = { "+": 1.15, "=": 1.15, "-": 1 / 1.15 }[event.key];
      if (!turn && !zoom) return;
      event.preventDefault();
      if (turn && this.spin) {
        const way = c.position.clone().sub(t), side = way.clone().cross(c.up).normalize();
        way.applyAxisAngle(c.up, step * turn[0]);
        const high = way.angleTo(c.up) - step * turn[1];
        if (high > 0.05 && high < 3.09) way.applyAxisAngle(side, step * turn[1]);
        c.position.copy(t).add(way);
      } else if (turn) {
        const move = new THREE.Vector3(turn[0], turn[1], 0).multiplyScalar(0.1 / c.zoom);
        c.position.add(move); t.add(move);
      }
      if (zoom && c.isPerspectiveCamera) c.position.sub(t).divideScalar(zoom).add(t);
      else if (zoom) { c.zoom *= zoom; c.updateProjectionMatrix(); }
      this.orbit.update(); this.draw(); this.heard.changed();
    }
    pointed(event) {
      if (event.buttons || this.waiting || !this.mesh) return;
      this.waiting = true;
      requestAnimationFrame(() => {
        this.waiting = false;
        const box = this.canvas.getBoundingClientRect();
        const at = new THREE.Vector2(2 * (event.clientX - box.left) / box.width - 1, 1 - 2 * (event.clientY - box.top) / box.height);
        this.ray.setFromCamera(at, this.camera);
        const found = this.mesh.visible ? this.ray.intersectObject(this.mesh, false) : [], cut = this.cut;
        const hit = found.find((each) => !cut || each.point.dot(cut) <= cut.w);
        this.heard.hovered(hit ? { face: hit.faceIndex, weights: weightsOf(this.mesh.geometry, hit.faceIndex, hit.point) } : null, this);
      });
    }
    at(face, weights) {
      const sum = new THREE.Vector3(), corner = new THREE.Vector3();
      cornersOf(this.mesh.geometry, face).forEach((v, k) => sum.addScaledVector(corner.fromBufferAttribute(this.mesh.geometry.attributes.position, v), weights[k]));
      return sum;
    }
  }

  const cornersOf = (geometry, face) => [0, 1, 2].map((k) => geometry.index ? geometry.index.getX(3 * face + k) : 3 * face + k);
  const weightsOf = (geometry, face, point) => {
    const [a, b, c] = cornersOf(geometry, face).map((v) => new THREE.Vector3().fromBufferAttribute(geometry.attributes.position, v));
    const u = b.clone().sub(a), v = c.clone().sub(a), w = point.clone().sub(a), n = u.clone().cross(v), size = n.lengthSq() || 1;
    const s = w.clone().cross(v).dot(n) / size, t = u.clone().cross(w).dot(n) / size;
    return [1 - s - t, s, t];
  };

  const material = (flat) => new THREE.ShaderMaterial({
    vertexShader: VERTEX, fragmentShader: FRAGMENT, side: THREE.DoubleSide, polygonOffset: true, polygonOffsetFactor: 1, polygonOffsetUnits: 1,
    uniforms: { zebra: { value: false }, flat_: { value: flat }, cut: { value: Object.assign(new THREE.Vector3(), { w: 9 }) } },
  });
  const lines = (text, colour, opacity) => {
    const geometry = new THREE.BufferGeometry().setAttribute("position", new THREE.BufferAttribute(floats(text), 3));
    const look = new THREE.LineBasicMaterial({ color: colour, transparent: opacity < 1, opacity });
    return new THREE.LineSegments(geometry, look);
  };
  const tints = (geometry, count) => geometry.setAttribute("tint", new THREE.BufferAttribute(new Float32Array(3 * count), 3));
  const clear = (pane) => { pane.things.traverse((each) => each.geometry?.dispose()); pane.things.clear(); pane.mesh = null; };
  const pairs = (array) => new THREE.BufferGeometry().setAttribute("position", new THREE.BufferAttribute(array, 3));

  // ---- X/H beside the surface: one lift of every triangle, the edges of the input, and copies round about ----

  const CAPTIONS = { h2: "X/H in the hyperbolic disc", e2: "X/H in the plane", s2: "X/H on the sphere" };
  const buildPlane = (plane, xh) => {
    const flat = pairs(floats(xh.position));
    tints(flat, flat.attributes.position.count);
    plane.mesh = new THREE.Mesh(flat, new THREE.MeshBasicMaterial({ vertexColors: true, side: THREE.DoubleSide, polygonOffset: true, polygonOffsetFactor: 2, polygonOffsetUnits: 2 }));
    plane.things.add(plane.mesh, lines(xh.far, 0x8a8f94, 0.55), lines(xh.edges, 0x14202c, 0.8));
    if (xh.geometry === "h2") {
      const rim = [];
      for (let k = 0; k < 256; k++) for (const j of [k, k + 1]) rim.push(Math.cos(Math.PI * j / 128), Math.sin(Math.PI * j / 128), 0);
      plane.things.add(new THREE.LineSegments(pairs(new Float32Array(rim)), new THREE.LineBasicMaterial({ color: 0x8a8f94 })));
    }
    flat.computeBoundingSphere();
    plane.half = xh.geometry === "e2" ? 1.25 * (flat.boundingSphere.radius + flat.boundingSphere.center.length()) : 1.08;
    $("xh-name").textContent = CAPTIONS[xh.geometry];
  };
  const views = (space, plane, xh) => {
    space.look([0.75, -1.3, 1.5], [0, 0, 1], true);
    const sphere = xh?.geometry === "s2";
    plane.look(sphere ? [0.6, -1.4, 2.6] : [0, 0, 5], sphere ? [0, 0, 1] : [0, 1, 0], sphere);
  };
  // The colours of a surface (of vertices, three numbers each) on the triangles of X/H.
  const paintPlane = (plane, index, tint) => {
    const colours = new Float32Array(3 * index.length);
    for (let k = 0; k < index.length; k++) for (let j = 0; j < 3; j++) colours[3 * k + j] = tint[3 * index[k] + j] ** 2.2;
    plane.mesh.geometry.setAttribute("color", new THREE.BufferAttribute(colours, 3));
  };

  // ---- what a reload keeps ----

  const memory = { // a frame without an origin of its own has none
    load() { try { return JSON.parse(sessionStorage.getItem(location.pathname) || "{}"); } catch { return {}; } },
    save(what) { try { sessionStorage.setItem(location.pathname, JSON.stringify(what)); } catch { /* no memory */ } },
  };
  const valueOf = (id) => $(id).type === "checkbox" ? $(id).checked : $(id).value;
  const viewOf = (pane) => [...pane.camera.position, ...pane.orbit.target, pane.camera.zoom];
  const recall = (pane, numbers) => {
    if (!numbers) return;
    pane.camera.position.set(...numbers.slice(0, 3)); pane.orbit.target.set(...numbers.slice(3, 6));
    pane.camera.zoom = numbers[6]; pane.camera.updateProjectionMatrix(); pane.orbit.update(); pane.draw();
  };

  const screenshot = (shown, name, said) => {
    const sheet = document.createElement("canvas");
    for (const pane of shown) { pane.sharpen(pane.whole); pane.renderer.render(pane.scene, pane.camera); }
    sheet.width = shown.reduce((sum, pane) => sum + pane.canvas.width, 0); sheet.height = Math.max(...shown.map((pane) => pane.canvas.height));
    const brush = sheet.getContext("2d");
    brush.fillStyle = getComputedStyle(document.body).backgroundColor; brush.fillRect(0, 0, sheet.width, sheet.height);
    let left = 0;
    for (const pane of shown) { pane.renderer.render(pane.scene, pane.camera); brush.drawImage(pane.canvas, left, 0); left += pane.canvas.width; }
    sheet.toBlob((blob) => {
      const saved = Object.assign(document.createElement("a"), { href: URL.createObjectURL(blob), download: `${name}.png` });
      saved.click(); said(`${saved.download} saved`);
      setTimeout(() => URL.revokeObjectURL(saved.href), 5000);
    });
  };
  const failed = (words) => { $("told").classList.add("error"); $("told").textContent = words; document.body.dataset.state = "failed"; };

  return { RISING, DIVERGING, CLAY, WARM, $, decoded, floats, colourOf, Pane, cornersOf, weightsOf, material, lines, tints, clear, pairs,
    buildPlane, views, paintPlane, memory, valueOf, viewOf, recall, screenshot, failed };
})();
