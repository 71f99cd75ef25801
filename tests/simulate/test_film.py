import numpy as np
import pytest
import shapely

from panoplan.simulate.families import make_building
from panoplan.simulate.film import PACE, film


@pytest.fixture(scope="module")
def films():
    made = []
    for family, seed in (("flat", 3), ("flat", 8), ("mp3d-fpe", 6)):
        building = make_building(family, seed)
        made.append((building, film(building, np.random.default_rng(seed))))
    return made


def test_every_room_is_filmed_and_only_from_inside(films):
    for building, way in films:
        assert set(way.rooms.tolist()) == set(range(len(building.rooms)))
        floors = [room.floor for room in building.rooms]
        floors += [shapely.Polygon(p.area) for p in building.passages]
        inside = shapely.union_all(floors).buffer(1e-6)
        assert inside.covers(shapely.LineString(way.frames.translations[:, [0, 2]]))


def test_a_person_walks_no_faster_than_that_and_slows_down_to_turn(films):
    for _, way in films:
        moved = np.diff(way.frames.translations[:, [0, 2]], axis=0)
        speed = np.hypot(*moved.T) * PACE.frames_per_s
        assert speed.max() < 1.16 * PACE.speed_m_s
        assert 0.5 < np.median(speed) < 1.1
        heading = np.arctan2(way.frames.rotations[:, 0, 2], way.frames.rotations[:, 2, 2])
        turning = np.abs(np.angle(np.exp(1j * np.diff(heading)))) * PACE.frames_per_s
        assert np.rad2deg(np.quantile(turning, 0.99)) < 1.4 * PACE.turn_deg_s
        sharp = turning > np.deg2rad(0.9 * PACE.turn_deg_s)
        assert speed[sharp].min() < 0.6 * np.median(speed)


def test_the_camera_rises_and_falls_with_the_steps_and_tilts_a_little(films):
    for _, way in films:
        rise = way.frames.translations[:, 1]
        assert 0.008 < rise.std() < 0.025
        spectrum = np.abs(np.fft.rfft(rise - rise.mean())) ** 2
        hertz = np.fft.rfftfreq(len(rise), 1 / PACE.frames_per_s)
        stepping = (hertz > 1.2) & (hertz < 2.2)
        assert spectrum[stepping].sum() > 0.3 * spectrum.sum()
        down = np.arccos(np.clip(way.frames.rotations[:, 1, 1], -1, 1))
        tilt = np.rad2deg(np.sqrt(np.mean(down**2)))
        assert tilt == pytest.approx(PACE.tilt_deg * np.sqrt(2), rel=0.25)


def test_keyframes_are_frames_closer_together_in_small_rooms(films):
    for building, way in films:
        index = [int(label) - 1 for label in way.trajectory.labels]
        assert index[0] == 0
        np.testing.assert_array_equal(way.frames.translations[index], way.trajectory.translations)
        assert np.all(np.diff(index) > 0)
        path = way.frames.translations[:, [0, 2]]
        gone = np.concatenate([[0.0], np.cumsum(np.hypot(*np.diff(path, axis=0).T))])
        steps = np.diff(gone[index])
        assert steps.max() < 1.25 * PACE.keyframe_m[1] + 0.12
        sides = np.sqrt([room.area for room in building.rooms])[way.rooms[:-1]]
        usual = np.clip(PACE.parallax * sides, *PACE.keyframe_m)
        assert np.median(steps / usual) == pytest.approx(1.0, abs=0.2)


def test_the_height_is_the_one_given_and_the_seed_decides():
    building = make_building("flat", 5)
    way, again = (film(building, np.random.default_rng(1), camera_height_m=1.3) for _ in range(2))
    assert way.camera_height_m == 1.3
    np.testing.assert_array_equal(way.trajectory.translations, again.trajectory.translations)
