"""Tours of made-up rooms, their features made up as well: what joins them and what must not."""

from dataclasses import replace

import numpy as np
import pytest

from panoplan.config import Config, RegistrationConfig, TourConfig
from panoplan.geometry.rigid import heading_of
from panoplan.poses.tour.features import Features
from panoplan.poses.tour.frames import relative
from panoplan.poses.tour.heading import quarter_difference, wall_heading, yaw_prior
from panoplan.poses.tour.matching import Matches, without_distant
from panoplan.poses.tour.pair import Pair, Place
from panoplan.poses.tour.room import log_surface_ranges, room_seen
from panoplan.poses.tour.tour import join_tour
from panoplan.simulate.buildings import l_shape, single_room
from panoplan.simulate.views import ViewCaster
from panoplan.types.layout import Spans

HEIGHT = 1.5
POSES = np.array(
    [[1.0, 1.2, 0.3], [2.6, 1.0, -1.0], [4.4, 1.3, 2.0], [1.2, 3.0, 0.9], [2.0, 2.1, -2.5]]
)


class Home:
    """One room with points on its walls and floor, each of a look of its own."""

    def __init__(self, seed, size=(6.0, 5.0, 2.5, 2.5)):
        rng = np.random.default_rng(seed)
        polygon = l_shape(*size)
        self.caster = ViewCaster(single_room(polygon))
        start, end = polygon, np.roll(polygon, -1, axis=0)
        length = np.hypot(*(end - start).T)
        edge = rng.choice(len(polygon), 260, p=length / length.sum())
        self.points = start[edge] + rng.uniform(size=(260, 1)) * (end - start)[edge]
        self.heights = rng.uniform(-HEIGHT, 0.9, 260)
        self.looks = rng.integers(0, 255, (260, 128)).astype(np.uint8)

    def view(self, pose):
        pose = np.asarray(pose)
        return self.caster.view(pose[:2], pose[2], HEIGHT)

    def features(self, pose, rng, noise_deg=0.15):
        """What a camera sees of the points, and as many things of no meaning."""
        away = self.points - pose[:2]
        distance = np.hypot(*away.T)
        heading = (np.arctan2(*away.T) - pose[2] + np.pi) % (2 * np.pi) - np.pi
        view = self.view(pose)
        column = ((heading + np.pi) * 1024 / (2 * np.pi)).astype(int) % 1024
        seen = distance < view.range_m[column] + 0.1
        elevation = np.arctan2(self.heights, distance)
        seen &= np.abs(elevation) > np.deg2rad(1.5)
        noise = np.deg2rad(noise_deg) * rng.standard_normal((2, len(seen)))
        count = 150
        return Features(
            np.concatenate([(heading + noise[0])[seen], rng.uniform(-np.pi, np.pi, count)]),
            np.concatenate([(elevation + noise[1])[seen], rng.choice([-1, 1], count)
                            * rng.uniform(0.05, 0.9, count)]),
            np.full(seen.sum() + count, 0.01),
            np.vstack([self.looks[seen], rng.integers(0, 255, (count, 128))]).astype(np.uint8),
        )  # fmt: skip


def joined(shots, config=None):
    """A tour of (home, pose) pairs."""
    config = config or Config()
    rng = np.random.default_rng(0)
    seen = {f"p{k}": home.features(pose, rng) for k, (home, pose) in enumerate(shots)}
    layouts = {f"p{k}": home.view(pose).layout for k, (home, pose) in enumerate(shots)}
    blank = np.zeros((2, 4), dtype=np.uint8)
    return join_tour(
        dict.fromkeys(seen, blank),
        layouts,
        config,
        lambda done, total, what: None,
        lambda name, image, settings: seen[name],
    )


@pytest.fixture(scope="module")
def one_home():
    home = Home(0)
    return joined([(home, pose) for pose in POSES])


def test_photos_of_one_room_are_placed(one_home):
    (group,) = one_home.groups
    assert group.photos == ("p0", "p1", "p2", "p3", "p4")
    true = np.array([relative(POSES[0], pose) for pose in POSES])
    off = group.poses - true / [HEIGHT, HEIGHT, 1.0]
    assert np.hypot(*off[:, :2].T).max() * HEIGHT < 0.05
    assert np.rad2deg(np.abs(off[:, 2])).max() < 0.3
    assert one_home.reasons == {}


def test_covariances_hold(one_home):
    (group,) = one_home.groups
    true = np.array([relative(POSES[0], pose) for pose in POSES]) / [HEIGHT, HEIGHT, 1.0]
    assert np.all(group.covariances[0] == 0)
    squares = [
        d @ np.linalg.solve(c, d)
        for d, c in zip(group.poses[1:] - true[1:], group.covariances[1:], strict=True)
    ]
    assert max(squares) < 16.3  # one in a thousand of three unknowns
    sigma = np.sqrt([np.trace(c[:2, :2]) for c in group.covariances[1:]])
    assert sigma.max() * HEIGHT < 0.3


def test_the_trajectory_has_the_poses(one_home):
    (group,) = one_home.groups
    trajectory = group.trajectory()
    assert trajectory.labels == group.photos
    assert trajectory.translations[:, [0, 2]] == pytest.approx(group.poses[:, :2])
    assert [heading_of(r) for r in trajectory.rotations] == pytest.approx(group.poses[:, 2])


