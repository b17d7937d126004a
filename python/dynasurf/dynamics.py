"""Meshes that move under forces until they rest on a border."""

from . import _core
from ._core import BorderPlanes, EvolutionResult
from ._options import classes_of, text_of
from ._progress import progress_of

__all__ = ["BorderPlanes", "EvolutionResult", "evolve", "evolve_steps", *(_found := classes_of("dynamics"))]
globals().update(_found)


def _own_forces(forces):
    """Forces by name, from a dict or from functions."""
    if not forces:
        return {}
    if callable(forces):
        forces = [forces]
    if isinstance(forces, dict):
        return dict(forces)
    return {getattr(f, "__name__", f"force {n + 1}"): f for n, f in enumerate(forces)}


def evolve(
    start, field, border, options=None, *, planes=None, forces=None, stop=None, drag=None, progress=None, threads=0, **members
):
    """Move a mesh under a field until it rests on the border.

    Parameters
    ----------
    start : TriMesh
        In the grid frame of the border.
    field : VectorField
    border : Image
        Its non-zero voxels stop particles.
    options : Evolution, optional
    planes : BorderPlanes, optional
        Where the border runs inside its voxels, for stop.point "subvoxel".
    forces : callable, list of callables or dict of them, optional
        Functions of (positions, velocities), each (n, 3) in mm and mm/s, that return forces (n, 3) in kg mm/s2.
        They act next to those of the model.
    stop : callable, optional
        Function of (from, to), each (3,) in mm, that returns where a particle on this way stops for good, or None.
        It is asked for every particle in every step.
    drag : Image, optional
        Drag of every voxel, kg/s.
    progress : bool or callable, optional
        See `dynasurf.progress_of`.
    threads : int
        At most; 0: all. The result is the same.
    **members
        Members of Evolution by name.

    Returns
    -------
    EvolutionResult

    Raises
    ------
    OptionError, InputError
        For an option out of range; for an empty or far start, or a field that is not finite.

    See Also
    --------
    dynasurf/dynamics/evolve.hpp : thesis 3.4, 4 and 6.1.2.3.
    """
    text = text_of(options, "dynamics.Evolution", members)
    with progress_of(progress) as tell:
        return _core.evolve(start, field, border, text, planes, _own_forces(forces), stop, drag, tell, threads)


class evolve_steps:
    """The same motion step by step: ``for steps, mesh in evolve_steps(...)``.

    Parameters
    ----------
    start, field, border, options, planes, forces, stop, drag, **members
        As of `evolve`.
    every : int
        Steps between two meshes.

    Attributes
    ----------
    result : EvolutionResult
        What `evolve` returns; None before the end.

    Notes
    -----
    The motion waits between the steps, on a thread of its own. Leaving the loop ends it.
    """

    def __init__(
        self, start, field, border, options=None, *, planes=None, forces=None, stop=None, drag=None, every=1, **members
    ):
        text = text_of(options, "dynamics.Evolution", members)
        self._stepper = _core.evolve_steps(start, field, border, text, planes, _own_forces(forces), stop, drag, every)

    def __iter__(self):
        return self

    def __next__(self):
        return next(self._stepper)

    @property
    def result(self):
        return self._stepper.result

    def close(self):
        """End the motion where it stands."""
        self._stepper.close()
