import numpy as np

from panoplan.exporters.model.atlas import packed


def test_pictures_lie_apart_and_whole():
    rng = np.random.default_rng(0)
    made = {
        str(k): rng.integers(0, 255, (*rng.integers(1, 90, 2), 3), dtype=np.uint8)
        for k in range(30)
    }
    atlas = packed(made)
    count = np.zeros(atlas.pixels.shape[:2], dtype=int)
    for name, picture in made.items():
        x, y = atlas.places[name]
        rows, columns = picture.shape[:2]
        assert np.array_equal(atlas.pixels[y : y + rows, x : x + columns], picture)
        count[y : y + rows, x : x + columns] += 1
    assert count.max() == 1
    assert count.mean() > 0.5
