import itertools
import threading

import dynasurf as ds
import numpy as np
import pytest


@pytest.fixture(scope="module")
def image(study):
    array = study.gates[0].array
    return ds.Image(array / array.max(), affine=study.affine)


@pytest.fixture(scope="module")
def edges(image):
    return ds.image.detect_edges(image)


@pytest.fixture(scope="module")
def labels(image, edges):
    return ds.ventricle.label_borders(image, edges)


@pytest.mark.parametrize("method", ["canny", "canny_revised", "gradient", "sobel", "compass", "acc"])
def test_every_detector_finds_edges_of_a_ball_and_none_of_nothing(method, ball):
    found = ds.image.detect_edges(ball, method).edges.array
    assert found.any() and set(np.unique(found)) <= {0, 1, 2}
    empty = ds.Image(np.ones((3, 8, 8)), spacing=(1, 1, 1))
    assert not ds.image.detect_edges(empty, method).edges.array.any()


def test_edges_turn_with_the_image(ball):
    turned = ds.Image(ball.array.transpose(0, 2, 1), spacing=(1, 1, 2))
    assert np.array_equal(ds.image.detect_edges(turned).edges.array,
                          ds.image.detect_edges(ball).edges.array.transpose(0, 2, 1))  # fmt: skip


@pytest.mark.parametrize("method", ["gvf", "steady", "steady_ggvf", "ggvf", "band", "band_ggvf"])
def test_a_field_points_at_the_ball(method, ball):
    field = ds.field.flow_field(ball, method).field
    x, _, _ = field.components
    assert x[6, 11, 1] > 0 > x[6, 11, 22]


@pytest.mark.parametrize("method", ["steady", "gvf"])
def test_a_constant_map_has_no_field(method):
    flat = ds.Image(np.ones((3, 4, 5)), spacing=(1, 1, 1))
    assert not ds.field.flow_field(flat, method).field.array.any()


@pytest.mark.parametrize("threads", [1, 2, 3])
def test_threads_change_no_byte_of_a_field(threads, ball):
    assert ds.field.flow_field(ball, threads=threads).field.array.tobytes() == \
        ds.field.flow_field(ball).field.array.tobytes()  # fmt: skip


def test_an_edge_map_is_one_at_most(ball):
    assert ds.field.edge_map_of(ball, of="gradient").array.max() == 1


@pytest.mark.parametrize("shape", ["ellipsoid", "sphere", "cube", "hull", "marching_cubes"])
def test_every_start_is_a_closed_surface_around_the_ball(shape, ball):
    start = ds.mesh.start_mesh(ball, 2, shape=shape)
    assert ds.mesh.check_surface(start).closed and ds.mesh.volume_mm3(start) > 0


def surface_of(ball):
    found = ds.image.detect_edges(ball).edges.array
    return ds.Image((found > 0).astype("f4"), affine=ball.affine)


def test_evolve_brings_a_start_to_the_border(ball):
    border = surface_of(ball)
    field = ds.field.flow_field(border, "steady").field
    start = ds.mesh.start_mesh(border, 2)
    moved = ds.dynamics.evolve(start, field, border)
    assert moved.reason in ("all_stopped", "at_rest") and moved.stopped_fraction > 0.9
    assert ds.mesh.volume_mm3(moved.mesh) < ds.mesh.volume_mm3(start)


@pytest.fixture(scope="module")
def motion():
    z, y, x = np.mgrid[:12, :24, :24].astype(float)
    solid = (x - 11.5) ** 2 + (y - 11.5) ** 2 + (2 * (z - 5.5)) ** 2 < 64
    border = surface_of(ds.Image(solid.astype("f4"), spacing=(1, 1, 2)))
    return ds.mesh.start_mesh(border, 2), ds.field.flow_field(border, "steady").field, border


def test_steps_end_where_evolve_ends(motion):
    steps = ds.dynamics.evolve_steps(*motion)
    seen = [(n, mesh.vertices.copy()) for n, mesh in steps]
    whole = ds.dynamics.evolve(*motion)
    assert [n for n, _ in seen] == list(range(1, whole.steps + 1))
    assert steps.result.mesh.vertices.tobytes() == whole.mesh.vertices.tobytes()


def test_every_nth_step_is_every_nth_step(motion):
    every = {n: mesh.vertices.tobytes() for n, mesh in ds.dynamics.evolve_steps(*motion)}
    for n, mesh in ds.dynamics.evolve_steps(*motion, every=7):
        assert n % 7 == 0 and mesh.vertices.tobytes() == every[n]


def test_a_loop_may_be_left(motion):
    before = threading.active_count()
    steps = ds.dynamics.evolve_steps(*motion)
    assert len(list(itertools.islice(steps, 3))) == 3
    steps.close()
    assert list(steps) == [] and steps.result is None and threading.active_count() == before


def test_steps_of_a_bad_start_tell_so(motion):
    with pytest.raises(ds.InputError):
        next(ds.dynamics.evolve_steps(ds.TriMesh(np.zeros((0, 3)), np.zeros((0, 3))), *motion[1:]))


