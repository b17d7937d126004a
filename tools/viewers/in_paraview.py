"""Opens a result of `dynasurf ventricle` in ParaView, prints what ParaView sees and draws the wall at end systole.

pvbatch tools/viewers/in_paraview.py RESULT PICTURE.png
"""

import json
import pathlib
import sys

from paraview.simple import (ColorBy, CreateView, ExtractBlock, GetColorTransferFunction, GetScalarBar, PVDReader,
                             Render, SaveScreenshot, Show)  # fmt: skip

folder, picture = pathlib.Path(sys.argv[1]), sys.argv[2]
results = json.loads((folder / "results.json").read_text())
series = PVDReader(FileName=str(folder / "cycle.pvd"))
series.UpdatePipeline()
walls = [ExtractBlock(Input=series, Selectors=[f"/Root/Block{part}"]) for part in (0, 1)]

seen = []
for time in series.TimestepValues:
    for wall in walls:
        wall.UpdatePipeline(time)
    infos = [wall.GetDataInformation() for wall in walls]
    seen.append([[info.GetNumberOfPoints(), list(info.GetBounds())] for info in infos])

view = CreateView("RenderView")
view.ViewSize = [900, 700]
view.ViewTime = series.TimestepValues[results["es_gate"] - 1]
view.UseColorPaletteForBackground = 0
view.Background = [1, 1, 1]
view.OrientationAxesLabelColor = [0, 0, 0]
inner, outer = (Show(wall, view) for wall in walls)
ColorBy(inner, ("POINTS", "thickness_mm"))
colours = GetColorTransferFunction("thickness_mm")
inner.RescaleTransferFunctionToDataRange(False, True)
inner.SetScalarBarVisibility(view, True)
bar = GetScalarBar(colours, view)
bar.TitleColor = bar.LabelColor = [0, 0, 0]
bar.Title = "thickness, mm"
outer.ColorArrayName = ["POINTS", ""]
outer.Opacity = 0.2
outer.DiffuseColor = [0.85, 0.45, 0.3]
camera = view.GetActiveCamera()
bounds = seen[0][1][1]
middle = [(bounds[2 * a] + bounds[2 * a + 1]) / 2 for a in range(3)]
camera.SetFocalPoint(*middle)
camera.SetPosition(middle[0] + 60, middle[1] - 260, middle[2] + 60)  # from the front, a little from the left and above
camera.SetViewUp(0, 0, 1)
Render(view)
SaveScreenshot(picture, view)
print(json.dumps({"times": list(series.TimestepValues), "walls": seen, "arrays": sorted(series.PointData.keys())}))
