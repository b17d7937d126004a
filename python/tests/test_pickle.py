import copy
import pickle

import dynasurf as ds
import numpy as np
import pytest


def test_a_ventricles_result_survives_pickling_to_the_byte(edges_heart, heart, tmp_path):
    for n, result in enumerate((heart, edges_heart)):
        again = pickle.loads(pickle.dumps(result))
        assert again.results_text() == result.results_text() and again.options == result.options
        result.save(tmp_path / f"old{n}", timings=False)
        again.save(tmp_path / f"new{n}", timings=False)
        files = sorted(p.relative_to(tmp_path / f"old{n}") for p in (tmp_path / f"old{n}").rglob("*") if p.is_file())
        assert len(files) > 20
        assert [f for f in files if (tmp_path / f"old{n}" / f).read_bytes() != (tmp_path / f"new{n}" / f).read_bytes()] == []
        assert np.array_equal(again.segments.tobytes(), result.segments.tobytes())


def test_a_clouds_result_survives_pickling_to_the_byte(lods):
    again = pickle.loads(pickle.dumps(lods))
    assert again.results_text() == lods.results_text()
    assert again[0].vertices.tobytes() == lods[0].vertices.tobytes()
    assert again[1].errors.tobytes() == lods[1].errors.tobytes() and again.report_html() == lods.report_html()


def test_studies_and_clouds_survive_pickling(study, cloud):
    again = pickle.loads(pickle.dumps(study))
    assert np.array_equal(again.array, study.array) and np.array_equal(again.affine, study.affine)
    assert again.time_ms == study.time_ms and again.view == study.view
    assert np.array_equal(pickle.loads(pickle.dumps(cloud)).points, cloud.points)


def test_an_estimate_survives_pickling(heart):
    assert pickle.loads(pickle.dumps(heart.ef)) == heart.ef and heart.ef != 3


def test_copies_are_the_thing_itself_as_it_cannot_change(heart, lods):
    for result in (heart, lods):
        assert copy.copy(result) is result and copy.deepcopy(result) is result


@pytest.mark.parametrize("spoil", ["cut", "longer", "author", "length"])
def test_what_was_pickled_by_others_is_refused(lods, spoil):
    (bytes_,) = [part for part in lods.__reduce_ex__(4) if isinstance(part, bytes)] or [lods.__getstate__()]
    bad = {
        "cut": bytes_[: len(bytes_) // 2],
        "longer": bytes_ + b"x",
        "author": bytes_.replace(b"dynasurf ", b"somebody ", 1),
        "length": b"\xff" * 8 + bytes_[8:],
    }[spoil]
    other = ds.cloud.CloudResult.__new__(ds.cloud.CloudResult)
    with pytest.raises(ds.InputError, match="pickled object"):
        other.__setstate__(bad)
