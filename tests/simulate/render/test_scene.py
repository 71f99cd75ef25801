"""Rendered buildings: depth by hand, seams, light, the edge between wall and floor."""

import numpy as np
import pytest
import shapely

from panoplan.geometry.sphere import column_heading
from panoplan.simulate.buildings import rectangle, single_room
from panoplan.simulate.flats import make_flat
from panoplan.simulate.render.cast import ray_caster
from panoplan.simulate.render.labels import Labeller
from panoplan.simulate.render.lamp import Lamp
from panoplan.simulate.render.light import bake
from panoplan.simulate.render.looks import draw_look
from panoplan.simulate.render.mesh import MeshBuilder
from panoplan.simulate.render.scene import PREVIEW, STILL, Scene
from panoplan.simulate.render.shell import raise_shell
from panoplan.simulate.walks import about_y, walk

WIDTH = 256


def _elevations(width):
    rows = np.arange(width // 2)
    return np.pi / 2 - np.pi * (rows + 0.5) / (width // 2)


@pytest.fixture(scope="module")
def flat():
    return make_flat(3, opening_share=0.5)


@pytest.fixture(scope="module")
def scene(flat):
    return Scene(flat, 5, PREVIEW, furnished=0.0)


def _standing(scene, room):
    """The freest place of a room, and the camera there, 1.5 m above the floor."""
    polygon = shapely.Polygon(scene.building.rooms[room].polygon)
    free = polygon.difference(shapely.union_all([p.buffer(0.2) for p in scene.furniture.solid]))
    at = shapely.maximum_inscribed_circle(free).centroid if not free.is_empty else polygon.centroid
    return np.array([at.x, at.y]), np.array([at.x, -1.5, at.y])


def test_depth_of_a_box_room_by_hand():
    scene = Scene(single_room(rectangle(4.0, 3.0)), 0, PREVIEW, furnished=0.0)
    camera = np.array([1.0, -1.4, 1.2])
    depth = scene.panorama(camera, np.eye(3), WIDTH).distance_m
    heading = column_heading(np.arange(WIDTH), WIDTH)
    x, z = np.sin(heading), np.cos(heading)
    with np.errstate(divide="ignore"):
        to_x = np.where(x > 0, (4 - 1.0) / x, -1.0 / x)
        to_z = np.where(z > 0, (3 - 1.2) / z, -1.2 / z)
    wall = np.minimum(to_x, to_z)
    elevation = _elevations(WIDTH)[:, None]
    end = np.where(elevation < 0, 1.4 / np.sin(-elevation), (2.5 - 1.4) / np.sin(elevation))
    expected = np.minimum(wall / np.cos(elevation), end)
    same = np.abs(depth - expected) < 1e-4 * expected
    # Lamps and fittings stand before the walls; nothing lies behind them.
    assert same.mean() > 0.5
    assert (depth < expected * 1.0001)[~same].all()


@pytest.mark.parametrize("columns", [1, 37])
def test_turning_the_camera_turns_the_picture_over_the_seam(scene, columns):
    _, camera = _standing(scene, 0)
    turn = about_y(np.array([2 * np.pi * columns / WIDTH]))[0]
    level, turned = (scene.panorama(camera, r, WIDTH) for r in (np.eye(3), turn))
    rolled = np.roll(level.radiance, -columns, axis=1)
    off = np.abs(rolled - turned.radiance).max(axis=2) > 1e-2 * (rolled.max(axis=2) + 0.01)
    assert off.mean() < 0.01


def test_the_true_boundary_is_where_the_floor_ends(scene):
    """A ray just below it meets the floor, one just above does not, unless something hides it."""
    labeller = Labeller(scene)
    width, seen = 512, 0
    step = np.pi / (width // 2)
    for room in range(len(scene.building.rooms)):
        position, camera = _standing(scene, room)
        depth = scene.panorama(camera, np.eye(3), width).distance_m
        closed = labeller.labels(position, 0.0, 1.5, width=width).closed
        boundary = closed.floor_boundary
        elevation = _elevations(width)
        column = np.arange(width)
        below = np.floor((np.pi / 2 - boundary) / step + 0.5).astype(int)
        height = 1.5 + depth * np.sin(elevation)[:, None]
        passages = np.zeros(width, dtype=bool)
        for first, last in np.vstack([closed.spans.doors, closed.spans.openings]).astype(int):
            passages[np.arange(first, first + (last - first) % width + 1) % width] = True
        wall = 1.5 / np.tan(-boundary)
        reach = depth[below, column] * np.cos(elevation[below])
        clear = ~passages & (np.abs(height[below, column]) < 1e-3)
        assert (reach[clear] <= wall[clear] + 1e-3).all()
        above = height[below - 1, column]
        assert (above[clear] > 1e-5).mean() > 0.99
        seen += clear.sum()
    assert seen > 0.4 * width * len(scene.building.rooms)


def test_the_same_seed_gives_the_same_picture(flat, scene):
    _, camera = _standing(scene, 1)
    again = Scene(flat, 5, PREVIEW, furnished=0.0).panorama(camera, np.eye(3), WIDTH)
    other = Scene(flat, 6, PREVIEW, furnished=0.0).panorama(camera, np.eye(3), WIDTH)
    first = scene.panorama(camera, np.eye(3), WIDTH)
    assert first.radiance.tobytes() == again.radiance.tobytes()
    assert not np.array_equal(first.radiance, other.radiance)


def test_a_still_is_the_same_place_in_finer_light(flat):
    _, camera = _standing(Scene(flat, 5, PREVIEW), 0)
    preview, still = (Scene(flat, 5, q).panorama(camera, np.eye(3), 128) for q in (PREVIEW, STILL))
    near = np.abs(preview.distance_m - still.distance_m) < 0.05 * still.distance_m
    assert near.mean() > 0.9
    ratio = np.median(preview.radiance) / np.median(still.radiance)
    assert 0.7 < ratio < 1.4


def test_furniture_stands_in_its_room_and_out_of_the_doors(flat):
    scene = Scene(flat, 11, PREVIEW, furnished=1.0)
    rooms = [shapely.Polygon(room.polygon).buffer(2e-3) for room in flat.rooms]
    assert len(scene.furniture.solid) > 10
    for piece in scene.furniture.solid:
        assert any(room.covers(piece) for room in rooms)
    for a in range(len(scene.furniture.solid)):
        for b in range(a):
            shared = scene.furniture.solid[a].intersection(scene.furniture.solid[b])
            assert shared.area < 0.05
    for passage in flat.passages:
        middle = shapely.Point(passage.faces.mean(axis=(0, 1))).buffer(0.3)
        assert not any(piece.intersects(middle) for piece in scene.furniture.solid)


def _box_light(power, count=4000):
    mesh = MeshBuilder()
    room = single_room(rectangle(4.0, 4.0, (-2.0, -2.0)))
    raise_shell(
        room, draw_look(np.random.default_rng(0)), frozenset(), mesh, np.random.default_rng(0)
    )
    built = mesh.build()
    lamps = (Lamp(np.array([0.0, -1.25, 0.0]), np.full(3, power)),) if power else ()
    rng = np.random.default_rng(0)
    caster = ray_caster(built.triangles)
    return built, bake(built, caster, (), np.zeros(3), lamps, None, PREVIEW.bake, rng)


def test_light_falls_off_from_the_lamp_and_grows_with_its_power():
    built, one = _box_light(1.0)
    _, two = _box_light(2.0)
    _, dark = _box_light(0.0)
    assert dark.light.max() < 0.1
    np.testing.assert_allclose(two.light - dark.light, 2 * (one.light - dark.light), rtol=5e-3)
    floor = int(np.argmax((built.normal[:, 1] < -0.5) & (built.size[:, 0] > 3)))
    texels = slice(one.first[floor], one.first[floor] + np.prod(one.shape[floor]))
    grid = one.light[texels, 1].reshape(one.shape[floor][::-1])
    middle, corner = grid[grid.shape[0] // 2, grid.shape[1] // 2], grid[0, 0]
    assert middle > 2 * corner > 0
    # Lamp and room are symmetric, so is the light.
    np.testing.assert_allclose(grid, grid[::-1], rtol=0.35)


def test_nobody_walks_through_a_shut_door():
    """Every door on the way is open, and its leaf out of the way; others are as they were."""
    through = 0
    for seed in range(4):
        flat = make_flat(seed, rooms=5, area_m2=55, opening_share=0.0)
        way = walk(flat, np.random.default_rng(seed), step_m=0.25).trajectory
        places = way.translations[:, [0, 2]]
        rngs = [np.random.default_rng(9) for _ in range(2)]
        look = draw_look(np.random.default_rng(seed))
        without, shell = (
            raise_shell(flat, look, frozenset(), MeshBuilder(), rng, clear)
            for rng, clear in zip(rngs, (None, places), strict=True)
        )
        through += len(without.shut)
        line = shapely.LineString(places)
        walked = {
            k for k, p in enumerate(flat.passages) if line.intersects(shapely.Polygon(p.area))
        }
        assert not shell.shut & walked
        leaves = shapely.linestrings([leaf for leaf in shell.leaves if np.ptp(leaf, axis=0).any()])
        assert shapely.distance(leaves, line).min() > 0.12
    assert through > 0


def test_an_opening_as_high_as_its_rooms_has_their_ceiling_and_floor():
    """No stripe in the colour of the walls tells where it is."""
    flat, look = make_flat(3, opening_share=1.0), draw_look(np.random.default_rng(1))
    mesh = MeshBuilder()
    raise_shell(flat, look, frozenset(), mesh, np.random.default_rng(0))
    built = mesh.build()
    middle = np.array(
        [built.triangles[built.patch == k].mean((0, 1)) for k in range(len(built.size))]
    )
    colour, flush = built.materials[built.material, 1:4], 0
    for passage in flat.passages:
        if passage.kind == "door":
            continue
        within = shapely.contains_xy(shapely.Polygon(passage.area), middle[:, 0], middle[:, 2])
        (above,), (below,) = (
            np.flatnonzero(within & (s * built.normal[:, 1] > 0.5)) for s in (1, -1)
        )
        assert any(np.allclose(colour[below], floor.colour) for floor in look.floors)
        lowest = min(flat.rooms[k].ceiling_height_m for k in passage.rooms)
        if np.isclose(-built.origin[above, 1], lowest, atol=1e-5):
            np.testing.assert_allclose(colour[above], look.ceiling.colour, rtol=1e-5)
            flush += 1
    assert flush > 0


def test_a_bare_room_is_empty_and_white_and_the_others_are_furnished(flat):
    usual, bare = (Scene(flat, 5, PREVIEW, furnished=1.0, bare=b) for b in (frozenset(), {0}))
    inside = [shapely.Polygon(flat.rooms[k].polygon) for k in (0, 1)]
    stands = [
        [sum(s.intersects(room) for s in scene.furniture.solid) for room in inside]
        for scene in (usual, bare)
    ]
    assert stands[0][0] > 0 == stands[1][0]
    assert stands[1][1] > 0
    _, camera = _standing(bare, 0)
    floors = [scene.panorama(camera, np.eye(3), WIDTH).radiance[-3:] for scene in (usual, bare)]
    tints = [floor.mean(axis=(0, 1)) / floor.mean() for floor in floors]
    assert np.ptp(tints[1]) < 0.15 < np.ptp(tints[0])
