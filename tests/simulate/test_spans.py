"""Doors, openings and windows of exact views, and the errors of a network's."""

import numpy as np
import pytest
from tests.simulate.test_views import two_rooms

from panoplan.simulate.spans import EXACT_SPANS, MEASURED_SPANS, noisy_spans
from panoplan.simulate.views import ViewCaster, tilted
from panoplan.simulate.walks import about_y

RNG = np.random.default_rng(0)


def _span(kind="door", heading=0.0, errors=EXACT_SPANS, rng=RNG):
    view = ViewCaster(two_rooms(kind)).view(np.array([2.0, 1.5]), heading, 1.5)
    return noisy_spans(view, errors, rng)


@pytest.mark.parametrize("kind", ["door", "opening"])
def test_exact_spans_are_where_the_passage_is_seen(kind):
    spans = _span(kind)
    told = spans.doors if kind == "door" else spans.openings
    assert len(spans.doors) + len(spans.openings) + len(spans.windows) == 1
    # Its sides are 2 m ahead of the camera's right hand and 0.5 m to each side.
    headings = 2 * np.pi * (told[0] + 0.5) / 1024 - np.pi
    wanted = [np.arctan2(2.0, 0.5), np.arctan2(2.0, -0.5)]
    assert np.sort(headings) == pytest.approx(np.sort(wanted), abs=2 * np.pi / 1024)


def test_a_span_over_the_images_edge_ends_before_it_starts():
    first, last = _span(heading=-np.pi / 2).doors[0]
    assert first > 900
    assert last < 124


def test_recall_confusion_and_ends_are_those_measured():
    rng = np.random.default_rng(7)
    exact = _span("door").doors[0]
    found, errors, false = 0, [], 0
    for _ in range(1500):
        spans = _span("door", errors=MEASURED_SPANS, rng=rng)
        near = [span for span in spans.doors if np.abs(span - exact).max() <= 40]
        found += len(near) > 0
        errors += [np.abs(span - exact) for span in near[:1]]
        false += len(spans.doors) + len(spans.openings) + len(spans.windows) - len(near)
    assert found / 1500 == pytest.approx(MEASURED_SPANS.door_recall, abs=0.03)
    assert np.median(errors) == pytest.approx(3.0, abs=0.5)
    assert np.percentile(errors, 90) == pytest.approx(16.0, abs=2.0)
    assert false / max(1, found) == pytest.approx(MEASURED_SPANS.false_share, abs=0.015)
    openings = [_span("opening", errors=MEASURED_SPANS, rng=rng) for _ in range(1500)]
    as_door = np.mean([len(spans.doors) > 0 for spans in openings])
    assert as_door == pytest.approx(MEASURED_SPANS.opening_as_door, abs=0.04)


def test_a_tilted_camera_sees_the_door_in_nearly_the_same_columns():
    view = ViewCaster(two_rooms()).view(np.array([2.0, 1.5]), 0.0, 1.5)
    level = view.layout
    level = type(level)(
        level.floor_boundary, spans=noisy_spans(view, EXACT_SPANS, np.random.default_rng(0))
    )
    turned = tilted(level, about_y(np.array([np.deg2rad(10.0)]))[0])
    moved = (turned.spans.doors[0] - level.spans.doors[0] + 512) % 1024 - 512
    assert np.abs(np.abs(moved) - 1024 * 10 / 360).max() < 2
