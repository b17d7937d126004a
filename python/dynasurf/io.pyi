# Written by tools/python_stubs.py.
from typing import Any, Callable, Dict, List, Literal, Optional, Tuple, Union

from ._options import Options as _Options
from ._core import PointCloud as PointCloud
from ._core import Study as Study
def read_cloud(*files: Any) -> PointCloud: ...
from ._core import read_mesh as read_mesh
def read_study(path: Any, series: Any = ...) -> Study: ...
from ._core import write_dicom as write_dicom
from ._core import write_mesh as write_mesh
from ._core import write_nifti as write_nifti
from ._core import write_nrrd as write_nrrd


