"""Files: studies, clouds, meshes."""

import os

from . import _core
from ._core import read_mesh, write_dicom, write_mesh, write_nifti, write_nrrd

__all__ = ["read_cloud", "read_mesh", "read_study", "write_dicom", "write_mesh", "write_nifti", "write_nrrd"]


def read_study(path, series=""):
    """A gated or ungated heart study.

    Parameters
    ----------
    path : path
        A DICOM file or folder, a NIfTI or an NRRD file.
    series : str
        Which image series of a DICOM folder: its number, UID, or a part of its description.

    Returns
    -------
    Study

    Raises
    ------
    InputError
        For content that is truncated, inconsistent or not supported, naming file, place and what was expected.
    IoError
        When the file cannot be read.

    See Also
    --------
    dynasurf/io/study_io.hpp
    """
    return _core.read_study(os.fspath(path), series)


def read_cloud(*files):
    """Files of points, or of surfaces that are sampled, as one cloud.

    Parameters
    ----------
    *files : path
        PLY, XYZ, TXT, PTS, CSV, PWN, OBJ, OFF, LAS or STL.

    Returns
    -------
    PointCloud

    Raises
    ------
    InputError, IoError

    See Also
    --------
    dynasurf/io/cloud_io.hpp
    """
    return _core.read_cloud([os.fspath(file) for file in files])
