# Written by tools/python_stubs.py.
from typing import Any, Callable, Dict, List, Literal, Optional, Tuple, Union

from . import image as _image
from ._options import Options as _Options
from ._core import EdgeMap as EdgeMap
from ._core import Image as Image
from ._core import Mask as Mask
def detect_edges(image: Any, options: Any = ..., *, progress: Any = ..., threads: Any = ...) -> EdgeMap: ...

class Canny(_Options):
    sigma_px: float
    low: float
    high: float
    threshold: Literal['max_fraction', 'max_fraction_slice', 'percentile']
    subpixel: bool
    def __init__(self, *, sigma_px: float = ..., low: float = ..., high: float = ..., threshold: Literal['max_fraction', 'max_fraction_slice', 'percentile'] = ..., subpixel: bool = ...) -> None: ...

class CannyRevised(_Options):
    canny: _image.Canny
    def __init__(self, *, canny: _image.Canny = ...) -> None: ...

class GradientEdges(_Options):
    measure: Literal['squared', 'magnitude', 'laplacian', 'roberts']
    threshold: float
    thin: bool
    subpixel: bool
    def __init__(self, *, measure: Literal['squared', 'magnitude', 'laplacian', 'roberts'] = ..., threshold: float = ..., thin: bool = ..., subpixel: bool = ...) -> None: ...

class SobelEdges(_Options):
    threshold: float
    thin: bool
    subpixel: bool
    def __init__(self, *, threshold: float = ..., thin: bool = ..., subpixel: bool = ...) -> None: ...

class Compass(_Options):
    sigma_px: float
    low: float
    high: float
    clusters: int
    wedges: int
    gamma: float
    subpixel: bool
    def __init__(self, *, sigma_px: float = ..., low: float = ..., high: float = ..., clusters: int = ..., wedges: int = ..., gamma: float = ..., subpixel: bool = ...) -> None: ...

class ContourCompletion(_Options):
    gradient_sigma_px: float
    tensor_sigma_px: float
    step: float
    steps: int
    refresh: int
    complete: bool
    complete_level: float
    prior: Literal['none', 'circle', 'ellipse']
    prior_weight: float
    prior_x_px: Optional[float]
    prior_y_px: Optional[float]
    canny: _image.Canny
    def __init__(self, *, gradient_sigma_px: float = ..., tensor_sigma_px: float = ..., step: float = ..., steps: int = ..., refresh: int = ..., complete: bool = ..., complete_level: float = ..., prior: Literal['none', 'circle', 'ellipse'] = ..., prior_weight: float = ..., prior_x_px: Optional[float] = ..., prior_y_px: Optional[float] = ..., canny: _image.Canny = ...) -> None: ...

class Preparation(_Options):
    from_least: bool
    doubling: Literal['none', 'three', 'single']
    threshold: Optional[float]
    cut_radius_px: Optional[float]
    cut_x_px: Optional[float]
    cut_y_px: Optional[float]
    soft_cut: bool
    def __init__(self, *, from_least: bool = ..., doubling: Literal['none', 'three', 'single'] = ..., threshold: Optional[float] = ..., cut_radius_px: Optional[float] = ..., cut_x_px: Optional[float] = ..., cut_y_px: Optional[float] = ..., soft_cut: bool = ...) -> None: ...
