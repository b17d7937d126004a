"""Result folders as they were written."""

from __future__ import annotations

from . import _core
from ._core import Estimate, InputError

_SCHEMAS = {"dynasurf.ventricle/3", "dynasurf.cloud/1"}


class Saved:
    """A result folder.

    Attributes
    ----------
    folder : pathlib.Path
    results : dict
        results.json.
    """

    def __init__(self, folder, results):
        self.folder, self.results = folder, results

    def _of(self, *path):
        """A value of results.json. Raises InputError where the file has none."""
        value = self.results
        for name in path:
            try:
                value = value[name]
            except (KeyError, IndexError, TypeError):
                where = ".".join(str(p) for p in path)
                raise InputError(f"{self.folder / 'results.json'}: has no {where}; expected what its schema, "
                                 f"{self.results['schema']}, asks for") from None  # fmt: skip
        return value

    def __repr__(self):
        return f"<dynasurf.{type(self).__name__} of {self.folder}>"

    def _mesh(self, stem):
        found = next((p for e in ("ply", "obj", "off", "stl") if (p := self.folder / "meshes" / f"{stem}.{e}").is_file()), None)
        return None if found is None else _core.read_mesh(str(found))


class SavedGate:
    """One gate of a saved result: walls as they were written, World (LPS), mm."""

    def __init__(self, saved, number):
        self._saved, self.gate = saved, number

    @property
    def time_ms(self):
        return self._saved._of("gates", self.gate, "time_ms")

    @property
    def endo(self):
        """TriMesh; None: not found, or not written in a format that can be read back."""
        return self._saved._mesh(f"endo_g{self.gate + 1:02d}")

    @property
    def epi(self):
        """TriMesh; None: as of `endo`."""
        return self._saved._mesh(f"epi_g{self.gate + 1:02d}")


class SavedVentricle(Saved):
    """A result of ``dynasurf ventricle`` or of `VentricleResult.save`."""

    def _estimate(self, name):
        value, interval = self._of(name), self._of(name + "_90")
        if value is None:
            return None
        return Estimate(value, 0 if interval is None else (interval[1] - interval[0]) / (2 * 1.645))

    ef = property(lambda self: self._estimate("ef_percent"), doc="Ejection fraction, %.")
    edv = property(lambda self: self._estimate("edv_ml"), doc="End-diastolic volume, mL.")
    esv = property(lambda self: self._estimate("esv_ml"), doc="End-systolic volume, mL.")
    sv = property(lambda self: self._estimate("sv_ml"), doc="Stroke volume, mL.")
    wall = property(lambda self: self._estimate("wall_ml"), doc="Volume of the muscle, mL.")
    verdict = property(lambda self: self._of("quality", "verdict"), doc="ok, check or fail.")

    @property
    def gates(self):
        return [SavedGate(self, n) for n in range(len(self._of("gates")))]

    @property
    def volumes_ml(self):
        """(gates, 2): inner and outer wall; NaN: not found."""
        import numpy as np

        return np.array([[g["endo_ml"], g["epi_ml"]] for g in self._of("gates")], dtype=float).reshape(-1, 2)

    @property
    def segments(self):
        """Segments by number, a structured array as of VentricleResult."""
        import numpy as np

        from ._methods import SEGMENT_COLUMNS, _segment_type

        if self._of("measures") is None:
            return np.empty(0, _segment_type())
        return np.array([tuple(_column(s, n) for n in SEGMENT_COLUMNS) for s in self._of("measures", "segments")],
                        dtype=_segment_type())  # fmt: skip


def _column(segment, name):
    nan = float("nan")
    if not name.endswith("_sd"):
        return nan if segment[name] is None else segment[name]
    interval = segment[name[:-3] + "_90"]
    return nan if interval is None else (interval[1] - interval[0]) / (2 * 1.645)


class SavedCloud(Saved):
    """A result of ``dynasurf cloud`` or of `CloudResult.save`: a sequence of meshes, finest first."""

    watertight = property(lambda self: self._of("watertight"))

    def __len__(self):
        return len(self._of("levels"))

    def __getitem__(self, level):
        count = len(self)
        if not -count <= level < count:
            raise IndexError("level out of range")
        return self._mesh(self._of("levels", level, "name"))


def load(folder):
    """Read a result folder back.

    Parameters
    ----------
    folder : path
        Of ``dynasurf ventricle``, ``dynasurf cloud`` or a result's ``save``.

    Returns
    -------
    SavedVentricle or SavedCloud

    Raises
    ------
    IoError
        When there is no results.json.
    InputError
        When it is of another schema, or lacks what its schema asks for.
    """
    import json
    import pathlib

    folder = pathlib.Path(folder)
    file = folder / "results.json"
    try:
        text = file.read_text(encoding="utf-8")
    except OSError as error:
        raise _core.IoError(f"{file}: cannot be read: {error.strerror}") from None
    try:
        results = json.loads(text)
    except ValueError as error:
        raise InputError(f"{file}: is no JSON: {error}") from None
    schema = results.get("schema") if isinstance(results, dict) else None
    if schema not in _SCHEMAS:
        raise InputError(f"{file}: has the schema {schema!r}; expected {' or '.join(sorted(_SCHEMAS))}")
    return (SavedVentricle if schema.startswith("dynasurf.ventricle/") else SavedCloud)(folder, results)
