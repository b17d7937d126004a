"""Vector fields that pull surfaces onto borders."""

from . import _core
from ._core import FlowResult, VectorField
from ._options import classes_of, text_of, text_of_method
from ._progress import progress_of

__all__ = ["FlowResult", "VectorField", "edge_map_of", "flow_field", *(_found := classes_of("field"))]
globals().update(_found)

_METHODS = tuple(f"field.{n}" for n in ("Gvf", "SteadyGvf", "SteadyGgvf", "Ggvf", "BandGvf", "BandGgvf"))


def flow_field(edge_map, options=None, *, progress=None, threads=0):
    """Gradient vector flow of an edge map that is high on borders.

    Parameters
    ----------
    edge_map : Image
    options : Gvf, SteadyGvf, SteadyGgvf, Ggvf, BandGvf, BandGgvf or str
        The method, or its word; None: Gvf, the explicit scheme of the thesis.
    progress : bool or callable, optional
        See `dynasurf.progress_of`.
    threads : int
        At most; 0: all. The result is the same.

    Returns
    -------
    FlowResult
        With ``field`` in 1/mm along the axes of the grid.

    Raises
    ------
    OptionError
        For an option out of range.
    InputError
        For a map that is empty or not finite.

    See Also
    --------
    dynasurf/field/gvf.hpp, dynasurf/field/steady.hpp, dynasurf/field/band.hpp : thesis 3.3.4 and 4.5.

    Examples
    --------
    >>> import numpy as np, dynasurf as ds
    >>> ramp = ds.Image(np.arange(27, dtype="f4").reshape(3, 3, 3) // 9, spacing=(1, 1, 2))
    >>> ds.field.flow_field(ramp).field.components[2][1, 1, 1]
    0.5
    """
    with progress_of(progress) as tell:
        return _core.flow_field(edge_map, text_of_method(options, "field.Gvf", _METHODS), tell, threads)


def edge_map_of(image, options=None, **members):
    """The edge map of a grey image: high where surfaces shall go, its largest value 1.

    Parameters
    ----------
    image : Image
    options : EdgeMapOptions, optional
    **members
        Members of EdgeMapOptions by name.

    Returns
    -------
    Image

    Raises
    ------
    OptionError, InputError

    See Also
    --------
    dynasurf/field/edge_map.hpp : thesis 3.3.4, eqs 6.1 and 6.2.
    """
    return _core.edge_map_of(image, text_of(options, "field.EdgeMapOptions", members))
