from concurrent.futures import ThreadPoolExecutor

import dynasurf as ds
import numpy as np
import pytest


def test_a_result_is_near_the_truth(heart, phantom):
    assert abs(heart.ef.value - phantom.ef_percent) < 6
    assert abs(heart.edv.value / phantom.edv_ml - 1) < 0.15
    assert heart.ef.low < heart.ef.value < heart.ef.high and heart.verdict in ("ok", "check")


def test_numbers_of_a_result_agree_with_each_other(heart):
    volumes = heart.volumes_ml
    assert heart.edv.value == pytest.approx(volumes[:, 0].max())
    assert heart.esv.value == pytest.approx(volumes[:, 0].min())
    assert heart.sv.value == pytest.approx(heart.edv.value - heart.esv.value)
    assert heart.ef.value == pytest.approx(100 * heart.sv.value / heart.edv.value)
    assert volumes[heart.ed_gate, 0] == volumes[:, 0].max()


def test_walls_lie_within_each_other_and_enclose_their_volume(heart):
    for gate in heart.gates:
        for wall in (gate.endo, gate.epi):
            assert ds.mesh.check_surface(wall.mesh).valid
            assert ds.mesh.volume_mm3(wall.mesh) / 1000 == pytest.approx(wall.volume_ml.value, rel=2e-2)
        assert gate.epi.volume_ml.value > gate.endo.volume_ml.value


def test_segments_are_seventeen_rows_with_names_and_units(heart):
    segments = heart.segments
    assert len(segments) == 17 and list(segments["number"]) == list(range(1, 18))
    assert set(segments["territory"]) == {"LAD", "RCA", "LCX"}
    assert segments["wall_share_percent"].sum() == pytest.approx(100, abs=1)
    assert np.nanmax(segments["perfusion_percent"]) <= 110


def test_the_curve_passes_near_the_gates(heart):
    phase, volume, rate = heart.curve(400)
    middles = (np.arange(len(heart.gates)) + 0.5) / len(heart.gates)
    assert np.abs(np.interp(middles, phase, volume) - heart.volumes_ml[:, 0]).max() < 0.1 * heart.edv.value
    assert rate.mean() == pytest.approx(0, abs=1e-3)


def test_polar_maps_have_one_grid(heart):
    maps = heart.measures.polar
    assert "perfusion_percent" in maps and len({m.shape for m in maps.values()}) == 1


def test_keyword_options_are_those_of_the_result(study):
    heart = ds.ventricle.reconstruct(study, preset="edges", mesh_level=2, field=ds.field.Gvf(mu=0.5))
    assert heart.options.mesh_level == 2 and heart.options.field.mu == 0.5
    assert heart.command == ("dynasurf ventricle STUDY --out RESULT --preset edges --set field=gvf "
                             "--set field.mu=0.5 --set mesh_level=2")  # fmt: skip
    assert len(heart.gates[0].edge_endo.vertices) == 162


def test_an_unknown_keyword_is_refused(study):
    with pytest.raises(ds.OptionError, match="mesh_level"):
        ds.ventricle.reconstruct(study, mesh_levl=2)


def test_threads_change_no_byte(study, edges_heart):
    alone = ds.ventricle.reconstruct(study, preset="edges", threads=1)
    assert alone.results_text(timings=False) == edges_heart.results_text(timings=False)
    assert alone.gates[2].endo.vertices.tobytes() == edges_heart.gates[2].endo.vertices.tobytes()


def test_the_programs_own_stages_given_as_functions_change_no_surface(study, edges_heart):
    options = ds.ventricle.preset("edges")
    labelling = options.labels

    def my_edges(image):
        return ds.image.detect_edges(image, options.edges)

    def my_labels(image, edges):
        return ds.ventricle.label_borders(image, edges, labelling)

    same = ds.ventricle.reconstruct(study, preset="edges", edges=my_edges)
    assert same.gates[1].endo.vertices.tobytes() == edges_heart.gates[1].endo.vertices.tobytes()
    assert [n.message for n in same.notes if n.code == "stage.replaced"] == \
        ["the edges were found by the Python function my_edges"]  # fmt: skip
    both = ds.ventricle.reconstruct(study, preset="edges", edges=my_edges, labels=my_labels)
    assert [n.message for n in both.notes if n.code == "stage.replaced"][1].endswith("my_labels")
    assert "my_labels" in both.results_text()


