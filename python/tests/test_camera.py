import dynasurf as ds
import numpy as np
import pytest

SMALL = {"views": 16, "size": 32, "bin_mm": 12.8, "oversampling": 1}


def study_of(**members):
    heart = ds.synthetic.CameraHeart(gates=2)
    cut = ds.synthetic.Reorientation(size=24, slices=16)
    return ds.synthetic.make_camera_study(
        heart=heart, acquisition=ds.synthetic.Acquisition(**SMALL), reorientation=cut, **members
    )


@pytest.fixture(scope="module")
def camera():
    return study_of()


def test_projections_are_arrays_of_counts(camera):
    counts = camera.projections.counts
    assert counts.shape == (2, 16, 32, 32) and counts.dtype == np.float32
    assert np.array_equal(counts, np.round(counts)) and counts.min() == 0
    assert counts.sum() == pytest.approx(4e6, rel=0.01)  # acquisition.million_counts, all gates and views
    assert camera.projections.scatter.shape == counts.shape


def test_the_camera_stands_on_its_arc(camera):
    angles = camera.projections.angle_deg
    assert len(angles) == 16 and angles[0] == -45 and np.allclose(np.diff(angles), 180 / 16)
    with pytest.raises(ValueError, match="read-only"):
        angles[0] = 0


def test_what_was_reconstructed_is_a_study(camera):
    assert camera.transaxial.array.shape == (2, 32, 32, 32) and camera.short_axis.array.shape == (2, 16, 24, 24)
    assert camera.short_axis.view == "short_axis" and camera.attenuation.array.shape == (32, 32, 32)
    assert camera.truth.ef_percent > 0 and len(camera.truth.truth) == 2


def test_a_method_of_reconstruction_is_an_option(camera):
    other = study_of(reconstruction=ds.synthetic.Fbp(window="hann", cutoff_per_cm=0.7))
    assert np.array_equal(other.projections.counts, camera.projections.counts)  # the same camera, the same noise
    assert not np.array_equal(other.transaxial.array, camera.transaxial.array)
    with pytest.raises(ds.OptionError, match="subsets"):
        study_of(reconstruction=ds.synthetic.Osem(subsets=7))


def test_another_seed_is_another_noise_of_the_same_patient(camera):
    other = study_of(seed=2)
    assert not np.array_equal(other.projections.counts, camera.projections.counts)
    assert other.truth.edv_ml == camera.truth.edv_ml
