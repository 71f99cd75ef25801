import numpy as np
import pytest
from tests.exporters.storeys import turned_plan, two_storeys
from tests.metrics.plans import FLAT, plan

from panoplan.errors import InputError
from panoplan.exporters.sheet.layout import main_turn, place
from panoplan.exporters.storeys import storeys


@pytest.mark.parametrize(
    ("size", "expected"),
    [(1, ("A4", 50)), (2, ("A3", 50)), (2.5, ("A4", 100)), (4.5, ("A3", 100)), (6, ("A2", 100))],
)
def test_everyday_paper_first(size, expected):
    placement = place(storeys(plan([size * ring for ring in FLAT], ())))
    assert (placement.paper.name, placement.denominator) == expected


def test_paper_that_is_asked_for():
    assert place(storeys(plan()), "A0").paper.name == "A0"
    with pytest.raises(InputError, match="fits on A4 at 1:1000"):
        place(storeys(plan([50 * ring for ring in FLAT], ())), "A4")


@pytest.mark.parametrize("angle", [0.0, 0.3, -0.7, 1.2, 3.0])
def test_walls_become_parallel_to_the_paper(angle):
    placement = place(storeys(turned_plan(angle)))
    a, b = placement.on_paper(turned_plan(angle).rooms[0].walls[0].a[None]), None
    b = placement.on_paper(turned_plan(angle).rooms[0].walls[0].b[None])
    assert np.abs(b - a).min() == pytest.approx(0.0, abs=1e-9)
    assert np.abs(b - a).max() == pytest.approx(4.0 * placement.mm_per_m)
    assert abs(placement.turn) <= np.pi / 4 + 1e-9


def test_up_is_up_and_right_is_right():
    placement = place(storeys(plan()))
    origin, right, up = placement.on_paper(np.array([[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]]))
    assert right - origin == pytest.approx([20.0, 0.0])
    assert up - origin == pytest.approx([0.0, -20.0])


def test_no_walls_no_turn():
    assert main_turn(()) == 0.0


def test_all_storeys_lie_alike():
    made = two_storeys()
    placement = place(storeys(made))
    for room in made.rooms[:4]:
        assert placement.on_paper(room.polygon).min() > 10.0
