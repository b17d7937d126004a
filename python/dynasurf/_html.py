"""What a notebook shows of a result: the program's own page in a frame that loads nothing and may reach nothing.

A notebook may hold ten results, so a page is packed to 400 kB: slices are binned, and places of vertices are rounded to
eight of the page's steps (0.02 mm) and told by their differences from gate to gate and from vertex to vertex.
"""

_MOST_VOXELS = 20_000
_ROUNDED_BITS = 3
_DATA = r'(<script[^>]*id="data"[^>]*>)(.*?)(</script>)'

# The frame unpacks the page and becomes it. `walls` holds the differences: the low bytes of all numbers, then the high.
_LOADER = """<!doctype html><meta charset="utf-8"><title>Dynasurf</title><body>
<script type="text/plain" id="packed">{packed}</script>
<script>
const bytesOf = text => Uint8Array.from(atob(text), c => c.charCodeAt(0));
const textOf = bytes => {{ let t = ""; for (const b of bytes) t += String.fromCharCode(b); return btoa(t); }};
function restore(data, walls) {{
  for (const {{wall, gates, vertices, bytes}} of walls) {{
    const packed = bytesOf(bytes), n = packed.length / 2, one = vertices * 3;
    let former = new Int32Array(one);
    for (let g = 0; g < gates; ++g) {{
      const now = new Uint16Array(one), kept = new Int32Array(one);
      for (let a = 0; a < 3; ++a)
        for (let v = 0, sum = 0; v < vertices; ++v) {{
          const at = (a * gates + g) * vertices + v, code = packed[at] | (packed[n + at] << 8);
          sum += (code >> 1) ^ -(code & 1);
          kept[3 * v + a] = former[3 * v + a] + sum;
          now[3 * v + a] = kept[3 * v + a] << {bits};
        }}
      former = kept;
      data.surfaces[wall][g].positions = textOf(new Uint8Array(now.buffer));
    }}
  }}
}}
(async () => {{
  const unpacked = new Blob([bytesOf(document.getElementById("packed").textContent)]).stream()
    .pipeThrough(new DecompressionStream("gzip"));
  const {{head, data, tail, walls}} = JSON.parse(await new Response(unpacked).text());
  restore(data, walls);
  document.open();
  document.write(head + JSON.stringify(data).replaceAll("<", "\\\\u003c") + tail);
  document.close();
}})();
</script>"""

_FRAME = '<iframe sandbox="allow-scripts" style="width:100%;height:{height}px;border:0" title="{title}" srcdoc="{page}"></iframe>'


def _differences(positions):
    """Places of the vertices of all gates, (gates, vertices, 3), as bytes that pack well."""
    import numpy as np

    steps = positions.astype(np.int32) >> _ROUNDED_BITS
    steps[1:] -= steps[:-1].copy()
    steps[:, 1:] -= steps[:, :-1].copy()
    codes = ((steps << 1) ^ (steps >> 31)).transpose(2, 0, 1)  # signs last: small numbers of either sign are small
    return (codes & 255).astype(np.uint8).tobytes() + (codes >> 8).astype(np.uint8).tobytes()


def _take_walls(data):
    """Takes the places of vertices out of the page's data, where all gates have the same ones."""
    import base64

    import numpy as np

    walls = []
    for wall in ("endo", "epi"):
        gates = data["surfaces"][wall]
        if not gates or any(gate is None for gate in gates):
            continue
        places = [np.frombuffer(base64.b64decode(gate["positions"]), "<u2").reshape(-1, 3) for gate in gates]
        if len({len(p) for p in places}) != 1:
            continue
        packed = base64.b64encode(_differences(np.stack(places))).decode()
        walls.append({"wall": wall, "gates": len(places), "vertices": len(places[0]), "bytes": packed})
        for gate in gates:
            gate["positions"] = ""
    return walls


def framed(page, title, height):
    """A page of the program in a sandboxed frame, packed.

    Browsers draw nothing in such a frame before it is scrolled to: a picture of a whole notebook shows it empty, unless
    it was seen before.
    """
    import base64
    import gzip
    import html
    import json
    import re

    found = re.search(_DATA, page, re.S)
    data = json.loads(found[2])
    walls = _take_walls(data) if "epi" in (data.get("surfaces") or {}) else []
    parts = {"head": page[: found.end(1)], "data": data, "tail": page[found.start(3) :], "walls": walls}
    text = json.dumps(parts, separators=(",", ":"))
    packed = base64.b64encode(gzip.compress(text.encode(), 9, mtime=0)).decode()
    loader = _LOADER.format(packed=packed, bits=_ROUNDED_BITS)
    return _FRAME.format(title=html.escape(title), height=height, page=html.escape(loader))


def of_heart(heart):
    """The beating heart, the curve and the verdict."""
    return framed(heart.report_html(_MOST_VOXELS), "Report of the left ventricle", 1290)  # down to the end of its surfaces


def of_cloud(lods):
    """The levels of detail side by side, and their certificates."""
    return framed(lods.report_html(), "Levels of detail", 900)
