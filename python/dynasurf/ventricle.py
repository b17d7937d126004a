"""The left ventricle: from a gated study to walls and numbers, and every stage on the way."""

import os

from . import _core
from ._core import (
    Estimate,
    FittedBeat,
    Gate,
    Labels,
    LeadingSurface,
    Measures,
    Surface,
    VentricleResult,
    border_planes,
    border_volume,
    close_border,
    find_base_slice,
    with_room,
)
from ._options import classes_of, text_of
from ._progress import progress_of

__all__ = [
    "Estimate",
    "FittedBeat",
    "Gate",
    "Labels",
    "LeadingSurface",
    "Measures",
    "Surface",
    "VentricleResult",
    "border_planes",
    "border_volume",
    "close_border",
    "find_base_slice",
    "fit",
    "label_borders",
    "measure",
    "preset",
    "reconstruct",
    "settle",
    "with_room",
    *(_found := classes_of("ventricle")),
]
globals().update(_found)

Options = _found["Options"]


def preset(name):
    """A named set of options: psf_corrected, pet, mr, ct, edges or thesis.

    Returns
    -------
    Options

    Raises
    ------
    OptionError
        For another name.
    """
    return Options.from_json(_core.ventricle_preset(name))


def reconstruct(
    study,
    options=None,
    *,
    preset="psf_corrected",
    fwhm_mm=None,
    mask=None,
    start=None,
    edges=None,
    labels=None,
    cache=None,
    progress=None,
    threads=0,
    **members,
):
    """The whole way from a study to walls and numbers, as ``dynasurf ventricle`` goes it.

    Parameters
    ----------
    study : Study
    options : Options, optional
        In the place of those of `preset`.
    preset : str
        See `dynasurf.ventricle.preset`.
    fwhm_mm : float, optional
        Width of the camera's point spread in the image, mm; 0: sharp.
    mask : Image or path, optional
        Placed in the world like the study: only where it is above 0 the study is looked at.
    start : TriMesh or path, optional
        The mesh that all surfaces start from.
    edges : callable, optional
        Function of an Image that returns an EdgeMap or a Mask: an edge detector in the place of the program's.
    labels : callable, optional
        Function of (Image, EdgeMap) that returns Labels: a labeller in the place of the program's. A note of the
        result tells both. Both are called from other threads, one at a time.
    cache : StageCache, optional
        What the run before found: stages that the changed options do not touch are not done again. Not used beside `edges`
        and `labels`.
    progress : bool or callable, optional
        See `dynasurf.progress_of`.
    threads : int
        At most; 0: all. The result is the same. Holds for the whole process while this call runs.
    **members
        Members of Options by name: ``mesh_level=4``.

    Returns
    -------
    VentricleResult
        World (LPS), mm, mL.

    Raises
    ------
    OptionError
        For an option out of range.
    InputError
        For a study that cannot be worked on: fewer than 3 slices, values that are not finite.
    KeyboardInterrupt
        Within 0.2 s after Ctrl-C.

    See Also
    --------
    dynasurf/ventricle/reconstruct.hpp : thesis 7.1.
    """
    chosen = _options_of(options, preset, fwhm_mm, start, members)
    mask, mask_sha256 = _mask_of(mask)
    start, start_sha256 = _start_of(start)
    with progress_of(progress) as tell:
        return _core.reconstruct_ventricle(
            study, chosen.to_json(), preset, mask, mask_sha256, start, start_sha256,
            _edge_function(edges), _name_of(edges), labels, _name_of(labels), cache, tell, threads,
        )  # fmt: skip


def _options_of(options, name, fwhm_mm, start, members):
    chosen = preset(name) if options is None else Options.from_json(text_of(options, "ventricle.Options"))
    if fwhm_mm is not None:
        chosen.fit.fwhm_mm = fwhm_mm
    if start is not None:
        chosen.placement.shape = "file"
    return Options.from_json(text_of(chosen, "ventricle.Options", members))


