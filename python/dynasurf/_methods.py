"""What Python adds to the classes of the C++ module: tables, pictures, other programs' objects."""

import os

from . import _core, _friends, _html
from ._options import _classes

SEGMENT_COLUMNS = (
    "number", "name", "territory", "wall_share_percent", "perfusion_percent", "thickness_ed_mm", "thickness_es_mm",
    "thickening_percent", "count_thickening_percent", "motion_mm", "displacement_mm", "area_strain_percent",
    "phase_counts_deg", "phase_motion_deg", "phase_thickness_deg", "perfusion_percent_sd", "thickness_ed_mm_sd",
    "thickness_es_mm_sd", "thickening_percent_sd", "motion_mm_sd", "displacement_mm_sd", "area_strain_percent_sd",
    "phase_motion_deg_sd", "phase_thickness_deg_sd",
)  # fmt: skip


def _segment_type():
    words = {"number": "i4", "name": "U24", "territory": "U3"}
    return [(name, words.get(name, "f8")) for name in SEGMENT_COLUMNS]


def _segments_of_measures(measures):
    """Segments by number, a structured array; NaN: no value. `_sd`: one standard deviation."""
    import numpy as np

    return np.array(measures._segment_rows(), dtype=_segment_type())


def _segments(heart):
    """Segments by number, a structured array; NaN: no value. `_sd`: one standard deviation."""
    import numpy as np

    return np.empty(0, _segment_type()) if heart.measures is None else heart.measures.segments


def _curve(heart, instants=64):
    """The volume curve's periodic fit.

    Returns
    -------
    ndarray, (3, instants) or None
        Phase of the beat, volume in mL, rate in end-diastolic volumes per beat.
    """
    return None if heart.measures is None else heart.measures.curve(instants)


def _volumes(heart):
    """Per gate: volume of the inner and of the outer wall, mL, (gates, 2); NaN: not found."""
    import numpy as np

    rows = [[np.nan if wall is None else wall.volume_ml.value for wall in (g.endo, g.epi)] for g in heart.gates]
    return np.array(rows).reshape(-1, 2)


def _options(name):
    def options(result):
        """The options, as resolved."""
        return _classes[name].from_json(result._options_text())

    return options


def _save_heart(heart, folder, *, mesh_formats=("ply", "vtp"), timings=True, replace=False, labels=None,
                partial_volumes=False):  # fmt: skip
    """Write the folder of ``dynasurf ventricle``.

    Parameters
    ----------
    folder : path
        Appears whole or not at all. An untouched former result there is replaced.
    mesh_formats : sequence of str
        ply, stl, obj, off, vtp, glb, 3mf.
    timings : bool
        False: without times, so that equal runs give equal bytes (``--no-timings``).
    replace : bool
        Move aside what else stands there.
    labels : str, optional
        "nii.gz" or "nii": write walls and borders as voxels of the study, too.
    partial_volumes : bool
        With labels: the exact part of each voxel that is cavity and wall, too.

    Raises
    ------
    IoError, OptionError
    """
    heart._save(os.fspath(folder), list(mesh_formats), timings, replace, labels or "", partial_volumes)


def _save_cloud(lods, folder, *, mesh_formats=("ply",), textures=False, packed=False, timings=True, replace=False):
    """Write the folder of ``dynasurf cloud``.

    Parameters
    ----------
    folder : path
        Appears whole or not at all. An untouched former result there is replaced.
    mesh_formats : sequence of str
        ply, stl, obj, off, vtp, glb, 3mf.
    textures : bool
        Write textured.glb too.
    packed : bool
        Write packed.glb too: all levels in a quarter of the bytes.
    timings, replace : bool
        As of a ventricle's result.

    Raises
    ------
    IoError, OptionError
    """
    lods._save(os.fspath(folder), list(mesh_formats), textures, packed, timings, replace)


def _results(result):
    """results.json as a dictionary."""
    import json

    return json.loads(result.results_text())


def _heart_text(heart):
    numbers = [f"{name} {getattr(heart, name)!r} {unit}" for name, unit in (("ef", "%"), ("edv", "mL"), ("esv", "mL"))
               if getattr(heart, name) is not None]  # fmt: skip
    return f"<dynasurf.VentricleResult of {len(heart.gates)} gates: {', '.join([*numbers, heart.verdict])}>"


def _cloud_text(lods):
    levels = ", ".join(str(level.certificate.triangles) for level in lods)
    word = "watertight" if lods.watertight else "not watertight"
    if lods.facts.boundary != "close" and all(level.certificate.sound_open for level in lods):
        word = f"open, boundary loops: {lods.facts.boundary_loops}"
    return f"<dynasurf.CloudResult of {len(lods)} levels of {levels} triangles: {word}>"


def _same(value):
    return value


def _deep_same(value, memo):
    return value


def give_to_classes():
    """Complete the classes of the C++ module."""
    heart, lods = _core.VentricleResult, _core.CloudResult
    _core.Measures.segments = property(_segments_of_measures)
    heart.segments = property(_segments)
    heart.volumes_ml = property(_volumes)
    heart.curve = _curve
    heart.options = property(_options("ventricle.Options"))
    heart.save = _save_heart
    heart.__repr__ = _heart_text
    heart._repr_html_ = _html.of_heart
    lods.options = property(_options("cloud.Options"))
    lods.save = _save_cloud
    lods.__repr__ = _cloud_text
    lods._repr_html_ = _html.of_cloud
    heart.results = lods.results = property(_results)
    _friends.give_to_classes()
    # Nothing of these can be changed: a copy is the thing itself.
    for kind in (heart, lods, _core.Image, _core.Mask, _core.Study, _core.PointCloud, _core.VectorField, _core.EdgeMap,
                 _core.Labels, _core.FlowResult, _core.EvolutionResult, _core.Grid, _core.TetMesh, _core.Measures):  # fmt: skip
        kind.__copy__, kind.__deepcopy__ = _same, _deep_same
