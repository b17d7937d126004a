"""Lets VTK read what the program writes for ParaView and other tools, and compares.

usage: vtk_reads.py TEST_IO WORK_FOLDER      exit code 77: skipped, VTK for Python is not installed
"""
import os
import shutil
import subprocess
import sys

try:
    import vtk
    from vtk.util.numpy_support import vtk_to_numpy
except ImportError:
    print("skipped: no VTK (apt-get install python3-vtk9)")
    sys.exit(77)

program, work = sys.argv[1:]
shutil.rmtree(work, ignore_errors=True)
os.makedirs(work)
subprocess.run([program, "--gtest_filter=*WritesSamplesForVtk"], check=True, stdout=subprocess.DEVNULL,
               env={**os.environ, "DYNASURF_VTK_SAMPLES": work})


def read(reader, name):
    reader.SetFileName(os.path.join(work, name))
    reader.Update()
    assert reader.GetErrorCode() == 0, name
    return reader.GetOutput()


def near(a, b, relative):
    return abs(a - b) <= relative * max(abs(a), abs(b))


# Every mesh: the volume, place and size that VTK sees are those the program measured.
expected = dict(line.split("=") for line in open(os.path.join(work, "expected.txt")).read().split())
readers = {"ply": vtk.vtkPLYReader, "stl": vtk.vtkSTLReader, "obj": vtk.vtkOBJReader,
           "vtp": vtk.vtkXMLPolyDataReader}  # VTK has no reader for OFF
for ending, reader in readers.items():
    mesh = read(reader(), "ball." + ending)
    assert mesh.GetNumberOfPoints() == int(expected["vertices"]), ending
    assert mesh.GetNumberOfPolys() == int(expected["triangles"]), ending
    mass = vtk.vtkMassProperties()
    mass.SetInputData(mesh)
    # VTK's own sum of columns is good to about 1e-5 in single precision.
    assert near(mass.GetVolume(), float(expected["volume_mm3"]), 1e-4), (ending, mass.GetVolume())
    bounds = mesh.GetBounds()
    for i, key in enumerate(["xmin", "xmax", "ymin", "ymax", "zmin", "zmax"]):
        assert near(bounds[i], float(expected[key]), 1e-6), (ending, key, bounds[i])
    print(f"ball.{ending}: {mesh.GetNumberOfPoints()} points, {mass.GetVolume():.3f} mm3")

# The space, where 3D Slicer looks for it: its vtkMRMLModelStorageNode asks VTK's readers for these.
def comments_of(ply):
    return [ply.GetComments().GetValue(n) for n in range(ply.GetComments().GetNumberOfValues())]


asked = {"ply": (vtk.vtkPLYReader(), comments_of), "stl": (vtk.vtkSTLReader(), lambda stl: [stl.GetHeader()]),
         "obj": (vtk.vtkOBJReader(), lambda obj: [obj.GetComment()])}
for ending, (reader, texts_of) in asked.items():
    read(reader, "ball." + ending)
    assert any("SPACE=LPS" in text for text in texts_of(reader)), (ending, texts_of(reader))
space = read(vtk.vtkXMLPolyDataReader(), "ball.vtp").GetFieldData().GetAbstractArray("SPACE")
assert space.GetClassName() == "vtkStringArray" and space.GetValue(0) == "LPS"
print("SPACE is LPS in PLY, STL, OBJ and VTP")

mesh = read(vtk.vtkXMLPolyDataReader(), "ball.vtp")
normals = mesh.GetPointData().GetNormals()
assert normals is not None and normals.GetNumberOfComponents() == 3
height = vtk_to_numpy(mesh.GetPointData().GetArray("height"))
points = vtk_to_numpy(mesh.GetPoints().GetData())
assert abs(height - points[:, 2]).max() < 1e-4, "scalars do not belong to their points"
ply = read(vtk.vtkPLYReader(), "ball.ply")
assert abs(vtk_to_numpy(ply.GetPoints().GetData()) - points).max() < 1e-4

# The image: every voxel holds the coordinates of its own centre, so VTK's idea of where it lies must agree.
image = read(vtk.vtkXMLImageDataReader(), "stage.vti")
data = image.GetPointData()
where = [vtk_to_numpy(data.GetArray(name)) for name in "xyz"]
for i in range(image.GetNumberOfPoints()):
    p = image.GetPoint(i)
    assert all(abs(p[a] - where[a][i]) < 1e-4 for a in range(3)), (i, p)
# The field points along the grid's first axis; in the world that is the step from one voxel to the next.
field = vtk_to_numpy(data.GetArray("field"))
step = [image.GetPoint(1)[a] - image.GetPoint(0)[a] for a in range(3)]
length = sum(s * s for s in step) ** 0.5
assert all(abs(field[:, a] - step[a] / length).max() < 1e-6 for a in range(3))
assert data.GetArray("mask").GetDataType() == vtk.VTK_UNSIGNED_CHAR
print(f"stage.vti: {image.GetDimensions()}, {data.GetNumberOfArrays()} arrays")
