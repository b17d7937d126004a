"""Dynasurf: surfaces of the left ventricle from gated heart studies, and of bodies from point clouds.

>>> import dynasurf as ds
>>> cloud = ds.synthetic.make_cloud(shape="sphere", points=2000)
>>> lods = ds.cloud.reconstruct(cloud, triangles=[320])
>>> lods[0].certificate.watertight
True

World coordinates are DICOM's LPS in mm. Volumes are arrays (gate, z, y, x) of float32, meshes `vertices` (n, 3) of
float64 and `triangles` (m, 3) of int32. Arrays of results are read-only views of the result's own memory, which they
keep alive.

Research use only. Not for diagnosis.
"""

import atexit as _atexit

from . import _core, _methods, cloud, dynamics, field, image, io, mesh, synthetic, ventricle
from ._core import (
    Cancelled,
    Estimate,
    Grid,
    Image,
    InputError,
    IoError,
    Mask,
    Note,
    OptionError,
    PointCloud,
    StageCache,
    Study,
    TriMesh,
    VectorField,
)
from ._load import load
from ._progress import progress_of
from .io import read_cloud, read_mesh, read_study

__version__ = _core.version
__all__ = [
    "Cancelled",
    "Estimate",
    "Grid",
    "Image",
    "InputError",
    "IoError",
    "Mask",
    "Note",
    "OptionError",
    "PointCloud",
    "StageCache",
    "Study",
    "TriMesh",
    "VectorField",
    "cloud",
    "dynamics",
    "field",
    "image",
    "io",
    "load",
    "mesh",
    "progress_of",
    "read_cloud",
    "read_mesh",
    "read_study",
    "synthetic",
    "ventricle",
]

_methods.give_to_classes()
_atexit.register(_core.wait_for_abandoned)
