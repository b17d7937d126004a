"""Pictures of a ventricle's result, by matplotlib."""

from matplotlib import pyplot

ENDO, EPI = "#c4372c", "#b08b5a"


def _axes(axes, **how):
    return axes if axes is not None else pyplot.subplots(subplot_kw=how)[1]


def curve(heart, *, axes=None, **_):
    """Volumes of the cavity over the beat, and their periodic fit."""
    axes = _axes(axes)
    gates = len(heart.gates)
    axes.plot([(g + 0.5) / gates for g in range(gates)], heart.volumes_ml[:, 0], "o", color=ENDO, label="gates")
    fit = heart.curve()
    if fit is not None:
        axes.plot(fit[0], fit[1], color=ENDO, label="periodic fit")
    axes.set(xlabel="part of the beat", ylabel="volume of the cavity, mL", xlim=(0, 1))
    axes.set_ylim(bottom=0)
    axes.legend()
    return axes.figure


def polar(heart, *, name="perfusion_percent", axes=None, **_):
    """A polar map: the apex in the middle, the anterior wall on top."""
    import numpy as np

    from ._core import OptionError

    maps = heart.measures.polar if heart.measures is not None else {}
    if name not in maps:
        raise OptionError(f"there is no polar map '{name}'; expected {', '.join(maps) or 'a study with one'}")
    values = maps[name]
    axes = _axes(axes, projection="polar")
    rings, sectors = values.shape
    around, out = np.linspace(0, 2 * np.pi, sectors + 1), np.linspace(0, 1, rings + 1)
    axes.grid(False)
    drawn = axes.pcolormesh(around, out, np.ma.masked_invalid(values), cmap="viridis")
    axes.set(theta_zero_location="N", xticks=[], yticks=[], title=name)
    axes.figure.colorbar(drawn, ax=axes, shrink=0.8)
    return axes.figure


def slices(heart, *, gate=0, **_):
    """Every slice of a gate with the sections of its walls."""
    import numpy as np

    from . import _core

    image, found = heart.study.gates[gate], heart.gates[gate]
    columns = min(6, len(image.array))
    rows = -(-len(image.array) // columns)
    figure, places = pyplot.subplots(rows, columns, figsize=(2 * columns, 2 * rows), squeeze=False)
    for place in places.flat:
        place.axis("off")
    for k, (place, pixels) in enumerate(zip(places.flat, image.array)):
        place.imshow(pixels, cmap="gray", vmin=0, vmax=image.array.max())
        height = np.array([0, 0, k * image.grid.spacing[2]])
        for surface, colour in ((found.endo, ENDO), (found.epi, EPI)):
            if surface is None:
                continue
            inside = _core.to_grid(image.grid, surface.mesh)
            for polygon in _core.cross_section(inside, height, (0, 0, 1)):
                place.plot(polygon[:, 0] / image.grid.spacing[0], polygon[:, 1] / image.grid.spacing[1], color=colour, lw=1)
    figure.tight_layout()
    return figure
