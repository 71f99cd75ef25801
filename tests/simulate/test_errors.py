"""Layouts of the grade `measured` err as a real network's do, row by row."""

from dataclasses import replace

import numpy as np
import pytest

from panoplan.bench.difficulty import open_home_views
from panoplan.geometry.rigid import heading_of
from panoplan.simulate.errors import error_table
from panoplan.simulate.families import family_of
from panoplan.simulate.houses import make_house
from panoplan.simulate.measured import MEASURED
from panoplan.simulate.noise import EXACT, REAL
from panoplan.simulate.scene import noisy_view
from panoplan.simulate.views import ViewCaster
from panoplan.simulate.walks import stills


@pytest.fixture(scope="module")
def table():
    return error_table(*open_home_views(REAL, range(100, 160)))


def test_bias_of_each_distance(table):
    np.testing.assert_allclose(table.bias_deg, MEASURED.bias_deg, atol=0.1)


def test_sigma_of_each_distance(table):
    np.testing.assert_allclose(table.sigma_deg, MEASURED.sigma_deg, rtol=0.15)


def test_percentile_90_of_each_distance(table):
    ratio = np.array(table.percentile_90_m) / MEASURED.percentile_90_m
    assert ratio[:5].min() > 0.7
    assert ratio[:5].max() < 1.4
    # At 4-6 m it lies where gross errors begin and swings with their share.
    assert 0.4 < ratio[5] < 1.5


def test_gross_share_of_each_distance_and_surface(table):
    np.testing.assert_allclose(table.gross_share, MEASURED.gross_share, atol=0.045)
    assert table.gross_share[5] > 0.1
    for surface, atol in (("wall", 0.02), ("door", 0.03), ("opening", 0.08), ("window", 0.02)):
        measured = getattr(MEASURED, f"gross_{surface}")
        assert table.gross_by_surface[surface] == pytest.approx(measured, abs=atol)


def test_scale_and_correlation(table):
    assert table.scale_mad_sigma == pytest.approx(MEASURED.scale_mad_sigma, abs=0.004)
    assert table.scale_std == pytest.approx(MEASURED.scale_std, abs=0.015)
    np.testing.assert_allclose(table.autocorrelation, MEASURED.autocorrelation, atol=0.05)


def test_leaks(table):
    assert table.through["door"] == pytest.approx(MEASURED.door_through, abs=0.02)
    assert table.stops["door"] == pytest.approx(MEASURED.door_stops, abs=0.04)
    assert table.through["opening"] == pytest.approx(MEASURED.opening_through, abs=0.05)
    assert table.stops["opening"] == pytest.approx(MEASURED.opening_stops, abs=0.06)
    assert 0.6 < table.leak_median_m / MEASURED.leak_median_m < 1.8
    assert 0.6 < table.leak_percentile_90_m / MEASURED.leak_percentile_90_m < 1.4


def test_bad_and_good_views(table):
    # Some of those measured stood in doorways; these do not.
    assert table.bad_views == pytest.approx(MEASURED.bad_views, abs=0.06)
    assert table.good_views == pytest.approx(MEASURED.good_views, abs=0.1)


def test_exact_layouts_have_no_errors():
    table = error_table(*open_home_views(EXACT, range(2)))
    assert max(map(abs, table.bias_deg)) < 1e-9
    assert max(table.gross_share) == 0
    assert table.through == {"door": 0, "opening": 0}
    assert table.stops == {"door": 1, "opening": 1}
    assert table.good_views == 1


def test_the_table_finds_errors_put_in_by_hand():
    seen, told = open_home_views(EXACT, range(3))
    nearer = [replace(t, floor_boundary=t.floor_boundary - np.deg2rad(0.5)) for t in told]
    table = error_table(seen, nearer)
    np.testing.assert_allclose(table.bias_deg, -0.5, atol=1e-9)
    np.testing.assert_allclose(table.sigma_deg, 0.0, atol=1e-9)
    farther = [
        replace(t, floor_boundary=-np.arctan2(v.camera_height_m, 1.05 * v.range_m))
        for v, t in zip(seen, told, strict=True)
    ]
    assert error_table(seen, farther).scale_std < 1e-9


def test_a_camera_looks_where_its_view_says():
    flat = family_of("flat")
    home = make_house("home", flat.style, *flat.size(3), np.random.default_rng(0))
    tour = stills(home, np.random.default_rng(0))
    view, layout = noisy_view(ViewCaster(home), tour, 0, EXACT, np.random.default_rng(0))
    pose = tour.trajectory[0]
    again = ViewCaster(home).view(
        pose.translation[[0, 2]],
        heading_of(pose.rotation),
        tour.camera_height_m - pose.translation[1],
    )
    np.testing.assert_allclose(layout.floor_boundary, again.floor_boundary, atol=1e-12)
    np.testing.assert_array_equal(view.range_m, again.range_m)