def _mask_of(mask):
    """The mask, and the hash of its file."""
    if mask is None or isinstance(mask, _core.Image):
        return mask, None
    study = _core.read_study(os.fspath(mask))
    if len(study) != 1:
        raise _core.InputError(f"{os.fspath(mask)}: holds {len(study)} volumes; expected a mask of one")
    return study.gates[0], _core.sha256_of_file(os.fspath(mask))


def _start_of(start):
    if start is None or isinstance(start, _core.TriMesh):
        return start, None
    return _core.read_mesh(os.fspath(start)), _core.sha256_of_file(os.fspath(start))


def _name_of(function):
    return "" if function is None else "the Python function " + getattr(function, "__name__", type(function).__name__)


def _edge_function(function):
    """The function with its result as an EdgeMap."""
    if function is None:
        return None

    def found(image):
        edges = function(image)
        return _core.EdgeMap(edges) if isinstance(edges, _core.Mask) else edges

    return found


def label_borders(image, edges, options=None, **members):
    """Tell the inner from the outer border among the edges.

    Parameters
    ----------
    image : Image
        Values from 0 to 1, slices from apex to base.
    edges : EdgeMap
    options : Labelling, optional
    **members
        Members of Labelling by name.

    Returns
    -------
    Labels

    Raises
    ------
    OptionError
        For an option out of range. Hard data never raise: what was not found is absent, with notes.

    See Also
    --------
    dynasurf/ventricle/labels.hpp : thesis 2.3 to 2.6.
    """
    return _core.label_borders(image, edges, text_of(options, "ventricle.Labelling", members))


def settle(mesh, image, base=(0, 0, 0), options=None, **members):
    """Move a surface along its normals to where the image is steepest.

    Parameters
    ----------
    mesh : TriMesh
        Closed, in the grid frame of the image.
    image : Image
    base : array_like, (3,)
        Direction whose side stays, unit; zeros: none does.
    options : Settle, optional
    **members
        Members of Settle by name.

    Returns
    -------
    TriMesh

    Raises
    ------
    OptionError

    See Also
    --------
    dynasurf/ventricle/detail/settle.hpp
    """
    return _core.settle_on_slope(mesh, image, base, text_of(options, "ventricle.Settle", members))


def fit(study, endo, epi, *, axis, lateral, options=None, progress=None, threads=0, **members):
    """Fit the walls of all gates together through the camera's blur.

    Parameters
    ----------
    study : Study
        As stored, any orientation.
    endo, epi : list of TriMesh
        The walls to begin with, one per gate, world (LPS), mm.
    axis : array_like, (3,)
        From apex to base, world.
    lateral : array_like, (3,)
        The heart's x, world; not along the axis.
    options : BlurFit, optional
    progress, threads
        As of `reconstruct`.
    **members
        Members of BlurFit by name.

    Returns
    -------
    FittedBeat

    Raises
    ------
    OptionError, InputError

    See Also
    --------
    dynasurf/psf_fit/blur_fit.hpp
    """
    text = text_of(options, "ventricle.BlurFit", members)
    with progress_of(progress) as tell:
        return _core.fit_through_blur(study, list(endo), list(epi), axis, lateral, text, tell, threads)


def measure(study, endo, epi, *, axis, from_edges=True, options=None, **members):
    """Measure walls: function, thickness, motion, phase, polar maps, segments.

    Parameters
    ----------
    study : Study
    endo, epi : list of TriMesh or None
        One per gate, closed, world (LPS), mm.
    axis : array_like, (3,)
        From apex to base, world.
    from_edges : bool
        The surfaces are edges of a blurred image: their thickness is apparent.
    options : MeasureOptions, optional
    **members
        Members of MeasureOptions by name.

    Returns
    -------
    Measures

    Raises
    ------
    OptionError

    See Also
    --------
    dynasurf/ventricle/measures/measures.hpp
    """
    text = text_of(options, "ventricle.MeasureOptions", members)
    return _core.measure_walls(study, list(endo), list(epi), axis, from_edges, text)
