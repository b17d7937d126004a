"""Builds the wheel with CMake (PEP 517). Needs nothing but Python, CMake, Ninja and the libraries of the program."""

import base64
import hashlib
import os
import pathlib
import re
import shutil
import subprocess
import sys
import sysconfig
import tarfile
import tempfile
import zipfile

ROOT = pathlib.Path(__file__).resolve().parent.parent
SKIPPED = {".git", ".cache", "__pycache__", "build", "demo", "node_modules"}


def _version():
    return re.search(r"^project\(dynasurf VERSION ([0-9.]+)", (ROOT / "CMakeLists.txt").read_text(), re.M)[1]


def _metadata():
    return (
        f"Metadata-Version: 2.1\nName: dynasurf\nVersion: {_version()}\n"
        "Summary: Surfaces of the left ventricle from gated heart studies, and of bodies from point clouds\n"
        "Requires-Python: >=3.11\nRequires-Dist: numpy\nLicense-File: LICENSE\n\nResearch use only. Not for diagnosis.\n"
    )


def _tag():
    python = f"cp{sys.version_info.major}{sys.version_info.minor}"
    return f"{python}-{python}-{re.sub('[-.]', '_', sysconfig.get_platform())}"


def _has_pages():
    """Whether the pages of reports can be bundled without a network: what they are made of is there."""
    node = shutil.which("node") or shutil.which("nodejs")
    return bool(node and shutil.which("npm") and (ROOT / "web/node_modules/.package-lock.json").is_file())


def _run(*command):
    subprocess.run([str(word) for word in command], check=True, stdout=sys.stderr)


def _install(build, stage, settings):
    """Builds the module and installs the package below `stage`."""
    pages = settings.get("pages", "on" if _has_pages() else "off")
    if pages != "on":
        print("dynasurf: web/node_modules is not there; reports and notebooks get no interactive page", file=sys.stderr)
    _run("cmake", "-S", ROOT, "-B", build, "-G", "Ninja", "-DCMAKE_BUILD_TYPE=Release", "-DDYNASURF_BUILD_APP=OFF",
         "-DDYNASURF_BUILD_TESTS=OFF", "-DDYNASURF_WITH_PYTHON=REQUIRED", "-DDYNASURF_PYTHON_DIR=.",
         f"-DDYNASURF_WITH_PAGES={pages}", f"-DPython3_EXECUTABLE={sys.executable}",
         f"-DCMAKE_INSTALL_PREFIX={stage}")  # fmt: skip
    _run("cmake", "--build", build, "--target", "python", "-j", settings.get("jobs", os.cpu_count() or 1))
    _run("cmake", "--install", build, "--component", "python", "--strip")


def _write_wheel(path, stage, info):
    """All files of `stage` as a wheel, in a fixed order and with fixed times: the same files give the same bytes."""
    texts = {f"{info}/METADATA": _metadata(), f"{info}/LICENSE": (ROOT / "LICENSE").read_text(),
             f"{info}/WHEEL": f"Wheel-Version: 1.0\nGenerator: dynasurf\nRoot-Is-Purelib: false\nTag: {_tag()}\n"}  # fmt: skip
    files = {str(f.relative_to(stage)): f.read_bytes() for f in sorted(stage.rglob("*")) if f.is_file()}
    files.update({name: text.encode() for name, text in texts.items()})
    record = []
    with zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED) as wheel:
        for name, content in files.items():
            wheel.writestr(zipfile.ZipInfo(name, (2020, 1, 1, 0, 0, 0)), content, zipfile.ZIP_DEFLATED)
            digest = base64.urlsafe_b64encode(hashlib.sha256(content).digest()).rstrip(b"=").decode()
            record.append(f"{name},sha256={digest},{len(content)}")
        lines = "\n".join([*record, f"{info}/RECORD,,"]) + "\n"
        wheel.writestr(zipfile.ZipInfo(f"{info}/RECORD", (2020, 1, 1, 0, 0, 0)), lines)


def get_requires_for_build_wheel(config_settings=None):
    return []


def get_requires_for_build_sdist(config_settings=None):
    return []


def prepare_metadata_for_build_wheel(metadata_directory, config_settings=None):
    info = f"dynasurf-{_version()}.dist-info"
    folder = pathlib.Path(metadata_directory) / info
    folder.mkdir(parents=True)
    (folder / "METADATA").write_text(_metadata())
    return info


def build_wheel(wheel_directory, config_settings=None, metadata_directory=None):
    """Settings: `pages` on or off, `jobs`, and `build`, a folder that is kept for the next build."""
    settings = config_settings or {}
    name = f"dynasurf-{_version()}-{_tag()}.whl"
    with tempfile.TemporaryDirectory(prefix="dynasurf-wheel-") as folder:
        stage = pathlib.Path(folder) / "stage"
        _install(settings.get("build", f"{folder}/build"), stage, settings)
        _write_wheel(pathlib.Path(wheel_directory) / name, stage, f"dynasurf-{_version()}.dist-info")
    return name


def build_sdist(sdist_directory, config_settings=None):
    base = f"dynasurf-{_version()}"
    path = pathlib.Path(sdist_directory) / f"{base}.tar.gz"

    def kept(entry):
        return None if SKIPPED & set(pathlib.PurePath(entry.name).parts[1:]) else entry

    info = pathlib.Path(tempfile.mkdtemp()) / "PKG-INFO"
    info.write_text(_metadata())
    with tarfile.open(path, "w:gz", format=tarfile.PAX_FORMAT) as archive:
        archive.add(ROOT, base, filter=kept)
        archive.add(info, f"{base}/PKG-INFO")
    shutil.rmtree(info.parent)
    return path.name
