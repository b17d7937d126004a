# Written by tools/python_stubs.py.
from typing import Any, Callable, Dict, List, Literal, Optional, Tuple, Union

from . import synthetic as _synthetic
from ._options import Options as _Options
from ._core import PointCloud as PointCloud
from ._core import CameraStudy as CameraStudy
from ._core import Phantom as Phantom
from ._core import Projections as Projections
from ._core import TrueGate as TrueGate
def make_camera_study(options: Any = ..., *, progress: Any = ..., threads: Any = ..., **members: Any) -> CameraStudy: ...
def make_cloud(options: Any = ..., **members: Any) -> PointCloud: ...
def make_phantom(options: Any, *, threads: Any = ...) -> Phantom: ...

class CloudPhantom(_Options):
    shape: Literal['sphere', 'ellipsoid', 'torus', 'two_torus', 'cube', 'plate', 'spring', 'vase', 'blobs', 'rabbit', 'screwdriver', 'venus', 'moai', 'squirrel']
    points: int
    noise_percent: float
    missing_percent: float
    normals: bool
    seed: int
    def __init__(self, *, shape: Literal['sphere', 'ellipsoid', 'torus', 'two_torus', 'cube', 'plate', 'spring', 'vase', 'blobs', 'rabbit', 'screwdriver', 'venus', 'moai', 'squirrel'] = ..., points: int = ..., noise_percent: float = ..., missing_percent: float = ..., normals: bool = ..., seed: int = ...) -> None: ...

class Lattice(_Options):
    nx: int
    ny: int
    nz: int
    dx_mm: float
    dy_mm: float
    dz_mm: float
    def __init__(self, *, nx: int = ..., ny: int = ..., nz: int = ..., dx_mm: float = ..., dy_mm: float = ..., dz_mm: float = ...) -> None: ...

class Noise(_Options):
    peak_counts: float
    filter_fwhm_mm: float
    gaussian_percent: float
    seed: int
    texture: float
    def __init__(self, *, peak_counts: float = ..., filter_fwhm_mm: float = ..., gaussian_percent: float = ..., seed: int = ..., texture: float = ...) -> None: ...

class Pose(_Options):
    offset_x_mm: float
    offset_y_mm: float
    offset_z_mm: float
    tilt_deg: float
    tilt_towards_deg: float
    def __init__(self, *, offset_x_mm: float = ..., offset_y_mm: float = ..., offset_z_mm: float = ..., tilt_deg: float = ..., tilt_towards_deg: float = ...) -> None: ...

class CupShape(_Options):
    inner_radius_mm: float
    outer_radius_mm: float
    height_mm: float
    def __init__(self, *, inner_radius_mm: float = ..., outer_radius_mm: float = ..., height_mm: float = ...) -> None: ...

class Hebron(_Options):
    shape: _synthetic.CupShape
    sigma_mm: float
    values: Literal['grey', 'binary']
    binary_level: float
    cover: bool
    cover_radius_mm: float
    doubled: bool
    pose: _synthetic.Pose
    lattice: _synthetic.Lattice
    noise: _synthetic.Noise
    def __init__(self, *, shape: _synthetic.CupShape = ..., sigma_mm: float = ..., values: Literal['grey', 'binary'] = ..., binary_level: float = ..., cover: bool = ..., cover_radius_mm: float = ..., doubled: bool = ..., pose: _synthetic.Pose = ..., lattice: _synthetic.Lattice = ..., noise: _synthetic.Noise = ...) -> None: ...

class Mayo(_Options):
    volume_mm3: float
    sigma_mm: float
    pose: _synthetic.Pose
    lattice: _synthetic.Lattice
    noise: _synthetic.Noise
    def __init__(self, *, volume_mm3: float = ..., sigma_mm: float = ..., pose: _synthetic.Pose = ..., lattice: _synthetic.Lattice = ..., noise: _synthetic.Noise = ...) -> None: ...

class Partial(_Options):
    fraction: float
    missing: Literal['sector', 'patch', 'apex']
    pieces: int
    towards_deg: float
    base: _synthetic.Mayo
    def __init__(self, *, fraction: float = ..., missing: Literal['sector', 'patch', 'apex'] = ..., pieces: int = ..., towards_deg: float = ..., base: _synthetic.Mayo = ...) -> None: ...

class TwoSpheres(_Options):
    size: int
    inner_radius_voxels: float
    outer_radius_voxels: float
    spacing_mm: float
    def __init__(self, *, size: int = ..., inner_radius_voxels: float = ..., outer_radius_voxels: float = ..., spacing_mm: float = ...) -> None: ...

class VoxelSphere(_Options):
    size: int
    radius_voxels: float
    spacing_mm: float
    def __init__(self, *, size: int = ..., radius_voxels: float = ..., spacing_mm: float = ...) -> None: ...

class Gap(_Options):
    part: float
    base: _synthetic.Hebron
    def __init__(self, *, part: float = ..., base: _synthetic.Hebron = ...) -> None: ...

