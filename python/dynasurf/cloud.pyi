# Written by tools/python_stubs.py.
from typing import Any, Callable, Dict, List, Literal, Optional, Tuple, Union

from ._options import Options as _Options
from ._core import Certificate as Certificate
from ._core import CloudFacts as CloudFacts
from ._core import CloudLevel as CloudLevel
from ._core import CloudResult as CloudResult
from ._core import PointCloud as PointCloud
from ._core import certify as certify
def preset(name: Any) -> Options: ...
def reconstruct(points: Any, options: Any = ..., *, triangles: Any = ..., preset: Any = ..., normals: Any = ..., colours: Any = ..., cache: Any = ..., progress: Any = ..., threads: Any = ..., **members: Any) -> CloudResult: ...

class Options(_Options):
    method: Literal['shaped', 'faithful', 'thesis']
    triangles: List[int]
    max_error_percent: Optional[float]
    genus: Literal['auto', '0', 'keep']
    start: Literal['auto', 'field', 'sphere', 'ellipsoid', 'hull']
    boundary: Literal['auto', 'close', 'keep', 'trim']
    lid: Literal['smooth', 'flat']
    keep_sharp: bool
    cells: Optional[int]
    noise_percent: Optional[float]
    outliers: float
    use_normals: bool
    smallest_part_percent: float
    def __init__(self, *, method: Literal['shaped', 'faithful', 'thesis'] = ..., triangles: List[int] = ..., max_error_percent: Optional[float] = ..., genus: Literal['auto', '0', 'keep'] = ..., start: Literal['auto', 'field', 'sphere', 'ellipsoid', 'hull'] = ..., boundary: Literal['auto', 'close', 'keep', 'trim'] = ..., lid: Literal['smooth', 'flat'] = ..., keep_sharp: bool = ..., cells: Optional[int] = ..., noise_percent: Optional[float] = ..., outliers: float = ..., use_normals: bool = ..., smallest_part_percent: float = ...) -> None: ...

class LodRule(_Options):
    edge_px: float
    hysteresis_percent: float
    def __init__(self, *, edge_px: float = ..., hysteresis_percent: float = ...) -> None: ...
