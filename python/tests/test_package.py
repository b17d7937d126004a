import doctest
import importlib
import inspect
import os
import pathlib
import resource
import shutil
import subprocess
import sys

import dynasurf as ds
import pytest

ROOMS = ["image", "field", "mesh", "dynamics", "ventricle", "cloud", "synthetic", "io"]


@pytest.mark.parametrize("room", ["dynasurf", *(f"dynasurf.{r}" for r in ROOMS)])
def test_examples_of_docstrings_run(room):
    result = doctest.testmod(importlib.import_module(room))
    assert result.failed == 0


@pytest.mark.parametrize("room", ROOMS)
def test_everything_public_is_documented(room):
    module = getattr(ds, room)
    for name in module.__all__:
        assert (inspect.getdoc(getattr(module, name)) or "").strip(), name


def test_importing_takes_no_time():
    """Of the processor: a busy machine makes everything take long."""

    def seconds(code):
        before = resource.getrusage(resource.RUSAGE_CHILDREN)
        subprocess.run([sys.executable, "-c", code], check=True)
        after = resource.getrusage(resource.RUSAGE_CHILDREN)
        return after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime

    assert min(seconds("import dynasurf") - seconds("pass") for _ in range(5)) < 0.15


def test_mypy_accepts_the_package():
    if shutil.which("mypy") is None:
        pytest.skip("mypy is not installed")
    package = pathlib.Path(ds.__file__).parent
    done = subprocess.run(["mypy", "--ignore-missing-imports", "--cache-dir=/dev/null", "-p", "dynasurf"],
                          capture_output=True, text=True, cwd=package.parent)  # fmt: skip
    assert done.returncode == 0, done.stdout


def test_the_stubs_are_those_of_the_module():
    tool = pathlib.Path(os.environ.get("DYNASURF_SOURCE", "."), "tools/python_stubs.py")
    if shutil.which("stubgen") is None or not tool.is_file():
        pytest.skip("stubgen is not installed, or the sources are not there")
    done = subprocess.run([sys.executable, tool, "--check"], capture_output=True, text=True)
    assert done.returncode == 0, done.stdout + done.stderr


def test_mypy_knows_the_options(tmp_path):
    if shutil.which("mypy") is None:
        pytest.skip("mypy is not installed")
    (tmp_path / "use.py").write_text(
        "import dynasurf as ds\n"
        "options = ds.ventricle.Options(field=ds.field.SteadyGvf(mu=0.15), mesh_level=2)\n"
        "mesh: ds.TriMesh = ds.mesh.icosphere(2)\n"
        "wrong: int = ds.field.Gvf(mu='much').mu\n"
    )
    done = subprocess.run(["mypy", "--ignore-missing-imports", "--cache-dir=/dev/null", tmp_path / "use.py"],
                          capture_output=True, text=True, cwd=tmp_path,
                          env={**os.environ, "MYPYPATH": str(pathlib.Path(ds.__file__).parents[1])})  # fmt: skip
    found = [line for line in done.stdout.splitlines() if ": error:" in line]
    assert found and all("use.py:4:" in line for line in found), done.stdout


def test_the_module_has_no_name_of_the_libraries_outside():
    if shutil.which("nm") is None:
        pytest.skip("nm is not installed")
    from dynasurf import _core

    names = subprocess.run(["nm", "-D", "--defined-only", _core.__file__], capture_output=True, text=True).stdout
    assert "PyInit__core" in names and "reconstruct" not in names


def test_every_public_name_has_its_place_on_a_page(tmp_path):
    tool = pathlib.Path(os.environ.get("DYNASURF_SOURCE", "."), "tools/python_pages.py")
    if not tool.is_file():
        pytest.skip("the sources are not there")
    subprocess.run([sys.executable, tool, tmp_path], check=True, cwd=tool.parents[1])
    for room in ROOMS:
        text = (tmp_path / f"python-{room}.md").read_text()
        for name in set(getattr(ds, room).__all__) - set(ds.__all__):
            assert f"\n## {name}" in text, f"{room}.{name}"
