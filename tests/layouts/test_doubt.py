from itertools import islice

import numpy as np
import pytest

from panoplan.formats.image import read_panorama
from panoplan.layouts.dense import Dense
from panoplan.layouts.doubt import answer_doubt, image_doubt
from panoplan.layouts.network.samples import samples
from panoplan.layouts.onnx import SHIPPED, OnnxLayouts

FLOOR = np.full(64, -0.6)


def perspective(panorama, heading, fov_deg=90):
    """A 2:1 perspective photo out of a panorama."""
    height, width = panorama.shape[:2]
    x, y = np.meshgrid(np.linspace(-1, 1, 1024), np.linspace(-0.5, 0.5, 512))
    forward = 1 / np.tan(np.radians(fov_deg) / 2)
    theta = np.arctan2(x, forward) + heading
    phi = np.arctan2(-y, np.hypot(x, forward))
    columns = ((theta + np.pi) / (2 * np.pi) * width).astype(int) % width
    rows = ((np.pi / 2 - phi) / np.pi * height).astype(int)
    return panorama[rows, columns]


def test_a_grey_image_is_doubted():
    noise = np.random.default_rng(0).normal(0, 2, (256, 512, 3))
    assert "one colour" in image_doubt(np.clip(128 + noise, 0, 255).astype(np.uint8))


def test_perspective_photos_are_doubted_and_panoramas_are_not(shared_data):
    panoramas = [
        read_panorama(p) for p in sorted((shared_data / "zind_000" / "images").glob("*.jpg"))[::4]
    ]
    assert [image_doubt(p) for p in panoramas] == [None] * len(panoramas)
    doubts = [image_doubt(perspective(p, k)) for k, p in enumerate(panoramas)]
    assert sum(d is not None for d in doubts) >= 0.6 * len(panoramas)


@pytest.mark.parametrize(
    ("dense", "told"),
    [
        (Dense(FLOOR, confidence=0.2), "confidence 0.20"),
        (Dense(np.full(64, np.nan)), "0 % of the columns"),
        (Dense(FLOOR, sigma=np.full(64, 0.3)), "17°"),
        (Dense(FLOOR, sigma=np.full(64, np.nan)), "unsure"),
        (Dense(FLOOR, np.arctan(1.7 * np.tan(-FLOOR))), "upside down"),
    ],
)
def test_answers_that_are_no_room_are_doubted(dense, told):
    assert told in answer_doubt(dense)


def test_an_ordinary_answer_is_believed():
    ceiling = np.arctan(0.7 * np.tan(-FLOOR))
    assert answer_doubt(Dense(FLOOR, ceiling, np.full(64, 0.02), confidence=0.9)) is None


@pytest.fixture(scope="module")
def rendered():
    """Panoramas of two homes that the shipped network has not seen."""
    return [sample.image for sample in islice(samples(10**7, 6), 12)]


def _doubts(images):
    network = OnnxLayouts(SHIPPED, threads=1)
    return [image_doubt(image) or answer_doubt(network(image)) for image in images]


def test_most_rendered_rooms_are_believed(rendered):
    """Cameras near a wall or low above the floor may be doubted."""
    assert _doubts(rendered).count(None) >= 8


@pytest.mark.parametrize(
    "spoilt",
    [
        lambda image: image[::-1, ::-1],
        lambda image: np.full_like(image, 120),
        lambda image: np.random.default_rng(0).normal(120, 30, image.shape).astype("u1"),
        lambda image: perspective(np.kron(image, np.ones((2, 2, 1), np.uint8)), 1.0),
    ],
    ids=["upside down", "grey", "noise", "perspective"],
)
def test_no_room_is_told_of_what_shows_none_or_shows_it_wrongly(rendered, spoilt):
    doubts = _doubts([np.ascontiguousarray(spoilt(image)) for image in rendered])
    assert None not in doubts
