// Labels that overlap neither each other nor the edge of the drawing.

const measuring = document.createElement("canvas").getContext("2d");

const fontFamily = getComputedStyle(document.body).fontFamily;

function textWidth(text, size) {
  measuring.font = `600 ${size}px ${fontFamily}`;
  return measuring.measureText(text).width;
}

const overlap = (a, b) =>
  Math.max(0, Math.min(a.x1, b.x1) - Math.max(a.x0, b.x0)) * Math.max(0, Math.min(a.y1, b.y1) - Math.max(a.y0, b.y0));

/**
 * Places labels { text, x, y, dx, dy, colour } at the points (x, y), on the side (dx, dy) if there is room, and draws
 * them; a label that does not fit next to its point is moved away and joined to it by a line.
 */
function placeLabels(parent, labels, obstacles, width, height) {
  const size = 13;
  const taken = obstacles.slice();
  for (const label of labels) {
    const w = textWidth(label.text, size) + 6;
    const h = size + 5;
    let best = null;
    const straight = Math.atan2(label.dy, label.dx);
    for (const distance of [4, 14, 30, 55, 90])
      for (const turn of [0, 0.6, -0.6, 1.2, -1.2, 1.8, -1.8, 2.5, -2.5, Math.PI]) {
        const [c, s] = [Math.cos(straight + turn), Math.sin(straight + turn)];
        // The centre of a box whose edge is at the distance from the point.
        const reach = distance + Math.min(w / 2 / Math.max(Math.abs(c), 1e-6), h / 2 / Math.max(Math.abs(s), 1e-6));
        const [x, y] = [label.x + c * reach, label.y + s * reach];
        const box = { x0: x - w / 2, x1: x + w / 2, y0: y - h / 2, y1: y + h / 2 };
        const outside = w * h - overlap(box, { x0: 2, y0: 2, x1: width - 2, y1: height - 2 });
        const covered = taken.reduce((sum, other) => sum + overlap(box, other), 0);
        const cost = 20 * outside + 10 * covered + 2 * distance + 3 * Math.abs(turn);
        if (!best || cost < best.cost) best = { cost, x, y, box, distance };
      }
    taken.push(best.box);
    if (best.distance > 20)
      draw(parent, "line", { x1: label.x, y1: label.y, x2: best.x, y2: best.y, stroke: label.colour, "stroke-width": 0.8, "stroke-opacity": 0.6 });
    draw(parent, "text", {
      x: best.x, y: best.y + size * 0.35, "font-size": size, "font-weight": 600, "text-anchor": "middle", class: "halo",
      style: `fill: ${label.colour}`,
    }, label.text);
  }
}
