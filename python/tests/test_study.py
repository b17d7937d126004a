import dynasurf as ds
import numpy as np
import pytest

nibabel = pytest.importorskip("nibabel")


def rotation(angle):
    c, s = np.cos(angle), np.sin(angle)
    return np.array([[c, -s, 0], [s, c, 0], [0, 0, 1.0]])


def l_marker():
    """An L whose long arm runs along +x, its short arm along +y, its foot along +z: no turn or flip leaves it as it is."""
    array = np.zeros((2, 6, 7, 8), "f4")
    array[:, 1, 1, 1:7] = 1
    array[:, 1, 1:4, 1] = 2
    array[:, 1:3, 1, 1] = 3
    return array


def affine():
    made = np.eye(4)
    made[:3, :3] = rotation(0.3) @ np.diag([1.5, 2.0, 3.0])
    made[:3, 3] = [10, -20, 30]
    return made


def test_the_affine_is_kept():
    study = ds.Study(l_marker(), affine=affine())
    assert np.allclose(study.affine, affine(), atol=1e-12)
    assert np.allclose(study.grid.spacing, [1.5, 2, 3]) and study.grid.dims == [8, 7, 6]


def test_no_axis_flips_on_the_way_through_nibabel():
    study = ds.Study(l_marker(), affine=affine())
    image = study.to_nibabel()
    # The same voxel at the same place: LPS is RAS with x and y turned round.
    for i, j, k in [(6, 1, 1), (1, 3, 1), (1, 1, 2), (0, 0, 0)]:
        assert image.get_fdata()[i, j, k, 0] == l_marker()[0, k, j, i]
        assert np.allclose(image.affine @ [i, j, k, 1], np.diag([-1, -1, 1, 1]) @ affine() @ [i, j, k, 1])
    back = ds.Study.from_nibabel(image)
    assert np.array_equal(back.array, study.array) and np.allclose(back.affine, study.affine)


@pytest.mark.parametrize("ending", ["nii", "nii.gz"])
def test_nibabel_reads_what_the_program_writes_and_back(tmp_path, ending):
    study = ds.Study(l_marker(), affine=affine(), time_ms=[0, 50], cycle_ms=100)
    ds.io.write_nifti(study, tmp_path / f"s.{ending}")
    seen = nibabel.load(tmp_path / f"s.{ending}")
    assert np.array_equal(np.asarray(seen.dataobj).transpose(), study.array)
    assert np.allclose(seen.affine, study.to_nibabel().affine, atol=1e-5)
    again = ds.read_study(tmp_path / f"s.{ending}")
    assert np.array_equal(again.array, study.array) and np.allclose(again.affine, study.affine, atol=1e-5)


def test_what_nibabel_writes_the_program_reads(tmp_path):
    study = ds.Study(l_marker(), affine=affine())
    nibabel.save(study.to_nibabel(), tmp_path / "s.nii")
    again = ds.read_study(tmp_path / "s.nii")
    assert np.array_equal(again.array, study.array) and np.allclose(again.affine, study.affine, atol=1e-5)


def test_a_volume_to_nibabel_keeps_its_place():
    image = ds.Study(l_marker(), affine=affine()).gates[0]
    assert np.allclose(image.to_nibabel().affine, np.diag([-1, -1, 1, 1]) @ affine())
    assert np.array_equal(np.asarray(image.to_nibabel().dataobj).transpose(), image.array)


@pytest.mark.parametrize("writer", ["write_nifti", "write_nrrd"])
def test_files_keep_every_value(tmp_path, writer, study):
    path = tmp_path / {"write_nifti": "s.nii.gz", "write_nrrd": "s.seq.nrrd"}[writer]
    getattr(ds.io, writer)(study, path)
    assert np.array_equal(ds.read_study(path).array, study.array)


def test_dicom_is_read_back_to_its_steps(tmp_path, study):
    scale = 30000 / study.array.max()
    ds.io.write_dicom(study, tmp_path / "s.dcm", counts_scale=scale)
    again = ds.read_study(tmp_path / "s.dcm")
    assert again.format == "DICOM"
    # Half a step of what is stored, and the rounding of floats of its size.
    assert np.abs(again.array - study.array * scale).max() <= 0.5 + 30000 * np.finfo("f4").eps


@pytest.mark.parametrize(
    ("how", "words"),
    [
        ({"spacing": (1, 1)}, "spacing"),
        ({"spacing": (1, 0, 1)}, "positive"),
        ({"affine": np.eye(3)}, r"\(4, 4\)"),
        ({"affine": np.array([[1, 1, 0, 0], [0, 1, 0, 0], [0, 0, 1, 0], [0, 0, 0, 1.0]])}, "right angles"),
        ({"affine": np.zeros((4, 4))}, "right angles"),
        ({"affine": np.full((4, 4), np.nan)}, "right angles"),
        ({"affine": np.eye(4), "spacing": (2, 1, 1)}, "not that of affine"),
        ({"spacing": (1, 1, 1), "time_ms": [1, 2, 3]}, "one for each of the 2 gates"),
        ({"spacing": (1, 1, 1), "view": "sideways"}, "view is 'sideways'"),
        ({"spacing": (1, 1, 1), "cycle_ms": -1}, "cycle_ms"),
    ],
)
def test_a_study_that_is_none_is_refused(how, words):
    with pytest.raises(ds.OptionError, match=words):
        ds.Study(l_marker(), **how)


def test_a_file_that_is_none_is_refused_naming_it(tmp_path):
    (tmp_path / "s.nii").write_bytes(b"nothing of the kind")
    with pytest.raises(ds.InputError, match="s.nii"):
        ds.read_study(tmp_path / "s.nii")
    with pytest.raises(OSError, match="none.dcm"):
        ds.read_study(tmp_path / "none.dcm")
