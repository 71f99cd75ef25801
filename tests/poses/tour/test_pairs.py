"""Features, matches and hypotheses of two panoramas of one painted box."""

from dataclasses import replace

import numpy as np
import pytest

from panoplan.config import TourConfig
from panoplan.geometry.upright import WALL
from panoplan.poses.tour.features import Features, upright_features
from panoplan.poses.tour.matching import Matches, match
from panoplan.poses.tour.twoview import hypotheses

CONFIG = TourConfig(first_octave=0)
HALF = np.array([2.0, 1.0, 2.5])  # x, y down, z
WIDTH = 1024


@pytest.fixture(scope="module")
def painting():
    """Six faces of coloured noise, as a function of a point on the box."""
    from scipy.ndimage import gaussian_filter

    rng = np.random.default_rng(5)
    faces = []
    for _ in range(6):
        layers = [gaussian_filter(rng.standard_normal((400, 400)), s) * s for s in (2, 5, 12)]
        face = sum(layers)
        faces.append((face - face.min()) / np.ptp(face))

    def colour(points):
        unit = points / HALF
        axis = np.argmax(np.abs(unit), axis=-1)
        value = np.zeros(points.shape[:-1])
        for k in range(3):
            others = [j for j in range(3) if j != k]
            for side in (0, 1):
                on = (axis == k) & ((unit[..., k] > 0) == bool(side))
                at = np.clip(((unit[on][:, others] + 1) * 199.5).astype(int), 0, 399)
                value[on] = faces[2 * k + side][at[:, 0], at[:, 1]]
        return value

    return colour


def panorama(colour, x, z, yaw, width=WIDTH):
    heading = 2 * np.pi * (np.arange(width) + 0.5) / width - np.pi + yaw
    elevation = np.pi / 2 - np.pi * (np.arange(width // 2) + 0.5) / (width // 2)
    cos = np.cos(elevation)[:, None]
    rays = np.stack(
        [cos * np.sin(heading), np.broadcast_to(-np.sin(elevation)[:, None], (width // 2, width)),
         cos * np.cos(heading)], axis=-1,
    )  # fmt: skip
    at = np.array([x, 0.0, z])
    with np.errstate(divide="ignore"):
        distance = np.min((np.sign(rays) * HALF - at) / rays, axis=-1)
    return np.asarray(255 * colour(at + rays * distance[..., None]), dtype=np.uint8)


@pytest.fixture(scope="module")
def two(painting):
    pytest.importorskip("pycolmap", reason="the extra 'images' is not installed")
    images = (panorama(painting, 0.0, 0.0, 0.0), panorama(painting, 0.6, -0.8, 2.0))
    return tuple(upright_features(image, CONFIG) for image in images)


def hypotheses_of(matches):
    return hypotheses(matches, np.full(len(matches), WALL), np.zeros(240), CONFIG)


def test_features_keep_to_their_rows_and_turn_with_the_camera(two, painting):
    first = two[0]
    assert np.rad2deg(first.elevations).min() > CONFIG.lowest_elevation_deg - 0.5
    assert np.rad2deg(first.elevations).max() < CONFIG.highest_elevation_deg + 0.5
    assert np.rad2deg(np.abs(first.elevations)).min() >= CONFIG.horizon_deg
    turned = upright_features(panorama(painting, 0.0, 0.0, np.pi / 2), CONFIG)
    matches = match(first, turned, replace(CONFIG, max_ratio=0.7))
    shift = matches.angles[:, 0] - matches.angles[:, 2] - np.pi / 2
    shift = (shift + np.pi) % (2 * np.pi) - np.pi
    assert len(matches) > 200
    assert np.mean(np.abs(shift) < np.deg2rad(0.3)) > 0.97
    # Features at the image's seam are found in either.
    assert np.abs(matches.angles[:, 0]).max() > np.deg2rad(179)


def test_matches_are_one_a_cell_and_of_one_side_of_the_horizon(two):
    angles = match(*two, CONFIG).angles
    assert 100 < len(angles) <= CONFIG.max_matches
    assert np.all(angles[:, 1] * angles[:, 3] > 0)
    for columns in ((0, 1), (2, 3)):
        cells = angles[:, columns] // np.deg2rad(CONFIG.match_cell_deg)
        assert len(np.unique(cells, axis=0)) == len(cells)


def test_the_second_camera_is_found(two):
    found = hypotheses_of(match(*two, CONFIG))
    best = found[0]
    assert best.yaw == pytest.approx(2.0, abs=np.deg2rad(0.3))
    assert best.direction == pytest.approx(np.arctan2(0.6, -0.8), abs=np.deg2rad(0.6))
    assert best.evidence > 100
    assert all(other.evidence < best.evidence / 2 for other in found[1:])


def test_nothing_in_common_gives_no_strong_hypothesis(two):
    rng = np.random.default_rng(0)
    strange = Features(
        two[1].headings,
        two[1].elevations,
        two[1].sizes,
        rng.integers(0, 255, two[1].descriptors.shape).astype(np.uint8),
    )
    found = hypotheses_of(match(two[0], strange, CONFIG))
    assert [h.evidence for h in found if h.evidence >= 20] == []


def test_a_blank_image_has_no_features_and_no_hypotheses(two):
    blank = upright_features(np.full((WIDTH // 2, WIDTH), 128, dtype=np.uint8), CONFIG)
    assert len(blank) == 0
    matches = match(two[0], blank, CONFIG)
    assert len(matches) == 0
    assert hypotheses_of(matches) == ()


def seen_from(points, heights, yaw, camera):
    """(N, 4) headings and elevations of points in two cameras, the first at the origin."""
    angles = []
    for place, turn in ((np.zeros(2), 0.0), (np.asarray(camera), yaw)):
        off = points - place
        heading = np.arctan2(off[:, 0], off[:, 1]) - turn
        angles += [(heading + np.pi) % (2 * np.pi) - np.pi, np.arctan2(heights, np.hypot(*off.T))]
    return np.column_stack(angles)


def test_one_bookcase_does_not_hide_where_all_else_agrees():
    rng = np.random.default_rng(0)
    around = rng.uniform(-3, 3, (20, 2))
    rest = seen_from(around, rng.choice([-0.5, 0.6], 20), 0.8, [0.9, 0.5])
    books = np.column_stack([rng.uniform(2.0, 2.3, 400), np.full(400, 2.5)])
    other = seen_from(books, rng.uniform(-0.5, -0.1, 400), -1.9, [-0.4, 1.1])
    angles = np.vstack([rest, other]) + np.deg2rad(0.1) * rng.standard_normal((420, 4))
    best = hypotheses_of(Matches(angles, np.ones(420)))[0]
    assert best.yaw == pytest.approx(0.8, abs=np.deg2rad(1.0))
    assert best.direction == pytest.approx(np.arctan2(0.9, 0.5), abs=np.deg2rad(2.0))
