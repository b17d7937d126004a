import base64
import gzip
import html
import json
import os
import pathlib
import re
import shutil
import subprocess
import sys

import dynasurf as ds
import numpy as np
import pytest


@pytest.fixture(autouse=True)
def no_window(monkeypatch):
    monkeypatch.setenv("MPLBACKEND", "Agg")


def test_meshio_gets_every_vertex_and_triangle(heart):
    meshio = pytest.importorskip("meshio")
    surface = heart.gates[0].endo
    mesh = surface.to_meshio()
    assert isinstance(mesh, meshio.Mesh)
    assert np.array_equal(mesh.points, surface.vertices) and np.array_equal(mesh.cells[0].data, surface.triangles)


def test_trimesh_gets_the_same_body(heart):
    pytest.importorskip("trimesh")
    surface = heart.gates[0].endo
    body = surface.to_trimesh()
    assert body.is_watertight and np.array_equal(body.vertices, surface.vertices)
    assert body.volume / 1000 == pytest.approx(surface.volume_ml.value, rel=1e-9)


def test_pyvista_gets_the_same_body(heart):
    pytest.importorskip("pyvista")
    surface = heart.gates[0].endo
    body = surface.to_pyvista()
    assert body.n_points == len(surface.vertices) and body.n_cells == len(surface.triangles) and body.n_open_edges == 0
    assert body.volume / 1000 == pytest.approx(surface.volume_ml.value, rel=1e-4)  # VTK sums columns


def test_meshio_writes_what_the_program_reads(heart, tmp_path):
    meshio = pytest.importorskip("meshio")
    surface = heart.gates[0].epi
    meshio.write(tmp_path / "epi.ply", surface.to_meshio())
    assert np.array_equal(ds.io.read_mesh(tmp_path / "epi.ply").vertices, surface.vertices)


def test_meshio_gets_a_solid():
    pytest.importorskip("meshio")
    inner = ds.mesh.icosphere(1)
    solid = ds.mesh.fill_between(inner, ds.TriMesh(inner.vertices * 2, inner.triangles))
    assert solid.to_meshio().cells[0].type == "tetra"


def test_pandas_gets_a_row_per_gate_and_level(heart, lods):
    pytest.importorskip("pandas")
    table = heart.to_pandas()
    assert list(table.columns) == ["gate", "time_ms", "endo_ml", "epi_ml", "wall_ml"] and len(table) == 6
    assert table.endo_ml.max() == pytest.approx(heart.edv.value)
    assert list(lods.to_pandas().triangles) == [1280, 320]


@pytest.mark.parametrize("what", ["curve", "polar", "slices"])
def test_plots_are_drawn(heart, what, tmp_path):
    pyplot = pytest.importorskip("matplotlib.pyplot")
    figure = heart.plot(what)
    figure.savefig(tmp_path / "p.png")
    assert (tmp_path / "p.png").stat().st_size > 5000
    pyplot.close(figure)


def test_an_unknown_plot_names_the_choices(heart):
    pytest.importorskip("matplotlib")
    with pytest.raises(ds.OptionError, match="curve, polar, slices"):
        heart.plot("pie")


@pytest.mark.parametrize(
    ("module", "call"),
    [
        ("trimesh", "ds.mesh.icosphere(1).to_trimesh()"),
        ("meshio", "ds.mesh.icosphere(1).to_meshio()"),
        ("pyvista", "ds.mesh.icosphere(1).to_pyvista()"),
        ("nibabel", "ds.Image([[[1]]], spacing=(1, 1, 1)).to_nibabel()"),
        ("pandas", "ds.cloud.reconstruct(ds.synthetic.make_cloud(points=500), triangles=[80]).to_pandas()"),
    ],
)
def test_what_is_not_installed_is_named(module, call):
    script = f"import sys; sys.modules[{module!r}] = None\nimport dynasurf as ds\n{call}"
    done = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True)
    assert f"this needs {module}, which is not installed" in done.stderr


def test_friends_are_not_imported_before_they_are_asked_for():
    script = "import sys, dynasurf; print([m for m in ('numpy', 'matplotlib', 'nibabel', 'pandas', 'tqdm') if m in sys.modules])"
    assert subprocess.run([sys.executable, "-c", script], capture_output=True, text=True).stdout == "[]\n"


def parts_of(frame):
    loader = html.unescape(re.search(r'srcdoc="([^"]*)"', frame)[1])
    return json.loads(gzip.decompress(base64.b64decode(re.search(r'id="packed">([^<]*)<', loader)[1])))


