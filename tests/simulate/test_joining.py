"""Openings that leave nothing of a wall."""

import numpy as np
import pytest

from panoplan.simulate.buildings import InteriorRoom, rectangle
from panoplan.simulate.joining import Joinery, join

ROOMS = (
    InteriorRoom("living", rectangle(4, 3)),
    InteriorRoom("kitchen", rectangle(3, 5, (4.2, -1))),
)


@pytest.mark.parametrize("seed", range(5))
@pytest.mark.parametrize(("whole", "widest", "is_whole"), [(1, 5, True), (1, 2, False), (0, 5, 0)])
def test_an_opening_takes_the_whole_shared_wall_where_it_may(seed, whole, widest, is_whole):
    how = Joinery(1.0, 0.0, (0.7, 0.9), 0.0, widest, whole_walls=whole)
    (passage,) = join(ROOMS, how, np.random.default_rng(seed))
    assert passage.kind == "opening"
    ends = np.sort(passage.faces[0, :, 1])
    if is_whole:
        np.testing.assert_allclose(ends, [0, 3])
    else:
        assert 0.09 < ends[0] < ends[1] < 2.91
        assert passage.width <= widest
