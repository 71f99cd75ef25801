"""Straight pieces of one view's boundary on the walls of a rectangle."""

import numpy as np
import pytest
from tests.scenes import RECTANGLE, exact_layout

from panoplan.config import Config
from panoplan.stages.plan.pieces import pieces_on_walls
from panoplan.stages.registration import cast, register
from panoplan.types.keyframe import Keyframe
from panoplan.types.pose import Pose
from panoplan.types.view import Correction

CONFIG = Config()
CAMERA = np.array([0.3, 0.2])
NOT_MOVED = Correction()


def _pieces(width=1024, *, ring=RECTANGLE, moved=NOT_MOVED):
    layout = exact_layout(RECTANGLE, CAMERA, np.eye(3), width=width)
    keyframe = Keyframe("kf", Pose(np.eye(3), [CAMERA[0], 0.0, CAMERA[1]]), layout)
    view = register(cast(keyframe, 0, np.zeros(3), np.eye(2), CONFIG.registration), 1.0)
    return pieces_on_walls([view], [([0], ring)], [moved], 0.3, CONFIG.adjust)


@pytest.mark.parametrize("width", [64, 512, 1024])
def test_each_wall_has_a_piece_as_sure_however_many_columns_there_are(width):
    pieces, usual = _pieces(width), _pieces()
    assert pieces.view.tolist() == [0] * 4
    assert pieces.wall.tolist() == [0, 1, 2, 3]
    for wall, axis in enumerate((1, 0, 1, 0)):
        across = pieces.points[wall, :, axis] + CAMERA[axis]
        assert across == pytest.approx([RECTANGLE[wall, axis]] * 2, abs=0.02)
        assert np.ptp(pieces.points[wall, :, 1 - axis]) > 0.5
    assert pieces.sigma == pytest.approx(usual.sigma, rel=0.05)


def test_what_lies_far_from_every_wall_is_no_piece():
    assert _pieces(ring=3.0 * RECTANGLE).wall.tolist() == []


def test_pieces_are_told_as_the_view_was_before_it_was_moved():
    moved = Correction((0.1, -0.05), np.deg2rad(3.0), 1.02)
    pieces = _pieces(moved=moved)
    assert pieces.wall.tolist() == [0, 1, 2, 3]
    assert pieces.points == pytest.approx(_pieces().points, abs=0.2)
    for wall, axis in enumerate((1, 0, 1, 0)):
        across = pieces.points[wall, :, axis] + CAMERA[axis]
        assert across == pytest.approx([RECTANGLE[wall, axis]] * 2, abs=0.01)
