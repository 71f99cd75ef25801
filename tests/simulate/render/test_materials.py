"""Procedural patterns: colours that can be, and no flicker far away."""

import numpy as np
import pytest

from panoplan.simulate.render.looks import draw_look
from panoplan.simulate.render.materials import Material, Pattern, albedo, packed

PATTERNS = [p for p in Pattern if p is not Pattern.OUTSIDE]


def _sampled(material, pixel, count=400, seed=3):
    row = packed([material])[0]
    rng = np.random.default_rng(seed)
    places = rng.uniform(0, [4, 2.5], (count, 2))
    return np.array([albedo(row, s, t, 4.0, 2.5, np.float32(pixel), seed) for s, t in places])


@pytest.mark.parametrize("pattern", PATTERNS)
def test_colours_are_finite_and_not_negative(pattern):
    for a, b, c in ((0.3, 0.6, 0.01), (0.05, 0.05, 0.0)):
        material = Material(pattern, (0.5, 0.4, 0.3), a=a, b=b, c=c, contrast=0.8, detail=1)
        colours = _sampled(material, 0.005)
        assert np.isfinite(colours).all()
        assert (colours >= 0).all()
        assert (colours < 1.5).all()


def test_tiles_without_joints_are_even():
    wall = Material(Pattern.WALL, (0.8,) * 3, (0.3,) * 3, a=0, b=0, c=9.0, contrast=0, detail=0)
    np.testing.assert_allclose(_sampled(wall, 0.01), 0.3, rtol=1e-6)


@pytest.mark.parametrize("pattern", [Pattern.PLANKS, Pattern.TILES, Pattern.PILE, Pattern.SLATS])
def test_a_pattern_finer_than_a_pixel_is_not_seen(pattern):
    material = Material(pattern, (0.5, 0.4, 0.3), a=0.1, b=0.1, c=0.004, contrast=0.5)
    near, far = (_sampled(material, pixel).std() for pixel in (0.001, 3.0))
    spread = _sampled(Material(Pattern.PLAIN, (0.5, 0.4, 0.3), contrast=0), 3.0).std()
    assert near - spread > 2 * (far - spread)


def test_a_tile_joint_has_the_second_colour():
    row = packed(
        [Material(Pattern.TILES, (0.8,) * 3, (0.1,) * 3, a=0.5, b=0.5, c=0.02, contrast=0)]
    )
    pixel = np.float32(0.001)
    assert albedo(row[0], 0.5, 0.2, 4.0, 2.5, pixel, 1)[0] == pytest.approx(0.1, abs=1e-3)
    assert albedo(row[0], 0.25, 0.2, 4.0, 2.5, pixel, 1)[0] == pytest.approx(0.8, abs=1e-3)


def test_a_wall_without_skirting_has_none_even_below_its_edge():
    row = packed([Material(Pattern.WALL, (0.8,) * 3, (0.1,) * 3, a=0, b=0, contrast=0)])
    colour = albedo(row[0], 1.0, -1e-7, 4.0, 2.5, np.float32(0.01), 1)
    np.testing.assert_allclose(colour, 0.8, rtol=1e-6)


def test_looks_are_drawn_by_the_seed():
    one, again, other = (draw_look(np.random.default_rng(k)) for k in (1, 1, 2))
    assert one == again
    assert one != other
