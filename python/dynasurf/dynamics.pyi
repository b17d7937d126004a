# Written by tools/python_stubs.py.
from typing import Any, Callable, Dict, List, Literal, Optional, Tuple, Union

from . import dynamics as _dynamics
from . import mesh as _mesh
from ._options import Options as _Options
from ._core import BorderPlanes as BorderPlanes
from ._core import EvolutionResult as EvolutionResult
def evolve(start: Any, field: Any, border: Any, options: Any = ..., *, planes: Any = ..., forces: Any = ..., stop: Any = ..., drag: Any = ..., progress: Any = ..., threads: Any = ..., **members: Any) -> EvolutionResult: ...
class evolve_steps:
    def __init__(self, start: Any, field: Any, border: Any, options: Any = ..., *, planes: Any = ..., forces: Any = ..., stop: Any = ..., drag: Any = ..., every: Any = ..., **members: Any) -> None: ...
    def __iter__(self) -> Any: ...
    def __next__(self) -> Any: ...
    def close(self) -> Any: ...
    result: Any

class FieldForce(_Options):
    strength: float
    drag: float
    sampling: Literal['nearest', 'trilinear', 'neighbour']
    def __init__(self, *, strength: float = ..., drag: float = ..., sampling: Literal['nearest', 'trilinear', 'neighbour'] = ...) -> None: ...

class StopVoxel(_Options):
    enabled: bool
    point: Literal['entry', 'centre', 'backtrack', 'subvoxel']
    def __init__(self, *, enabled: bool = ..., point: Literal['entry', 'centre', 'backtrack', 'subvoxel'] = ...) -> None: ...

class StopConv(_Options):
    still_share: float
    still_move: float
    still_radius: float
    still_steps: int
    max_steps: int
    def __init__(self, *, still_share: float = ..., still_move: float = ..., still_radius: float = ..., still_steps: int = ..., max_steps: int = ...) -> None: ...

class UniformDrag(_Options):
    def __init__(self) -> None: ...

class IntensityDrag(_Options):
    ratio: float
    def __init__(self, *, ratio: float = ...) -> None: ...

class FieldDrag(_Options):
    ratio: float
    def __init__(self, *, ratio: float = ...) -> None: ...

class BorderDrag(_Options):
    ratio: float
    reach_voxels: float
    def __init__(self, *, ratio: float = ..., reach_voxels: float = ...) -> None: ...

class FreeModel(_Options):
    def __init__(self) -> None: ...

class SpringModel(_Options):
    stiffness: float
    damping: float
    rest_scale: float
    def __init__(self, *, stiffness: float = ..., damping: float = ..., rest_scale: float = ...) -> None: ...

class RestrictedSpringModel(_Options):
    stiffness: float
    damping: float
    rest_scale: float
    threshold: float
    def __init__(self, *, stiffness: float = ..., damping: float = ..., rest_scale: float = ..., threshold: float = ...) -> None: ...

class PlainModel(_Options):
    stretch: float
    stretch_damping: float
    shear: float
    shear_damping: float
    bend: float
    bend_damping: float
    rest_scale: float
    area_unit_mm2: float
    def __init__(self, *, stretch: float = ..., stretch_damping: float = ..., shear: float = ..., shear_damping: float = ..., bend: float = ..., bend_damping: float = ..., rest_scale: float = ..., area_unit_mm2: float = ...) -> None: ...

class CurvatureModel(_Options):
    strength: float
    def __init__(self, *, strength: float = ...) -> None: ...

class Euler(_Options):
    def __init__(self) -> None: ...

class Midpoint(_Options):
    def __init__(self) -> None: ...

class Rk4(_Options):
    def __init__(self) -> None: ...

class StepDoubling(_Options):
    base: Literal['euler', 'midpoint', 'rk4']
    tolerance: float
    extrapolate: bool
    def __init__(self, *, base: Literal['euler', 'midpoint', 'rk4'] = ..., tolerance: float = ..., extrapolate: bool = ...) -> None: ...

class Rkf45(_Options):
    tolerance: float
    def __init__(self, *, tolerance: float = ...) -> None: ...

class BackwardEuler(_Options):
    tolerance: float
    max_iterations: int
    stiffness: Literal['definite', 'exact']
    def __init__(self, *, tolerance: float = ..., max_iterations: int = ..., stiffness: Literal['definite', 'exact'] = ...) -> None: ...

class AutomaticSolver(_Options):
    def __init__(self) -> None: ...

class Evolution(_Options):
    model: Union[_dynamics.FreeModel, _dynamics.SpringModel, _dynamics.RestrictedSpringModel, _dynamics.PlainModel, _dynamics.CurvatureModel, str]
    solver: Union[_dynamics.Euler, _dynamics.Midpoint, _dynamics.Rk4, _dynamics.StepDoubling, _dynamics.Rkf45, _dynamics.BackwardEuler, _dynamics.AutomaticSolver, str]
    step_s: float
    mass_kg: float
    force: _dynamics.FieldForce
    damping: Union[_dynamics.UniformDrag, _dynamics.IntensityDrag, _dynamics.FieldDrag, _dynamics.BorderDrag, str]
    stop: _dynamics.StopVoxel
    end: _dynamics.StopConv
    smooth_every: int
    smooth_during: _mesh.Smoothing
    smooth_after: _mesh.Smoothing
    trajectory_every: int
    def __init__(self, *, model: Union[_dynamics.FreeModel, _dynamics.SpringModel, _dynamics.RestrictedSpringModel, _dynamics.PlainModel, _dynamics.CurvatureModel, str] = ..., solver: Union[_dynamics.Euler, _dynamics.Midpoint, _dynamics.Rk4, _dynamics.StepDoubling, _dynamics.Rkf45, _dynamics.BackwardEuler, _dynamics.AutomaticSolver, str] = ..., step_s: float = ..., mass_kg: float = ..., force: _dynamics.FieldForce = ..., damping: Union[_dynamics.UniformDrag, _dynamics.IntensityDrag, _dynamics.FieldDrag, _dynamics.BorderDrag, str] = ..., stop: _dynamics.StopVoxel = ..., end: _dynamics.StopConv = ..., smooth_every: int = ..., smooth_during: _mesh.Smoothing = ..., smooth_after: _mesh.Smoothing = ..., trajectory_every: int = ...) -> None: ...

class DiscreteContour(_Options):
    external: float
    internal: float
    damping: float
    mass: float
    step: float
    edge_px: float
    resample_every: int
    radial_only: bool
    filter: Literal['fixed', 'adaptive']
    still_px: float
    still_checks: int
    max_steps: int
    def __init__(self, *, external: float = ..., internal: float = ..., damping: float = ..., mass: float = ..., step: float = ..., edge_px: float = ..., resample_every: int = ..., radial_only: bool = ..., filter: Literal['fixed', 'adaptive'] = ..., still_px: float = ..., still_checks: int = ..., max_steps: int = ...) -> None: ...
