"""Objects of other libraries, imported only when asked for."""

from . import _core


def _friend(module, package):
    """A library, or ImportError that tells how to get it."""
    import importlib

    try:
        return importlib.import_module(module)
    except ImportError as error:
        raise ImportError(f"this needs {module}, which is not installed (Debian: {package}; pip: {module})") from error


def _mesh_of(surface):
    return surface if isinstance(surface, _core.TriMesh) else surface.mesh


def _to_trimesh(surface):
    """The surface as a trimesh.Trimesh, vertices and triangles as they are."""
    trimesh = _friend("trimesh", "not packaged")
    mesh = _mesh_of(surface)
    return trimesh.Trimesh(mesh.vertices, mesh.triangles, process=False)


def _to_meshio(surface):
    """The surface as a meshio.Mesh."""
    meshio = _friend("meshio", "python3-meshio")
    mesh = _mesh_of(surface)
    return meshio.Mesh(mesh.vertices, [("triangle", mesh.triangles)])


def _solid_to_meshio(solid):
    """The solid as a meshio.Mesh."""
    meshio = _friend("meshio", "python3-meshio")
    return meshio.Mesh(solid.vertices, [("tetra", solid.tetrahedra)])


def _to_pyvista(surface):
    """The surface as a pyvista.PolyData."""
    pyvista = _friend("pyvista", "not packaged")
    import numpy as np

    mesh = _mesh_of(surface)
    faces = np.column_stack([np.full(len(mesh.triangles), 3), mesh.triangles]).ravel()
    return pyvista.PolyData(mesh.vertices, faces)


def _lps_to_ras(affine):
    import numpy as np

    return np.diag([-1.0, -1.0, 1.0, 1.0]) @ affine


def _volume_to_nibabel(volume):
    """The volume as a nibabel.Nifti1Image, axes (i, j, k), RAS mm."""
    nibabel = _friend("nibabel", "python3-nibabel")
    return nibabel.Nifti1Image(volume.array.transpose(2, 1, 0), _lps_to_ras(volume.affine))


def _study_to_nibabel(study):
    """The study as a nibabel.Nifti1Image, axes (i, j, k) or (i, j, k, gate), RAS mm."""
    nibabel = _friend("nibabel", "python3-nibabel")
    array = study.array.transpose(3, 2, 1, 0)
    image = nibabel.Nifti1Image(array if len(study) > 1 else array[..., 0], _lps_to_ras(study.affine))
    image.header.set_xyzt_units("mm", "msec")
    if len(study.time_ms) > 1:
        image.header["pixdim"][4] = study.time_ms[1] - study.time_ms[0]
    return image


def _study_from_nibabel(image, **facts):
    """A study from a nibabel image of three or four axes.

    Parameters
    ----------
    image : nibabel image
        Axes (i, j, k) or (i, j, k, gate); its affine in RAS mm becomes LPS.
    **facts
        As of Study: time_ms, cycle_ms, modality, view, slice_order.

    Returns
    -------
    Study
    """
    import numpy as np

    data = np.asarray(image.dataobj, dtype=np.float32)
    if data.ndim not in (3, 4):
        raise _core.OptionError(f"image has {data.ndim} axes; expected (i, j, k) or (i, j, k, gate)")
    return _core.Study(data.transpose(), affine=_lps_to_ras(image.affine), **facts)


def _gates_to_pandas(heart):
    """One row per gate: time, volumes of both walls, the muscle between them."""
    pandas = _friend("pandas", "python3-pandas")
    volumes = heart.volumes_ml
    return pandas.DataFrame(
        {
            "gate": range(len(volumes)),
            "time_ms": [g.time_ms for g in heart.gates],
            "endo_ml": volumes[:, 0],
            "epi_ml": volumes[:, 1],
            "wall_ml": volumes[:, 1] - volumes[:, 0],
        }
    )


def _levels_to_pandas(lods):
    """One row per level: its certificate."""
    pandas = _friend("pandas", "python3-pandas")
    names = [n for n in dir(_core.Certificate) if not n.startswith("_")]
    return pandas.DataFrame([{n: getattr(level.certificate, n) for n in names} for level in lods])


def _plot_heart(heart, what="curve", *, gate=0, name="perfusion_percent", axes=None):
    """Draw with matplotlib.

    Parameters
    ----------
    what : str
        "curve": volumes over the beat. "polar": a polar map. "slices": a gate's slices with its borders.
    gate : int
        Of the slices, from 0.
    name : str
        Of the polar map; see `Measures.polar`.
    axes : matplotlib Axes, optional
        To draw a curve or a polar map on.

    Returns
    -------
    matplotlib Figure
    """
    _friend("matplotlib.pyplot", "python3-matplotlib")
    from . import _plots

    drawers = {"curve": _plots.curve, "polar": _plots.polar, "slices": _plots.slices}
    if what not in drawers:
        raise _core.OptionError(f"plot of '{what}'; expected {', '.join(drawers)}")
    return drawers[what](heart, gate=gate, name=name, axes=axes)


def give_to_classes():
    """Complete the classes of the C++ module."""
    surfaces = (_core.TriMesh, _core.LeadingSurface, _core.Surface, _core.CloudLevel)
    for kind in surfaces:
        kind.to_trimesh, kind.to_meshio, kind.to_pyvista = _to_trimesh, _to_meshio, _to_pyvista
    _core.TetMesh.to_meshio = _solid_to_meshio
    _core.Image.to_nibabel = _core.Mask.to_nibabel = _volume_to_nibabel
    _core.Study.to_nibabel = _study_to_nibabel
    _core.Study.from_nibabel = staticmethod(_study_from_nibabel)
    _core.VentricleResult.to_pandas = _gates_to_pandas
    _core.VentricleResult.plot = _plot_heart
    _core.CloudResult.to_pandas = _levels_to_pandas
