import numpy as np
import pytest
from tests.exporters.model.painted import CAMERAS, HEIGHT, paint, painted_plan, write_panoramas
from tests.exporters.storeys import flat

from panoplan.exporters.model.photos import free_space, reach_of
from panoplan.exporters.model.surfaces import plan_surfaces
from panoplan.exporters.model.texture import EDGE, pictures, read_photos
from panoplan.exporters.storeys import storeys


def textured(folder, **options):
    made = painted_plan()
    photos = read_photos(made, write_panoramas(folder, made, **options))
    surfaces = plan_surfaces(made)
    return surfaces, pictures(surfaces, photos, texel_m=0.05)


def painted_truth(surface, picture):
    """What a picture should show without its edge."""
    rows, columns = np.array(picture.pixels.shape[:2]) - 2 * EDGE
    s = picture.low[0] + picture.size[0] * (np.arange(columns) + 0.5) / columns
    t = picture.low[1] + picture.size[1] * (np.arange(rows) + 0.5) / rows
    grid = np.stack(np.meshgrid(s, t[::-1]), axis=-1).reshape(-1, 2)
    return paint(surface.in_space(grid)).reshape(rows, columns, 3)


def inner(picture):
    return picture.pixels[EDGE:-EDGE, EDGE:-EDGE].astype(float)


def psnr(one, other):
    return 10 * np.log10(255**2 / np.mean((one - other) ** 2))


def test_every_surface_shows_what_is_painted_on_it(tmp_path):
    surfaces, made = textured(tmp_path)
    assert set(made) == {surface.id for surface in surfaces}
    for surface in surfaces:
        truth = painted_truth(surface, made[surface.id])
        assert psnr(inner(made[surface.id]), truth) > 30
        # A picture that is mirrored or turned would not do.
        for wrong in (truth[:, ::-1], truth[::-1]):
            assert psnr(inner(made[surface.id]), wrong) < 25


def test_a_tripod_is_not_on_the_floor(tmp_path):
    surfaces, made = textured(tmp_path, tripod_deg=63)
    floor = made["room_01_floor"]
    red = (inner(floor)[..., 0] > 250) & (inner(floor)[..., 1:].max(axis=-1) < 10)
    assert not red.any()
    assert psnr(inner(floor), painted_truth(surfaces[0], floor)) > 28


def test_a_camera_sees_through_a_door_and_not_through_walls():
    made = flat()
    (floor,) = storeys(made)
    free = free_space(floor)
    camera = made.trajectory[0]
    reach = reach_of(camera, free)
    headings = np.arange(len(reach)) / len(reach) * 2 * np.pi

    def towards(x, y):
        angle = np.arctan2(x - camera.position[0], y - camera.position[1]) % (2 * np.pi)
        return reach[np.argmin(np.abs(headings - angle))]

    # The door is at y from 1 to 1.9 in the wall at x = 4; the next room ends at x = 7.2.
    assert towards(4.0, 1.4) == pytest.approx(np.hypot(6.2, 6.2 * 0.4 / 3.0), abs=0.05)
    assert towards(4.0, 0.5) == pytest.approx(np.hypot(3.0, 0.5), abs=0.05)
    assert towards(0.0, 1.0) == pytest.approx(1.0, abs=0.01)
    assert (
        reach_of(made.trajectory[0].__class__("x", np.array([4.1, 2.5]), 0.0, None), free) is None
    )


def test_photos_stand_where_the_cameras_do(tmp_path):
    made = painted_plan()
    photos = read_photos(made, write_panoramas(tmp_path, made, width=64))
    for photo, (x, y) in zip(photos, CAMERAS, strict=True):
        assert photo.place == pytest.approx([x, HEIGHT, -y])


def test_without_a_photo_there_is_no_picture():
    assert pictures(plan_surfaces(painted_plan()), (), texel_m=0.05) == {}