def test_two_homes_are_two_groups_and_told():
    here, there = Home(0), Home(1)
    shots = [(here, POSES[0]), (there, POSES[1]), (here, POSES[4]), (here, POSES[1]),
             (there, POSES[4])]  # fmt: skip
    result = joined(shots)
    assert [group.photos for group in result.groups] == [("p0", "p2", "p3"), ("p1", "p4")]
    assert set(result.reasons) == {"p1", "p4"}
    assert "nats" in result.reasons["p1"] or "common" in result.reasons["p1"]


def test_a_photo_alone_and_none():
    result = joined([(Home(0), POSES[0])])
    assert [group.photos for group in result.groups] == [("p0",)]
    assert joined([]).groups == ()


def test_what_a_config_demands_is_demanded():
    home = Home(0)
    strict = replace(Config(), tour=TourConfig(merge_evidence=100_000.0))
    result = joined([(home, POSES[0]), (home, POSES[1])], strict)
    assert len(result.groups) == 2
    assert "100000 are needed" in result.reasons["p1"]
    (guess,) = result.guesses
    assert guess.poses[0, :2] * HEIGHT == pytest.approx(relative(POSES[0], POSES[1])[:2], abs=0.05)


@pytest.mark.parametrize("turn", [0.0, 0.35, 1.2, -2.0])
def test_the_walls_heading_turns_with_the_camera(turn):
    home, config = Home(0), TourConfig()
    seen = wall_heading(room_seen(home.view([2.0, 2.1, turn]).layout, RegistrationConfig()), config)
    # Walls run along the axes: at heading −turn in the camera's frame.
    assert np.rad2deg(abs(quarter_difference(seen.heading, -turn))) < 0.3
    assert seen.share > 0.6
    prior = yaw_prior(seen, seen, 240, config)
    assert prior[[0, 60, 120, 180]] == pytest.approx(prior.max())
    assert prior.max() > 2
    assert np.all(prior[5:56] < 0)
    assert prior.min() > -3


def test_the_first_surface_is_floor_wall_or_ceiling():
    room = room_seen(Home(0).view([1.0, 1.2, 0.0]).layout, RegistrationConfig())
    # Looking back at the wall 1.2 m away (0.8 camera heights): the floor meets it at 51°.
    heading = np.full(3, np.pi - 1e-3)
    rays = heading, np.deg2rad([-60.0, -20.0, 70.0])
    logs, sigmas, level, passage = log_surface_ranges(room, *rays)
    ceiling = (2.5 - HEIGHT) / HEIGHT
    expected = [1 / np.tan(np.deg2rad(60)), 0.8, ceiling / np.tan(np.deg2rad(70))]
    assert np.exp(logs) == pytest.approx(expected, rel=0.02)
    assert level.tolist() == [True, False, True]
    assert not passage.any()
    assert np.all(sigmas > 0)


def test_the_wall_has_a_passage_where_the_layout_tells_a_door():
    layout = Home(0).view([1.0, 1.2, 0.0]).layout
    # Over the image's edge, where the wall behind the camera is.
    spans = Spans(np.array([[layout.width - 20, 30]]), np.empty((0, 2)), np.empty((0, 2)))
    room = room_seen(replace(layout, spans=spans), RegistrationConfig())
    heading = np.array([np.pi - 1e-3, -np.pi + 1e-3, 1e-3, np.pi - 1e-3])
    elevation = np.deg2rad([-20.0, 10.0, -20.0, -60.0])
    *_, passage = log_surface_ranges(room, heading, elevation)
    assert passage.tolist() == [True, True, False, False]


def test_what_is_far_outside_tells_no_place():
    layout = Home(0).view([1.0, 1.2, 0.0]).layout
    # The middle of the image is a window, its edge a door.
    spans = Spans(np.array([[1000, 23]]), np.empty((0, 2)), np.array([[480, 540]]))
    room = room_seen(replace(layout, spans=spans), RegistrationConfig())
    middle, edge, wall, same = 0.0, np.pi - 1e-3, 1.0, np.deg2rad(7.0)
    angles = np.array(
        [
            [middle, same, middle, same + np.deg2rad(0.1)],
            [middle, same, edge, same],
            [middle, same, middle, same + np.deg2rad(2.0)],
            [middle, same, wall, same],
            [wall, same, wall, same],
        ]
    )
    matches = Matches(angles, np.arange(1.0, 6.0))
    assert without_distant(matches, room, room, TourConfig()).prior.tolist() == [3.0, 4.0, 5.0]
    assert without_distant(matches, room, None, TourConfig()) is matches


def test_two_photos_near_in_one_room_must_have_much_in_common():
    """Rectangles fit rectangles: the walls alone would take two like rooms for one."""
    view = Home(0).view([1.0, 1.2, 0.0]).layout
    config = TourConfig()
    place = Place("a", room_seen(view, RegistrationConfig()), None)
    nothing = Matches(np.empty((0, 4)), np.empty(0))
    pair = Pair(place, replace(place, name="b"), nothing, config)
    near = pair.evidence(np.array([0.0, 0.01, 0.0])).walls
    assert near == pytest.approx(config.walls_cap - config.same_room_cost)
    lax = Pair(place, replace(place, name="b"), nothing, replace(config, same_room_near_ch=0.0))
    assert lax.evidence(np.array([0.0, 0.01, 0.0])).walls == pytest.approx(config.walls_cap)