def test_a_labeller_of_circles_is_what_the_result_is_made_of(study):
    seen = []

    def circles(image, edges):
        depth, rows, columns = image.array.shape
        y, x = np.mgrid[:rows, :columns]
        far = np.hypot(x - columns // 2, y - rows // 2)
        seen.append(image.array.shape)
        borders = np.zeros(image.array.shape, "u1")
        borders[3:-3, (far >= 3.5) & (far < 4.5)] |= 1
        borders[3:-3, (far >= 6.5) & (far < 7.5)] |= 2
        return ds.ventricle.Labels(ds.Mask(borders, affine=image.affine), columns // 2, rows // 2, 10, 5, 3)

    heart = ds.ventricle.reconstruct(study, preset="edges", labels=circles, settle=ds.ventricle.Settle(rounds=0))
    assert len(seen) == len(study.gates)
    assert np.array_equal(heart.gates[0].labels.borders.array & 1, (heart.gates[1].labels.borders.array & 1))
    across = np.ptp(ds.mesh.to_grid(heart.study.grid, heart.gates[0].edge_epi.mesh).vertices[:, 0])
    assert across == pytest.approx(14 * heart.study.grid.spacing[0], rel=0.2)


@pytest.mark.parametrize("wrong", [lambda i, e: 1 / 0, lambda i, e: None, lambda i, e: "labels"])
def test_a_labeller_that_fails_is_told(study, wrong):
    with pytest.raises((ZeroDivisionError, ds.OptionError)):
        ds.ventricle.reconstruct(study, preset="edges", labels=wrong)


def test_edges_on_another_grid_are_refused(study):
    with pytest.raises(ds.InputError, match="another grid"):
        ds.ventricle.reconstruct(study, edges=lambda image: ds.Mask(np.zeros((3, 3, 3)), spacing=(1, 1, 1)))


def test_a_study_of_two_slices_is_refused():
    with pytest.raises(ds.InputError, match="slices"):
        ds.ventricle.reconstruct(ds.Study(np.zeros((2, 2, 20, 20)), spacing=(4, 4, 4)))


def test_values_that_are_not_finite_are_refused(study):
    array = study.array
    array[0, 3, 3, 3] = np.nan
    with pytest.raises(ds.InputError):
        ds.ventricle.reconstruct(ds.Study(array, affine=study.affine))


def test_the_fit_alone_gives_the_fits_numbers(study, edges_heart, heart):
    grid = heart.study.grid
    fitted = ds.ventricle.fit(study, [g.edge_endo.mesh for g in edges_heart.gates],
                              [g.edge_epi.mesh for g in edges_heart.gates], axis=grid.direction[:, 2],
                              lateral=grid.direction[:, 0], fwhm_mm=12)  # fmt: skip
    assert fitted.ef.value == pytest.approx(heart.ef.value, abs=4) and len(fitted.gates) == 6


def test_measuring_the_walls_again_gives_their_volumes(study, heart):
    measured = ds.ventricle.measure(study, [g.endo.mesh for g in heart.gates], [g.epi.mesh for g in heart.gates],
                                    axis=heart.study.grid.direction[:, 2], from_edges=False)  # fmt: skip
    assert np.allclose(measured.volumes_ml, heart.volumes_ml, rtol=2e-2) and len(measured.segments) == 17


@pytest.mark.parametrize("missing", ["endo", "epi"])
def test_a_fit_without_a_wall_is_refused(study, heart, missing):
    walls = {w: [getattr(g, w).mesh for g in heart.gates] for w in ("endo", "epi")}
    walls[missing][1] = None
    with pytest.raises(ds.OptionError, match="has not both walls"):
        ds.ventricle.fit(study, **walls, axis=(0, 0, 1), lateral=(1, 0, 0))


@pytest.mark.parametrize(
    "call",
    [
        lambda: ds.ventricle.reconstruct(None),
        lambda: ds.field.flow_field(None),
        lambda: ds.image.detect_edges(None),
        lambda: ds.mesh.volume_mm3(None),
        lambda: ds.dynamics.evolve(None, None, None),
        lambda: ds.dynamics.evolve_steps(None, None, None),
        lambda: ds.ventricle.label_borders(None, None),
        lambda: ds.io.write_mesh(None, "m.ply"),
        lambda: ds.cloud.certify(ds.mesh.icosphere(1), None),
        lambda: ds.image.EdgeMap(None),
    ],
)
def test_nothing_in_the_place_of_something_is_a_type_error(call):
    with pytest.raises(TypeError):
        call()


def test_a_cache_spares_stages_and_changes_no_byte(study, tmp_path):
    cache = ds.StageCache()
    first = ds.ventricle.reconstruct(study, fwhm_mm=12, cache=cache)
    decision = {"manual": ds.ventricle.UserOverrides(decision="accepted", reader="A. Reader")}
    again = ds.ventricle.reconstruct(study, fwhm_mm=12, cache=cache, **decision)
    plain = ds.ventricle.reconstruct(study, fwhm_mm=12, **decision)
    assert set(again.seconds) == {"measures"} < set(first.seconds)
    for name, heart in {"again": again, "plain": plain}.items():
        heart.save(tmp_path / name, timings=False)
    names = sorted(p.relative_to(tmp_path / "plain") for p in (tmp_path / "plain").rglob("*") if p.is_file())
    assert len(names) > 10
    for name in names:
        assert (tmp_path / "again" / name).read_bytes() == (tmp_path / "plain" / name).read_bytes(), name


def test_a_cache_is_used_by_threads_in_turn(study):
    cache = ds.StageCache()
    with ThreadPoolExecutor(3) as pool:
        levels = [2, 3, 2]
        hearts = pool.map(lambda n: ds.ventricle.reconstruct(study, preset="edges", mesh_level=n, cache=cache), levels)
    assert [len(heart.gates[0].edge_endo.vertices) for heart in hearts] == [162, 642, 162]
