# Written by tools/python_stubs.py.
from typing import Any, Callable, Dict, List, Literal, Optional, Tuple, Union

from ._options import Options as _Options
from ._core import SurfaceCheck as SurfaceCheck
from ._core import TetMesh as TetMesh
from ._core import TriMesh as TriMesh
from ._core import area_mm2 as area_mm2
from ._core import check_surface as check_surface
from ._core import cross_section as cross_section
from ._core import fill_between as fill_between
from ._core import icosphere as icosphere
def start_mesh(border: Any, level: Any = ..., placement: Any = ..., given: Any = ..., **members: Any) -> TriMesh: ...
from ._core import to_grid as to_grid
from ._core import to_world as to_world
from ._core import volume_mm3 as volume_mm3
from ._core import voxel_parts as voxel_parts

class Placement(_Options):
    shape: Literal['ellipsoid', 'sphere', 'cube', 'hull', 'marching_cubes', 'discretised_cubes', 'radial', 'file']
    direction: Literal['out_to_in', 'in_to_out']
    scale: float
    inside_scale: float
    centre_of_mass: bool
    def __init__(self, *, shape: Literal['ellipsoid', 'sphere', 'cube', 'hull', 'marching_cubes', 'discretised_cubes', 'radial', 'file'] = ..., direction: Literal['out_to_in', 'in_to_out'] = ..., scale: float = ..., inside_scale: float = ..., centre_of_mass: bool = ...) -> None: ...

class Smoothing(_Options):
    tolerance_rad: float
    step_mm: float
    literal_step: bool
    sweeps: int
    def __init__(self, *, tolerance_rad: float = ..., step_mm: float = ..., literal_step: bool = ..., sweeps: int = ...) -> None: ...

class Tidy(_Options):
    shape: float
    sweeps: int
    untangle_rounds: int
    def __init__(self, *, shape: float = ..., sweeps: int = ..., untangle_rounds: int = ...) -> None: ...

class Keyframes(_Options):
    interpolation: Literal['linear', 'periodic_cubic', 'catmull_rom', 'b_spline']
    frames_between: int
    def __init__(self, *, interpolation: Literal['linear', 'periodic_cubic', 'catmull_rom', 'b_spline'] = ..., frames_between: int = ...) -> None: ...

class Tessellation(_Options):
    points: int
    strip: Literal['even', 'greedy']
    def __init__(self, *, points: int = ..., strip: Literal['even', 'greedy'] = ...) -> None: ...
