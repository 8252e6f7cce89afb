// Turns the momentum spheres: projects the scene again with the same rules as the static picture.
(() => {
  const between = (a, b, t) => [0, 1, 2].map((i) => a[i] + t * (b[i] - a[i]));

  // Where the condition `inside` changes between a and b, by bisection.
  const crossing = (a, b, inside) => {
    const start = inside(a);
    let lo = 0, hi = 1;
    for (let i = 0; i < 12; i++) {
      const middle = (lo + hi) / 2;
      if (inside(between(a, b, middle)) === start) lo = middle;
      else hi = middle;
    }
    return between(a, b, hi);
  };
  const clip = (polygon, inside) => polygon.flatMap((b, i) => {
    const a = polygon.at(i - 1), keep = inside(b);
    const cut = inside(a) !== keep ? [crossing(a, b, inside)] : [];
    return keep ? [...cut, b] : cut;
  });

  // A point is hidden if the ray to the viewer leaves an ellipsoid ahead of the point.
  const hiddenBy = (semi) => {
    const form = (p, q) => [0, 1, 2].reduce((sum, i) => sum + (p[i] * q[i]) / semi[i] ** 2, 0);
    return (p, toward) => {
      const a = form(toward, toward), b = form(p, toward), c = form(p, p) - 1;
      const discriminant = b * b - a * c;
      return discriminant > 0 && Math.sqrt(discriminant) - b > 0.02 * a;
    };
  };

  // The parts of the ellipsoid outside of the unit sphere as small polygons.
  const meshOutside = (semi) => {
    const step = Math.PI / 36, polygons = [];
    const place = ([lat, lon]) =>
      [semi[0] * Math.cos(lat) * Math.cos(lon), semi[1] * Math.cos(lat) * Math.sin(lon), semi[2] * Math.sin(lat)];
    const outside = (angles) => dot(place(angles), place(angles)) > 1;
    for (let i = -18; i < 18; i++) {
      for (let j = 0; j < 72; j++) {
        const quad = [[i, j], [i, j + 1], [i + 1, j + 1], [i + 1, j]].map(([u, v]) => [u * step, v * step, 0]);
        const cut = clip(quad, outside);
        if (cut.length > 2) polygons.push(cut.map(place));
      }
    }
    return polygons;
  };

  const sphere = (svg, scene) => {
    const { centre, scale, semi, shades, tips } = scene;
    const surfaces = [hiddenBy([1, 1, 1])].concat(semi ? [hiddenBy(semi)] : []);
    const lines = scene.lines.map((line) => line.map((piece) => piece.map((p) => p.map((x) => x / 1000))));
    const mesh = semi ? meshOutside(semi) : [];
    const find = (name, k) => svg.querySelector(`[data-${name}="${k}"]`);

    const ends = scene.ends.map((end) => end.map((x) => x / 1000));

    const draw = (azimuth, elevation) => {
      const { right, up, toward } = camera(azimuth, elevation);
      const screen = (p) => [centre[0] + scale * dot(p, right), centre[1] - scale * dot(p, up)];
      const path = (points) => "M" + points.map((p) => screen(p).map(px).join(" ")).join("L");
      const hidden = (p) => surfaces.some((hides) => hides(p, toward));

      lines.forEach((line, k) => {
        const d = ["", ""];
        for (const piece of line) {
          let run = [], state = piece.length > 0 && hidden(piece[0]);
          for (const p of piece) {
            const next = hidden(p);
            if (next !== state) {
              const cut = crossing(run.at(-1), p, hidden);
              d[+state] += path([...run, cut]);
              run = [cut];
            }
            state = next;
            run.push(p);
          }
          if (run.length > 1) d[+state] += path(run);
        }
        find("line-front", k).setAttribute("d", d[0]);
        find("line-back", k)?.setAttribute("d", d[1]);
      });

      const fills = Array(2 * shades).fill("");
      const normal = (p) => p.map((x, i) => x / semi[i] ** 2);
      const lamp = [0, 1, 2].map((i) => 0.7 * toward[i] - 0.4 * right[i] + 0.59 * up[i]);
      for (const polygon of mesh) {
        const facing = clip(polygon, (p) => dot(normal(p), toward) >= 0);
        if (facing.length < 3) continue;
        const middle = [0, 1, 2].map((i) => facing.reduce((sum, p) => sum + p[i], 0) / facing.length);
        const n = normal(middle);
        const bright = 0.5 + (0.5 * dot(n, lamp)) / Math.hypot(...n);
        const shade = Math.max(0, Math.min(shades - 1, Math.floor(bright * shades)));
        fills[shade + (dot(middle, toward) < 0 ? 0 : shades)] += path(facing) + "z";
      }
      fills.forEach((d, k) => find("fill", k).setAttribute("d", d));

      tips.forEach((length, i) => {
        const unit = [0, 1, 2].map((j) => +(i === j)), tip = unit.map((u) => u * length);
        const [x, y] = screen(tip), dx = dot(unit, right), dy = dot(unit, up);
        const size = Math.max(0.2, Math.hypot(dx, dy)), ux = dx / size, uy = -dy / size;
        const head = find("head", i), name = find("name", i), far = hidden(tip);
        const corners = [[x + 9 * dx, y - 9 * dy], [x + 3.6 * uy, y - 3.6 * ux], [x - 3.6 * uy, y + 3.6 * ux]];
        head.setAttribute("d", `M${corners.map((c) => c.map(px).join(" ")).join("L")}z`);
        name.setAttribute("x", px(x + 9 * dx + 13 * ux));
        name.setAttribute("y", px(y - 9 * dy + 13 * uy + 4));
        [head, name].forEach((element) => element.classList.toggle("lf-far", far));
      });

      ends.forEach((end, i) => {
        const mark = find("end", i), [x, y] = screen(end);
        mark.setAttribute("cx", px(x));
        mark.setAttribute("cy", px(y));
        mark.classList.toggle("lf-far", hidden(end));
      });
    };

    turnable(svg, scene.view, draw, "sphere");
  };

  for (const data of document.querySelectorAll("script.scene")) {
    sphere(data.parentElement.querySelector("svg"), JSON.parse(data.textContent));
  }
})();
