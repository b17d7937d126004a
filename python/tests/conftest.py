"""What the tests share. DYNASURF_PROGRAM names the program whose results are compared; without it that is skipped."""

import os

import dynasurf as ds
import numpy as np
import pytest


@pytest.fixture(scope="session")
def phantom():
    return ds.synthetic.make_phantom(ds.synthetic.VirtualPatient(gates=6))


@pytest.fixture(scope="session")
def study(phantom):
    return phantom.study


@pytest.fixture(scope="session")
def heart(study):
    return ds.ventricle.reconstruct(study, fwhm_mm=12)


@pytest.fixture(scope="session")
def edges_heart(study):
    return ds.ventricle.reconstruct(study, preset="edges")


@pytest.fixture(scope="session")
def cloud():
    return ds.synthetic.make_cloud(shape="torus", points=8000, seed=3)


@pytest.fixture(scope="session")
def lods(cloud):
    return ds.cloud.reconstruct(cloud, triangles=[1280, 320])


@pytest.fixture(scope="session")
def program():
    path = os.environ.get("DYNASURF_PROGRAM")
    if not path:
        pytest.skip("DYNASURF_PROGRAM does not name the program")
    return path


@pytest.fixture
def ball():
    """A solid ball of radius 8 mm in a grid of 24 x 24 x 12 voxels of 1 x 1 x 2 mm."""
    z, y, x = np.mgrid[:12, :24, :24].astype(float)
    inside = (x - 11.5) ** 2 + (y - 11.5) ** 2 + (2 * (z - 5.5)) ** 2 < 64
    return ds.Image(inside.astype("f4"), spacing=(1, 1, 2))
