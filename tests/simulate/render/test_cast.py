"""Rays against triangles, by Embree and without it."""

import numpy as np
import pytest

from panoplan.simulate.render.cast import ray_caster

BACKENDS = ["embree", "numba"]
WALL = np.array([[[-1, -1, 2], [1, -1, 2], [1, 1, 2]], [[-1, -1, 2], [1, 1, 2], [-1, 1, 2]]])


def _caster(triangles, backend):
    if backend == "embree":
        pytest.importorskip("embreex")
    return ray_caster(np.asarray(triangles, dtype=np.float32), backend)


def _rays(*directions):
    directions = np.array(directions, dtype=np.float32)
    return np.zeros_like(directions), directions


@pytest.mark.parametrize("backend", BACKENDS)
def test_distances_count_in_lengths_of_the_direction(backend):
    hits = _caster(WALL, backend).first(*_rays([0.1, 0, 1], [0.1, 0, 4], [0, 0, -1], [1, 0.2, 1]))
    np.testing.assert_allclose(hits.distance, [2, 0.5, np.inf, np.inf], rtol=1e-6)
    assert list(hits.triangle[2:]) == [-1, -1]


@pytest.mark.parametrize("backend", BACKENDS)
def test_the_nearest_of_several_is_met(backend):
    behind = np.concatenate([WALL * [1, 1, 1.5], WALL, WALL * [1, 1, 2]])
    hits = _caster(behind, backend).first(*_rays([0.3, -0.1, 1]))
    assert hits.distance[0] == pytest.approx(2)
    assert hits.triangle[0] in (2, 3)


@pytest.mark.parametrize("backend", BACKENDS)
def test_only_what_is_within_reach_blocks(backend):
    origins, directions = _rays([0.1, 0.2, 1], [0.1, 0.2, 1], [0, 0, -1])
    reach = np.array([1.9, 2.1, 9], dtype=np.float32)
    blocked = _caster(WALL, backend).blocked(origins, directions, reach)
    assert list(blocked) == [False, True, False]


def test_both_casters_agree_on_a_soup_of_triangles():
    rng = np.random.default_rng(0)
    soup = rng.normal(0, 1, (300, 1, 3)) + rng.normal(0, 0.3, (300, 3, 3))
    origins = rng.normal(0, 2, (4000, 3)).astype(np.float32)
    directions = rng.normal(0, 1, (4000, 3)).astype(np.float32)
    one, two = (_caster(soup, backend).first(origins, directions) for backend in BACKENDS)
    same = one.triangle == two.triangle
    assert same.mean() > 0.998
    np.testing.assert_allclose(one.distance[same], two.distance[same], rtol=1e-4)
