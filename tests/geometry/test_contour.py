import numpy as np
import pytest

from panoplan.geometry.contour import trace_outline
from panoplan.geometry.polygons import signed_area


def _mask(*rectangles):
    mask = np.zeros((12, 12), dtype=bool)
    for i, j, n, m in rectangles:
        mask[i : i + n, j : j + m] = True
    return mask


@pytest.mark.parametrize(
    ("mask", "area", "steps"),
    [
        (_mask((4, 4, 1, 1)), 1, 4),
        (_mask((2, 3, 4, 5)), 20, 18),
        (_mask((2, 2, 6, 2), (2, 2, 2, 7)), 22, 26),
        (_mask((2, 2, 3, 3), (5, 5, 3, 3)), 9, 12),
    ],
    ids=["cell", "rectangle", "L", "two parts that touch at a corner"],
)
def test_outline_encloses_the_mask_counter_clockwise(mask, area, steps):
    outline = trace_outline(mask)
    assert signed_area(outline) == area
    assert len(outline) == steps
    assert np.all(np.abs(np.roll(outline, -1, axis=0) - outline).sum(axis=1) == 1)
