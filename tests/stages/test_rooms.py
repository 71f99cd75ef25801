from dataclasses import replace

import numpy as np
import pytest
from tests.scenes import RECTANGLE, walk

from panoplan.config import RegistrationConfig, RoomsConfig
from panoplan.stages import rooms
from panoplan.stages.registration import cast, register
from panoplan.types.layout import Layout

CONFIG = RoomsConfig()
NEXT, AWAY = np.array([4.1, 0.0]), np.array([10.0, 0.0])
PAPER = replace(CONFIG, normalise="running_max", membership="camera")


def _patches(polygon, cameras, config=CONFIG):
    keyframes = walk(polygon, cameras)
    origin = np.zeros(3)
    views = [
        register(cast(k, i, origin, np.eye(2), RegistrationConfig()), 1.0)
        for i, k in enumerate(keyframes)
    ]
    return [rooms.clipped_patch(view, config) for view in views]


def test_patch_of_a_rectangle_has_its_area():
    (patch,) = _patches(RECTANGLE, [[0.3, 0.2]])
    area = patch.density.mask.sum() * CONFIG.cell_ch**2
    assert area == pytest.approx(12.0, rel=0.01)


def test_patch_is_clipped_at_the_radius():
    (patch,) = _patches(RECTANGLE, [[0.0, 0.0]], replace(CONFIG, clip_radius_ch=1.0))
    area = patch.density.mask.sum() * CONFIG.cell_ch**2
    assert area == pytest.approx(np.pi, rel=0.01)


def test_the_public_codes_clip_spares_points_below_its_trigger():
    """Ranges are 1.5 to 2.5; the lower quartile is about 1.56."""
    (spared,) = _patches(RECTANGLE, [[0, 0]], replace(CONFIG, clip_radius_ch=1.0, clip_quartiles=6))
    assert spared.density.mask.sum() * CONFIG.cell_ch**2 == pytest.approx(12.0, rel=0.01)
    (moved,) = _patches(
        RECTANGLE, [[0, 0]], replace(CONFIG, clip_radius_ch=1.8, clip_quartiles=1.2)
    )
    area = moved.density.mask.sum() * CONFIG.cell_ch**2
    inside = np.hypot(*(np.indices((801, 601)) / 200 - np.array([2.0, 1.5])[:, None, None]))
    assert area == pytest.approx(12.0 * np.mean(inside <= 1.8), rel=0.02)


def test_overlap_over_the_union_is_that_of_a_part_in_its_whole():
    whole, part = _patches(RECTANGLE, [[0, 0]]), _patches(RECTANGLE / 2, [[0, 0]])
    one, other = whole[0].density, part[0].density
    assert rooms.overlap(one, other) == pytest.approx(1.0)
    assert rooms.overlap(one, other, "union") == pytest.approx(0.25, abs=0.01)


def test_running_maximum_halves_old_evidence_each_time():
    """Algorithm 1: a cell unseen for two views is at a quarter."""
    (far,) = _patches(RECTANGLE + AWAY, [[10, 0]], PAPER)
    (near,) = _patches(RECTANGLE, [[0, 0]], PAPER)
    room = rooms.add(far.density, near.density, PAPER)
    for _ in range(2):
        room = rooms.add(room, near.density, PAPER)
    values = np.unique(rooms.density(room, PAPER))
    np.testing.assert_allclose(values[values > 0], [0.25, 1.0])


@pytest.mark.parametrize("config", [CONFIG, PAPER], ids=["sound", "paper"])
def test_a_second_camera_in_the_room_is_in_the_room(config):
    first, second = _patches(RECTANGLE, [[0, 0], [1.2, 0.8]], config)
    chosen, scores = rooms.choose(second, [first.density], 0, config)
    assert chosen == 0
    assert scores[0] > 0.9


@pytest.mark.parametrize("config", [CONFIG, PAPER], ids=["sound", "paper"])
def test_a_camera_in_the_next_room_opens_a_room(config):
    (first,) = _patches(RECTANGLE, [[0, 0]], config)
    (other,) = _patches(RECTANGLE + NEXT, [[4.1, 0]], config)
    assert rooms.choose(other, [first.density], 0, config)[0] is None


@pytest.mark.parametrize("config", [CONFIG, PAPER], ids=["sound", "paper"])
def test_a_camera_that_returns_is_in_the_earlier_room(config):
    first, back = _patches(RECTANGLE, [[0, 0], [-1, 0.5]], config)
    (other,) = _patches(RECTANGLE + NEXT, [[4.1, 0]], config)
    assert rooms.choose(back, [first.density, other.density], 1, config)[0] == 0


def test_a_camera_in_the_doorway_belongs_to_the_room_it_looks_into():
    """The camera stands in the wall, outside the mask; its layout fills the room."""
    (first,) = _patches(RECTANGLE, [[0, 0]])
    niche = np.array(
        [[-2, -1.5], [2, -1.5], [2, -0.4], [2.15, -0.4], [2.15, 0.4], [2, 0.4], [2, 1.5], [-2, 1.5]]
    )
    (door,) = _patches(niche, [[2.08, 0.0]])
    assert rooms.choose(door, [first.density], 0, CONFIG)[0] == 0
    assert rooms.choose(door, [first.density], 0, PAPER)[0] is None


def test_one_leaking_view_does_not_widen_the_mask():
    clean = _patches(RECTANGLE, [[x, 0.5] for x in (0.3, 0.6, 0.9, 1.2)])
    leak = np.array(
        [[-2, -1.5], [2, -1.5], [2, -0.3], [3.5, -0.3], [3.5, 0.3], [2, 0.3], [2, 1.5], [-2, 1.5]]
    )
    (leaking,) = _patches(leak, [[0.0, 0.0]])
    room = clean[0].density
    for patch in [*clean[1:], leaking]:
        room = rooms.add(room, patch.density, CONFIG)
    area = room.mask.sum() * CONFIG.cell_ch**2
    assert area == pytest.approx(12.0, rel=0.03)


def test_unknown_columns_say_nothing():
    keyframe = walk(RECTANGLE, [[0.0, 0.0]])[0]
    blind = replace(keyframe, layout=Layout(np.full(1024, np.nan)))
    view = register(cast(blind, 0, np.zeros(3), np.eye(2), RegistrationConfig()), 1.0)
    patch = rooms.clipped_patch(view, CONFIG)
    assert patch.area_cells == 0
    assert patch.density.against.sum() == 0
