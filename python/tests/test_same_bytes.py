"""Results of Python and of the program are the same bytes, file by file."""

import pathlib
import subprocess

import dynasurf as ds
import numpy as np
import pytest


def run(program, *words):
    done = subprocess.run([program, *map(str, words)], capture_output=True, text=True)
    assert done.returncode in (0, 3), done.stderr


def files_of(folder):
    return {str(f.relative_to(folder)): f.read_bytes() for f in sorted(pathlib.Path(folder).rglob("*")) if f.is_file()}


def assert_same(one, other):
    one, other = files_of(one), files_of(other)
    assert sorted(one) == sorted(other)
    assert [name for name in one if one[name] != other[name]] == []


@pytest.fixture(scope="module")
def files(tmp_path_factory, study):
    folder = tmp_path_factory.mktemp("files")
    ds.io.write_dicom(study, folder / "study.dcm", counts_scale=30000 / study.array.max())
    ds.io.write_nifti(study, folder / "study.nii.gz")
    ds.io.write_nrrd(study, folder / "study.seq.nrrd")
    return folder


@pytest.mark.parametrize(
    ("file", "words", "how"),
    [
        ("study.dcm", ["--fwhm", "12"], {"fwhm_mm": 12}),
        ("study.nii.gz", ["--preset", "edges", "--set", "mesh_level=2"], {"preset": "edges", "mesh_level": 2}),
        ("study.seq.nrrd", ["--preset", "thesis"], {"preset": "thesis"}),
        ("study.dcm", ["--preset", "edges", "--set", "field=gvf", "--set", "field.mu=0.5"],
         {"preset": "edges", "field": ds.field.Gvf(mu=0.5)}),
        ("study.dcm", ["--pipeline", "contour", "--preset", "edges"], {"preset": "edges", "pipeline": "contour"}),
    ],
)  # fmt: skip
def test_a_ventricle_is_the_programs(program, files, tmp_path, file, words, how):
    run(program, "ventricle", files / file, "--out", tmp_path / "program", "--no-timings", "--quiet", *words)
    heart = ds.ventricle.reconstruct(ds.read_study(files / file), **how)
    heart.save(tmp_path / "python", timings=False)
    assert_same(tmp_path / "program", tmp_path / "python")


def test_a_mask_is_that_of_the_program(program, files, tmp_path, study):
    mask = np.zeros_like(study.array[0])
    mask[2:-2, 5:-5, 5:-5] = 1
    ds.io.write_nifti(ds.Study(mask, affine=study.affine), tmp_path / "mask.nii")
    run(program, "ventricle", files / "study.dcm", "--out", tmp_path / "program", "--no-timings", "--preset", "edges",
        "--mask", tmp_path / "mask.nii")  # fmt: skip
    heart = ds.ventricle.reconstruct(ds.read_study(files / "study.dcm"), preset="edges", mask=tmp_path / "mask.nii")
    heart.save(tmp_path / "python", timings=False)
    assert_same(tmp_path / "program", tmp_path / "python")


@pytest.mark.parametrize(
    ("shape", "words", "how"),
    [
        ("vase", ["--triangles", "1280,320"], {"triangles": [1280, 320]}),
        ("torus", ["--preset", "faithful", "--triangles", "640", "--genus", "keep"],
         {"preset": "faithful", "triangles": [640], "genus": "keep"}),
    ],
)  # fmt: skip
def test_a_cloud_is_the_programs(program, tmp_path, shape, words, how):
    points = ds.synthetic.make_cloud(shape=shape, points=4000).points
    (tmp_path / "c.xyz").write_text("".join(f"{x!r} {y!r} {z!r}\n" for x, y, z in points.tolist()))
    run(program, "cloud", tmp_path / "c.xyz", "--out", tmp_path / "program", "--no-timings", *words)
    ds.cloud.reconstruct(ds.read_cloud(tmp_path / "c.xyz"), **how).save(tmp_path / "python", timings=False)
    assert_same(tmp_path / "program", tmp_path / "python")


def test_the_program_repeats_what_python_saved(program, files, tmp_path):
    heart = ds.ventricle.reconstruct(ds.read_study(files / "study.dcm"), preset="edges", mesh_level=2)
    heart.save(tmp_path / "python", timings=False)
    run(program, "rerun", tmp_path / "python", "--study", files / "study.dcm", "--out", tmp_path / "again")
    theirs, ours = files_of(tmp_path / "again"), files_of(tmp_path / "python")
    assert [n for n in ours if theirs[n] != ours[n] and n not in ("results.json", "manifest.txt")] == []


@pytest.mark.parametrize("setting", ["mesh_level=99", "field.mu=-3", "edges=canni", "closure.covr=true", "warm_start=perhaps"])
def test_a_mistake_is_told_in_the_programs_words(program, files, tmp_path, setting):
    told = subprocess.run([program, "ventricle", files / "study.dcm", "--out", tmp_path / "out", "--set", setting],
                          capture_output=True, text=True)  # fmt: skip
    with pytest.raises(ValueError) as error:
        ds.ventricle.Options().set(setting)
    assert told.returncode == 1 and str(error.value) in told.stderr


def test_a_saved_result_may_not_take_a_users_folder(tmp_path, edges_heart):
    (tmp_path / "mine").mkdir()
    (tmp_path / "mine" / "notes.txt").write_text("keep me")
    with pytest.raises(ds.IoError, match="mine"):
        edges_heart.save(tmp_path / "mine")
    assert (tmp_path / "mine" / "notes.txt").read_text() == "keep me"
    edges_heart.save(tmp_path / "mine", replace=True)
    assert (tmp_path / "mine.old-1" / "notes.txt").exists()


def test_an_unknown_mesh_format_is_refused(tmp_path, edges_heart):
    with pytest.raises(ds.OptionError, match="mesh_formats"):
        edges_heart.save(tmp_path / "out", mesh_formats=["dae"])
    assert not (tmp_path / "out").exists()