def test_no_force_changes_nothing_and_a_wind_blows_away(motion):
    calls = []

    def none(positions, velocities):
        calls.append(positions.shape)
        return np.zeros_like(positions)

    def wind(positions, velocities):
        return np.full_like(positions, [5.0, 0, 0])

    end = ds.dynamics.StopConv(max_steps=20)
    calm = ds.dynamics.evolve(*motion, forces=none, end=end)
    blown = ds.dynamics.evolve(*motion, forces={"wind": wind}, end=end)
    assert calls and calls[0] == motion[0].vertices.shape
    assert blown.mesh.vertices.mean(axis=0)[0] > calm.mesh.vertices.mean(axis=0)[0] + 1e-3


def test_a_stop_of_ones_own_holds_every_particle(motion):
    stopped = ds.dynamics.evolve(*motion, stop=lambda at, to: at, threads=2)
    assert stopped.reason == "all_stopped" and stopped.steps == 1
    assert np.abs(stopped.mesh.vertices - motion[0].vertices).max() < 1


@pytest.mark.parametrize("wrong", [lambda p, v: p[:1], lambda p, v: p.ravel(), lambda p, v: 1 / 0])
def test_a_force_that_fails_is_told(motion, wrong):
    with pytest.raises((ds.OptionError, ZeroDivisionError)):
        ds.dynamics.evolve(*motion, forces=wrong)


def test_labels_of_a_heart_have_both_borders(labels):
    assert {1, 2} <= set(np.unique(labels.borders.array))
    for wall, bit in (("endo", 1), ("epi", 2)):
        volume = ds.ventricle.border_volume(labels, wall).array
        assert np.array_equal(volume > 0, (labels.borders.array & bit) > 0)


def test_a_wall_has_two_names(labels):
    with pytest.raises(ds.OptionError, match="expected endo or epi"):
        ds.ventricle.border_volume(labels, "inner")


def test_the_stages_one_by_one_reach_a_wall(image, edges, labels, phantom):
    base = ds.ventricle.find_base_slice(image, labels)
    border = ds.ventricle.with_room(ds.ventricle.close_border(ds.ventricle.border_volume(labels, "epi"), base))
    planes = ds.ventricle.border_planes(border, "epi", labels, edges, base)
    field = ds.field.flow_field(border).field
    moved = ds.dynamics.evolve(ds.mesh.start_mesh(border, 3), field, border, planes=planes)
    volume = ds.mesh.volume_mm3(moved.mesh) / 1000
    # Edges of a blurred wall lie outside it, and without a valve plane the base is closed at a slice.
    assert 0.7 * phantom.truth[0].epi_ml < volume < 1.6 * phantom.truth[0].epi_ml


def test_settling_a_surface_on_a_ball_brings_it_to_its_radius():
    z, y, x = np.mgrid[:32, :32, :32].astype(float)
    r = np.sqrt((x - 16) ** 2 + (y - 16) ** 2 + (z - 16) ** 2)
    soft = ds.Image(1 / (1 + np.exp(2 * (r - 10))), spacing=(1, 1, 1))
    near = ds.mesh.icosphere(3)
    near = ds.TriMesh(near.vertices * 10.8 + 16, near.triangles)
    settled = ds.ventricle.settle(near, soft, rounds=4)
    off = np.abs(np.linalg.norm(settled.vertices - 16, axis=1) - 10)
    assert off.mean() < 0.1 and off.max() < 0.5  # of a voxel: the slope is read from voxels


def test_tetrahedra_fill_what_is_between():
    inner = ds.mesh.icosphere(3)
    outer = ds.TriMesh(inner.vertices * 1.3, inner.triangles)
    solid = ds.mesh.fill_between(inner, outer, layers=2)
    assert ds.mesh.volume_mm3(solid) == pytest.approx(ds.mesh.volume_mm3(outer) - ds.mesh.volume_mm3(inner))
    assert solid.tetrahedra.shape == (2 * 3 * 1280, 4)


@pytest.mark.parametrize("level", range(5))
def test_icospheres_are_the_thesis_spheres(level):
    mesh = ds.mesh.icosphere(level)
    assert len(mesh.vertices) == 10 * 4**level + 2 and len(mesh.triangles) == 20 * 4**level
    assert ds.mesh.check_surface(mesh).valid
    assert np.allclose(np.linalg.norm(mesh.vertices, axis=1), 1)


def test_world_and_grid_are_inverse(study):
    mesh = ds.mesh.icosphere(2)
    there = ds.mesh.to_world(study.grid, mesh)
    assert np.allclose(ds.mesh.to_grid(study.grid, there).vertices, mesh.vertices, atol=1e-12)


def test_a_cross_section_of_a_sphere_is_a_closed_circle():
    (polygon,) = ds.mesh.cross_section(ds.mesh.icosphere(4), (0, 0, 0.1), (0, 0, 1))
    assert np.array_equal(polygon[0], polygon[-1]) and np.allclose(polygon[:, 2], 0.1)
    assert np.allclose(np.hypot(polygon[:, 0], polygon[:, 1]), np.sqrt(1 - 0.01), atol=5e-3)
