"""Made-up homes photographed as estate agents do."""

import numpy as np
import pytest
import shapely

from panoplan.simulate.render.tour import tour_home


@pytest.mark.parametrize("seed", [0, 25])
def test_every_room_has_a_photo_and_large_ones_more(seed):
    home = tour_home(seed)
    rooms = home.building.rooms
    assert len(home.keyframes) == round(1.7 * len(rooms))
    x, z = home.truth.trajectory.translations[:, [0, 2]].T
    photos = np.array([shapely.intersects_xy(room.floor, x, z).sum() for room in rooms])
    assert photos.min() >= 1
    areas = [room.area for room in rooms]
    assert photos[int(np.argmax(areas))] >= 2
    in_doorways = sum(
        shapely.intersects_xy(shapely.Polygon(passage.area), x, z).sum()
        for passage in home.building.passages
    )
    assert in_doorways == round(0.25 * len(home.keyframes))
    assert all(keyframe.layout is not None for keyframe in home.keyframes)


def test_a_seed_is_one_tour():
    one, two = tour_home(7), tour_home(7)
    assert np.array_equal(one.truth.trajectory.translations, two.truth.trajectory.translations)
    assert one.name == two.name
