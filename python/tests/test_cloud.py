import pickle

import dynasurf as ds
import numpy as np
import pytest


def test_levels_are_watertight_and_as_asked_for(lods):
    assert [len(level.triangles) for level in lods] == [1280, 320]
    assert lods.watertight and all(level.certificate.watertight for level in lods)
    assert lods[-1].certificate.triangles == 320 and len(lods) == 2
    with pytest.raises(IndexError):
        lods[2]


def test_a_finer_level_lies_nearer(lods):
    assert lods[0].certificate.cloud_to_mesh_mean < lods[1].certificate.cloud_to_mesh_mean


def test_arrays_and_files_give_the_same_bytes(tmp_path, cloud, lods):
    again = ds.cloud.reconstruct(np.array(cloud.points), triangles=[1280, 320])
    assert again[0].vertices.tobytes() == lods[0].vertices.tobytes()
    (tmp_path / "c.xyz").write_text("".join(f"{x!r} {y!r} {z!r}\n" for x, y, z in cloud.points.tolist()))
    read = ds.cloud.reconstruct(ds.read_cloud(tmp_path / "c.xyz"), triangles="1280,320")
    assert read[1].vertices.tobytes() == lods[1].vertices.tobytes()


def test_a_sphere_has_no_handle_and_a_torus_one():
    for shape, genus in (("sphere", 0), ("torus", 1)):
        lods = ds.cloud.reconstruct(ds.synthetic.make_cloud(shape=shape, points=4000), triangles=[640])
        assert lods[0].certificate.genus == genus


def test_the_certificate_alone_is_the_results(cloud, lods):
    alone = ds.cloud.certify(lods[0].mesh, cloud)
    assert alone.watertight and alone.genus == lods[0].certificate.genus


def test_a_terrain_stays_open_unless_told_otherwise():
    x, y = np.meshgrid(np.linspace(0, 2, 70), np.linspace(0, 1.5, 55))
    hills = np.column_stack([x.ravel(), y.ravel(), 0.1 * np.sin(4 * x.ravel()) * np.cos(3 * y.ravel())])
    lods = ds.cloud.reconstruct(hills, triangles=[640, 160])
    assert (lods.facts.boundary, lods.facts.boundary_loops) == ("keep", 1) and lods.trustworthy and not lods.watertight
    assert all(level.certificate.sound_open and level.certificate.boundary_loops == 1 for level in lods)
    assert "open, boundary loops: 1" in repr(lods) and "open" in repr(lods[0].certificate)
    again = pickle.loads(pickle.dumps(lods))
    assert again.facts.boundary == "keep" and again[1].certificate.boundary_loops == 1
    closed = ds.cloud.reconstruct(hills, triangles=[640], boundary="close")
    assert closed.facts.boundary == "close" and not closed[0].certificate.sound_open


def test_an_open_surface_faces_its_scanner():
    across = np.linspace(-1, 1, 40)
    x, y = (a.ravel() for a in np.meshgrid(across, across))
    points = np.stack([x, y, 0.2 * (x**2 + y**2)], axis=1)
    for height in (5, -5):
        place = [[0, 0, height]]
        cloud = ds.cloud.PointCloud(points, scans=np.zeros(len(points), int), scanners=place)
        assert np.array_equal(cloud.scanners, place) and not cloud.scans.any() and len(cloud.scans) == len(points)
        level = ds.cloud.reconstruct(cloud, triangles=[320], boundary="keep")[0]
        corners = level.vertices[level.triangles]
        across_it = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
        assert (np.sign(across_it[:, 2]) == np.sign(height)).all()
    before_the_first = np.full(len(points), -1)
    for wrong in ({"scans": [0]}, {"scans": points}, {"scans": before_the_first}, {"scanners": [1, 2]}):
        with pytest.raises(ds.OptionError):
            ds.cloud.PointCloud(points, **wrong)
    with pytest.raises(ds.InputError):
        ds.cloud.reconstruct(ds.cloud.PointCloud(points, scans=np.ones(len(points), int), scanners=[[0, 0, 1]]))


def test_colours_reach_the_vertices(cloud):
    colours = np.zeros((len(cloud), 3), "u1")
    colours[:, 1] = 200
    level = ds.cloud.reconstruct(np.array(cloud.points), colours=colours, triangles=[320])[0]
    assert level.colours.shape == (len(level.vertices), 3) and np.array_equal(np.unique(level.colours[:, 1]), [200])


@pytest.mark.parametrize(
    ("arguments", "error"),
    [
        ({"points": np.zeros((5, 3))}, ds.InputError),
        ({"points": np.random.default_rng(1).normal(size=(100, 2))}, ds.OptionError),
        ({"points": np.random.default_rng(1).normal(size=(100, 3)), "normals": np.ones((9, 3))}, ds.OptionError),
        ({"points": np.random.default_rng(1).normal(size=(100, 3)), "triangles": [320, 1280]}, ds.OptionError),
        ({"points": np.random.default_rng(1).normal(size=(100, 3)), "genus": "many"}, ds.OptionError),
        ({"points": np.random.default_rng(1).normal(size=(100, 3)) * [1, 1, 0]}, ds.InputError),
    ],
)
def test_what_is_no_cloud_is_refused(arguments, error):
    with pytest.raises(error):
        ds.cloud.reconstruct(**arguments)


def test_the_command_is_that_of_the_program(lods):
    assert lods.command == "dynasurf cloud CLOUD --out RESULT --preset shaped --set triangles=1280,320"


def test_a_cache_spares_stages_and_changes_no_vertex(cloud, lods):
    cache = ds.StageCache()
    ds.cloud.reconstruct(cloud, triangles=[1280], cache=cache)
    again = ds.cloud.reconstruct(cloud, triangles=[1280, 320], cache=cache)
    assert [np.array_equal(a.mesh.vertices, b.mesh.vertices) for a, b in zip(again, lods)] == [True, True]
