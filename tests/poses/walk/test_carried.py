import numpy as np

from panoplan.poses.walk.carried import carried

WIDTH, HEIGHT = 1024, 512


def walk(count=10, seed=0):
    """Panoramas of a camera that moves through noise."""
    rng = np.random.default_rng(seed)
    coarse = rng.integers(0, 255, (count, 64, 128, 1)).astype(np.uint8)
    return [np.repeat(np.repeat(np.repeat(c, 4, 0), 4, 1), 3, 2) for c in coarse]


def with_photographer(panoramas):
    """A grey column from straight below up to 20° below the horizon, over the image's edge."""
    for p in panoramas:
        p[156:, :40] = p[156:, -24:] = 90
        p[244:] = 60
    return panoramas


def test_what_stays_the_same_upwards_from_below_is_carried():
    mask = carried(with_photographer(walk()), WIDTH, HEIGHT)
    assert mask.shape == (HEIGHT, WIDTH)
    assert mask[400, 20]
    assert mask[400, -10]
    assert mask[505].all()
    assert not mask[400, 300:800].any()
    assert not mask[:256].any()


def test_a_walk_that_carries_nothing_has_no_mask():
    assert carried(walk(), WIDTH, HEIGHT) is None


def test_a_camera_that_stands_still_tells_nothing():
    assert carried(with_photographer([walk()[0]] * 10), WIDTH, HEIGHT) is None


def test_a_few_panoramas_tell_nothing():
    assert carried(with_photographer(walk(5)), WIDTH, HEIGHT) is None
