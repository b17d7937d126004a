// Small pictures of a study: a slice with both walls, the polar map of its perfusion, its volume curve, on canvases.

const scale: [number, number, number][] = [
  [68, 1, 84],
  [59, 82, 139],
  [33, 145, 140],
  [94, 201, 98],
  [253, 231, 37],
];

function colourAt(share: number): string {
  const place = Math.min(Math.max(share, 0), 1) * (scale.length - 1);
  const low = Math.min(Math.floor(place), scale.length - 2);
  const mixed = scale[low]!.map((v, n) => Math.round(v + (place - low) * (scale[low + 1]![n]! - v)));
  return `rgb(${mixed.join(",")})`;
}

/** Segments of the AHA's model of 17: rings from outside, how many in each, and where the first has its middle. */
const rings: [number, number, number][] = [
  [6, 0.75, 1],
  [6, 0.5, 0.75],
  [4, 0.25, 0.5],
  [1, 0, 0.25],
];

/** A sharp canvas of a size in pixels of the page. */
function canvasOf(width: number, height: number, name: string): [HTMLCanvasElement, CanvasRenderingContext2D] {
  const canvas = document.createElement("canvas");
  const ratio = Math.min(window.devicePixelRatio || 1, 2);
  canvas.width = width * ratio;
  canvas.height = height * ratio;
  canvas.style.width = `${width}px`;
  canvas.style.height = `${height}px`;
  canvas.className = name;
  const context = canvas.getContext("2d")!;
  context.scale(ratio, ratio);
  return [canvas, context];
}

// The slices of a study as draw_splash lays them out, at half size: rows of eight square cells, end diastole first.
const cells = { across: 8, middle: 4, gap: 2, title: 8 };

/** The slice of end diastole in the middle of the heart, cut out of a PNG in base64; grey without one. */
export function sliceThumb(png: string | undefined, size: number): HTMLCanvasElement {
  const [canvas, context] = canvasOf(size, size, "slice");
  context.fillStyle = "#eef2f5";
  context.fillRect(0, 0, size, size);
  if (!png) return canvas;
  const picture = new Image();
  picture.onload = () => {
    const step = (picture.naturalWidth - cells.gap) / cells.across;
    const side = step - cells.gap;
    context.drawImage(picture, cells.gap + cells.middle * step, cells.gap + cells.title, side, side, 0, 0, size, size);
  };
  picture.src = `data:image/png;base64,${png}`;
  return canvas;
}

/** Perfusion in 17 segments, 40 to 100 % of the bright wall; grey where there is none. Anterior wall on top, septum left. */
export function polarThumb(values: (number | null)[], size: number): HTMLCanvasElement {
  const [canvas, context] = canvasOf(size, size, "polar");
  const middle = size / 2;
  const radius = middle - 1;
  let segment = 0;
  for (const [count, inner, outer] of rings) {
    for (let n = 0; n < count; ++n) {
      const value = values.length === 17 ? values[segment] : null;
      ++segment;
      // Segment 1 is anterior; the numbers go against the clock, over the septum.
      const angle = -Math.PI / 2 - (2 * Math.PI * n) / count;
      const half = Math.PI / count;
      context.beginPath();
      context.arc(middle, middle, radius * outer, angle - half, angle + half);
      if (inner > 0) context.arc(middle, middle, radius * inner, angle + half, angle - half, true);
      context.closePath();
      context.fillStyle = value === null || value === undefined ? "#dfe5ea" : colourAt((value - 40) / 60);
      context.fill();
      context.strokeStyle = "#fff";
      context.lineWidth = 0.7;
      context.stroke();
    }
  }
  return canvas;
}

export function curveThumb(values: (number | null)[], width: number, height: number): HTMLCanvasElement {
  const [canvas, context] = canvasOf(width, height, "curve");
  const known = values.filter((v): v is number => v !== null);
  if (known.length < 2) return canvas;
  const top = Math.max(...known);
  context.strokeStyle = "#c3ced8";
  context.strokeRect(0.5, 0.5, width - 1, height - 1);
  context.strokeStyle = "#0a5ea8";
  context.lineWidth = 1.6;
  context.beginPath();
  let drawn = false;
  // The beat comes round to its first gate.
  [...values, values[0]!].forEach((v, n) => {
    if (v === null) return;
    const x = 4 + ((width - 8) * n) / values.length;
    const y = height - 4 - ((height - 8) * v) / top;
    if (drawn) context.lineTo(x, y);
    else context.moveTo(x, y);
    drawn = true;
  });
  context.stroke();
  return canvas;
}
