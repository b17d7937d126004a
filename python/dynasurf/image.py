"""Edges of images, slice by slice."""

from . import _core
from ._core import EdgeMap, Image, Mask
from ._options import classes_of, text_of_method

__all__ = ["EdgeMap", "Image", "Mask", "detect_edges", *(_found := classes_of("image"))]
globals().update(_found)

_METHODS = tuple(f"image.{n}" for n in ("Canny", "CannyRevised", "GradientEdges", "SobelEdges", "Compass", "ContourCompletion"))


def detect_edges(image, options=None, *, progress=None, threads=0):
    """Edges of every slice of a normalised volume.

    Parameters
    ----------
    image : Image
        Values from 0 to 1.
    options : Canny, CannyRevised, GradientEdges, SobelEdges, Compass, ContourCompletion or str
        The method, or its word; None: Canny.
    progress : bool or callable, optional
        See `dynasurf.progress_of`.
    threads : int
        At most; 0: all. The result is the same.

    Returns
    -------
    EdgeMap

    Raises
    ------
    OptionError
        For an option out of range, or ``high`` below ``low``.
    InputError
        For values that are not finite.

    See Also
    --------
    dynasurf/image/edges.hpp : thesis 2.2.
    """
    from ._progress import progress_of

    with progress_of(progress) as tell:
        return _core.detect_edges(image, text_of_method(options, "image.Canny", _METHODS), tell, threads)
