"""Labelled panoramas for training, and their shards."""

from itertools import islice

import numpy as np
import pytest

from panoplan.layouts.network import shards
from panoplan.layouts.network.homes import draw_home
from panoplan.layouts.network.samples import REALISM, TARGETS, WIDTH, samples, targets
from panoplan.layouts.network.stands import draw_stand
from panoplan.simulate.render.labels import Labels
from panoplan.types.layout import Layout, Spans


def test_samples_are_repeated_by_the_seed_and_are_plausible():
    first, again = (list(islice(samples(3, 2), 3)) for _ in range(2))
    for one, two in zip(first, again, strict=True):
        np.testing.assert_array_equal(one.image, two.image)
        np.testing.assert_array_equal(one.targets, two.targets)
        assert one.image.shape == (WIDTH // 2, WIDTH, 3)
        assert one.image.std() > 5
        floor, through, ceiling = one.targets[:3]
        assert np.isfinite(one.targets).all()
        assert (floor < 0).all()
        assert (ceiling > 0).all()
        # What is seen through a door lies no nearer than the door.
        assert (through >= floor - 1e-4).mean() > 0.99
    assert not np.array_equal(first[0].image, first[1].image)


@pytest.fixture(scope="module")
def full():
    return list(islice(samples(3, 2), 2))


@pytest.mark.parametrize("kind", [kind for kind in REALISM if kind != "closets"])
def test_what_is_left_out_changes_the_pictures(full, kind):
    """Two panoramas of one home; what the camera and the light do is not in the truth."""
    less = list(islice(samples(3, 2, without=(kind,)), 2))
    assert any(not np.array_equal(a.image, b.image) for a, b in zip(full, less, strict=True))
    same_truth = all(np.array_equal(a.targets, b.targets) for a, b in zip(full, less, strict=True))
    assert same_truth == (kind in ("light", "camera"))


def test_without_open_plans_most_homes_have_doors_only():
    homes = [draw_home(np.random.default_rng(k), open_plans=False) for k in range(12)]
    kinds = [{p.kind for p in home.passages} for home in homes]
    assert sum(kind == {"door"} for kind in kinds) >= 8


def test_targets_of_a_layout_by_hand():
    spans = Spans(np.array([[10.0, 12.0]]), np.array([[510.0, 1.0]]), np.empty((0, 2)))
    floor, through = np.full(WIDTH, -0.6), np.full(WIDTH, -0.4)
    closed = Layout(floor, np.full(WIDTH, 0.5), np.array([0.0, 100.0]), spans=spans)
    rows = dict(zip(TARGETS, targets(Labels(closed, Layout(through))), strict=True))
    np.testing.assert_allclose([rows[k][7] for k in TARGETS[:3]], [-0.6, -0.4, 0.5], rtol=1e-6)
    assert list(np.flatnonzero(rows["door"])) == [10, 11, 12]
    assert list(np.flatnonzero(rows["opening"])) == [0, 1, 510, 511]
    assert rows["window"].max() == 0
    assert rows["corner"][100] == 1
    assert rows["corner"][101] == rows["corner"][99] == pytest.approx(0.9)
    assert rows["corner"][511] == pytest.approx(0.9)


def test_a_shard_is_rendered_once_and_whole(tmp_path, monkeypatch):
    monkeypatch.setattr(shards, "SHARD", 2)
    monkeypatch.setattr(shards, "samples", lambda seed: samples(seed, 2))
    told = []
    shards.render_shard(tmp_path, 5, told.append)
    assert told == [1, 2]
    images = np.load(tmp_path / "images-0000005.npy")
    assert images.shape == (2, WIDTH // 2, WIDTH, 3)
    shards.render_shard(tmp_path, 5, told.append)
    assert told == [1, 2]
    assert shards.shards(tmp_path, held_out=False) == [5]
    assert shards.shards(tmp_path, held_out=True) == []
    (tmp_path / f"targets-{shards.HELD_OUT_SEED:07d}.npy").touch()
    assert shards.shards(tmp_path, held_out=True) == [shards.HELD_OUT_SEED]
    assert shards.shards(tmp_path, held_out=False) == [5]


def test_leaving_out_closets_moves_only_the_cameras_at_them(monkeypatch):
    """The others stand where they stood: nothing else differs between two trainings."""
    monkeypatch.setattr(
        "panoplan.layouts.network.samples._sample",
        lambda scene, labeller, rng, without: draw_stand(
            scene, rng, small="closets" not in without
        ),
    )
    usual, less = (list(islice(samples(3, 40, without=w), 40)) for w in ((), ("closets",)))
    moved = sum(not np.array_equal(a[0], b[0]) for a, b in zip(usual, less, strict=True))
    assert 2 <= moved <= 20
