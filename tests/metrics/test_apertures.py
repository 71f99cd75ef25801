import numpy as np
import pytest

from panoplan.metrics.apertures import aperture_score, merged_faces


def _segment(x0, y0, x1, y1):
    return np.array([[x0, y0], [x1, y1]], dtype=float)


FRONT = _segment(1.0, 0.0, 1.9, 0.0)


def test_the_two_faces_of_a_wall_become_their_middle():
    (one,) = merged_faces([FRONT, _segment(1.9, 0.2, 1.0, 0.2)])
    assert one == pytest.approx(np.array([[1.0, 0.1], [1.9, 0.1]]))


@pytest.mark.parametrize(
    "other",
    [
        _segment(1.0, 0.6, 1.9, 0.6),  # beyond the thickest wall
        _segment(2.0, 0.0, 2.9, 0.0),  # beside it in the same wall
        _segment(1.4, -0.4, 1.4, 0.4),  # across it
    ],
)
def test_other_segments_stay(other):
    assert len(merged_faces([FRONT, other])) == 2


def test_midpoints_within_40_cm_count_one_to_one():
    true = [FRONT, _segment(5.0, 0.0, 5.9, 0.0)]
    near = FRONT + [0.0, 0.39]
    score = aperture_score(true, [near, FRONT + [0.1, 0.0], FRONT + [0.0, 0.41]])
    assert (score.hits, score.true, score.predicted) == (1, 2, 3)


def test_the_matching_finds_most_pairs():
    """The nearest first would leave the second door without a partner."""
    true = [FRONT, FRONT + [0.6, 0.0]]
    score = aperture_score(true, [FRONT + [0.28, 0.0], FRONT + [-0.35, 0.0]])
    assert score.hits == 2


def test_nothing_is_a_score():
    assert aperture_score([], [FRONT]).precision == 0.0
    assert aperture_score([FRONT], []).recall == 0.0
