"""What of inner outlines is a hole of a room."""

import numpy as np

from panoplan.stages.plan.outline import holes_within

ROOM = np.array([[0.0, 0.0], [4.0, 0.0], [4.0, 3.0], [0.0, 3.0]])


def _pillar(x, y, size):
    square = np.array([[0.0, 0.0], [0.0, 1.0], [1.0, 1.0], [1.0, 0.0]])
    return size * square + [x, y]


def _found(*inner):
    return [hole.tolist() for hole in holes_within(ROOM, inner)]


def test_pillars_apart_are_holes():
    one, other = _pillar(1.0, 1.0, 0.5), _pillar(2.0, 1.0, 0.3)
    assert _found(other, one) == [one.tolist(), other.tolist()]


def test_of_two_pillars_that_overlap_the_larger_stays():
    one, other = _pillar(1.0, 1.0, 0.5), _pillar(1.4, 1.2, 0.3)
    assert _found(other, one) == [one.tolist()]


def test_what_crosses_the_room_or_itself_or_is_nothing_is_no_hole():
    crossing = np.array([[1.0, 1.0], [1.5, 1.5], [1.5, 1.0], [1.0, 1.5]])
    assert _found(_pillar(3.8, 1.0, 0.5), _pillar(5.0, 1.0, 0.5), crossing, np.empty((0, 2))) == []
