"""Named groups of marks in a matplotlib figure, which become groups of an SVG."""

from __future__ import annotations

from collections.abc import Iterable

from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.backend_bases import RendererBase


class Layer(Artist):
    """Marks that are drawn one after the other, in an SVG inside one group with an id.

    Args:
        name: the group's id.
        marks: artists that are on no axes yet.
        order: layers of a higher one are drawn later.
    """

    def __init__(self, name: str, marks: Iterable[Artist], order: float) -> None:
        super().__init__()
        self.name = name
        self.marks = tuple(marks)
        self.set_zorder(order)

    def draw(self, renderer: RendererBase) -> None:
        """Draws the marks in their order."""
        renderer.open_group("layer", gid=self.name)
        for mark in self.marks:
            mark.draw(renderer)
        renderer.close_group("layer")
        self.stale = False


def add_layer(axes: Axes, name: str, marks: Iterable[Artist], order: float) -> None:
    """Puts marks on axes as a layer; marks without a transform of their own are in data units."""
    layer = Layer(name, marks, order)
    figure = axes.get_figure(root=False)
    assert figure is not None
    for mark in layer.marks:
        mark.axes = axes
        mark.set_figure(figure)
        if not mark.is_transform_set():
            mark.set_transform(axes.transData)
    axes.add_artist(layer)
