"""Every notebook runs from clean, in a kernel of its own."""

import importlib.util
import pathlib
import sys

import pytest

NOTEBOOKS = sorted((pathlib.Path(__file__).resolve().parents[1] / "notebooks").glob("*.ipynb"))


@pytest.mark.parametrize("path", NOTEBOOKS, ids=lambda p: p.stem)
def test_a_notebook_runs(path, tmp_path):
    for module in ("nbformat", "nbclient", "ipykernel", "matplotlib"):
        if importlib.util.find_spec(module) is None:
            pytest.skip(f"{module} is not installed")
    import jupyter_client
    import nbclient
    import nbformat
    from jupyter_client.kernelspec import KernelSpec

    notebook = nbformat.read(path, as_version=4)
    assert all(not cell.get("outputs") for cell in notebook.cells), "kept without outputs"
    manager = jupyter_client.AsyncKernelManager()
    manager._kernel_spec = KernelSpec(argv=[sys.executable, "-m", "ipykernel_launcher", "-f", "{connection_file}"],
                                      display_name="Python 3", language="python")  # fmt: skip
    client = nbclient.NotebookClient(notebook, km=manager, timeout=400, resources={"metadata": {"path": str(tmp_path)}})
    client.execute()
    shown = [output for cell in notebook.cells for output in cell.get("outputs", [])]
    assert shown and not any(output.output_type == "error" for output in shown)
    pictures = sum("image/png" in output.get("data", {}) for output in shown)
    assert pictures == {"gvf": 2, "labeller": 1, "scan": 2, "study": 2}[path.stem]
    assert any("text/html" in o.get("data", {}) for o in shown) == (path.stem in ("scan", "study"))
