import copy
import gc
import pickle

import dynasurf as ds
import numpy as np
import pytest


def address(array):
    return array.__array_interface__["data"][0]


def test_a_volume_is_seen_where_it_lies():
    image = ds.Image(np.arange(24, dtype="f4").reshape(2, 3, 4), spacing=(1, 1, 1))
    assert address(image.array) == address(image.array)
    assert image.array.shape == (2, 3, 4) and image.array.dtype == np.float32
    assert image.array[1, 2, 3] == 23


def test_a_volume_is_filled_without_a_copy(ball):
    """The array that was written is the memory that stages read and results show."""
    image, array = ds.Image.to_fill(ball.array.shape, affine=ball.affine)
    assert address(array) == address(image.array) and array.dtype == np.float32 and not array.any()
    array[...] = ball.array
    assert np.array_equal(image.array, ball.array) and not image.array.flags.writeable
    found = ds.image.detect_edges(image).edges.array
    assert found.any() and np.array_equal(found, ds.image.detect_edges(ball).edges.array)


def test_a_study_is_filled_without_a_copy(study):
    """What is written is what the gates show, at the same address, and gives the same result."""
    filled, arrays = ds.Study.to_fill(study.array.shape, affine=study.affine, time_ms=study.time_ms,
                                      cycle_ms=study.cycle_ms, view=study.view, slice_order=study.slice_order)  # fmt: skip
    assert [address(a) for a in arrays] == [address(g.array) for g in filled.gates] and not filled.array.any()
    for array, gate in zip(arrays, study.gates, strict=True):
        array[...] = gate.array
    assert np.array_equal(filled.array, study.array) and not filled.gates[0].array.flags.writeable
    copied = ds.Study(study.array, affine=study.affine, view=study.view, slice_order=study.slice_order)
    a, b = (ds.ventricle.reconstruct(s, preset="edges").gates[0].endo.vertices for s in (filled, copied))
    assert np.array_equal(a, b)


@pytest.mark.parametrize("shape", [(0, 2, 4, 5), (2, 3, 0, 5)])
def test_a_study_to_fill_has_gates_and_voxels(shape):
    with pytest.raises(ds.OptionError, match="shape"):
        ds.Study.to_fill(shape, spacing=(1, 1, 1))


def test_the_vertices_of_a_mesh_are_filled_without_a_copy():
    ball = ds.mesh.icosphere(2)
    mesh, vertices = ds.TriMesh.to_fill(len(ball.vertices), ball.triangles)
    assert address(vertices) == address(mesh.vertices) and ds.mesh.volume_mm3(mesh) == 0
    vertices[...] = ball.vertices
    assert ds.mesh.volume_mm3(mesh) == ds.mesh.volume_mm3(ball) and not mesh.vertices.flags.writeable
    del mesh
    gc.collect()
    assert np.array_equal(vertices, ball.vertices)


def test_a_mesh_to_fill_has_the_vertices_of_its_triangles():
    with pytest.raises(ds.InputError, match="expected 0 to 2 less 1"):
        ds.TriMesh.to_fill(2, [[0, 1, 2]])


def test_an_array_to_fill_outlives_its_volume():
    array = ds.Mask.to_fill((3, 40, 50), spacing=(1, 1, 1))[1]
    gc.collect()
    array[...] = 7
    assert array.sum() == 7 * array.size


@pytest.mark.parametrize("shape", [(0, 4, 5), (3, -1, 5)])
def test_a_volume_to_fill_has_voxels(shape):
    with pytest.raises(ds.OptionError, match="expected"):
        ds.Image.to_fill(shape, spacing=(1, 1, 1))


def test_arrays_go_through_a_stage_and_a_friend_without_a_copy(ball):
    nibabel = pytest.importorskip("nibabel")
    assert address(np.asanyarray(ball.to_nibabel().dataobj)) == address(ball.array) and nibabel
    mesh = ds.mesh.start_mesh(ball, 1)
    assert address(mesh.vertices) == address(np.asarray(mesh.vertices, dtype="f8"))


def test_mesh_arrays_are_views_of_the_mesh():
    mesh = ds.mesh.icosphere(2)
    assert address(mesh.vertices) == address(mesh.vertices) and address(mesh.triangles) == address(mesh.triangles)
    assert mesh.vertices.dtype == np.float64 and mesh.triangles.dtype == np.int32
    assert mesh.vertices.shape == (162, 3) and mesh.triangles.shape == (320, 3)


