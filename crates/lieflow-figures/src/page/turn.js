"use strict";
// Turns a figure by dragging and by the arrow keys: `draw` gets the azimuth and the elevation in degrees.
const turnable = (svg, [azimuth, elevation], draw, what) => {
  const view = [azimuth, elevation];
  let waiting = false;
  const rotate = (byAzimuth, byElevation) => {
    view[0] = (view[0] + byAzimuth) % 360;
    view[1] = Math.max(-90, Math.min(90, view[1] + byElevation));
    if (waiting) return;
    waiting = true;
    requestAnimationFrame(() => {
      waiting = false;
      draw(...view);
    });
  };
  svg.addEventListener("pointerdown", (event) => {
    if (!event.target.closest(".lf-key")) svg.setPointerCapture(event.pointerId);
  });
  svg.addEventListener("pointermove", (event) => {
    if (svg.hasPointerCapture(event.pointerId)) rotate(-event.movementX / 2, event.movementY / 2);
  });
  svg.addEventListener("keydown", (event) => {
    const by = { ArrowLeft: [5, 0], ArrowRight: [-5, 0], ArrowUp: [0, -5], ArrowDown: [0, 5] }[event.key];
    if (event.key === "Home") rotate(azimuth - view[0], elevation - view[1]);
    if (!by && event.key !== "Home") return;
    event.preventDefault();
    if (by) rotate(...by);
  });
  svg.setAttribute("role", "group");
  svg.setAttribute("tabindex", "0");
  svg.setAttribute("aria-roledescription", "figure to turn with the arrow keys");
  svg.classList.add("lf-turns");
  const hint = svg.parentElement.appendChild(document.createElement("p"));
  hint.className = "hint";
  hint.textContent = `Drag, or use the arrow keys, to turn the ${what}. Home restores the view.`;
  return view;
};

// The directions to the right, upward and to the viewer.
const camera = (azimuth, elevation) => {
  const [a, e] = [azimuth, elevation].map((degrees) => (degrees * Math.PI) / 180);
  return {
    right: [-Math.sin(a), Math.cos(a), 0],
    up: [-Math.sin(e) * Math.cos(a), -Math.sin(e) * Math.sin(a), Math.cos(e)],
    toward: [Math.cos(e) * Math.cos(a), Math.cos(e) * Math.sin(a), Math.sin(e)],
  };
};
const dot = (a, b) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
const px = (x) => String(Math.round(x * 10) / 10);
