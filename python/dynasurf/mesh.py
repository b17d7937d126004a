"""Triangle meshes: starts, measures, checks, solids."""

from . import _core
from ._core import (
    SurfaceCheck,
    TetMesh,
    TriMesh,
    area_mm2,
    check_surface,
    cross_section,
    fill_between,
    icosphere,
    to_grid,
    to_world,
    volume_mm3,
    voxel_parts,
)
from ._options import classes_of, text_of

__all__ = [
    "SurfaceCheck",
    "TetMesh",
    "TriMesh",
    "area_mm2",
    "check_surface",
    "cross_section",
    "fill_between",
    "icosphere",
    "start_mesh",
    "to_grid",
    "to_world",
    "volume_mm3",
    "voxel_parts",
    *(_found := classes_of("mesh")),
]
globals().update(_found)


def start_mesh(border, level=3, placement=None, given=None, **members):
    """The mesh that is deformed: around, or inside, the non-zero voxels of a border.

    Parameters
    ----------
    border : Image
    level : int
        About 10 * 4**level vertices.
    placement : Placement, optional
    given : TriMesh, optional
        The mesh of shape "file", fitted to the border's box.
    **members
        Members of Placement by name.

    Returns
    -------
    TriMesh
        In the grid frame of the border: mm along its axes.

    Raises
    ------
    OptionError
        For an option out of range.
    InputError
        For a border without voxels.

    See Also
    --------
    dynasurf/mesh/shapes.hpp : thesis 5.2.
    """
    return _core.start_mesh(border, level, text_of(placement, "mesh.Placement", members), given)
