"use strict";
(() => {
  const scenes = JSON.parse(document.getElementById("scenes").textContent);
  const byId = (name) => document.getElementById(name);
  const plane = byId("plane"), surface = byId("surface"), play = byId("play"), scrub = byId("scrub");
  const view = { azimuth: -0.9, elevation: 0.42 };
  let scene = scenes[scenes.length - 1], frame = 0, playing = false, last = 0, clock = 0;

  scenes.forEach((one, index) => byId("trial").add(new Option(one.name, String(index))));
  byId("trial").value = String(scenes.length - 1);

  function sharp(canvas) {
    const ratio = window.devicePixelRatio || 1, box = canvas.getBoundingClientRect();
    const width = Math.round(box.width * ratio), height = Math.round(box.height * ratio);
    if (canvas.width !== width || canvas.height !== height) { canvas.width = width; canvas.height = height; }
    const pen = canvas.getContext("2d");
    pen.setTransform(ratio, 0, 0, ratio, 0, 0);
    pen.clearRect(0, 0, box.width, box.height);
    pen.lineJoin = pen.lineCap = "round";
    return { pen, width: box.width, height: box.height };
  }

  function line(pen, points, color, width, dash) {
    pen.beginPath();
    points.forEach(([x, y], index) => (index ? pen.lineTo(x, y) : pen.moveTo(x, y)));
    pen.strokeStyle = color; pen.lineWidth = width; pen.setLineDash(dash || []);
    pen.stroke();
    pen.setLineDash([]);
  }

  function dot(pen, [x, y], radius, color) {
    pen.beginPath(); pen.arc(x, y, radius, 0, 2 * Math.PI); pen.fillStyle = color; pen.fill();
  }

  function arrow(pen, from, to, color, width) {
    line(pen, [from, to], color, width);
    const angle = Math.atan2(to[1] - from[1], to[0] - from[0]), size = Math.min(10, Math.hypot(to[0] - from[0], to[1] - from[1]));
    pen.beginPath();
    pen.moveTo(to[0], to[1]);
    for (const side of [0.42, -0.42]) pen.lineTo(to[0] - size * Math.cos(angle + side), to[1] - size * Math.sin(angle + side));
    pen.closePath(); pen.fillStyle = color; pen.fill();
  }

  const sliding = (time) => scene.slide_s !== null && time >= scene.slide_s[0] && time < scene.slide_s[1];

  function drawPlane() {
    const { pen, width, height } = sharp(plane);
    const reach = 0.5 * Math.hypot(...scene.block_m);
    const away = (pose, index) => Math.hypot(pose[0] - scene.finger[index][0], pose[1] - scene.finger[index][1]);
    const all = scene.finger.concat(scene.object.filter((pose, index) => away(pose, index) < 3 * reach));  // not where it flew to
    const low = [0, 1].map((axis) => Math.min(...all.map((pose) => pose[axis])) - reach);
    const high = [0, 1].map((axis) => Math.max(...all.map((pose) => pose[axis])) + reach);
    const scale = 0.96 * Math.min(width / (high[0] - low[0]), height / (high[1] - low[1]));
    const middle = [0, 1].map((axis) => 0.5 * (low[axis] + high[axis]));
    const at = (x, y) => [0.5 * width + scale * (x - middle[0]), 0.5 * height - scale * (y - middle[1])];
    line(pen, scene.finger.map((pose) => at(pose[0], pose[1])), "#c9ced3", 1.5);
    line(pen, scene.finger.filter((_, index) => sliding(scene.time_s[index])).map((pose) => at(pose[0], pose[1])), "#2e7d32", 4);
    const [x, y, turn] = scene.object[frame], c = Math.cos(turn), s = Math.sin(turn);
    const corner = ([u, v]) => at(x + c * u - s * v, y + s * u + c * v);
    const [a, b] = scene.block_m.map((side) => 0.5 * side);
    const outline = [[-a, -b], [a, -b], [a, b], [-a, b]].map(corner);
    pen.beginPath();
    outline.forEach((point, index) => (index ? pen.lineTo(...point) : pen.moveTo(...point)));
    pen.closePath(); pen.fillStyle = "rgba(239,233,220,0.9)"; pen.fill();
    line(pen, [...outline, outline[0]], "#4a4a4a", 1.5);
    line(pen, [corner([0, 0]), corner([0.36 * a, 0])], "#4a4a4a", 1);
    const [fx, fy, angle] = scene.finger[frame], long = 0.6 * a + 0.6 * b;
    line(pen, [at(fx, fy), at(fx + long * Math.cos(angle), fy + long * Math.sin(angle))], "#8b4513", 4);
    dot(pen, at(fx, fy), 6, "#b3261e");
    pen.fillStyle = "#56606a"; pen.font = "13px system-ui, sans-serif";
    const bar = scale * 0.1;
    line(pen, [[12, 26], [12 + bar, 26]], "#56606a", 2);
    pen.fillText("0.1 m", 12, 19);
  }

  function drawSurface() {
    const { pen, width, height } = sharp(surface);
    const [sx, sy, sz] = scene.semi_axes_n, scale = 0.36 * Math.min(width, 1.3 * height) / sx;
    const ca = Math.cos(view.azimuth), sa = Math.sin(view.azimuth), ce = Math.cos(view.elevation), se = Math.sin(view.elevation);
    const at = ([x, y, z]) => [0.5 * width + scale * (ca * y - sa * x), 0.5 * height - scale * (ce * z - se * (ca * x + sa * y))];
    const turns = Array.from({ length: 61 }, (_, index) => (index * Math.PI) / 30);
    for (let k = 0; k < 6; k++) {
      const l = (k * Math.PI) / 6;
      line(pen, turns.map((t) => at([sx * Math.cos(l) * Math.cos(t), sy * Math.sin(l) * Math.cos(t), sz * Math.sin(t)])), "#c3cad1", 0.8);
      const v = ((k - 2.5) * Math.PI) / 6;
      line(pen, turns.map((t) => at([sx * Math.cos(t) * Math.cos(v), sy * Math.sin(t) * Math.cos(v), sz * Math.sin(v)])), "#c3cad1", 0.8);
    }
    pen.fillStyle = "#1d2329"; pen.font = "italic 14px system-ui, sans-serif";
    [["fx", [1.25 * sx, 0, 0]], ["fy", [0, 1.25 * sy, 0]], ["mz / a", [0, 0, 1.3 * sz]]].forEach(([name, tip]) => {
      line(pen, [at(tip.map((value) => -value)), at(tip)], "#8b949e", 1);
      const [x, y] = at(tip.map((value) => 1.06 * value));
      pen.fillText(name, x - 6, y + 4);
    });
    const start = Math.max(0, frame - 30);
    for (let index = start; index < frame; index++) {
      const color = sliding(scene.time_s[index]) ? "#2e7d32" : "#1f5fa8";
      pen.globalAlpha = 0.15 + (0.85 * (index - start)) / 30;
      line(pen, [at(scene.friction[index]), at(scene.friction[index + 1])], color, 2.5);
    }
    pen.globalAlpha = 1;
    arrow(pen, at([0, 0, 0]), at(scene.friction[frame]), "#8b4513", 3);
  }

  function say() {
    const time = scene.time_s[frame], f = scene.friction[frame];
    const load = Math.hypot(...f.map((value, axis) => value / scene.semi_axes_n[axis]));
    const [x, y, turn] = scene.relative[frame];
    byId("now").textContent = `${time.toFixed(3)} s, ${sliding(time) ? "sliding" : "sticking"}. ` +
      `Friction ${Math.hypot(f[0], f[1]).toFixed(2)} N, ${(100 * load).toFixed(0)} % of the limit. ` +
      `Finger on the block: x ${x.toFixed(1)} mm, y ${y.toFixed(1)} mm, ${turn.toFixed(1)}°.`;
    scrub.setAttribute("aria-valuetext", `${time.toFixed(2)} s`);
  }

  function show(index) {
    frame = Math.max(0, Math.min(scene.time_s.length - 1, index));
    scrub.value = String(frame);
    drawPlane(); drawSurface(); say();
  }

  function set(on) {
    playing = on;
    play.textContent = on ? "Pause" : "Play";
    if (!on) return;
    if (frame === scene.time_s.length - 1) show(0);
    clock = scene.time_s[frame]; last = performance.now();
    requestAnimationFrame(tick);
  }

  function tick(now) {
    if (!playing) return;
    clock += ((now - last) / 1000) * Number(byId("speed").value);
    last = now;
    let next = frame;
    while (next < scene.time_s.length - 1 && scene.time_s[next + 1] <= clock) next++;
    if (next !== frame) show(next);
    if (frame === scene.time_s.length - 1) set(false);
    else requestAnimationFrame(tick);
  }

  function choose(index) {
    set(false);
    scene = scenes[index];
    scrub.max = String(scene.time_s.length - 1);
    show(0);
  }

  play.addEventListener("click", () => set(!playing));
  scrub.addEventListener("input", () => { set(false); show(Number(scrub.value)); });
  byId("trial").addEventListener("change", (event) => choose(Number(event.target.value)));
  document.addEventListener("keydown", (event) => {
    const kind = event.target.tagName;
    if (event.altKey || event.ctrlKey || event.metaKey || ["SELECT", "SUMMARY", "PRE"].includes(kind)) return;
    const steps = { ArrowLeft: frame - 1, ArrowRight: frame + 1, Home: 0, End: scene.time_s.length - 1 };
    if (event.key === " " && kind !== "BUTTON") { event.preventDefault(); set(!playing); }
    else if (event.key in steps && !event.target.classList.contains("scroll")) { event.preventDefault(); set(false); show(steps[event.key]); }
  });
  let held = null;
  surface.addEventListener("pointerdown", (event) => { held = [event.clientX, event.clientY]; surface.setPointerCapture(event.pointerId); });
  surface.addEventListener("pointermove", (event) => {
    if (!held) return;
    view.azimuth -= 0.01 * (event.clientX - held[0]);
    view.elevation = Math.max(-1.5, Math.min(1.5, view.elevation + 0.01 * (event.clientY - held[1])));
    held = [event.clientX, event.clientY];
    drawSurface();
  });
  ["pointerup", "pointercancel"].forEach((name) => surface.addEventListener(name, () => { held = null; }));
  window.addEventListener("resize", () => show(frame));
  choose(scenes.length - 1);
})();
