"""Phantoms: studies and clouds with known truth, made by code."""

from . import _core
from ._core import CameraStudy, Phantom, Projections, TrueGate
from ._options import classes_of, text_of, text_of_method
from ._progress import progress_of

__all__ = [
    "CameraStudy",
    "Phantom",
    "Projections",
    "TrueGate",
    "make_camera_study",
    "make_cloud",
    "make_phantom",
    *(_found := classes_of("synthetic")),
]
globals().update(_found)

_KINDS = tuple(
    f"synthetic.{n}"
    for n in (
        "Hebron", "Mayo", "Partial", "TwoSpheres", "VoxelSphere", "Gap", "CardiacCycle", "Pathology", "VirtualPatient", "Organ"
    )
)  # fmt: skip


def make_phantom(options, *, threads=0):
    """A study together with its truth.

    Parameters
    ----------
    options : VirtualPatient, Hebron, Mayo, Partial, TwoSpheres, VoxelSphere, Gap, CardiacCycle, Pathology, Organ or str
        What is made, or its word.
    threads : int
        At most; 0: all. The result is the same.

    Returns
    -------
    Phantom

    Raises
    ------
    OptionError
        For an option out of range.

    See Also
    --------
    dynasurf/synthetic/phantoms.hpp
    """
    return _core.make_phantom(text_of_method(options, "synthetic.VirtualPatient", _KINDS), threads)


def make_camera_study(options=None, *, progress=None, threads=0, **members):
    """A virtual patient seen by a rotating gamma camera: projections, reconstructed, cut along the heart's axes.

    Parameters
    ----------
    options : CameraPhantom, optional
    progress, threads
        As of `dynasurf.ventricle.reconstruct`.
    **members
        Members of CameraPhantom by name: ``reconstruction="fbp", seed=3``.

    Returns
    -------
    CameraStudy

    Raises
    ------
    OptionError
        For an option out of range.

    See Also
    --------
    dynasurf/synthetic/camera.hpp
    """
    text = text_of(options, "synthetic.CameraPhantom", members)
    with progress_of(progress) as tell:
        return _core.make_camera_study(text, tell, threads)


def make_cloud(options=None, **members):
    """A scan of a body with known shape.

    Parameters
    ----------
    options : CloudPhantom, optional
    **members
        Members of CloudPhantom by name: ``shape="vase", points=20000``.

    Returns
    -------
    PointCloud

    Raises
    ------
    OptionError

    Examples
    --------
    >>> import dynasurf as ds
    >>> len(ds.synthetic.make_cloud(shape="torus", points=500))
    500
    """
    return _core.make_cloud(text_of(options, "synthetic.CloudPhantom", members))
