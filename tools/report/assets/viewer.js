"use strict";
// The interactive view: surfaces of each frame, unpacked when first shown, drawn only when something changed.
(() => {
  const data = JSON.parse(document.getElementById("view-data").textContent);
  const figure = document.getElementById("viewer");
  const stage = figure.querySelector(".stage"), canvas = figure.querySelector("canvas");
  const overlay = figure.querySelector("svg"), caption = figure.querySelector(".caption");
  const slider = figure.querySelector(".frame"), play = figure.querySelector(".play");
  const [low, high] = data.bounds.map((corner) => new THREE.Vector3(...corner));
  const centre = low.clone().add(high).multiplyScalar(0.5), radius = high.distanceTo(low) / 2;
  const HOME = { turn: -1.07, rise: 0.41 };

  let renderer;
  try {
    const context = canvas.getContext("webgl", { antialias: true });
    if (!context) throw new Error("no WebGL");
    renderer = new THREE.WebGLRenderer({ canvas, context });
  } catch (error) {
    figure.classList.add("off");
    figure.textContent = "This browser has no WebGL, which the turning view needs; the pictures below show the same sample.";
    return;
  }
  renderer.setClearColor(0xffffff);
  const scene = new THREE.Scene();
  const camera = new THREE.OrthographicCamera(-1, 1, 1, -1, 0.1 * radius, 8 * radius);
  camera.up.set(0, 0, 1);
  const lamp = new THREE.DirectionalLight(0xffffff, 0.62);
  scene.add(new THREE.HemisphereLight(0xffffff, 0xb9c2cf, 0.55), lamp, lamp.target);

  const view = { ...HOME, zoom: 1, focus: centre.clone() };
  const state = { frame: data.start, sampleOpacity: data.opacity, shown: {} };

  // ---- surfaces ------------------------------------------------------------------------------------------------------
  const bytes = (text) => Uint8Array.from(atob(text), (letter) => letter.charCodeAt(0)).buffer;

  function geometryOf(packed, colourOf) {
    const steps = new Uint16Array(bytes(packed.points)), points = new Float32Array(steps.length);
    const size = [high.x - low.x, high.y - low.y, high.z - low.z], corner = [low.x, low.y, low.z];
    for (let k = 0; k < steps.length; ++k) points[k] = corner[k % 3] + (steps[k] / 65535) * size[k % 3];
    const colours = new Uint8Array(steps.length), mix = new THREE.Color();
    let next = 0;
    for (const [number, count] of packed.bodies) {
      mix.set(colourOf[number]);
      for (let k = 0; k < count; ++k) colours.set([mix.r * 255, mix.g * 255, mix.b * 255], 3 * next++);
    }
    const geometry = new THREE.BufferGeometry();
    geometry.setAttribute("position", new THREE.BufferAttribute(points, 3));
    geometry.setAttribute("color", new THREE.BufferAttribute(colours, 3, true));
    const triangles = bytes(packed.triangles);
    geometry.setIndex(new THREE.BufferAttribute(packed.wide ? new Uint32Array(triangles) : new Uint16Array(triangles), 1));
    geometry.computeVertexNormals();
    return geometry;
  }

  // A translucent skin is denser where it is seen at a slant, as glass is.
  function skin(side) {
    const material = new THREE.MeshPhongMaterial({ vertexColors: THREE.VertexColors, side, transparent: true, depthWrite: false,
      shininess: 18, specular: 0x181818 });
    material.onBeforeCompile = (shader) => {
      shader.fragmentShader = shader.fragmentShader.replace("gl_FragColor = vec4( outgoingLight, diffuseColor.a );",
        "float slant = 1.0 - abs( normalize( normal ).z );\n" +
        "gl_FragColor = vec4( outgoingLight, diffuseColor.a * clamp( 0.45 + 1.6 * slant * slant, 0.0, 1.0 ) );");
    };
    return material;
  }
  const solid = new THREE.MeshPhongMaterial({ vertexColors: THREE.VertexColors, side: THREE.DoubleSide, shininess: 18,
    specular: 0x181818 });
  const back = skin(THREE.BackSide), front = skin(THREE.FrontSide);

  const layers = data.layers.map((layer) => ({ ...layer, geometries: {}, group: new THREE.Group() }));
  for (const layer of layers) {
    scene.add(layer.group);
    state.shown[layer.name] = true;
  }

  function showSurface(layer) {
    const packed = layer.frames[state.frame];
    const translucent = layer.kind === "sample" && state.sampleOpacity < 0.995;
    layer.group.visible = state.shown[layer.name] && packed !== null && !(translucent && state.sampleOpacity < 0.005);
    layer.group.children.length = 0;
    if (!layer.group.visible) return;
    const geometry = (layer.geometries[state.frame] = layer.geometries[state.frame] || geometryOf(packed, layer.colours));
    if (!translucent) {
      layer.group.add(new THREE.Mesh(geometry, solid));
      return;
    }
    [back, front].forEach((material, order) => {
      material.opacity = state.sampleOpacity;
      const mesh = new THREE.Mesh(geometry, material);
      mesh.renderOrder = 1 + order;
      layer.group.add(mesh);
    });
  }

  const edges = new THREE.LineSegments(
    new THREE.EdgesGeometry(new THREE.BoxGeometry(...data.box[1].map((value, axis) => value - data.box[0][axis]))),
    new THREE.LineBasicMaterial({ color: 0xaab2bd }));
  edges.position.set(...data.box[0].map((value, axis) => (value + data.box[1][axis]) / 2));
  scene.add(edges);
  state.shown["first frame's box"] = true;

  // ---- drawing -------------------------------------------------------------------------------------------------------
  function svg(name, attributes, text) {
    const element = document.createElementNS("http://www.w3.org/2000/svg", name);
    for (const [key, value] of Object.entries(attributes)) element.setAttribute(key, value);
    if (text !== undefined) element.textContent = text;
    overlay.append(element);
    return element;
  }

  function lengthText(mm) {
    for (const [factor, unit] of [[1e-3, "m"], [1, "mm"], [1e3, "µm"], [1e6, "nm"]])
      if (mm * factor >= 0.9995) return `${+(mm * factor).toPrecision(3)} ${unit}`;
    return `${+(mm * 1e6).toPrecision(3)} nm`;
  }

  function drawOverlay(width, height, mmPerPixel) {
    overlay.replaceChildren();
    const limit = Math.min(0.25 * width, 200) * mmPerPixel, power = 10 ** Math.floor(Math.log10(limit));
    const bar = ([5, 2].find((digit) => digit * power <= limit) || 1) * power, pixels = bar / mmPerPixel;
    svg("rect", { x: 18, y: height - 22, width: pixels, height: 4, fill: "#28303c" });
    svg("text", { x: 18 + pixels / 2, y: height - 29, "text-anchor": "middle" }, lengthText(bar));

    const inverse = camera.quaternion.clone().inverse(), origin = [width - 56, height - 48];
    const axes = [["x", "#b03a2e"], ["y", "#1e8449"], ["z", "#2459a8"]].map(([name, colour], axis) => {
      const seen = new THREE.Vector3(+(axis === 0), +(axis === 1), +(axis === 2)).applyQuaternion(inverse);
      return { name, colour, seen };
    });
    axes.sort((a, b) => a.seen.z - b.seen.z);
    for (const { name, colour, seen } of axes) {
      const [x, y] = [origin[0] + 32 * seen.x, origin[1] - 32 * seen.y];
      svg("line", { x1: origin[0], y1: origin[1], x2: x, y2: y, stroke: colour, "stroke-width": 2.4, "stroke-linecap": "round" });
      const length = Math.hypot(seen.x, seen.y), beyond = length > 0.05 ? 11 / length : 0;
      svg("text", { x: x + beyond * seen.x, y: y - beyond * seen.y + 4.5, fill: colour, "text-anchor": "middle" }, name);
    }

    if (!state.shown.events) return;
    for (const event of data.events.filter((one) => one.frame === state.frame)) {
      const place = new THREE.Vector3(...event.place).project(camera);
      const [x, y] = [((place.x + 1) / 2) * width, ((1 - place.y) / 2) * height];
      svg("circle", { cx: x, cy: y, r: 11, fill: "none", stroke: "#b5179e", "stroke-width": 2.2 });
      svg("text", { x: x + 15, y: y + 4, fill: "#b5179e" }, event.name);
    }
  }

  let waiting = false;
  function redraw() {
    if (waiting) return;
    waiting = true;
    requestAnimationFrame(draw);
  }

  function draw() {
    waiting = false;
    const width = stage.clientWidth, height = stage.clientHeight;
    if (width === 0 || height === 0) return;
    renderer.setPixelRatio(Math.min(2, window.devicePixelRatio || 1));
    renderer.setSize(width, height, false);
    const mmPerPixel = (2.04 * radius) / Math.min(width, height) / view.zoom;
    const towards = new THREE.Vector3(Math.cos(view.rise) * Math.cos(view.turn), Math.cos(view.rise) * Math.sin(view.turn),
      Math.sin(view.rise));
    camera.position.copy(view.focus).addScaledVector(towards, 4 * radius);
    camera.lookAt(view.focus);
    [camera.left, camera.right] = [(-width / 2) * mmPerPixel, (width / 2) * mmPerPixel];
    [camera.bottom, camera.top] = [(-height / 2) * mmPerPixel, (height / 2) * mmPerPixel];
    camera.updateProjectionMatrix();
    camera.updateMatrixWorld();
    lamp.position.set(-0.45, 0.6, 1).applyQuaternion(camera.quaternion).add(view.focus);
    lamp.target.position.copy(view.focus);
    edges.visible = state.shown["first frame's box"];
    layers.forEach(showSurface);
    renderer.render(scene, camera);
    drawOverlay(width, height, mmPerPixel);
    view.mmPerPixel = mmPerPixel;
    figure.dataset.drawn = state.frame;
  }

  function showFrame(frame) {
    state.frame = frame;
    slider.value = frame;
    caption.textContent = data.captions[frame];
    figure.querySelector("output").textContent = `frame ${data.frames[frame]} of ${data.last}`;
    redraw();
  }

  // ---- hands ---------------------------------------------------------------------------------------------------------
  const fingers = new Map();
  function move(dx, dy) {
    const right = new THREE.Vector3(1, 0, 0).applyQuaternion(camera.quaternion);
    const up = new THREE.Vector3(0, 1, 0).applyQuaternion(camera.quaternion);
    view.focus.addScaledVector(right, -dx * view.mmPerPixel).addScaledVector(up, dy * view.mmPerPixel);
  }
  function zoom(factor, x, y) {
    const before = view.zoom;
    view.zoom = Math.min(60, Math.max(0.3, view.zoom * factor));
    // What is under the pointer stays there.
    const shift = 1 - before / view.zoom, box = stage.getBoundingClientRect();
    move(-shift * (x - box.left - box.width / 2), -shift * (y - box.top - box.height / 2));
  }
  stage.addEventListener("contextmenu", (event) => event.preventDefault());
  stage.addEventListener("pointerdown", (event) => {
    stage.setPointerCapture(event.pointerId);
    fingers.set(event.pointerId, { x: event.clientX, y: event.clientY, pan: event.button !== 0 || event.shiftKey });
    stage.classList.add("held");
  });
  stage.addEventListener("pointermove", (event) => {
    const from = fingers.get(event.pointerId);
    if (!from) return;
    const dx = event.clientX - from.x, dy = event.clientY - from.y;
    if (fingers.size === 2) {
      const other = [...fingers].find(([id]) => id !== event.pointerId)[1];
      const distance = (x, y) => Math.max(1, Math.hypot(x - other.x, y - other.y));
      zoom(distance(event.clientX, event.clientY) / distance(from.x, from.y), (event.clientX + other.x) / 2,
        (event.clientY + other.y) / 2);
      move(dx / 2, dy / 2);
    } else if (from.pan) {
      move(dx, dy);
    } else {
      view.turn -= dx * 0.0085;
      view.rise = Math.min(1.5707, Math.max(-1.5707, view.rise + dy * 0.0085));
    }
    [from.x, from.y] = [event.clientX, event.clientY];
    redraw();
  });
  for (const end of ["pointerup", "pointercancel"])
    stage.addEventListener(end, (event) => {
      fingers.delete(event.pointerId);
      if (fingers.size === 0) stage.classList.remove("held");
    });
  stage.addEventListener("wheel", (event) => {
    event.preventDefault();
    zoom(Math.exp(-0.0015 * event.deltaY * (event.deltaMode === 1 ? 16 : 1)), event.clientX, event.clientY);
    redraw();
  }, { passive: false });
  stage.addEventListener("keydown", (event) => {
    const turn = { ArrowLeft: [-0.12, 0], ArrowRight: [0.12, 0], ArrowUp: [0, 0.12], ArrowDown: [0, -0.12] }[event.key];
    if (turn) {
      view.turn += turn[0];
      view.rise = Math.min(1.5707, Math.max(-1.5707, view.rise + turn[1]));
    } else if (event.key === "+" || event.key === "-") {
      view.zoom *= event.key === "+" ? 1.2 : 1 / 1.2;
    } else return;
    event.preventDefault();
    redraw();
  });
  figure.querySelector(".reset").addEventListener("click", () => {
    Object.assign(view, HOME, { zoom: 1, focus: centre.clone() });
    redraw();
  });

  slider.max = data.frames.length - 1;
  slider.addEventListener("input", () => showFrame(+slider.value));
  let timer = 0;
  function stop() {
    clearInterval(timer);
    timer = 0;
    play.textContent = "▶";
    play.setAttribute("aria-label", "play");
  }
  play.addEventListener("click", () => {
    if (timer) return stop();
    play.textContent = "❚❚";
    play.setAttribute("aria-label", "pause");
    const each = Math.min(400, Math.max(60, 5000 / data.frames.length));
    timer = setInterval(() => showFrame((state.frame + 1) % data.frames.length), each);
  });
  if (data.frames.length < 2) figure.querySelector(".controls").hidden = true;

  function toggle(name, colour, text = name) {
    const label = document.createElement("label"), box = document.createElement("input");
    Object.assign(box, { type: "checkbox", checked: state.shown[name] !== false });
    box.dataset.layer = name;
    box.addEventListener("change", () => {
      state.shown[name] = box.checked;
      redraw();
    });
    const swatch = document.createElement("i");
    swatch.style.background = colour;
    label.append(box, swatch, text);
    figure.querySelector(".layers").append(label);
  }
  for (const layer of layers) toggle(layer.name, layer.swatch);
  toggle("first frame's box", "#aab2bd");
  if (data.events.length) {
    state.shown.events = true;
    toggle("events", "#b5179e");
  }
  const opacity = figure.querySelector(".opacity input");
  opacity.value = state.sampleOpacity;
  opacity.addEventListener("input", () => {
    state.sampleOpacity = +opacity.value;
    redraw();
  });
  document.addEventListener("click", (event) => {
    const row = event.target.closest("[data-view-frame]");
    if (!row) return;
    showFrame(+row.dataset.viewFrame);
    figure.scrollIntoView({ behavior: "smooth", block: "center" });
  });

  new ResizeObserver(redraw).observe(stage);
  showFrame(state.frame);
})();
