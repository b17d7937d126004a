#!/usr/bin/env python3
"""Runs the notebooks of python/notebooks from clean and writes them with their results as pages.

    PYTHONPATH=$PWD/build/release/python python3 tools/notebook_pages.py FOLDER [NAME ...]

Needs nbclient, nbconvert and ipykernel (on Debian: python3-nbclient, python3-nbconvert, python3-ipykernel).
"""

import os
import pathlib
import sys
import tempfile

import jupyter_client
import nbclient
import nbformat
from jupyter_client.kernelspec import KernelSpec
from nbconvert import HTMLExporter

os.environ["PYDEVD_DISABLE_FILE_VALIDATION"] = "1"  # else every kernel prints a warning of its debugger
NOTEBOOKS = pathlib.Path(__file__).resolve().parents[1] / "python/notebooks"


def executed(path, folder):
    """The notebook with what its cells show, run in `folder` by this interpreter. Raises CellExecutionError."""
    notebook = nbformat.read(path, as_version=4)
    manager = jupyter_client.AsyncKernelManager()
    manager._kernel_spec = KernelSpec(argv=[sys.executable, "-m", "ipykernel_launcher", "-f", "{connection_file}"],
                                      display_name="Python 3", language="python")  # fmt: skip
    nbclient.NotebookClient(notebook, km=manager, timeout=900, resources={"metadata": {"path": str(folder)}}).execute()
    return notebook


def main():
    out = pathlib.Path(sys.argv[1])
    out.mkdir(parents=True, exist_ok=True)
    exporter = HTMLExporter(template_name="basic", exclude_anchor_links=True)
    for path in sorted(NOTEBOOKS.glob("*.ipynb")):
        if sys.argv[2:] and path.stem not in sys.argv[2:]:
            continue
        with tempfile.TemporaryDirectory() as folder:
            body, _ = exporter.from_notebook_node(executed(path, folder))
        head = f'<!doctype html><meta charset="utf-8"><title>{path.stem}</title><link rel="stylesheet" href="notebook.css">'
        (out / f"{path.stem}.html").write_text(head + body)
        print(out / f"{path.stem}.html")
    (out / "notebook.css").write_text(
        "body{font:16px/1.5 sans-serif;max-width:60rem;margin:2rem auto;padding:0 1rem}\n"
        "pre{font:14px/1.45 monospace;overflow:auto;margin:0}\n"
        ".input_area pre,.input pre{background:#f4f4f4;padding:.6rem}\n"
        ".output_area,.output{margin:.6rem 0}\nimg{max-width:100%}\niframe{max-width:100%}\n"
        ".prompt,.jp-InputPrompt,.jp-OutputPrompt{display:none}\n"
    )


if __name__ == "__main__":
    main()
