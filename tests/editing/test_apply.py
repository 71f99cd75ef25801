from dataclasses import replace

import numpy as np
import pytest
from tests.metrics.plans import FLAT, plan, square, turned

from panoplan.editing.apply import apply
from panoplan.editing.change import changed
from panoplan.errors import InputError
from panoplan.types.edits import Edits


def edited(made, **words):
    return apply(made, changed(Edits(), made, **words))


def wall(made, name):
    return next(w for room in made.rooms for w in room.walls if w.id == name)


def length(made, name):
    item = wall(made, name)
    return float(np.hypot(*(item.b - item.a)))


def scaled_scale(made, factor):
    """The same home by another estimate of the scale, in other units."""
    rooms = tuple(
        replace(
            room,
            polygon=factor * room.polygon,
            walls=tuple(replace(w, a=factor * w.a, b=factor * w.b) for w in room.walls),
        )
        for room in made.rooms
    )
    scale = replace(made.scale, ch_per_su=made.scale.ch_per_su * factor * made.camera_height_m)
    return replace(made, rooms=rooms, unit="ch", camera_height_m=None, metric=None, scale=scale)


def renumbered(made):
    """The same rooms in another order under other ids."""
    rooms = []
    for number, room in enumerate(reversed(made.rooms), 1):
        walls = tuple(
            replace(w, id=f"wall_{90 + 10 * number + k}") for k, w in enumerate(room.walls)
        )
        rooms.append(replace(room, id=f"room_{number:02d}", walls=walls))
    return replace(made, rooms=tuple(rooms))


def test_no_edits_change_nothing():
    made = plan()
    again = apply(made, Edits())
    assert again.factor == 1.0
    assert again.lost == ()
    assert again.plan.rooms == made.rooms


def test_a_name():
    made = edited(plan(), names=["room_02=Küche = <b>"]).plan
    assert [room.name for room in made.rooms] == ["Room 1", "Küche = <b>", "Room 3"]


def test_a_length_scales_everything():
    before = plan(unit="ch")
    after = edited(before, lengths=["wall_00=6.0"])
    made = after.plan
    assert after.factor == pytest.approx(1.5)
    assert made.unit == "m"
    assert made.metric.source == "length"
    assert made.camera_height_m == pytest.approx(1.5)
    assert length(made, "wall_00") == pytest.approx(6.0)
    assert made.rooms[1].polygon == pytest.approx(1.5 * FLAT[1])
    assert made.rooms[0].ceiling_height == pytest.approx(1.5 * 2.5)
    assert made.rooms[0].area_sigma == pytest.approx(1.5**2 * 0.2)
    assert wall(made, "wall_00").sigma == pytest.approx(1.5 * 0.02)
    assert wall(made, "wall_00").length_sigma == pytest.approx(1.5 * 0.03)
    assert made.doors[0].segment == pytest.approx(1.5 * before.doors[0].segment)
    assert made.trajectory[1].position == pytest.approx(1.5 * before.trajectory[1].position)
    assert made.shared_walls[0].thickness == pytest.approx(1.5 * 0.12)


def test_two_lengths_are_weighed_by_how_sure_they_are():
    # By the tape, and by the estimated lengths, 3 cm each.
    one = np.hypot(0.005 / 4.2, 0.03 / 4.0)
    two = np.hypot(0.005 / 2.4, 0.03 / 2.0)
    weights = np.array([one, two]) ** -2
    made = plan((square(0, 0, 4.0), square(5, 0, 2.0)))
    after = edited(made, lengths=["wall_00=4.2", "wall_10=2.4"])
    assert after.factor == pytest.approx(weights @ [1.05, 1.2] / weights.sum())
    single = edited(made, lengths=["wall_00=4.2"]).plan.metric.sigma
    assert single == pytest.approx(one)
    # They disagree by far more than they should.
    assert after.plan.metric.sigma > 3 * single
    agree = edited(made, lengths=["wall_00=4.2", "wall_10=2.1"]).plan.metric.sigma
    assert agree < single