class CardiacCycle(_Options):
    wall: Literal['constant', 'published']
    wall_ml: float
    sigma_mm: float
    heart_rate_bpm: float
    pose: _synthetic.Pose
    lattice: _synthetic.Lattice
    noise: _synthetic.Noise
    def __init__(self, *, wall: Literal['constant', 'published'] = ..., wall_ml: float = ..., sigma_mm: float = ..., heart_rate_bpm: float = ..., pose: _synthetic.Pose = ..., lattice: _synthetic.Lattice = ..., noise: _synthetic.Noise = ...) -> None: ...

class Pathology(_Options):
    disease: Literal['inferior', 'apical', 'lateral', 'anteroapical', 'digestive', 'right_ventricle', 'muga']
    extent_deg: float
    uptake: float
    amplitude: float
    base: _synthetic.Hebron
    def __init__(self, *, disease: Literal['inferior', 'apical', 'lateral', 'anteroapical', 'digestive', 'right_ventricle', 'muga'] = ..., extent_deg: float = ..., uptake: float = ..., amplitude: float = ..., base: _synthetic.Hebron = ...) -> None: ...

class Torso(_Options):
    present: bool
    liver: float
    gallbladder: float
    lung: float
    spleen: float
    kidneys: float
    bowel: float
    bladder: float
    def __init__(self, *, present: bool = ..., liver: float = ..., gallbladder: float = ..., lung: float = ..., spleen: float = ..., kidneys: float = ..., bowel: float = ..., bladder: float = ...) -> None: ...

class Irregularity(_Options):
    walls: float
    papillary_mm: float
    tails: float
    depth: float
    def __init__(self, *, walls: float = ..., papillary_mm: float = ..., tails: float = ..., depth: float = ...) -> None: ...

class Tags(_Options):
    points: int
    twist_deg: float
    error_mm: float
    def __init__(self, *, points: int = ..., twist_deg: float = ..., error_mm: float = ...) -> None: ...

class VirtualPatient(_Options):
    edv_ml: float
    ef_percent: float
    wall_ml: float
    length_to_width: float
    base_excursion_mm: float
    gates: int
    heart_rate_bpm: float
    fwhm_mm: float
    cavity: float
    background: float
    defect: Literal['none', 'inferior', 'lateral', 'apical', 'anteroapical', 'septal']
    defect_extent_deg: float
    defect_severity: float
    late_wall: Literal['none', 'inferior', 'lateral', 'apical', 'anteroapical', 'septal']
    late_extent_deg: float
    delay_percent: float
    gut_amplitude: float
    gut_gap_mm: float
    gut_radius_mm: float
    gut_position: float
    right_ventricle: float
    irregular: _synthetic.Irregularity
    tags: _synthetic.Tags
    torso: _synthetic.Torso
    azimuth_deg: float
    elevation_deg: float
    cut: Literal['short_axis', 'transaxial']
    base_first: bool
    pose: _synthetic.Pose
    lattice: _synthetic.Lattice
    noise: _synthetic.Noise
    def __init__(self, *, edv_ml: float = ..., ef_percent: float = ..., wall_ml: float = ..., length_to_width: float = ..., base_excursion_mm: float = ..., gates: int = ..., heart_rate_bpm: float = ..., fwhm_mm: float = ..., cavity: float = ..., background: float = ..., defect: Literal['none', 'inferior', 'lateral', 'apical', 'anteroapical', 'septal'] = ..., defect_extent_deg: float = ..., defect_severity: float = ..., late_wall: Literal['none', 'inferior', 'lateral', 'apical', 'anteroapical', 'septal'] = ..., late_extent_deg: float = ..., delay_percent: float = ..., gut_amplitude: float = ..., gut_gap_mm: float = ..., gut_radius_mm: float = ..., gut_position: float = ..., right_ventricle: float = ..., irregular: _synthetic.Irregularity = ..., tags: _synthetic.Tags = ..., torso: _synthetic.Torso = ..., azimuth_deg: float = ..., elevation_deg: float = ..., cut: Literal['short_axis', 'transaxial'] = ..., base_first: bool = ..., pose: _synthetic.Pose = ..., lattice: _synthetic.Lattice = ..., noise: _synthetic.Noise = ...) -> None: ...

class Organ(_Options):
    shape: Literal['liver', 'prostate']
    volume_ml: float
    values: Literal['grey', 'labels']
    inside: float
    outside: float
    neighbour: float
    fwhm_mm: float
    pose: _synthetic.Pose
    lattice: _synthetic.Lattice
    noise: _synthetic.Noise
    def __init__(self, *, shape: Literal['liver', 'prostate'] = ..., volume_ml: float = ..., values: Literal['grey', 'labels'] = ..., inside: float = ..., outside: float = ..., neighbour: float = ..., fwhm_mm: float = ..., pose: _synthetic.Pose = ..., lattice: _synthetic.Lattice = ..., noise: _synthetic.Noise = ...) -> None: ...

