from dataclasses import replace

import pytest
from tests.exporters.storeys import two_storeys
from tests.metrics.plans import plan, square

from panoplan.exporters.heights import (
    CEILING_M,
    SLAB_M,
    ceilings,
    door_head,
    elevations,
    window_edges,
)
from panoplan.exporters.storeys import storeys


def with_ceilings(*heights, levels=None):
    made = plan([square(3 * k, 0) for k in range(len(heights))])
    levels = levels or [0] * len(heights)
    rooms = tuple(
        replace(room, ceiling_height=height, level=level)
        for room, height, level in zip(made.rooms, heights, levels, strict=True)
    )
    return storeys(replace(made, rooms=rooms))


def test_a_ceiling_that_was_not_seen_is_the_usual_one():
    assert list(ceilings(with_ceilings(2.4, None, 2.6, 2.6)).values()) == [2.4, 2.6, 2.6, 2.6]
    assert list(ceilings(with_ceilings(None)).values()) == [CEILING_M]
    found = ceilings(with_ceilings(2.4, None, 3.0, levels=[0, 1, 1]))
    assert list(found.values()) == [2.4, 3.0, 3.0]


def test_storeys_are_stacked_on_the_ground_floor():
    floors = with_ceilings(2.2, 2.5, 3.0, levels=[-1, 0, 1])
    assert elevations(floors) == pytest.approx({-1: -(2.2 + SLAB_M), 0: 0.0, 1: 2.5 + SLAB_M})
    assert elevations(storeys(two_storeys())) == pytest.approx({0: 0.0, 1: 2.8})


@pytest.mark.parametrize("ceiling", [0.5, 1.9, 2.5, 4.0])
def test_doors_and_windows_end_below_the_ceiling(ceiling):
    assert 0 < door_head(ceiling) < ceiling
    sill, head = window_edges(ceiling)
    assert 0 < sill < head < ceiling
