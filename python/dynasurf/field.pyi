# Written by tools/python_stubs.py.
from typing import Any, Callable, Dict, List, Literal, Optional, Tuple, Union

from ._options import Options as _Options
from ._core import Image as Image
from ._core import FlowResult as FlowResult
from ._core import VectorField as VectorField
def edge_map_of(image: Any, options: Any = ..., **members: Any) -> Image: ...
def flow_field(edge_map: Any, options: Any = ..., *, progress: Any = ..., threads: Any = ...) -> FlowResult: ...

class EdgeMapOptions(_Options):
    of: Literal['gradient_squared', 'gradient', 'intensity']
    sigma_px: float
    reversed: bool
    def __init__(self, *, of: Literal['gradient_squared', 'gradient', 'intensity'] = ..., sigma_px: float = ..., reversed: bool = ...) -> None: ...

class Gvf(_Options):
    mu: float
    iterations: int
    residual: float
    step_divisor: float
    scheme: Literal['thesis', 'metric']
    safe_step: bool
    def __init__(self, *, mu: float = ..., iterations: int = ..., residual: float = ..., step_divisor: float = ..., scheme: Literal['thesis', 'metric'] = ..., safe_step: bool = ...) -> None: ...

class SteadyGvf(_Options):
    mu: float
    tolerance: float
    scheme: Literal['thesis', 'metric']
    most_cycles: int
    def __init__(self, *, mu: float = ..., tolerance: float = ..., scheme: Literal['thesis', 'metric'] = ..., most_cycles: int = ...) -> None: ...

class SteadyGgvf(_Options):
    k: float
    tolerance: float
    most_cycles: int
    def __init__(self, *, k: float = ..., tolerance: float = ..., most_cycles: int = ...) -> None: ...

class Ggvf(_Options):
    k: float
    iterations: int
    residual: float
    step_divisor: float
    scheme: Literal['thesis', 'metric']
    safe_step: bool
    def __init__(self, *, k: float = ..., iterations: int = ..., residual: float = ..., step_divisor: float = ..., scheme: Literal['thesis', 'metric'] = ..., safe_step: bool = ...) -> None: ...

class BandGvf(_Options):
    mu: float
    tolerance: float
    reach_voxels: int
    most_cycles: int
    def __init__(self, *, mu: float = ..., tolerance: float = ..., reach_voxels: int = ..., most_cycles: int = ...) -> None: ...

class BandGgvf(_Options):
    k: float
    tolerance: float
    reach_voxels: int
    most_cycles: int
    def __init__(self, *, k: float = ..., tolerance: float = ..., reach_voxels: int = ..., most_cycles: int = ...) -> None: ...
