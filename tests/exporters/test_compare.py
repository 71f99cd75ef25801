from xml.etree import ElementTree

import matplotlib.image
import numpy as np
import pytest
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.text import Text
from tests.metrics.plans import CAMERAS, FLAT, LEFT, RIGHT, plan, square, truth, turned

from panoplan.errors import InputError
from panoplan.exporters.compare import draw_comparison, true_plan, write_comparison
from panoplan.exporters.layers import Layer

SVG = "{http://www.w3.org/2000/svg}"


def layers(axes):
    return {child.name: child for child in axes.get_children() if isinstance(child, Layer)}


def test_three_panels_at_one_scale():
    figure = draw_comparison(plan(), truth())
    FigureCanvasAgg(figure).draw()
    steps = [
        np.ptp(axes.transData.transform([[0.0, 0.0], [1.0, 1.0]]), axis=0) for axes in figure.axes
    ]
    assert len(steps) == 3
    assert steps[1] == pytest.approx(steps[0])
    assert steps[2] == pytest.approx(steps[0])


def test_matched_rooms_share_a_colour():
    figure = draw_comparison(plan((RIGHT, LEFT, square(20, 0))), truth())
    true, ours, _ = (layers(axes)["rooms"].marks for axes in figure.axes)
    assert ours[0].get_facecolor() == true[1].get_facecolor()
    assert ours[1].get_facecolor() == true[0].get_facecolor()
    assert ours[2].get_facecolor() not in [mark.get_facecolor() for mark in true]


def test_overlay_tells_missed_from_too_much():
    def parts(rooms):
        marks = layers(draw_comparison(plan(rooms), truth()).axes[2])["overlay"].marks
        return [mark.get_gid() for mark in marks]

    assert parts((LEFT, RIGHT)) == ["both", "missed"]
    assert parts((*FLAT, square(20, 20))) == ["both", "extra"]
    assert parts(()) == ["missed"]


def test_a_plan_is_aligned_before_it_is_drawn():
    wrong = plan(
        tuple(turned(p, 1.0, (3, 4), 0.4) for p in FLAT), turned(CAMERAS, 1.0, (3, 4), 0.4)
    )
    figure = draw_comparison(wrong, truth(), align="similarity")
    corners = layers(figure.axes[1])["corners"].marks[0].get_xydata()
    assert corners == pytest.approx(np.concatenate(FLAT), abs=1e-6)


@pytest.mark.parametrize("rooms", [(), (None,), (1e-3 * LEFT,), FLAT])
def test_comparison_is_written(tmp_path, rooms):
    write_comparison(tmp_path / "fig.png", plan(rooms), truth())
    assert max(matplotlib.image.imread(tmp_path / "fig.png").shape) >= 1600


def test_comparison_as_svg(tmp_path):
    flat = tuple(p * [4, 1] for p in FLAT)
    write_comparison(
        tmp_path / "fig.svg", plan(flat), truth(flat, partial=flat), rooms="rooms_partial"
    )
    root = ElementTree.parse(tmp_path / "fig.svg").getroot()
    assert {"Truth", "Prediction", "Overlay"} <= {node.text for node in root.iter(f"{SVG}text")}


def test_what_cannot_be_compared_is_refused(tmp_path):
    with pytest.raises(InputError, match="rooms_partial"):
        write_comparison(tmp_path / "fig.png", plan(), truth(), rooms="rooms_partial")
    with pytest.raises(InputError, match="suffix"):
        write_comparison(tmp_path / "fig.pdf", plan(), truth())


def test_truth_as_a_plan():
    made = true_plan(truth())
    assert made.unit == "m"
    assert [room.name for room in made.rooms] == ["hall 0", "hall 1", "hall 2"]
    assert [camera.id for camera in made.trajectory] == ["kf0", "kf1", "kf2", "kf3", "kf4"]


@pytest.mark.parametrize("stretch", [(1, 8), (8, 1), (1, 1)])
def test_no_text_of_a_comparison_is_cropped(stretch):
    rooms = tuple(p * stretch for p in FLAT)
    figure = draw_comparison(plan((*rooms[:2], None)), truth(rooms), align="none")
    canvas = FigureCanvasAgg(figure)
    canvas.draw()
    for axes in figure.axes:
        page = axes.get_window_extent()
        for layer in layers(axes).values():
            for mark in layer.marks:
                if isinstance(mark, Text):
                    box = mark.get_window_extent(canvas.get_renderer())
                    assert page.x0 - 1 <= box.x0 <= box.x1 <= page.x1 + 1
                    assert page.y0 - 1 <= box.y0 <= box.y1 <= page.y1 + 1
