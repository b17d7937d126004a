import json

import dynasurf as ds
import numpy as np
import pytest


@pytest.fixture(scope="module")
def saved(heart, tmp_path_factory):
    folder = tmp_path_factory.mktemp("saved") / "heart"
    heart.save(folder)
    return folder


def test_a_saved_ventricle_has_the_same_numbers(saved, heart):
    loaded = ds.load(saved)
    for name in ("ef", "edv", "esv", "sv", "wall"):
        assert getattr(loaded, name).value == pytest.approx(getattr(heart, name).value, rel=1e-9)
        assert getattr(loaded, name).low == pytest.approx(getattr(heart, name).low, rel=1e-6)
    assert loaded.verdict == heart.verdict
    assert np.allclose(loaded.volumes_ml, heart.volumes_ml)


def test_a_saved_ventricle_has_the_same_walls_to_the_byte(saved, heart):
    for old, new in zip(heart.gates, ds.load(saved).gates):
        assert new.endo.vertices.tobytes() == old.endo.vertices.tobytes()
        assert new.epi.triangles.tobytes() == old.epi.triangles.tobytes()


def test_saved_segments_are_the_same_table(saved, heart):
    old, new = heart.segments, ds.load(saved).segments
    assert old.dtype == new.dtype
    for name in ("perfusion_percent", "thickness_ed_mm", "motion_mm", "motion_mm_sd"):
        assert np.allclose(old[name], new[name], equal_nan=True, rtol=1e-6)


def test_a_saved_cloud_is_read_back(lods, tmp_path):
    lods.save(tmp_path / "c")
    loaded = ds.load(tmp_path / "c")
    assert loaded.watertight and len(loaded) == 2
    assert loaded[-1].vertices.tobytes() == lods[-1].vertices.tobytes()


@pytest.mark.parametrize(
    ("change", "words"),
    [
        ({"schema": "dynasurf.ventricle/99"}, "has the schema 'dynasurf.ventricle/99'; expected"),
        ({"schema": None}, "has the schema None"),
    ],
)
def test_another_schema_is_refused(saved, tmp_path, change, words):
    (tmp_path / "results.json").write_text(json.dumps(json.loads((saved / "results.json").read_text()) | change))
    with pytest.raises(ds.InputError, match=words):
        ds.load(tmp_path)


def test_a_missing_field_is_named(saved, tmp_path):
    results = json.loads((saved / "results.json").read_text())
    del results["ef_percent"], results["quality"]["verdict"]
    (tmp_path / "results.json").write_text(json.dumps(results))
    with pytest.raises(ds.InputError, match="has no ef_percent"):
        _ = ds.load(tmp_path).ef
    with pytest.raises(ds.InputError, match="has no quality.verdict"):
        _ = ds.load(tmp_path).verdict


def test_what_is_no_result_is_refused(tmp_path):
    with pytest.raises(ds.IoError, match="results.json"):
        ds.load(tmp_path)
    (tmp_path / "results.json").write_text("{")
    with pytest.raises(ds.InputError, match="no JSON"):
        ds.load(tmp_path)
