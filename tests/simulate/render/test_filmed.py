"""Walks filmed well and badly."""

import numpy as np
import pytest

from panoplan.formats.image import read_panorama, write_jpeg
from panoplan.simulate.render.filmed import FRAMES, exposed, film_badly, filmed_home, smeared


def test_a_walk_has_so_many_frames_and_passes_every_door():
    walk = filmed_home(25)
    true = walk.truth.trajectory
    assert len(walk.keyframes) == len(true) == FRAMES
    assert [k.id for k in walk.keyframes] == list(true.labels)
    assert len(set(walk.keyframe_rooms[:FRAMES])) == 6
    steps = np.linalg.norm(np.diff(true.translations, axis=0), axis=1)
    assert steps.max() < 0.35


def test_a_turn_smears_sideways_and_around_the_circle():
    pixels = np.zeros((64, 128, 3), dtype=np.uint8)
    pixels[:, 0] = 255
    blurred = smeared(pixels, 2 * np.pi * 4 / 128)
    assert blurred[:, :8].astype(int).sum() + blurred[:, -8:].astype(int).sum() == pytest.approx(
        255 * 64 * 3, rel=0.02
    )
    assert blurred[0, 0, 0] == 64
    assert blurred[0, -1, 0] + blurred[0, 1, 0] >= 64
    assert np.ptp(blurred, axis=0).max() == 0


def test_longer_exposure_is_brighter_and_ends_in_white():
    grey = np.full((2, 4, 3), 100, dtype=np.uint8)
    assert exposed(grey, 1.0)[0, 0, 0] == 100
    # A stop more is 2^(1/2.2) on screen.
    assert exposed(grey, 2.0)[0, 0, 0] == round(100 * 2 ** (1 / 2.2))
    assert exposed(np.full_like(grey, 250), 2.0).min() == 255


@pytest.mark.parametrize(("trouble", "least", "most"), [("blur", 3, 18), ("exposure", 10, 40)])
def test_trouble_changes_some_pictures_and_no_truth(tmp_path, trouble, least, most):
    good, bad = tmp_path / "good", tmp_path / "bad"
    (good / "images").mkdir(parents=True)
    (good / "depth").mkdir()
    (good / "trajectory_gt.tum").write_text("0 0 0 0 0 0 0 1\n")
    rng = np.random.default_rng(0)
    picture = rng.integers(0, 200, (256, 512, 3)).astype(np.uint8)
    for k in range(40):
        write_jpeg(good / "images" / f"{k:03d}.jpg", picture)
    film_badly(good, bad, trouble, 3)
    assert (bad / "trajectory_gt.tum").read_text() == "0 0 0 0 0 0 0 1\n"
    assert not (bad / "depth").exists()
    changed = 0
    for path in sorted((good / "images").iterdir()):
        one, other = (read_panorama(p).astype(int) for p in (path, bad / "images" / path.name))
        changed += np.abs(one - other).mean() > 12
    assert least <= changed <= most
