// The page of `phyvisgen view`: reads the JSON that pipeline/report_data.hpp describes, draws cards, curves and motion.

// ---- curves --------------------------------------------------------------------------------------------------------

// Lines over time with a cursor; returns the box and what moves the cursor to a time.
function curveChart(times, curve) {
  const W = 520, H = 190, left = 52, right = 14, top = 8, bottom = 24;
  const all = curve.lines.flatMap((line) => line.values);
  let low = Math.min(0, ...all.slice(0, 1), ...[all.reduce((a, b) => Math.min(a, b), Infinity)]);
  let high = all.reduce((a, b) => Math.max(a, b), -Infinity);
  if (!(high > low)) high = low + 1;
  const marks = ticks(low, high, 4);
  [low, high] = [marks[0], marks[marks.length - 1]];
  const end = times[times.length - 1], x = (t) => left + ((W - left - right) * t) / end;
  const y = (v) => H - bottom - ((H - top - bottom) * (v - low)) / (high - low);
  const svg = drawing("svg", { viewBox: `0 0 ${W} ${H}`, role: "img" });
  for (const v of marks) {
    svg.append(drawing("line", { x1: left, x2: W - right, y1: y(v), y2: y(v), stroke: v === 0 ? "#aab4be" : "#e3e8ed" }));
    svg.append(drawing("text", { x: left - 6, y: y(v) + 4, "text-anchor": "end" }, short(v)));
  }
  for (const t of ticks(0, end, 5).filter((t) => t <= end))
    svg.append(drawing("text", { x: x(t), y: H - 6, "text-anchor": "middle" }, `${short(t)} s`));
  curve.lines.forEach((line, i) => {
    const points = line.values.map((v, k) => `${x(times[k]).toFixed(1)},${y(v).toFixed(1)}`).join(" ");
    svg.append(drawing("polyline", { points, fill: "none", stroke: COLORS[i % COLORS.length], "stroke-width": 1.4 }));
  });
  const cursor = drawing("line", { y1: top, y2: H - bottom, stroke: "#1d2733", "stroke-width": 1 });
  svg.append(cursor);
  const legend = element("div", { class: "legend" });
  curve.lines.forEach((line, i) => legend.append(element("span", {}, element("i", { style: `background:${COLORS[i % COLORS.length]}` }), line.name)));
  const move = (t) => ["x1", "x2"].forEach((name) => cursor.setAttribute(name, x(Math.min(t, end))));
  move(0);
  return { box: element("div", {}, element("h3", { text: `${curve.title} [${curve.unit}]` }), svg, legend), move };
}

// Bars: [[label, value, text]] lying.
function bars(rows) {
  const H = 22, most = Math.max(...rows.map((row) => row[1]), 1e-12);
  const svg = drawing("svg", { viewBox: `0 0 520 ${H * rows.length + 4}`, style: "max-width:620px" });
  rows.forEach(([label, value, text], i) => {
    svg.append(drawing("text", { x: 112, y: H * i + 14, "text-anchor": "end" }, label));
    svg.append(drawing("rect", { x: 118, y: H * i + 4, width: (300 * value) / most, height: H - 8, fill: COLORS[0], rx: 2 }));
    svg.append(drawing("text", { x: 124 + (300 * value) / most, y: H * i + 14 }, text));
  });
  return svg;
}
// How numbers are spread: bars of a histogram, of a few a dot each. One value alone is written, not drawn.
function spread(values) {
  const low = Math.min(...values), high = Math.max(...values);
  if (!(high > low)) return element("div", { text: short(low) + (values.length > 1 ? ` (all ${values.length})` : "") });
  const FEW = 10, W = 240, H = 80, svg = drawing("svg", { viewBox: `0 0 ${W} ${H + 18}` });
  if (values.length < FEW) {
    svg.append(drawing("line", { x1: 6, x2: W - 6, y1: H / 2, y2: H / 2, stroke: "#e3e8ed" }));
    for (const v of values) svg.append(drawing("circle", { cx: 6 + ((W - 12) * (v - low)) / (high - low), cy: H / 2, r: 5, fill: COLORS[0], "fill-opacity": 0.6 }));
  } else {
    const n = Math.min(12, Math.max(4, Math.ceil(Math.sqrt(values.length)))), counts = new Array(n).fill(0);
    for (const v of values) ++counts[Math.min(n - 1, Math.floor(((v - low) / (high - low)) * n))];
    const most = Math.max(...counts);
    counts.forEach((count, i) =>
      svg.append(drawing("rect", { x: (W * i) / n + 1, width: W / n - 2, y: H - (H * count) / most, height: (H * count) / most, fill: COLORS[0] })));
  }
  svg.append(drawing("text", { x: 0, y: H + 14 }, short(low)));
  svg.append(drawing("text", { x: W, y: H + 14, "text-anchor": "end" }, short(high)));
  return svg;
}

