"""Closed meshes from scanned points, at several levels of detail."""

from . import _core
from ._core import Certificate, CloudFacts, CloudLevel, CloudResult, PointCloud, certify
from ._options import classes_of, text_of
from ._progress import progress_of

__all__ = [
    "Certificate",
    "CloudFacts",
    "CloudLevel",
    "CloudResult",
    "PointCloud",
    "certify",
    "preset",
    "reconstruct",
    *(_found := classes_of("cloud")),
]
globals().update(_found)

Options = _found["Options"]


def preset(name):
    """A named set of options: shaped, faithful or thesis.

    Returns
    -------
    Options

    Raises
    ------
    OptionError
        For another name.
    """
    return Options.from_json(_core.cloud_preset(name))


def reconstruct(
    points,
    options=None,
    *,
    triangles=None,
    preset="shaped",
    normals=None,
    colours=None,
    cache=None,
    progress=None,
    threads=0,
    **members,
):
    """Closed surfaces from points, as ``dynasurf cloud`` makes them.

    Parameters
    ----------
    points : array_like, (n, 3), or PointCloud
        In any unit. ``PointCloud(points, scanners=[place])`` tells where the scanner stood, which open surfaces then
        face; with several, ``scans`` gives the number of each point's.
    options : Options, optional
        In the place of those of `preset`.
    triangles : list of int, optional
        Of each level, falling.
    preset : str
        See `dynasurf.cloud.preset`.
    normals : array_like, (n, 3), optional
        Outwards, any length but 0.
    colours : array_like, (n, 3) uint8, optional
        sRGB.
    cache : StageCache, optional
        What the run before found: stages that the changed options do not touch are not done again.
    progress : bool or callable, optional
        See `dynasurf.progress_of`.
    threads : int
        At most; 0: all. The result is the same.
    **members
        Members of Options by name: ``genus="keep"``.

    Returns
    -------
    CloudResult
        A sequence of CloudLevel, finest first.

    Raises
    ------
    OptionError
        For an option out of range.
    InputError
        For fewer than 10 usable points, or points in one plane.

    See Also
    --------
    dynasurf/cloud/reconstruct_cloud.hpp : thesis 6.2.
    """
    cloud = points if isinstance(points, PointCloud) else PointCloud(points, normals, colours)
    if triangles is not None:
        members["triangles"] = triangles
    chosen = globals()["preset"](preset) if options is None else options
    with progress_of(progress) as tell:
        return _core.reconstruct_cloud(cloud, text_of(chosen, "cloud.Options", members), preset, cache, tell, threads)
