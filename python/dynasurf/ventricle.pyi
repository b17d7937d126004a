# Written by tools/python_stubs.py.
from typing import Any, Callable, Dict, List, Literal, Optional, Tuple, Union

from . import dynamics as _dynamics
from . import field as _field
from . import image as _image
from . import mesh as _mesh
from . import ventricle as _ventricle
from ._options import Options as _Options
from ._core import TriMesh as TriMesh
from ._core import Estimate as Estimate
from ._core import FittedBeat as FittedBeat
from ._core import Gate as Gate
from ._core import Labels as Labels
from ._core import LeadingSurface as LeadingSurface
from ._core import Measures as Measures
from ._core import Surface as Surface
from ._core import VentricleResult as VentricleResult
from ._core import border_planes as border_planes
from ._core import border_volume as border_volume
from ._core import close_border as close_border
from ._core import find_base_slice as find_base_slice
def fit(study: Any, endo: Any, epi: Any, *, axis: Any, lateral: Any, options: Any = ..., progress: Any = ..., threads: Any = ..., **members: Any) -> FittedBeat: ...
def label_borders(image: Any, edges: Any, options: Any = ..., **members: Any) -> Labels: ...
def measure(study: Any, endo: Any, epi: Any, *, axis: Any, from_edges: Any = ..., options: Any = ..., **members: Any) -> Measures: ...
def preset(name: Any) -> Options: ...
def reconstruct(study: Any, options: Any = ..., *, preset: Any = ..., fwhm_mm: Any = ..., mask: Any = ..., start: Any = ..., edges: Any = ..., labels: Any = ..., cache: Any = ..., progress: Any = ..., threads: Any = ..., **members: Any) -> VentricleResult: ...
def settle(mesh: Any, image: Any, base: Any = ..., options: Any = ..., **members: Any) -> TriMesh: ...
from ._core import with_room as with_room

class CoarseCircle(_Options):
    x_px: Optional[float]
    y_px: Optional[float]
    radius_px: Optional[float]
    def __init__(self, *, x_px: Optional[float] = ..., y_px: Optional[float] = ..., radius_px: Optional[float] = ...) -> None: ...

class AutoCircle(_Options):
    min_component_px: int
    centroid_tolerance_px: float
    centroid_share: float
    radius_tolerance_px: float
    radius_share: float
    centre_width: float
    offset_px: float
    robust_fit: bool
    def __init__(self, *, min_component_px: int = ..., centroid_tolerance_px: float = ..., centroid_share: float = ..., radius_tolerance_px: float = ..., radius_share: float = ..., centre_width: float = ..., offset_px: float = ..., robust_fit: bool = ...) -> None: ...

class DivisionSlice(_Options):
    jump: float
    floor: float
    expected_slice: Optional[float]
    def __init__(self, *, jump: float = ..., floor: float = ..., expected_slice: Optional[float] = ...) -> None: ...

class SliceFlow(_Options):
    mu: float
    iterations: int
    def __init__(self, *, mu: float = ..., iterations: int = ...) -> None: ...

class QuietPoints(_Options):
    low: float
    high: float
    width_px: int
    flow: _ventricle.SliceFlow
    def __init__(self, *, low: float = ..., high: float = ..., width_px: int = ..., flow: _ventricle.SliceFlow = ...) -> None: ...

class Mlc(_Options):
    strict_thesis: bool
    use_gradient: bool
    min_gap_px: float
    box_margin_px: float
    def __init__(self, *, strict_thesis: bool = ..., use_gradient: bool = ..., min_gap_px: float = ..., box_margin_px: float = ...) -> None: ...

class NoLabels(_Options):
    def __init__(self) -> None: ...

class SignLabels(_Options):
    least_change: float
    flow: _ventricle.SliceFlow
    def __init__(self, *, least_change: float = ..., flow: _ventricle.SliceFlow = ...) -> None: ...

class GradMagLabels(_Options):
    quiet: _ventricle.QuietPoints
    def __init__(self, *, quiet: _ventricle.QuietPoints = ...) -> None: ...

class CaseLabels(_Options):
    quiet: _ventricle.QuietPoints
    def __init__(self, *, quiet: _ventricle.QuietPoints = ...) -> None: ...

