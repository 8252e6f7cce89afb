"use strict";
(() => {
  const root = document.documentElement;
  root.classList.add("js");
  const all = (selector, from = document) => [...from.querySelectorAll(selector)];
  const create = (name, parent) => parent.appendChild(document.createElement(name));

  // The theme: that of the system until the reader chooses, and remembered where that is allowed.
  const button = document.getElementById("theme");
  const system = matchMedia("(prefers-color-scheme: dark)");
  const isDark = () => (root.dataset.theme ? root.dataset.theme === "dark" : system.matches);
  const nameTheme = () => {
    button.textContent = isDark() ? "Light theme" : "Dark theme";
  };
  try {
    const chosen = localStorage.getItem("lieflow-theme");
    if (chosen) root.dataset.theme = chosen;
  } catch { /* no storage for files in some browsers */ }
  button.hidden = false;
  button.addEventListener("click", () => {
    root.dataset.theme = isDark() ? "light" : "dark";
    try {
      localStorage.setItem("lieflow-theme", root.dataset.theme);
    } catch { /* the choice lasts as long as the page */ }
    nameTheme();
  });
  system.addEventListener("change", nameTheme);
  nameTheme();

  // The link to the words opens their fold.
  for (const link of all('a[href="#words"]')) {
    link.addEventListener("click", () => { document.querySelector("#words>details").open = true; });
  }

  // A click on a heading sorts the table by that column, a second click the other way round.
  const collator = new Intl.Collator("en", { numeric: true });
  for (const heading of all("th[data-sorts]")) {
    const table = heading.closest("table"), body = table.tBodies[0], column = heading.cellIndex;
    const button = document.createElement("button");
    button.append(...heading.childNodes);
    heading.append(button);
    button.addEventListener("click", () => {
      const down = heading.getAttribute("aria-sort") === "ascending", sign = down ? -1 : 1;
      all("th", table.tHead).forEach((other) => other.removeAttribute("aria-sort"));
      heading.setAttribute("aria-sort", down ? "descending" : "ascending");
      const number = heading.classList.contains("number");
      const key = ({ cells }) => {
        const cell = cells[column];
        return number ? parseFloat(cell?.dataset.value) : cell?.textContent.trim() ?? "";
      };
      // What has no number comes last in both directions.
      const order = (a, b) => {
        if (!number) return sign * collator.compare(a, b);
        const has = Number.isFinite;
        return has(a) && has(b) ? sign * (a - b) : has(b) - has(a);
      };
      const rows = [...body.rows].map((row) => [key(row), row]);
      body.append(...rows.sort(([a], [b]) => order(a, b)).map(([, row]) => row));
    });
  }

  // A table that is wider than the page says so, and fades where it goes on.
  for (const box of all(".scroll")) {
    const hint = document.createElement("p");
    hint.className = "hint";
    hint.textContent = "Scroll sideways for more columns →";
    box.after(hint);
    const look = () => {
      hint.hidden = box.scrollWidth <= box.clientWidth + 1;
      const rest = box.scrollWidth - box.clientWidth - box.scrollLeft;
      box.classList.toggle("more", !hint.hidden && rest > 1);
    };
    box.addEventListener("scroll", look, { passive: true });
    new ResizeObserver(look).observe(box);
  }

  // One tooltip for all charts. Its first line is the name of the line.
  const tip = create("div", document.body);
  tip.id = "tip";
  tip.hidden = true;
  tip.setAttribute("aria-hidden", "true");
  const showTip = (lines, x, y) => {
    tip.replaceChildren();
    lines.forEach((line, i) => { create(i ? "span" : "b", tip).textContent = line; });
    tip.hidden = false;
    const left = x + 16 + tip.offsetWidth > innerWidth ? x - 16 - tip.offsetWidth : x + 16;
    const top = Math.min(y + 14, innerHeight - tip.offsetHeight - 8);
    tip.style.transform = `translate(${Math.max(8, left)}px,${Math.max(8, top)}px)`;
  };

  // The browser's own tooltips would cover ours: the titles become labels.
  const titleToLabel = (element) => {
    const title = element.querySelector(":scope > title");
    if (!title) return [];
    const lines = title.textContent.split("\n");
    element.setAttribute("aria-label", lines.join(", "));
    element.removeAttribute("aria-labelledby");
    title.remove();
    return lines;
  };

  const superscript = (n) => String(n).replace(/./g, (c) => "⁻⁰¹²³⁴⁵⁶⁷⁸⁹"["-0123456789".indexOf(c)]);
  const number = (x, digits = 3) => {
    const [mantissa, exponent] = x.toExponential(digits - 1).replace("-", x < 0 ? "−" : "-").split("e");
    const plain = Math.abs(x) >= 1e-3 && Math.abs(x) < 1e6;
    if (x === 0 || plain) return String(Number(x.toPrecision(digits))).replace("-", "−");
    return `${mantissa}×10${superscript(Number(exponent))}`;
  };

  const inTime = (t) => [[1, "s"], [1e3, "ms"], [1e6, "µs"], [1e9, "ns"]]
    .find(([factor]) => Math.abs(t * factor) >= 1) || [1e9, "ns"];

  // The value at a pixel of an axis.
  const axisOf = (svg, name) => {
    const [kind, ...numbers] = svg.dataset[name].split(" ");
    const [lo, hi, from, to, linear] = numbers.map(Number);
    const unwarp = {
      linear: (t) => t,
      log10: (t) => 10 ** t,
      symlog: (t) => Math.sign(t) * linear * (10 ** Math.abs(t) - 1),
    }[kind];
    const { [`${name}Title`]: title, [`${name}Unit`]: unit } = svg.dataset;
    // As many digits as tell two pixels of a narrow range apart.
    const size = Math.max(Math.abs(lo), Math.abs(hi)) / (hi - lo);
    const digits = kind === "linear" ? Math.min(15, 3 + Math.max(0, Math.ceil(Math.log10(size)))) : 3;
    return (pixel) => {
      const value = unwarp(lo + ((pixel - from) / (to - from)) * (hi - lo));
      const [factor, name] = unit === "durations" ? inTime(value) : [1, unit];
      return `${title}: ${number(value * factor, digits)} ${name}`.trim();
    };
  };

  const legend = (svg) => {
    for (const key of all(".lf-key", svg)) {
      const lines = all(`.lf-s[data-line="${key.dataset.line}"]`, svg);
      const hot = (on) => {
        svg.classList.toggle("lf-dim", on && key.getAttribute("aria-pressed") === "true");
        lines.forEach((line) => line.classList.toggle("lf-hot", on));
      };
      const toggle = () => {
        const shown = key.getAttribute("aria-pressed") === "true";
        key.setAttribute("aria-pressed", String(!shown));
        lines.forEach((line) => line.classList.toggle("lf-off", shown));
        hot(!shown);
      };
      key.setAttribute("role", "button");
      key.setAttribute("tabindex", "0");
      key.setAttribute("aria-pressed", "true");
      key.setAttribute("aria-label", `Show ${key.dataset.series}`);
      key.addEventListener("click", toggle);
      key.addEventListener("keydown", (event) => {
        if (event.key !== "Enter" && event.key !== " ") return;
        event.preventDefault();
        toggle();
      });
      key.addEventListener("pointerenter", () => hot(true));
      key.addEventListener("pointerleave", () => hot(false));
    }
  };

  // Numbers along the axis that would touch are left out: all but every second, fifth, … so that the others stand at even
  // distances; those between the decades first.
  const thinOut = (labels) => {
    labels.forEach((label) => label.classList.remove("lf-off"));
    const spots = labels.map((label) =>
      ({ label, half: label.getComputedTextLength() / 2 + 4, at: Number(label.getAttribute("x")), n: label.dataset.n }));
    const fit = (some) => some.every((a, i) => some.slice(0, i).every((b) => Math.abs(a.at - b.at) >= a.half + b.half));
    const even = spots.filter((spot) => spot.n !== undefined);
    const every = (k) => even.filter((spot) => spot.n % k === 0);
    const kept = fit(spots) ? spots : every([1, 2, 5, 10, 20, 50, 100].find((k) => fit(every(k))) || 200);
    spots.forEach((spot) => spot.label.classList.toggle("lf-off", !kept.includes(spot)));
  };

  // Draws a chart as wide as its place: lines are stretched, text and markers keep their size. On a narrow
  // screen the names of the lines move below the data.
  const stretch = (svg) => {
    const [, , wide, high] = svg.getAttribute("viewBox").split(" ").map(Number);
    const [left, right, bottom] = svg.dataset.plot.split(" ").map(Number);
    const keys = all(".lf-key", svg), names = all(".lf-key text", svg), paths = all(".lf-grid,.lf-minor,.lf-frame,.lf-mark,.lf-line", svg);
    const ticks = all(".lf-tick[text-anchor=middle]", svg), title = svg.querySelector(".lf-label");
    const texts = ticks.map((tick) => [tick, Number(tick.getAttribute("x"))]);
    const markers = all(".lf-p", svg).map((p) => [p, ...p.getAttribute("transform").match(/-?[\d.]+/g).map(Number)]);
    const paper = svg.querySelector(".lf-paper");
    const place = { factor: 1, at: (x) => left + (x - left) * place.factor };
    const apply = () => {
      const width = svg.parentElement.clientWidth;
      if (!width) return; // Within a closed fold.
      const narrow = width < 620;
      // In a font that is wider than expected the names need more room.
      const over = Math.max(0, ...names.map((name) => Number(name.getAttribute("x")) + name.getComputedTextLength() - wide));
      const end = narrow ? width - 14 : right + width - wide - over;
      place.factor = (end - left) / (right - left);
      svg.classList.toggle("lf-narrow", narrow);
      paths.forEach((p) => p.setAttribute("transform", `matrix(${place.factor} 0 0 1 ${left - left * place.factor} 0)`));
      texts.forEach(([tick, x]) => tick.setAttribute("x", place.at(x)));
      markers.forEach(([p, x, y]) => p.setAttribute("transform", `translate(${place.at(x)} ${y})`));
      title.setAttribute("x", (left + end) / 2);
      let x = left, y = bottom + 52;
      // Beside the data the names are in the order of the ends of their lines, below in that of the lines.
      const inOrder = [...keys].sort((a, b) => a.dataset.line - b.dataset.line);
      (narrow ? inOrder : keys).forEach((key) => {
        if (!narrow) return key.setAttribute("transform", `translate(${end - right} 0)`);
        const box = key.querySelector("rect"), sample = key.querySelector("text");
        const length = Number(sample.getAttribute("x")) - Number(box.getAttribute("x")) + sample.getComputedTextLength();
        if (x > left && x + length > width) [x, y] = [left, y + 24];
        key.setAttribute("transform", `translate(${x - box.getAttribute("x")} ${y - box.getAttribute("y")})`);
        x += length + 14;
      });
      const height = narrow ? y + 24 : high;
      Object.entries({ viewBox: `0 0 ${width} ${height}`, width, height })
        .forEach(([name, value]) => svg.setAttribute(name, value));
      Object.entries({ width, height }).forEach(([name, value]) => paper.setAttribute(name, value));
      thinOut(ticks);
    };
    new ResizeObserver(apply).observe(svg.parentElement);
    apply();
    return place;
  };

  // The text of other figures, which are scaled as a whole, keeps its size.
  const keepText = (svg) => {
    const natural = Number(svg.getAttribute("width"));
    const apply = () => svg.style.setProperty("--lf-text", Math.max(1, natural / (svg.clientWidth || natural)));
    new ResizeObserver(apply).observe(svg);
    apply();
  };

  const chart = (svg) => {
    titleToLabel(svg);
    svg.setAttribute("role", "group");
    const valueX = axisOf(svg, "x"), valueY = axisOf(svg, "y");
    const cursor = svg.appendChild(document.createElementNS(svg.namespaceURI, "circle"));
    cursor.setAttribute("class", "lf-cursor");
    cursor.setAttribute("r", "0");
    // What a reader can point at: markers, and dense lines, of which the corners are kept.
    const marks = [], runs = [], stops = [];
    for (const element of all(".lf-p,.lf-dense", svg)) {
      const lines = titleToLabel(element), group = element.closest(".lf-s");
      element.setAttribute("role", "img");
      if (element.classList.contains("lf-dense")) {
        for (const piece of (element.getAttribute("d") || "").split("M")) {
          const numbers = (piece.match(/-?[\d.]+/g) || []).map(Number), points = [];
          for (let i = 0; i + 1 < numbers.length; i += 2) points.push([numbers[i], numbers[i + 1]]);
          if (points.length) runs.push({ points, group, name: lines[0] });
        }
        if (element.getAttribute("d")) stops.push({ element, group, lines });
      } else {
        const [x, y] = element.getAttribute("transform").match(/-?[\d.]+/g).map(Number);
        marks.push({ element, group, lines, x, y });
        stops.push({ element, group, lines });
      }
    }
    const place = stretch(svg);
    const clear = () => {
      tip.hidden = true;
      cursor.setAttribute("r", "0");
      all(".lf-on", svg).forEach((element) => element.classList.remove("lf-on"));
    };
    // The nearest point of a line, in pixels of the screen.
    const onSegment = (at, [x0, y0], [x1, y1]) => {
      const [a, b] = [place.at(x0), place.at(x1)];
      const length = (b - a) ** 2 + (y1 - y0) ** 2;
      const along = length ? ((at.x - a) * (b - a) + (at.y - y0) * (y1 - y0)) / length : 0;
      const t = Math.max(0, Math.min(1, along));
      return { x: x0 + t * (x1 - x0), y: y0 + t * (y1 - y0), far: Math.hypot(a + t * (b - a) - at.x, y0 + t * (y1 - y0) - at.y) };
    };
    svg.addEventListener("pointermove", (event) => {
      const matrix = svg.getScreenCTM();
      const at = new DOMPoint(event.clientX, event.clientY).matrixTransform(matrix.inverse());
      let best = { far: 16 };
      const look = (candidate) => { if (candidate.far < best.far) best = candidate; };
      const shown = ({ group }) => !group.classList.contains("lf-off");
      marks.filter(shown).forEach((mark) =>
        look({ mark, far: Math.hypot(place.at(mark.x) - at.x, mark.y - at.y) }));
      for (const { points, name } of runs.filter(shown)) {
        points.forEach((point, i) => look({ name, ...onSegment(at, points[Math.max(0, i - 1)], point) }));
      }
      clear();
      if (best.mark) {
        best.mark.element.classList.add("lf-on");
        showTip(best.mark.lines, event.clientX, event.clientY);
      } else if (best.name) {
        Object.entries({ cx: place.at(best.x), cy: best.y, r: 4 }).forEach(([k, v]) => cursor.setAttribute(k, v));
        showTip([best.name, valueX(best.x), valueY(best.y)], event.clientX, event.clientY);
      }
    });
    svg.addEventListener("pointerleave", clear);

    // One stop of the tab key; the arrow keys go along a line and from line to line.
    if (stops.length) stops[0].element.setAttribute("tabindex", "0");
    const go = (stop) => {
      stops.forEach((s) => s.element.setAttribute("tabindex", s === stop ? "0" : "-1"));
      stop.element.focus();
    };
    stops.forEach((stop, i) => {
      stop.element.addEventListener("focus", () => {
        const box = stop.element.getBoundingClientRect();
        showTip(stop.lines, box.left + box.width / 2, box.top + box.height / 2);
      });
      stop.element.addEventListener("blur", clear);
      stop.element.addEventListener("keydown", (event) => {
        const visible = stops.filter((s) => !s.group.classList.contains("lf-off"));
        const line = visible.filter((s) => s.group === stop.group);
        const groups = [...new Set(visible.map((s) => s.group))];
        const step = { ArrowRight: 1, ArrowLeft: -1, ArrowDown: 1, ArrowUp: -1 }[event.key];
        if (event.key === "Escape") clear();
        if (!step) return;
        event.preventDefault();
        const here = line.indexOf(stop);
        if (event.key === "ArrowRight" || event.key === "ArrowLeft") {
          if (line[here + step]) go(line[here + step]);
          return;
        }
        const group = groups[(groups.indexOf(stop.group) + step + groups.length) % groups.length];
        const other = visible.filter((s) => s.group === group);
        if (other.length) go(other[Math.min(here, other.length - 1)]);
      });
    });
    legend(svg);
  };

  all("svg.lf-chart").forEach(chart);
  all("svg.lf:not(.lf-chart)").forEach((svg) => {
    titleToLabel(svg);
    legend(svg);
    keepText(svg);
  });
})();