def test_a_door_height():
    made = plan(unit="ch")
    # The door's middle is 3.03 m from the camera at (1, 1); its edge is seen 10° up.
    rows = 1024
    row = (np.pi / 2 - np.deg2rad(10.0)) / np.pi * rows - 0.5
    after = edited(made, door_heights=[f"door_01=2.0@kf0,{row}/{rows}"])
    estimated = 1.0 + np.hypot(3.0, 0.45) * np.tan(np.deg2rad(10.0))
    assert after.factor == pytest.approx(2.0 / estimated)
    assert after.plan.metric.source == "door height"
    # The door 0.5 %; of 1.54: the place 0.02 of 0.54, the height 0.012 of 1, the row by itself.
    marked = 1.5 * np.pi / rows * np.hypot(3.0, 0.45) / np.cos(np.deg2rad(10.0)) ** 2
    parts = [0.01 / 2.0, *(np.array([0.02 * (estimated - 1), 0.012, marked]) / estimated)]
    assert after.plan.metric.sigma == pytest.approx(np.linalg.norm(parts), rel=0.01)


@pytest.mark.parametrize("change", [renumbered, lambda made: scaled_scale(made, 1.3)])
def test_edits_outlive_a_new_estimate(change):
    before = plan()
    words = {"names": ["room_03=Bath"], "lengths": ["wall_00=4.4"], "nudges": ["wall_22=0.1"]}
    edits = changed(Edits(), before, **words)
    old, new = apply(before, edits), apply(change(before), edits)
    assert new.lost == ()
    by_name = {room.name: room for room in new.plan.rooms}
    assert by_name["Bath"].polygon == pytest.approx(
        next(r for r in old.plan.rooms if r.name == "Bath").polygon
    )


def test_what_finds_no_place_is_told():
    edits = changed(
        Edits(), plan(), names=["room_03=Bath"], lengths=["wall_22=5.8"], nudges=["wall_20=0.1"]
    )
    after = apply(plan(FLAT[:2]), edits)
    assert len(after.lost) == 3
    assert any("'Bath'" in what for what in after.lost)
    assert after.factor == 1.0
    assert [room.name for room in after.plan.rooms] == ["Room 1", "Room 2"]


def test_faces_of_one_wall_are_told_apart():
    made = plan((square(0, 0), square(2.05, 0)))
    edits = changed(Edits(), made, nudges=["wall_01=-0.2"])
    after = apply(made, edits).plan
    assert after.rooms[0].polygon[:, 0].max() == pytest.approx(1.8)
    assert after.rooms[1].polygon == pytest.approx(made.rooms[1].polygon)


def test_a_later_edit_takes_the_place_of_an_older_one():
    made = plan()
    edits = changed(Edits(), made, names=["room_01=A", "room_02=B"], lengths=["wall_00=5"])
    edits = changed(edits, made, names=["room_01=C"], lengths=["wall_00=6"])
    assert [item.name for item in edits.names] == ["B", "C"]
    assert [item.metres for item in edits.lengths] == [6.0]
    edits = changed(edits, made, drop=["room_02", "wall_00"])
    assert [item.name for item in edits.names] == ["C"]
    assert edits.lengths == ()


@pytest.mark.parametrize(
    ("words", "told"),
    [
        ({"names": ["room_9=x"]}, "room_01, room_02|room_0"),
        ({"names": ["room_01"]}, "ID=VALUE"),
        ({"names": ["room_01= "]}, "1 to 200 characters"),
        ({"names": ["room_01=" + "x" * 10_000]}, "10000 characters"),
        ({"lengths": ["wall_00=nan"]}, "metres"),
        ({"lengths": ["wall_00=0"]}, "0.05 to 1000"),
        ({"nudges": ["wall_00=far"]}, "metres"),
        ({"door_heights": ["door_01=2"]}, "KEYFRAME"),
        ({"door_heights": ["door_01=2@kf0,5/8"]}, "16 rows"),
        ({"door_heights": ["door_01=20@kf0,5/512"]}, "10 metres"),
        ({"drop": ["wall_xx"]}, "wall_"),
    ],
)
def test_what_is_not_an_edit_is_told(words, told):
    with pytest.raises(InputError, match=told):
        changed(Edits(), plan(), **words)


def test_a_turned_home():
    before = plan([turned(ring, 0.6, (3.0, 1.0)) for ring in FLAT])
    after = edited(before, lengths=["wall_00=8.0"]).plan
    assert after.rooms[0].polygon == pytest.approx(2.0 * before.rooms[0].polygon)