def test_a_results_meshes_are_views_of_the_result(heart):
    for gate in range(len(heart.gates)):
        assert address(heart.gates[gate].endo.vertices) == address(heart.gates[gate].endo.mesh.vertices)


def test_views_outlive_what_they_came_from():
    vertices = ds.mesh.icosphere(3).vertices
    components = ds.field.flow_field(ds.Image(np.eye(5, dtype="f4")[None], spacing=(1, 1, 1)), "steady").field.components
    before = vertices.copy(), components[0].copy()
    gc.collect()
    _ = [np.full((642, 3), -1.0) for _ in range(50)]
    assert np.array_equal(vertices, before[0]) and np.array_equal(components[0], before[1])


def test_a_gates_mesh_outlives_its_result(study):
    mesh = ds.ventricle.reconstruct(study, preset="edges").gates[1].endo.mesh
    gc.collect()
    assert np.isfinite(mesh.vertices).all() and ds.mesh.volume_mm3(mesh) > 0


@pytest.mark.parametrize("array", ["image", "vertices", "triangles", "components", "stopped"])
def test_views_are_read_only(array, ball):
    mesh = ds.mesh.icosphere(1)
    views = {"image": ball.array, "vertices": mesh.vertices, "triangles": mesh.triangles}
    if array not in views:
        field = ds.field.flow_field(ball, "steady").field
        views["components"] = field.components[1]
        start = ds.mesh.start_mesh(ball, 1)
        views["stopped"] = ds.dynamics.evolve(start, field, ball).stopped
    with pytest.raises(ValueError, match="read-only"):
        views[array][...] = 0


@pytest.mark.parametrize(
    ("vertices", "triangles"),
    [
        (np.zeros((3, 2)), [[0, 1, 2]]),
        (np.zeros(9), [[0, 1, 2]]),
        (np.zeros((3, 3)), [[0, 1]]),
        (np.zeros((3, 3)), [[0, 1, 3]]),
        (np.zeros((3, 3)), [[0, 1, -1]]),
    ],
)
def test_a_mesh_that_is_none_is_refused(vertices, triangles):
    with pytest.raises(ValueError, match="expected"):
        ds.TriMesh(vertices, triangles)


@pytest.mark.parametrize("order", ["C", "F"])
@pytest.mark.parametrize("dtype", ["f4", "f8", "i2", ">f4"])
def test_any_layout_and_type_of_numbers_is_taken(order, dtype):
    array = np.asarray(np.arange(60).reshape(3, 4, 5), dtype=dtype, order=order)
    assert np.array_equal(ds.Image(array, spacing=(1, 1, 1)).array, array)
    assert np.array_equal(ds.Image(array[:, ::2, ::-1], spacing=(1, 1, 1)).array, array[:, ::2, ::-1])


@pytest.mark.parametrize("shape", [(3,), (3, 4), (0, 4, 5), (1, 2, 3, 4)])
def test_a_volume_of_another_shape_is_refused(shape):
    with pytest.raises(ds.OptionError, match="expected"):
        ds.Image(np.zeros(shape), spacing=(1, 1, 1))


def test_a_volume_without_a_size_is_refused():
    with pytest.raises(ds.OptionError, match="neither spacing nor affine"):
        ds.Image(np.zeros((2, 2, 2)))


def test_pickled_meshes_are_equal():
    mesh = ds.mesh.icosphere(2)
    other = pickle.loads(pickle.dumps(mesh))
    assert np.array_equal(other.vertices, mesh.vertices) and np.array_equal(other.triangles, mesh.triangles)
    assert np.array_equal(copy.deepcopy(mesh).vertices, mesh.vertices)


def test_a_field_from_an_array_is_the_array():
    image = ds.Image(np.zeros((2, 3, 4)), spacing=(1, 1, 1))
    array = np.random.default_rng(1).normal(size=(3, 2, 3, 4)).astype("f4")
    field = ds.VectorField(array, image.grid)
    assert np.array_equal(field.array, array) and np.array_equal(field.components[2], array[2])
    with pytest.raises(ds.OptionError, match="expected"):
        ds.VectorField(array[:, :1], image.grid)
