"""Voxels of walls and borders: what nibabel reads of them, and that they are the meshes'."""

import json
import subprocess

import dynasurf as ds
import numpy as np
import pytest

nibabel = pytest.importorskip("nibabel")
RAS_OF_LPS = np.diag([-1.0, -1.0, 1.0, 1.0])


@pytest.fixture(scope="module")
def saved(heart, tmp_path_factory):
    folder = tmp_path_factory.mktemp("labels") / "result"
    heart.save(folder, labels="nii.gz", partial_volumes=True)
    return folder / "labels"


def volumes(path):
    image = nibabel.load(path)
    return image, np.asarray(image.dataobj)


def test_labels_lie_on_the_study_in_ras(saved, study):
    for name in ("walls", "borders", "part_cavity", "part_wall"):
        image, array = volumes(saved / f"{name}.nii.gz")
        assert array.shape == (*study.grid.dims, len(study)), name
        # Inside LPS, in NIfTI RAS: the same voxel at the same place.
        assert np.allclose(image.affine, RAS_OF_LPS @ study.affine, atol=1e-4), name
        assert np.allclose(image.get_sform(), image.get_qform(), atol=1e-4), name
        assert image.header.get_xyzt_units() == ("mm", "msec"), name


def test_labels_are_whole_numbers_and_say_so(saved):
    walls, borders = volumes(saved / "walls.nii.gz"), volumes(saved / "borders.nii.gz")
    assert walls[1].dtype == borders[1].dtype == np.uint8
    assert set(np.unique(walls[1])) == {0, 1, 2} and {1, 2} <= set(np.unique(borders[1])) <= {0, 1, 2, 3}
    assert walls[0].header.get_intent()[0] == "label" and borders[0].header.get_intent()[0] == "label"


def test_the_parts_add_up_to_the_volumes_of_the_meshes(saved, heart, study):
    ml = np.prod(study.grid.spacing) / 1000
    cavity, wall = (volumes(saved / f"part_{n}.nii.gz")[1].astype(float) for n in ("cavity", "wall"))
    assert cavity.min() >= 0 and (cavity + wall).max() <= 1 + 1e-6
    for g, gate in enumerate(heart.gates):
        # Parts are single precision; every voxel rounds by at most 6e-8.
        assert cavity[..., g].sum() * ml == pytest.approx(gate.endo.volume_ml.value, rel=1e-6)
        assert (cavity + wall)[..., g].sum() * ml == pytest.approx(gate.epi.volume_ml.value, rel=1e-6)


def test_labels_are_the_voxels_with_the_larger_part_inside(saved):
    cavity, wall = (volumes(saved / f"part_{n}.nii.gz")[1] for n in ("cavity", "wall"))
    labels = volumes(saved / "walls.nii.gz")[1]
    assert np.array_equal(labels == 1, cavity >= 0.5)
    assert np.array_equal(labels == 2, (cavity < 0.5) & (cavity + wall >= 0.5))


def test_the_volume_of_labels_is_near_that_of_the_meshes(saved, heart, study):
    ml = np.prod(study.grid.spacing) / 1000
    labels = volumes(saved / "walls.nii.gz")[1]
    for g, gate in enumerate(heart.gates):
        assert (labels[..., g] > 0).sum() * ml == pytest.approx(gate.epi.volume_ml.value, rel=0.03)


def test_the_middle_of_the_labels_is_the_middle_of_the_mesh(saved, heart):
    """In the world: a flip or a turn would move it by centimetres. Half a voxel's part need not lie in its middle, which
    leaves some hundredths of a millimetre."""
    image, parts = volumes(saved / "part_cavity.nii.gz")
    gate = parts[..., 0].astype(float)
    middle = np.array([(gate * index).sum() / gate.sum() for index in np.indices(gate.shape)])
    mesh = heart.gates[0].endo.mesh
    corners = mesh.vertices[mesh.triangles]
    shares = np.linalg.det(corners) / 6
    expected = (shares[:, None] * corners.sum(axis=1) / 4).sum(axis=0) / shares.sum()
    assert np.allclose((RAS_OF_LPS @ image.affine @ [*middle, 1])[:3], expected, atol=0.1)


def test_borders_lie_where_the_walls_are(saved, study):
    """Border voxels of the inner wall are nearer to the cavity's surface than to the middle of the cavity."""
    borders, cavity = volumes(saved / "borders.nii.gz")[1], volumes(saved / "part_cavity.nii.gz")[1]
    inner = (borders[..., 0] & 1) > 0
    around = np.zeros_like(inner)
    partly = (cavity[..., 0] > 0) & (cavity[..., 0] < 1)
    for shift in np.ndindex(5, 5, 5):
        around |= np.roll(partly, np.array(shift) - 2, (0, 1, 2))
    assert inner.any() and (inner & around).sum() > 0.8 * inner.sum() and study


def test_base_first_studies_keep_their_slices(study, tmp_path):
    """The program turns the stack; labels lie as the study did."""
    turned = study.affine @ np.array([[1, 0, 0, 0], [0, 1, 0, 0], [0, 0, -1, study.grid.dims[2] - 1], [0, 0, 0, 1.0]])
    other = ds.Study(study.array[:, ::-1], affine=turned, slice_order="base_to_apex", view="short_axis",
                     time_ms=study.time_ms, cycle_ms=study.cycle_ms)  # fmt: skip
    found = {}
    for name, s in (("as_is", study), ("turned", other)):
        ds.ventricle.reconstruct(s, preset="edges").save(tmp_path / name, labels="nii")
        for what in ("walls", "borders"):
            image, found[name, what] = volumes(tmp_path / name / f"labels/{what}.nii")
            assert np.allclose(image.affine, RAS_OF_LPS @ s.affine, atol=1e-4)
    for what in ("walls", "borders"):
        # Found on another stack the surfaces differ by their last digits, and so may a voxel that is half inside.
        assert (found["as_is", what] != found["turned", what][:, :, ::-1]).sum() <= 3, what