class RadialLabels(_Options):
    ring_px: int
    least_share: float
    def __init__(self, *, ring_px: int = ..., least_share: float = ...) -> None: ...

class Labelling(_Options):
    bright: Literal['auto', 'wall', 'cavity']
    coarse: _ventricle.CoarseCircle
    circle: _ventricle.AutoCircle
    division: _ventricle.DivisionSlice
    method: Union[_ventricle.Mlc, _ventricle.NoLabels, _ventricle.SignLabels, _ventricle.GradMagLabels, _ventricle.CaseLabels, _ventricle.RadialLabels, str]
    def __init__(self, *, bright: Literal['auto', 'wall', 'cavity'] = ..., coarse: _ventricle.CoarseCircle = ..., circle: _ventricle.AutoCircle = ..., division: _ventricle.DivisionSlice = ..., method: Union[_ventricle.Mlc, _ventricle.NoLabels, _ventricle.SignLabels, _ventricle.GradMagLabels, _ventricle.CaseLabels, _ventricle.RadialLabels, str] = ...) -> None: ...

class Closure(_Options):
    cover: bool
    valve_plane: bool
    base_level: float
    def __init__(self, *, cover: bool = ..., valve_plane: bool = ..., base_level: float = ...) -> None: ...

class Orientation(_Options):
    method: Literal['header', 'data', 'auto']
    most_tilt_deg: float
    least_contrast: float
    widest_pixel_mm: float
    voxel_mm: Optional[float]
    def __init__(self, *, method: Literal['header', 'data', 'auto'] = ..., most_tilt_deg: float = ..., least_contrast: float = ..., widest_pixel_mm: float = ..., voxel_mm: Optional[float] = ...) -> None: ...

class UserOverrides(_Options):
    center_mm: Optional[List[float]]
    axis: Optional[List[float]]
    radius_mm: Optional[float]
    first_slice: Optional[int]
    last_slice: Optional[int]
    base_plane_mm: Optional[float]
    base_shift_mm: Optional[float]
    exclude_gates: List[int]
    endo_points: List[float]
    epi_points: List[float]
    decision: Literal['none', 'accepted', 'rejected']
    reader: str
    comment: str
    def __init__(self, *, center_mm: Optional[List[float]] = ..., axis: Optional[List[float]] = ..., radius_mm: Optional[float] = ..., first_slice: Optional[int] = ..., last_slice: Optional[int] = ..., base_plane_mm: Optional[float] = ..., base_shift_mm: Optional[float] = ..., exclude_gates: List[int] = ..., endo_points: List[float] = ..., epi_points: List[float] = ..., decision: Literal['none', 'accepted', 'rejected'] = ..., reader: str = ..., comment: str = ...) -> None: ...

class Settle(_Options):
    rounds: int
    reach_voxels: float
    def __init__(self, *, rounds: int = ..., reach_voxels: float = ...) -> None: ...

class ContourPipeline(_Options):
    sigma_px: float
    force: Literal['potential', 'flow', 'both']
    mu: float
    model: _dynamics.DiscreteContour
    best_slice: Optional[int]
    jump: float
    least_area_px2: float
    tessellation: _mesh.Tessellation
    ends: Literal['slice_centre', 'slice_face']
    smooth: _mesh.Smoothing
    def __init__(self, *, sigma_px: float = ..., force: Literal['potential', 'flow', 'both'] = ..., mu: float = ..., model: _dynamics.DiscreteContour = ..., best_slice: Optional[int] = ..., jump: float = ..., least_area_px2: float = ..., tessellation: _mesh.Tessellation = ..., ends: Literal['slice_centre', 'slice_face'] = ..., smooth: _mesh.Smoothing = ...) -> None: ...

class MeasureOptions(_Options):
    segments: Literal['aha17', 'segments20']
    anterior: Literal['auto', 'patient', 'rows']
    waves: int
    def __init__(self, *, segments: Literal['aha17', 'segments20'] = ..., anterior: Literal['auto', 'patient', 'rows'] = ..., waves: int = ...) -> None: ...