// ---- motion --------------------------------------------------------------------------------------------------------

function numbers(text, Type) {
  const bytes = Uint8Array.from(atob(text), (c) => c.charCodeAt(0));
  return new Type(bytes.buffer);
}

// Bodies in a box that the mouse turns; returns what shows a time.
function motionScene(box, motion) {
  const renderer = new THREE.WebGLRenderer({ antialias: true, alpha: true });
  renderer.setPixelRatio(window.devicePixelRatio);
  box.append(renderer.domElement);
  const scene = new THREE.Scene(), camera = new THREE.PerspectiveCamera(40, 1, 0.01, 50);
  camera.up.set(0, 0, 1);
  scene.add(new THREE.HemisphereLight(0xffffff, 0x8899aa, 0.75));
  const sun = new THREE.DirectionalLight(0xffffff, 0.6);
  sun.position.set(1, -2, 3);
  scene.add(sun);
  let color = 0;
  const bounds = new THREE.Box3();
  const bodies = motion.bodies.map((body) => {
    const geometry = new THREE.BufferGeometry(), points = numbers(body.points, Float32Array);
    geometry.setAttribute("position", new THREE.BufferAttribute(points, 3));
    geometry.setIndex(new THREE.BufferAttribute(numbers(body.triangles, Uint32Array), 1));
    const look = new THREE.MeshStandardMaterial({ color: body.is_fixed ? "#b8c2cb" : COLORS[color++ % COLORS.length], side: THREE.DoubleSide, flatShading: true, roughness: 0.7 });
    const mesh = new THREE.Mesh(geometry, look);
    mesh.matrixAutoUpdate = false;
    mesh.frustumCulled = false;
    scene.add(mesh);
    const moved = { mesh, geometry, points };
    if (body.poses) moved.poses = numbers(body.poses, Float32Array);
    else Object.assign(moved, { frames: numbers(body.frames, Uint16Array), low: body.low, range: body.high.map((h, k) => h - body.low[k]) });
    return moved;
  });
  function pose(body, key) {
    if (body.poses) {
      const m = body.poses.subarray(12 * key, 12 * key + 12);
      body.mesh.matrix.set(...m, 0, 0, 0, 1);
    } else {
      const n = body.points.length;
      for (let i = 0; i < n; ++i) body.points[i] = body.low[i % 3] + (body.range[i % 3] * body.frames[n * key + i]) / 65535;
      body.geometry.attributes.position.needsUpdate = true;
    }
    body.mesh.matrixWorldNeedsUpdate = true;
  }
  bodies.forEach((body, i) => {
    pose(body, 0);
    if (motion.bodies[i].is_fixed) return;
    body.geometry.computeBoundingBox();
    body.mesh.updateMatrixWorld(true);
    bounds.union(body.geometry.boundingBox.clone().applyMatrix4(body.mesh.matrix));
  });
  const center = bounds.getCenter(new THREE.Vector3()), size = Math.max(bounds.getSize(new THREE.Vector3()).length(), 0.1);
  camera.position.copy(center).add(new THREE.Vector3(0.9, -0.8, 0.5).multiplyScalar(size));
  const controls = new THREE.OrbitControls(camera, renderer.domElement);
  controls.target.copy(center);
  controls.update();
  const draw = () => renderer.render(scene, camera);
  const fit = () => {
    renderer.setSize(box.clientWidth, box.clientHeight);
    camera.aspect = box.clientWidth / box.clientHeight;
    camera.updateProjectionMatrix();
    draw();
  };
  controls.addEventListener("change", draw);
  window.addEventListener("resize", fit);
  fit();
  return (t) => {
    let key = 0;
    while (key + 1 < motion.times.length && motion.times[key] < t - 1e-6) ++key;
    bodies.forEach((body) => pose(body, key));
    draw();
  };
}

// ---- an episode ----------------------------------------------------------------------------------------------------

