import numpy as np
import pytest
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from matplotlib.text import Text
from tests.metrics.plans import CAMERAS, FLAT, LEFT, RIGHT, plan, square

from panoplan.exporters.drawing import (
    Shown,
    bar_length,
    content_bounds,
    draw_plan,
    plan_figure,
    room_colours,
    scaled_figure,
)
from panoplan.exporters.labels import printable
from panoplan.exporters.layers import Layer
from panoplan.types.plan import Aperture


def layers(figure):
    (axes,) = figure.axes
    return {child.name: child for child in axes.get_children() if isinstance(child, Layer)}


def texts(figure):
    return [mark for layer in layers(figure).values() for mark in layer.marks if type(mark) is Text]


def words(figure):
    return "\n".join(text.get_text() for text in texts(figure))


def test_a_plan_has_its_layers_in_order():
    names = list(layers(plan_figure(plan())))
    assert names == ["rooms", "walls", "openings", "path", "corners", "labels", "scale"]


def test_every_room_corner_and_camera_is_drawn():
    drawn = layers(plan_figure(plan()))
    assert len(drawn["rooms"].marks) == len(drawn["walls"].marks) == 3
    (corners,) = drawn["corners"].marks
    assert corners.get_xydata() == pytest.approx(np.concatenate(FLAT))
    assert drawn["path"].marks[1].get_xydata() == pytest.approx(CAMERAS)


@pytest.mark.parametrize("size", [(10, 7), (3, 3), (4, 12), (12, 2.5)])
def test_nothing_is_cropped(size):
    figure = Figure(figsize=size)
    axes = figure.add_axes((0, 0, 1, 1))
    made = plan((*FLAT, None), doors=(Aperture("door_01", np.array([[-1.0, 0.0], [9.0, 6.0]])),))
    draw_plan(axes, made, title="A title")
    canvas = FigureCanvasAgg(figure)
    canvas.draw()
    page = figure.bbox
    for text in texts(figure):
        box = text.get_window_extent(canvas.get_renderer())
        # The footer of a tiny sheet may be longer than the sheet is wide, never higher.
        assert box.y0 >= page.y0 - 1
        assert box.y1 <= page.y1 + 1
        assert size[0] < 4 or (box.x0 >= page.x0 - 1 and box.x1 <= page.x1 + 1)
    low, high = content_bounds(made)
    shown = axes.transData.inverted().transform([[page.x0, page.y0], [page.x1, page.y1]])
    assert np.all(shown[0] < low)
    assert np.all(shown[1] > high)


def test_both_axes_have_one_scale_and_up_is_up():
    figure = plan_figure(plan())
    canvas = FigureCanvasAgg(figure)
    canvas.draw()
    origin, right, up = figure.axes[0].transData.transform([[0, 0], [1, 0], [0, 1]])
    assert right[0] - origin[0] == pytest.approx(up[1] - origin[1], rel=1e-3)
    assert right[0] > origin[0]
    assert up[1] > origin[1]


def test_true_scale():
    figure = scaled_figure(plan(), 50)
    canvas = FigureCanvasAgg(figure)
    canvas.draw()
    origin, right = figure.axes[0].transData.transform([[0, 0], [1, 0]]) / figure.dpi
    assert (right[0] - origin[0]) * 0.0254 == pytest.approx(1 / 50, rel=1e-3)
    assert "1:50" in words(figure)
    assert "1:" not in words(plan_figure(plan()))


def test_names_and_areas_are_told_in_the_unit():
    told = words(plan_figure(plan()))
    assert "Room 1\n12.0 m²" in told
    # 3 x 3 and 1.2 x 2 for the L.
    assert "3 rooms, 33.8 m²" in told
    assert "ch²" in words(plan_figure(plan(unit="ch")))
    assert "camera height" in words(plan_figure(plan(unit="ch")))


def test_rooms_without_a_shape_are_listed():
    told = words(plan_figure(plan((LEFT, None), names=["Hall", "Attic"])))
    assert "Without a shape: Attic (no closed path)." in told.replace("\n", " ")


def test_many_failures_do_not_fill_the_page():
    told = words(plan_figure(plan((LEFT, *[None] * 200))))
    assert "more lines" in told
    assert len(told.splitlines()) < 15


def test_a_room_too_small_for_its_name_has_a_number():
    told = words(plan_figure(plan((LEFT, square(8, 0, 0.15)), names=["Hall", "Broom cupboard"])))
    assert "1 Broom cupboard, 0.0 m²" in told


def test_names_are_never_markup():
    names = ["$x^2$ \\frac", "<b>&amp;</b>", "line\nbreak\x00\x1b[31m"]
    figure = plan_figure(plan(names=names))
    FigureCanvasAgg(figure).draw()
    assert "$x^2$ \\frac" in words(figure)
    assert "\x00" not in words(figure)
    assert "\x1b" not in words(figure)


def test_printable():
    assert printable("a\tb\n c") == "a b c"
    assert printable("word " * 50).endswith("…")
    assert len(printable("x" * 500)) <= 60
    assert printable("") == ""


@pytest.mark.parametrize(
    ("rooms", "cameras", "told"),
    [((), CAMERAS, "no room found"), ((), (), "nothing found"), ((), CAMERAS[:1], "no room found")],
)
def test_a_plan_without_rooms_is_drawn(rooms, cameras, told):
    figure = plan_figure(plan(rooms, cameras, doors=(), openings=(), windows=()))
    FigureCanvasAgg(figure).draw()
    assert told in words(figure)
    assert len(layers(figure)["path"].marks) == (2 if len(cameras) else 0)


def test_what_is_not_asked_for_is_not_drawn():
    figure = Figure()
    bare = Shown(corners=False, path=False, labels=False, footer=False)
    draw_plan(figure.add_axes((0, 0, 1, 1)), plan(), shown=bare)
    assert set(layers(figure)) == {"rooms", "walls", "openings"}
    assert texts(figure) == []


def test_neighbours_differ_in_colour():
    grid = [square(2 * x, 2 * y) for x in range(6) for y in range(6)]
    rooms = plan(grid).rooms
    colours = [room_colours(rooms)[room.id] for room in rooms]
    for i, one in enumerate(grid):
        for j, other in enumerate(grid[:i]):
            if np.abs(one[0] - other[0]).max() < 2.5:
                assert colours[i] != colours[j]


@pytest.mark.parametrize(("extent", "length"), [(10, 2), (8, 2), (7.9, 1), (41, 10), (0.1, 0.02)])
def test_scale_bar_is_round(extent, length):
    assert bar_length(extent) == pytest.approx(length)


def test_a_room_that_crosses_itself_is_drawn():
    bow = np.array([[0.0, 0.0], [2.0, 2.0], [2.0, 0.0], [0.0, 2.0]])
    line = np.array([[0.0, 0.0], [1.0, 0.0], [2.0, 0.0]])
    figure = plan_figure(plan((bow, line, RIGHT)))
    FigureCanvasAgg(figure).draw()
    assert len(layers(figure)["rooms"].marks) == 2
