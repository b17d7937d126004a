"""How long work tells where it stands."""

from __future__ import annotations


class progress_of:
    """What long functions call with ``(stage, done, total)``.

    Parameters
    ----------
    progress : bool or callable or None
        True: a bar of tqdm where it is installed, else lines on standard error. A callable is called as it is, in the
        calling thread; an exception of it stops the work. None or False: nothing is told.
    """

    def __init__(self, progress):
        self._progress, self._bar = progress, None

    def __enter__(self):
        if not self._progress:
            return None
        if callable(self._progress):
            return self._progress
        self._bar = _bar()
        return self._bar

    def __exit__(self, *_):
        if self._bar is not None:
            self._bar.close()


def _bar():
    try:
        from tqdm.auto import tqdm
    except ImportError:
        return _Lines()
    return _Bar(tqdm)


class _Bar:
    """One bar of tqdm per stage."""

    def __init__(self, tqdm):
        self._tqdm, self._stage, self._bar = tqdm, None, None

    def __call__(self, stage, done, total):
        if stage != self._stage:
            self.close()
            self._stage, self._bar = stage, self._tqdm(total=total or None, desc=stage, leave=False)
        self._bar.n = done
        self._bar.refresh()

    def close(self):
        if self._bar is not None:
            self._bar.close()


class _Lines:
    """A line per stage, without tqdm."""

    def __init__(self):
        self._stage = None

    def __call__(self, stage, done, total):
        import sys

        if stage != self._stage:
            self._stage = stage
            print(f"dynasurf: {stage}", file=sys.stderr)

    def close(self):
        pass
