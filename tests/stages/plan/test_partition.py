"""Rooms made one plan, by hand."""

import numpy as np
import pytest
import shapely
from shapely import Polygon

from panoplan.config import Config
from panoplan.stages.plan.partition import partition
from panoplan.types.room import RoomShape

CONFIG = Config().partition


def _room(x0, y0, x1, y1, sigmas=(0.01,) * 4):
    ring = np.array([[x0, y0], [x1, y0], [x1, y1], [x0, y1]], dtype=float)
    return RoomShape(ring, None, sigmas=np.array(sigmas))


def _overlap(shapes):
    areas = [Polygon(s.polygon) for s in shapes if s.polygon is not None]
    return sum(a.area for a in areas) - shapely.union_all(areas).area


def test_a_measured_thickness_is_told_and_nothing_moves():
    rooms = [_room(0, 0, 2, 2), _room(2.1, 0.5, 4, 2)]
    out, (face,) = partition(rooms, CONFIG)
    assert [s.polygon.tolist() for s in out] == [s.polygon.tolist() for s in rooms]
    assert face.thickness == pytest.approx(0.1)
    assert face.measured
    assert face.solid
    assert face.rooms == (0, 1)
    assert face.walls == (1, 3)
    assert face.along == pytest.approx(np.array([[2.05, 0.5], [2.05, 2.0]]))


def test_walls_too_close_move_apart_by_their_variances():
    sure, unsure = (0.005,) * 4, (0.05,) * 4
    (one, other), (face,) = partition([_room(0, 0, 2, 2, sure), _room(2, 0, 4, 2, unsure)], CONFIG)
    # Least squares of a gap of 0 with both variances and the usual thickness with its own.
    own, usual = 0.005**2 + 0.05**2, CONFIG.thickness_sigma_ch**2
    assert face.thickness == pytest.approx(CONFIG.thickness_ch * own / (own + usual))
    assert not face.measured
    moved = one.polygon[1, 0] - 2.0, other.polygon[0, 0] - 2.0
    # The shares are those of the variances.
    assert moved[1] == pytest.approx(-100 * moved[0], rel=1e-6)
    # The other walls stay.
    assert one.polygon[0] == pytest.approx([0.0, 0.0])


def test_an_assumed_thickness_is_that_of_the_other_walls():
    row = [_room(k * 2.15, 0, k * 2.15 + 2, 2) for k in range(4)]
    last = _room(row[-1].polygon[1, 0] + 0.01, 0, row[-1].polygon[1, 0] + 2, 2)
    _, faces = partition([*row, last], CONFIG)
    own, usual = 2 * 0.01**2, CONFIG.thickness_sigma_ch**2
    assert faces[-1].thickness == pytest.approx((0.01 * usual + 0.15 * own) / (own + usual))
    assert [face.measured for face in faces] == [True, True, True, False]


def test_rooms_without_a_wall_between_meet_on_one_line():
    open_left, open_right = (0.01, np.nan, 0.01, 0.01), (0.01, 0.01, 0.01, np.nan)
    out, (face,) = partition(
        [_room(0, 0, 2, 2, open_left), _room(2.02, 0, 4, 2, open_right)], CONFIG
    )
    assert not face.solid
    assert out[0].polygon[1, 0] == pytest.approx(2.01, abs=1e-3)
    assert out[1].polygon[0, 0] == pytest.approx(2.01, abs=1e-3)


def test_what_overlaps_goes_to_the_surer_room():
    sure, unsure = _room(0, 0, 2, 2, (0.005,) * 4), _room(1.5, 0.5, 4, 1.5, (0.05,) * 4)
    for order in ([sure, unsure], [unsure, sure]):
        out, _ = partition(order, CONFIG)
        kept = next(s for s in out if s.polygon[:, 0].min() == 0)
        assert Polygon(kept.polygon).area == pytest.approx(4.0)
        assert _overlap(out) == 0.0


def test_a_room_within_another_is_none():
    out, _ = partition([_room(0, 0, 4, 4, (0.005,) * 4), _room(1, 1, 2, 2, (0.05,) * 4)], CONFIG)
    assert out[1].polygon is None
    assert "other rooms" in out[1].failure


def test_random_rooms_never_overlap():
    rng = np.random.default_rng(5)
    for _ in range(20):
        low = rng.uniform(0, 4, (6, 2))
        size = rng.uniform(0.8, 2.5, (6, 2))
        boxes = np.hstack([low, low + size])
        rooms = [_room(*box, rng.uniform(0.005, 0.05, 4)) for box in boxes]
        out, faces = partition(rooms, CONFIG)
        assert _overlap(out) == pytest.approx(0.0, abs=1e-9)
        for shape in out:
            if shape.polygon is not None:
                assert Polygon(shape.polygon, shape.holes).is_valid
                assert len(shape.sigmas) == len(shape.polygon)
        assert all(face.thickness <= CONFIG.max_thickness_ch for face in faces)


def test_nothing_is_a_plan_too():
    failed = RoomShape(None, "its views agree on no floor")
    assert partition([failed], CONFIG) == ((failed,), ())
    assert partition([], CONFIG) == ((), ())


def test_an_outline_that_crosses_itself_is_cut_like_others():
    bow = np.array([[0, 0], [2, 0], [2, 2], [1, -0.5], [0, 2]], dtype=float)
    crossed = RoomShape(bow, None, sigmas=np.full(5, 0.05))
    out, _ = partition([_room(0.5, -1, 1.5, 1), crossed], CONFIG)
    assert _overlap([shape for shape in out if shape.polygon is not None]) < 1e-9
