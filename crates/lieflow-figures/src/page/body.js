// Plays the motion of a body: a box at the attitude of each time, and the way of its longest axis up to there.
(() => {
  const cross = (a, b) => [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
  const rotated = ([w, ...u], v) => {
    const once = cross(u, v), twice = cross(u, once);
    return v.map((x, i) => x + 2 * (w * once[i] + twice[i]));
  };

  const play = (svg, scene) => {
    const { centre, scale, edges, span, t, q, way } = scene;
    const last = t.length - 1;
    if (last < 1) return;
    const poses = t.map((_, i) => q.slice(4 * i, 4 * i + 4));
    // Between two poses: the chord, brought back to length one.
    const pose = (time) => {
      let i = 0;
      for (let low = 0, high = last; low <= high;) {
        const middle = (low + high) >> 1;
        if (t[middle] <= time) [i, low] = [middle, middle + 1];
        else high = middle - 1;
      }
      const j = Math.min(i + 1, last), part = j > i ? (time - t[i]) / (t[j] - t[i]) : 0;
      const mixed = poses[i].map((x, k) => x + part * (poses[j][k] - x)), length = Math.hypot(...mixed);
      return [i, mixed.map((x) => x / length)];
    };
    const long = edges[way], length = Math.hypot(...long), axis = long.map((x) => x / length);
    const tips = poses.map((p) => rotated(p.map((x) => x / Math.hypot(...p)), axis));
    let view = scene.view, time = t[0];

    const draw = () => {
      const { right, up, toward } = camera(...view);
      const screen = (p) => `${px(centre[0] + scale * dot(p, right))} ${px(centre[1] - scale * dot(p, up))}`;
      const path = (points) => "M" + points.map(screen).join("L");
      const [at, turn] = pose(time);
      const now = edges.map((edge) => rotated(turn, edge));
      svg.querySelectorAll("[data-axis]").forEach((line, i) => {
        const along = (length) => [0, 1, 2].map((j) => (i === j ? length : 0));
        const tip = along(scene.axis), at = screen(tip), [x, y] = at.split(" ").map(Number);
        const dx = right[i], dy = up[i], size = Math.max(0.2, Math.hypot(dx, dy)), ux = dx / size, uy = -dy / size;
        const corner = (side) => `${px(x - 9 * dx + side * uy)} ${px(y + 9 * dy - side * ux)}`;
        const arrow = (from) => `M${corner(3.6)}L${at}L${corner(-3.6)}${path([along(from), tip])}`;
        line.setAttribute("d", arrow(0));
        // The part that leaves the box toward the viewer lies before the box.
        const leaves = (edge) => dot(edge, edge) / Math.abs(edge[i]);
        const face = now.reduce((a, b) => (leaves(b) < leaves(a) ? b : a));
        const front = face[i] * dot(face, toward) > 0 ? arrow(leaves(face)) : "";
        svg.querySelectorAll(`[data-front="${i}"]`).forEach((part) => part.setAttribute("d", front));
        const [left, top] = screen(along(scene.name)).split(" ").map(Number);
        const name = svg.querySelector(`[data-name="${i}"]`);
        name.setAttribute("x", left);
        name.setAttribute("y", top + 4);
      });
      const from = Math.max(0, at - 240);
      svg.querySelector("[data-way]").setAttribute("d", path([...tips.slice(from, at + 1), rotated(turn, axis)]));
      svg.querySelectorAll("[data-face]").forEach((face, k) => {
        const sign = k % 2 ? -1 : 1, [a, b, c] = [0, 1, 2].map((i) => now[((k >> 1) + i) % 3]);
        const corner = ([u, v]) => [0, 1, 2].map((i) => sign * a[i] + u * b[i] + v * c[i]);
        const seen = sign * dot(a, toward) > 0;
        face.setAttribute("d", seen ? path([[1, 1], [-1, 1], [-1, -1], [1, -1]].map(corner)) + "z" : "");
      });
    };

    const bar = document.createElement("div");
    bar.className = "player";
    const add = (name, attributes) => Object.assign(bar.appendChild(document.createElement(name)), attributes);
    const button = add("button", { type: "button" });
    const slider = add("input", { type: "range", min: t[0], max: t[last], step: "any", value: t[0] });
    const shown = add("output", {});
    slider.setAttribute("aria-label", "Time");
    svg.after(bar);

    // A radian and a half in a second, if that takes neither a moment nor for ever.
    const angle = poses.slice(1).reduce((sum, p, i) => {
      const cosine = Math.abs(p.reduce((s, x, k) => s + x * poses[i][k], 0)) / 1e8;
      return sum + 2 * Math.acos(Math.min(1, cosine));
    }, 0);
    const seconds = Math.max(6, Math.min(90, angle / 1.5));
    // t counts from the start. Digits that tell two times of the span apart.
    const direction = Math.sign(span[1] - span[0]), largest = Math.max(...span.map(Math.abs));
    const digits = Math.min(15, 4 + Math.max(0, Math.ceil(Math.log10(largest / t[last]))));
    let playing = false, before = 0;
    const tell = () => {
      button.textContent = playing ? "❚❚ Pause" : "▶ Play";
      shown.textContent = `t = ${Number((span[0] + direction * time).toPrecision(digits))}`;
      slider.value = time;
    };
    const frame = (now) => {
      if (!playing) return;
      time += ((t[last] - t[0]) * Math.max(0, Math.min(100, now - before))) / (1000 * seconds);
      if (time > t[last]) time = t[0];
      before = now;
      draw();
      tell();
      requestAnimationFrame(frame);
    };
    button.addEventListener("click", () => {
      playing = !playing;
      before = performance.now();
      tell();
      if (playing) requestAnimationFrame(frame);
    });
    slider.addEventListener("input", () => {
      time = Number(slider.value);
      draw();
      tell();
    });
    view = turnable(svg, view, draw, "body");
    tell();
  };

  for (const data of document.querySelectorAll("script.motion")) {
    play(data.parentElement.querySelector("svg"), JSON.parse(data.textContent));
  }
})();
