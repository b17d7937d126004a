import copy
import json
import pickle

import dynasurf as ds
import numpy as np
import pytest
from dynasurf import _core
from dynasurf._options import _classes

ALL = sorted(_classes)


@pytest.mark.parametrize("name", ALL)
def test_json_round_trip_is_the_identity(name):
    options = _classes[name]()
    assert _classes[name].from_json(options.to_json()) == options


@pytest.mark.parametrize("name", ALL)
def test_pickle_and_copies_are_equal_and_apart(name):
    options = _classes[name]()
    for other in (pickle.loads(pickle.dumps(options)), copy.copy(options), copy.deepcopy(options)):
        assert other == options and other is not options


@pytest.mark.parametrize("name", ALL)
def test_every_member_is_documented_and_listed(name):
    for member, facts in _classes[name]._members.items():
        assert member in dir(_classes[name]()) and member in _classes[name].__doc__
        assert len(facts.__doc__.splitlines()[1].strip()) > 3


@pytest.mark.parametrize("name", ALL)
def test_an_unknown_member_is_refused_by_keyword_and_by_name(name):
    with pytest.raises(ds.OptionError, match="unknown option"):
        _classes[name](no_such_thing=1)
    with pytest.raises(AttributeError, match="no option no_such_thing"):
        _classes[name]().no_such_thing = 1


def numbers():
    for name, kind in _classes.items():
        for entry in _core.options_described():
            if entry["name"] != name:
                continue
            for member in entry["members"]:
                if member["kind"].startswith(("float", "int")) and np.isfinite(member["min"]):
                    yield pytest.param(kind, member["name"], member["min"], id=f"{name}.{member['name']}")


@pytest.mark.parametrize(("kind", "member", "least"), list(numbers()))
def test_a_number_below_its_range_is_refused_and_changes_nothing(kind, member, least):
    options = kind()
    before = options.to_json()
    with pytest.raises(ds.OptionError, match=f"option {member} is "):
        setattr(options, member, int(least) - 1)
    assert options.to_json() == before


def test_options_are_those_of_the_issue():
    options = ds.ventricle.Options(field=ds.field.SteadyGvf(mu=0.15))
    assert options.field.mu == 0.15
    assert json.loads(options.to_json())["field"] == {"method": "steady", "mu": 0.15, "tolerance": 0.001,
                                                      "scheme": "metric", "most_cycles": 40}  # fmt: skip


def test_nested_options_are_shared_not_copied():
    field = ds.field.SteadyGvf()
    options = ds.ventricle.Options(field=field)
    field.mu = 3
    options.evolution.force.drag = 0.5
    assert options.field.mu == 3 and options.to_dict()["evolution"]["force"]["drag"] == 0.5


def test_the_message_is_the_programs_own():
    with pytest.raises(ValueError, match=r"^option mu is -3; expected a number >= 1e-06 and <= 10000$"):
        ds.field.Gvf(mu=-3)


@pytest.mark.parametrize("value", [float("nan"), float("inf"), "much", None, [1], object()])
def test_what_is_no_number_is_refused(value):
    with pytest.raises(ds.OptionError, match="option mu is"):
        ds.field.Gvf(mu=value)


def test_numpy_numbers_are_numbers():
    assert ds.field.Gvf(mu=np.float32(0.5), iterations=np.int64(3)).iterations == 3


def test_a_word_chooses_a_method_and_set_is_that_of_the_command_line():
    options = ds.ventricle.Options(edges="sobel")
    assert type(options.edges) is ds.image.SobelEdges
    options.set("edges.threshold=0.25")
    options.set("field=steady")
    assert options.edges.threshold == 0.25 and type(options.field) is ds.field.SteadyGvf
    with pytest.raises(ds.OptionError, match="unknown option"):
        options.set("edges.treshold=0.25")


def test_options_of_another_stage_are_refused():
    with pytest.raises(ds.OptionError):
        ds.ventricle.Options(field=ds.image.Canny())


def test_an_optional_number_may_be_none():
    options = ds.ventricle.BlurFit(fwhm_mm=9)
    options.fwhm_mm = None
    assert options.fwhm_mm is None


@pytest.mark.parametrize("name", ["psf_corrected", "edges", "thesis", "pet", "mr", "ct"])
def test_presets_are_options(name):
    assert isinstance(ds.ventricle.preset(name), ds.ventricle.Options)


def test_an_unknown_preset_names_the_choices():
    with pytest.raises(ds.OptionError, match="psf_corrected"):
        ds.ventricle.preset("best")


def test_repr_tells_what_differs_from_the_defaults():
    assert repr(ds.field.Gvf(mu=0.5)) == "field.Gvf(mu=0.5)"
