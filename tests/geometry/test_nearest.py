import numpy as np
import pytest

from panoplan.geometry.nearest import mutual_nearest


def unit(rows):
    rows = np.asarray(rows, dtype=np.float32)
    return rows / np.linalg.norm(rows, axis=1, keepdims=True)


def test_by_hand():
    a = unit([[1, 0], [0, 1]])
    b = unit([[0.1, 1], [1, 0.2], [1, -0.3]])
    pairs, ratio = mutual_nearest(a, b)
    assert pairs.tolist() == [[0, 1], [1, 0]]
    near, far = (np.sqrt(2 - 2 * x) for x in (b[1, 0], b[2, 0]))
    assert ratio[0] == pytest.approx(near / far, rel=1e-4)


def test_against_a_full_search():
    rng = np.random.default_rng(0)
    a, b = unit(rng.standard_normal((1300, 16))), unit(rng.standard_normal((700, 16)))
    pairs, ratio = mutual_nearest(a, b)
    distance = np.linalg.norm(a[:, None] - b[None], axis=2)
    expected = [
        (i, j) for i, j in enumerate(distance.argmin(axis=1)) if distance[:, j].argmin() == i
    ]
    assert [tuple(p) for p in pairs.tolist()] == expected
    for (i, j), value in zip(expected[:50], ratio[:50], strict=True):
        ways = (np.sort(distance[i])[:2], np.sort(distance[:, j])[:2])
        assert value == pytest.approx(max(w[0] / w[1] for w in ways), rel=1e-3)


def test_none_and_one():
    one, none = unit([[1, 0]]), np.empty((0, 2), dtype=np.float32)
    assert len(mutual_nearest(one, none)[0]) == 0
    pairs, ratio = mutual_nearest(one, one)
    assert pairs.tolist() == [[0, 0]]
    assert ratio.tolist() == [1.0]