class Collimator(_Options):
    hole_mm: float
    septum_mm: float
    length_mm: float
    intrinsic_mm: float
    def __init__(self, *, hole_mm: float = ..., septum_mm: float = ..., length_mm: float = ..., intrinsic_mm: float = ...) -> None: ...

class Acquisition(_Options):
    collimator: Literal['lehr', 'legp', 'czt', 'own']
    own_collimator: _synthetic.Collimator
    views: int
    start_deg: float
    arc_deg: float
    orbit: Literal['circular', 'body_contour']
    radius_mm: float
    gap_mm: float
    size: int
    bin_mm: float
    oversampling: int
    attenuation: bool
    scatter: float
    scatter_slope_per_cm: float
    million_counts: float
    is_noisy: bool
    rejected_percent: float
    breathing_mm: float
    move_x_mm: float
    move_y_mm: float
    move_z_mm: float
    move_at: float
    def __init__(self, *, collimator: Literal['lehr', 'legp', 'czt', 'own'] = ..., own_collimator: _synthetic.Collimator = ..., views: int = ..., start_deg: float = ..., arc_deg: float = ..., orbit: Literal['circular', 'body_contour'] = ..., radius_mm: float = ..., gap_mm: float = ..., size: int = ..., bin_mm: float = ..., oversampling: int = ..., attenuation: bool = ..., scatter: float = ..., scatter_slope_per_cm: float = ..., million_counts: float = ..., is_noisy: bool = ..., rejected_percent: float = ..., breathing_mm: float = ..., move_x_mm: float = ..., move_y_mm: float = ..., move_z_mm: float = ..., move_at: float = ...) -> None: ...

class Fbp(_Options):
    window: Literal['ramp', 'butterworth', 'hann']
    cutoff_per_cm: float
    order: float
    def __init__(self, *, window: Literal['ramp', 'butterworth', 'hann'] = ..., cutoff_per_cm: float = ..., order: float = ...) -> None: ...

class Osem(_Options):
    iterations: int
    subsets: int
    attenuation: bool
    scatter: bool
    resolution: bool
    filter_fwhm_mm: float
    def __init__(self, *, iterations: int = ..., subsets: int = ..., attenuation: bool = ..., scatter: bool = ..., resolution: bool = ..., filter_fwhm_mm: float = ...) -> None: ...

class Reorientation(_Options):
    size: int
    slices: int
    axis_error_deg: float
    axis_error_towards_deg: float
    def __init__(self, *, size: int = ..., slices: int = ..., axis_error_deg: float = ..., axis_error_towards_deg: float = ...) -> None: ...

class CameraHeart(_Options):
    edv_ml: float
    ef_percent: float
    wall_ml: float
    length_to_width: float
    base_excursion_mm: float
    gates: int
    heart_rate_bpm: float
    cavity: float
    background: float
    defect: Literal['none', 'inferior', 'lateral', 'apical', 'anteroapical', 'septal']
    defect_extent_deg: float
    defect_severity: float
    late_wall: Literal['none', 'inferior', 'lateral', 'apical', 'anteroapical', 'septal']
    late_extent_deg: float
    delay_percent: float
    gut_amplitude: float
    gut_gap_mm: float
    gut_radius_mm: float
    gut_position: float
    right_ventricle: float
    irregular: _synthetic.Irregularity
    tags: _synthetic.Tags
    torso: _synthetic.Torso
    azimuth_deg: float
    elevation_deg: float
    def __init__(self, *, edv_ml: float = ..., ef_percent: float = ..., wall_ml: float = ..., length_to_width: float = ..., base_excursion_mm: float = ..., gates: int = ..., heart_rate_bpm: float = ..., cavity: float = ..., background: float = ..., defect: Literal['none', 'inferior', 'lateral', 'apical', 'anteroapical', 'septal'] = ..., defect_extent_deg: float = ..., defect_severity: float = ..., late_wall: Literal['none', 'inferior', 'lateral', 'apical', 'anteroapical', 'septal'] = ..., late_extent_deg: float = ..., delay_percent: float = ..., gut_amplitude: float = ..., gut_gap_mm: float = ..., gut_radius_mm: float = ..., gut_position: float = ..., right_ventricle: float = ..., irregular: _synthetic.Irregularity = ..., tags: _synthetic.Tags = ..., torso: _synthetic.Torso = ..., azimuth_deg: float = ..., elevation_deg: float = ...) -> None: ...

class CameraPhantom(_Options):
    heart: _synthetic.CameraHeart
    arms_down: bool
    acquisition: _synthetic.Acquisition
    reconstruction: Union[_synthetic.Fbp, _synthetic.Osem, str]
    reorientation: _synthetic.Reorientation
    seed: int
    def __init__(self, *, heart: _synthetic.CameraHeart = ..., arms_down: bool = ..., acquisition: _synthetic.Acquisition = ..., reconstruction: Union[_synthetic.Fbp, _synthetic.Osem, str] = ..., reorientation: _synthetic.Reorientation = ..., seed: int = ...) -> None: ...