class BlurFit(_Options):
    run: bool
    fwhm_mm: Optional[float]
    fwhm_uncertainty: float
    filter_fwhm_mm: Optional[float]
    butterworth_per_cm: Optional[float]
    butterworth_order: float
    thickness_mm: Optional[float]
    thickness_uncertainty: float
    shape_degree: int
    wall_degree: int
    uptake_degree: int
    papillary_share: float
    attenuation: Literal['unknown', 'uncorrected', 'corrected']
    most_steps: int
    def __init__(self, *, run: bool = ..., fwhm_mm: Optional[float] = ..., fwhm_uncertainty: float = ..., filter_fwhm_mm: Optional[float] = ..., butterworth_per_cm: Optional[float] = ..., butterworth_order: float = ..., thickness_mm: Optional[float] = ..., thickness_uncertainty: float = ..., shape_degree: int = ..., wall_degree: int = ..., uptake_degree: int = ..., papillary_share: float = ..., attenuation: Literal['unknown', 'uncorrected', 'corrected'] = ..., most_steps: int = ...) -> None: ...

class Options(_Options):
    pipeline: Literal['surface', 'contour', 'direct']
    label: int
    orientation: _ventricle.Orientation
    manual: _ventricle.UserOverrides
    useful_slices: Literal['heart', 'score']
    noise_fraction: float
    prepare: _image.Preparation
    edges: Union[_image.Canny, _image.CannyRevised, _image.GradientEdges, _image.SobelEdges, _image.Compass, _image.ContourCompletion, str]
    labels: _ventricle.Labelling
    closure: _ventricle.Closure
    edge_map: _field.EdgeMapOptions
    field: Union[_field.Gvf, _field.SteadyGvf, _field.SteadyGgvf, _field.Ggvf, _field.BandGvf, _field.BandGgvf, str]
    mesh_level: int
    placement: _mesh.Placement
    evolution: _dynamics.Evolution
    settle: _ventricle.Settle
    tidy: _mesh.Tidy
    contour: _ventricle.ContourPipeline
    warm_start: bool
    warm_backward: bool
    keyframes: _mesh.Keyframes
    measures: _ventricle.MeasureOptions
    fit: _ventricle.BlurFit
    def __init__(self, *, pipeline: Literal['surface', 'contour', 'direct'] = ..., label: int = ..., orientation: _ventricle.Orientation = ..., manual: _ventricle.UserOverrides = ..., useful_slices: Literal['heart', 'score'] = ..., noise_fraction: float = ..., prepare: _image.Preparation = ..., edges: Union[_image.Canny, _image.CannyRevised, _image.GradientEdges, _image.SobelEdges, _image.Compass, _image.ContourCompletion, str] = ..., labels: _ventricle.Labelling = ..., closure: _ventricle.Closure = ..., edge_map: _field.EdgeMapOptions = ..., field: Union[_field.Gvf, _field.SteadyGvf, _field.SteadyGgvf, _field.Ggvf, _field.BandGvf, _field.BandGgvf, str] = ..., mesh_level: int = ..., placement: _mesh.Placement = ..., evolution: _dynamics.Evolution = ..., settle: _ventricle.Settle = ..., tidy: _mesh.Tidy = ..., contour: _ventricle.ContourPipeline = ..., warm_start: bool = ..., warm_backward: bool = ..., keyframes: _mesh.Keyframes = ..., measures: _ventricle.MeasureOptions = ..., fit: _ventricle.BlurFit = ...) -> None: ...

class OrganOptions(_Options):
    source: Literal['between', 'of_maximum', 'labels']
    level: float
    dark: bool
    label: int
    smooth_voxels: float
    mesh_level: int
    placement: _mesh.Placement
    field: Union[_field.Gvf, _field.SteadyGvf, _field.SteadyGgvf, _field.Ggvf, _field.BandGvf, _field.BandGgvf, str]
    evolution: _dynamics.Evolution
    settle: _ventricle.Settle
    tidy: _mesh.Tidy
    def __init__(self, *, source: Literal['between', 'of_maximum', 'labels'] = ..., level: float = ..., dark: bool = ..., label: int = ..., smooth_voxels: float = ..., mesh_level: int = ..., placement: _mesh.Placement = ..., field: Union[_field.Gvf, _field.SteadyGvf, _field.SteadyGgvf, _field.Ggvf, _field.BandGvf, _field.BandGgvf, str] = ..., evolution: _dynamics.Evolution = ..., settle: _ventricle.Settle = ..., tidy: _mesh.Tidy = ...) -> None: ...