function episodeCard(episode, isOpen) {
  const { summary } = episode, card = element("details", { class: "card" });
  const outcome = summary.success ? element("span", { class: "good", text: "success" }) : element("span", { class: "bad", text: summary.reason });
  const what = ` ${short(summary.duration_s)} s of motion, ${counted(summary.steps, "step")}, ${counted(summary.frames, "picture")}`;
  card.append(element("summary", {}, `${episode.folder} `, outcome, element("span", { class: "quiet", text: what })));
  const fill = () => {
    const body = element("div"), listeners = [];
    const views = element("div", { class: "row" }), clips = [];
    for (const video of episode.videos) {
      const clip = element("video", { src: video.source, muted: "", playsinline: "", preload: "auto" });
      clip.muted = true;
      clips.push(clip);
      views.append(element("div", {}, element("h3", { text: video.name }), clip));
    }
    const box = element("div", { class: "scene" });
    views.append(element("div", {}, element("h3", { text: "motion (turn it with the mouse)" }), box));
    body.append(views);
    const end = summary.duration_s, slider = element("input", { type: "range", min: 0, max: end, step: 0.01, value: 0, "aria-label": "time" });
    const button = element("button", { text: "play" }), clock = element("span", { class: "quiet", text: "0.00 s" });
    body.append(element("div", { class: "controls" }, button, slider, clock));
    const charts = element("div", { class: "charts" });
    for (const curve of episode.curves) {
      const chart = curveChart(episode.times, curve);
      charts.append(chart.box);
      listeners.push(chart.move);
    }
    body.append(charts);
    const drawn = Object.entries(episode.sampled || {});
    if (drawn.length) body.append(element("p", { class: "quiet", text: "drawn: " + drawn.map(([name, value]) => `${name} ${short(value)}`).join(", ") }));
    card.append(body);
    if (episode.motion.bodies.length) listeners.push(motionScene(box, episode.motion));
    let time = 0, last = null;
    const show = (t, seeks) => {
      time = t;
      slider.value = t;
      clock.textContent = `${t.toFixed(2)} s`;
      listeners.forEach((listener) => listener(t));
      // a picture shows the end of its interval
      if (seeks) clips.forEach((clip) => (clip.currentTime = Math.max(0, Math.min(t - 1e-3, clip.duration || t))));
    };
    slider.addEventListener("input", () => show(+slider.value, true));
    const tick = (now) => {
      if (last === null) return;
      const t = time + (now - last) / 1000;
      last = now;
      if (t >= end) return stop(end);
      show(t, true);
      requestAnimationFrame(tick);
    };
    const stop = (t) => {
      last = null;
      button.textContent = "play";
      show(t, true);
    };
    button.addEventListener("click", () => {
      if (last !== null) return stop(time);
      if (time >= end) time = 0;
      button.textContent = "stop";
      last = performance.now();
      requestAnimationFrame(tick);
    });
    show(isOpen ? end / 2 : 0, true);
    // a video knows its length later than the page
    clips.forEach((clip) => clip.addEventListener("loadedmetadata", () => show(time, true)));
  };
  if (episode.curves) {
    card.addEventListener("toggle", () => card.open && card.children.length === 1 && fill());
    card.open = isOpen;
  } else {
    card.append(element("p", { class: "quiet", text: "Only in the table: its record is not kept, or the page was asked for fewer episodes." }));
  }
  return card;
}

// ---- a set ---------------------------------------------------------------------------------------------------------

function setHead(status, episodes) {
  const head = element("div");
  head.append(element("h1", { text: `${status.task}, seed ${status.seed}` }));
  const made = status.done.length + status.failed.length;
  head.append(element("div", { class: "card" }, element("div", { class: "big", text: made ? percent(status.success_rate) : "no episode yet" }),
    `success: ${status.done.length} of ${counted(made, "episode")}` + (made ? `, 95 % interval by Wilson ${percent(status.success_low)} to ${percent(status.success_high)}` : "") + `; ${status.missing.length} of ${status.episodes} still to be made`));
  if (status.failed.length) {
    const table = element("table", {}, element("tr", {}, element("th", { text: "episode" }), element("th", { text: "why it failed" })));
    for (const failed of status.failed) table.append(element("tr", {}, element("td", { text: failed.episode }), element("td", { text: failed.reason })));
    head.append(element("h2", { text: "Failures" }), element("div", { class: "card" }, table));
  }
  const drawn = {}, seconds = {};
  for (const episode of episodes) {
    for (const [name, value] of Object.entries(episode.sampled || {})) (drawn[name] = drawn[name] || []).push(value);
    for (const [name, value] of Object.entries(episode.summary.seconds || {})) (seconds[name] = seconds[name] || []).push(value);
  }
  if (Object.keys(drawn).length) {
    const row = element("div", { class: "row card" });
    for (const [name, values] of Object.entries(drawn)) row.append(element("div", { style: "flex:0 1 240px" }, element("h3", { text: name }), spread(values)));
    head.append(element("h2", { text: "What was drawn by chance (SI)" }), row);
  }
  const mean = (values) => values.reduce((a, b) => a + b, 0) / values.length;
  if (Object.keys(seconds).length)
    head.append(element("h2", { text: "Seconds per episode, by stage" }),
      element("div", { class: "card" }, bars(Object.entries(seconds).map(([name, values]) => [name, mean(values), `${short(mean(values))} s`]))));
  head.append(element("h2", { text: "Episodes" }));
  return head;
}

const { status, episodes } = report;
document.title = status ? `${status.task}: ${counted(episodes.length, "episode")}` : episodes[0].folder;
if (status) page.append(setHead(status, episodes));
else page.append(element("h1", { text: `${episodes[0].summary.task}, seed ${episodes[0].summary.seed}, episode ${episodes[0].summary.episode}` }));
episodes.forEach((episode, i) => page.append(episodeCard(episode, i === 0)));
document.body.dataset.state = "complete";