def test_parts_of_a_box_are_known():
    corners = np.array([[x, y, z] for z in (0.5, 2.5) for y in (0.5, 2.0) for x in (0.5, 1.75)])
    faces = [(0, 2, 1), (1, 2, 3), (4, 5, 6), (5, 7, 6), (0, 1, 4), (1, 5, 4), (2, 6, 3), (3, 6, 7), (0, 4, 2), (2, 4, 6),
             (1, 3, 5), (3, 7, 5)]  # fmt: skip
    grid = ds.Image(np.zeros((4, 4, 4)), spacing=(1, 1, 1)).grid
    parts = ds.mesh.voxel_parts(grid, ds.TriMesh(corners, faces)).array
    expected = np.einsum("z,y,x->zyx", [0, 1, 1, 0], [0, 1, 0.5, 0], [0, 1, 0.25, 0])
    assert np.allclose(parts, expected, atol=1e-7)
    with pytest.raises(ds.InputError, match="closed"):
        ds.mesh.voxel_parts(grid, ds.TriMesh(corners, faces[1:]))


def test_labels_survive_pickling(edges_heart, tmp_path):
    import pickle

    edges_heart.save(tmp_path / "a", labels="nii", timings=False)
    pickle.loads(pickle.dumps(edges_heart)).save(tmp_path / "b", labels="nii", timings=False)
    assert (tmp_path / "a/labels/walls.nii").read_bytes() == (tmp_path / "b/labels/walls.nii").read_bytes()


@pytest.mark.parametrize("how", [{"labels": "nrrd"}, {"partial_volumes": True}])
def test_other_labels_are_refused(edges_heart, tmp_path, how):
    with pytest.raises(ds.OptionError, match="expected nii.gz or nii"):
        edges_heart.save(tmp_path / "r", **how)
    assert not (tmp_path / "r").exists()


def test_the_program_writes_the_same_labels(program, tmp_path, phantom):
    ds.io.write_nifti(phantom.study, tmp_path / "s.nii.gz")
    words = [program, "ventricle", tmp_path / "s.nii.gz", "--out", tmp_path / "a", "--preset", "edges", "--labels", "nii.gz",
             "--partial-volumes", "--quiet", "--no-timings"]  # fmt: skip
    subprocess.run(words, check=True)
    heart = ds.ventricle.reconstruct(ds.read_study(tmp_path / "s.nii.gz"), preset="edges")
    heart.save(tmp_path / "b", labels="nii.gz", partial_volumes=True, timings=False)
    names = sorted(p.relative_to(tmp_path / "a") for p in (tmp_path / "a").rglob("*") if p.is_file())
    assert sum(n.parts[0] == "labels" for n in names) == 4
    for name in names:
        assert (tmp_path / "a" / name).read_bytes() == (tmp_path / "b" / name).read_bytes(), name
    outputs = json.loads((tmp_path / "a/results.json").read_text())["provenance"]["outputs"]
    assert outputs["labels"] == "nii.gz" and outputs["partial_volumes"] is True
    done = subprocess.run([program, "rerun", tmp_path / "a"], capture_output=True, text=True, check=True)
    assert "same bytes" in done.stdout


@pytest.fixture(scope="module")
def patients(program, tmp_path_factory):
    out = tmp_path_factory.mktemp("patients") / "p"
    subprocess.run([program, "phantom", "patients", "--count", "3", "--seed", "1", "--small", "--out", out, "--labels", "nii.gz",
                    "--partial-volumes", "--quiet"], check=True)  # fmt: skip
    return out


def test_patients_come_with_volumes_labels_and_truth(patients):
    """Training data in one command."""
    import csv

    with open(patients / "patients.tsv") as file:
        rows = list(csv.DictReader(file, delimiter="\t"))
    assert len(rows) == 3
    for row in rows:
        folder = (patients / row["path"]).parent
        truth = json.loads((folder / "truth.json").read_text())
        image, counts = volumes(folder / "study.nii.gz")
        labelled, labels = volumes(folder / "labels/walls.nii.gz")
        assert labels.shape == counts.shape and np.allclose(labelled.affine, image.affine)
        ml = abs(np.linalg.det(image.affine[:3, :3])) / 1000
        cavity, wall = (volumes(folder / f"labels/part_{n}.nii.gz")[1].astype(float) for n in ("cavity", "wall"))
        for g, gate in enumerate(truth["gates"]):
            # The surfaces of the truth are fine meshes of analytic shapes.
            assert cavity[..., g].sum() * ml == pytest.approx(gate["endo_ml"], rel=2e-3)
            assert (cavity + wall)[..., g].sum() * ml == pytest.approx(gate["epi_ml"], rel=2e-3)
        # Muscle is bright: the labels lie on it.
        first = counts[..., 0].astype(float)
        assert first[labels[..., 0] == 2].mean() > 2 * first[labels[..., 0] == 0].mean()
        assert float(row["edv_true_ml"]) == pytest.approx(truth["edv_ml"])


def test_patients_of_an_earlier_call_get_the_labels_they_lack(program, tmp_path):
    def make(*words):
        subprocess.run([program, "phantom", "patients", "--count", "2", "--small", "--out", tmp_path / "p", "--quiet", *words],
                       check=True)  # fmt: skip
        return {f.relative_to(tmp_path): f.stat().st_mtime_ns for f in sorted((tmp_path / "p").rglob("walls.nii.gz"))}

    assert make() == {}
    made = make("--labels", "nii.gz")
    assert len(made) == 2
    assert make("--labels", "nii.gz") == made and make() == made