def test_a_notebook_shows_the_reports_page(heart):
    frame = heart._repr_html_()
    assert len(frame) <= 400_000 and 'sandbox="allow-scripts"' in frame and "allow-same-origin" not in frame
    parts = parts_of(frame)
    assert parts["data"]["results"]["edv_ml"] == pytest.approx(heart.edv.value)
    assert "default-src 'none'" in parts["head"] or "has no interactive page" in parts["head"]
    assert [(w["wall"], w["gates"], w["vertices"]) for w in parts["walls"]] == \
        [(w, 6, len(getattr(heart.gates[0], w).vertices)) for w in ("endo", "epi")]  # fmt: skip


def test_a_notebook_shows_a_result_without_walls():
    nothing = ds.ventricle.reconstruct(ds.Study(np.zeros((2, 8, 32, 32)), spacing=(4, 4, 4)))
    assert nothing.verdict == "fail" and nothing.ef is None and parts_of(nothing._repr_html_())["walls"] == []
    assert len(nothing.segments) == 0 and np.isnan(nothing.volumes_ml).all() and "fail" in repr(nothing)


def test_a_notebook_shows_the_clouds_page(lods):
    frame = lods._repr_html_()
    assert len(parts_of(frame)["data"]["results"]["levels"]) == 2 and len(frame) <= 400_000


BROWSE = """
const {{ chromium }} = require("playwright-core");
(async () => {{
  const browser = await chromium.launch({{executablePath: {browser!r}, args: ["--no-sandbox", "--enable-unsafe-swiftshader"]}});
  const page = await browser.newPage({{viewport: {{width: 1000, height: 1200}}}});
  const asked = [];
  page.on("request", request => asked.push(request.url()));
  await page.goto({address!r});
  let text = "";
  for (let tries = 0; tries < 100 && !text.includes({word!r}); ++tries) {{
    await page.waitForTimeout(200);
    text = await page.frames()[1].evaluate(() => document.body.innerText).catch(() => "");
  }}
  await page.mouse.wheel(0, 3000);
  for (let tries = 0; tries < 150; ++tries) {{
    await page.waitForTimeout(200);
    if (await page.frames()[1].evaluate(() => document.documentElement.dataset.ready).catch(() => "")) break;
  }}
  await page.waitForTimeout(3000);
  await page.screenshot({{path: {picture!r}}});
  const canvas = await page.frames()[1].locator("canvas").first().boundingBox();
  console.log(JSON.stringify({{asked: asked.length, text, canvas}}));
  await browser.close();
}})();
"""


@pytest.mark.parametrize(("what", "word"), [("heart", "Ejection fraction"), ("lods", "triangles")])
def test_the_page_is_drawn_in_a_browser_that_asks_for_nothing_else(what, word, request, tmp_path):
    """Below the first screen, as in a notebook; scrolled to, its surfaces stand on their dark ground."""
    image = pytest.importorskip("matplotlib.image")
    browser, node = shutil.which("chromium"), shutil.which("node")
    modules = pathlib.Path(os.environ.get("DYNASURF_SOURCE", "."), "web/node_modules")
    if not (browser and node and (modules / "playwright-core").is_dir()):
        pytest.skip("Chromium, Node.js or playwright-core is not installed")
    frame = request.getfixturevalue(what)._repr_html_()
    if "has no interactive page" in parts_of(frame)["head"]:
        pytest.skip("this build has no interactive page")
    (tmp_path / "page.html").write_text("<!doctype html><div style='height:3000px'></div>" + frame)
    script = BROWSE.format(browser=browser, address=f"file://{tmp_path}/page.html", word=word,
                           picture=str(tmp_path / "page.png"))  # fmt: skip
    done = subprocess.run([node, "-e", script], capture_output=True, text=True, timeout=240,
                          env={**os.environ, "NODE_PATH": str(modules)})  # fmt: skip
    told = json.loads(done.stdout)
    assert told["asked"] == 1 and word in told["text"]
    box = {side: int(length) for side, length in told["canvas"].items()}
    x, y = box["x"] + box["width"] // 4, box["y"] + box["height"] // 4
    middle = image.imread(tmp_path / "page.png")[y : y + box["height"] // 2, x : x + box["width"] // 2, :3]
    assert (middle.max(axis=2) > 0.35).mean() > 0.3 and middle.std() > 0.05


def test_text_tells_the_numbers(heart, lods):
    assert re.fullmatch(r"<dynasurf.VentricleResult of 6 gates: ef [\d.]+ \(.*\) %, edv .* mL, esv .* mL, \w+>", repr(heart))
    assert "1280, 320 triangles: watertight" in repr(lods)
