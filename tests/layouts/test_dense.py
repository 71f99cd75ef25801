import numpy as np
import pytest

from panoplan.geometry.sphere import column_heading
from panoplan.layouts.dense import Dense, closed, layout, likely_spans, mean, turned, widened


@pytest.mark.parametrize(
    ("likely", "spans"),
    [
        ([3, 4, 5], [[3, 5]]),
        ([0, 1, 15], [[15, 1]]),
        ([2, 8, 9], [[2, 2], [8, 9]]),
        ([], np.empty((0, 2))),
        (range(16), [[0, 15]]),
    ],
)
def test_spans_are_runs_of_likely_columns(likely, spans):
    chance = np.full(16, 0.4)
    chance[list(likely)] = 0.6
    np.testing.assert_array_equal(likely_spans(chance), spans)


def test_a_turn_and_a_mirror_undo_themselves():
    dense = Dense(-np.linspace(0.1, 1, 16), chances={"corners": np.linspace(0, 1, 16)})
    turn = turned(turned(dense, 5), -5)
    np.testing.assert_array_equal(turn.floor, dense.floor)
    assert turned(dense, 5).floor[5] == dense.floor[0]
    mirror = turned(turned(dense, 0, mirrored=True), 0, mirrored=True)
    np.testing.assert_array_equal(mirror.chances["corners"], dense.chances["corners"])
    assert turned(dense, 0, mirrored=True).floor[0] == dense.floor[-1]


def test_the_mean_tells_disagreement_in_sigma():
    one = Dense(np.full(16, -0.4), sigma=np.full(16, 0.03), confidence=1.0)
    other = Dense(np.full(16, -0.6), sigma=np.full(16, 0.05), confidence=0.5)
    both = mean([one, other])
    np.testing.assert_allclose(both.floor, -0.5)
    np.testing.assert_allclose(both.sigma, np.sqrt((0.03**2 + 0.05**2) / 2 + 0.1**2))
    assert both.confidence == 0.75
    assert both.ceiling is None


def test_spans_of_the_layout_are_those_that_the_network_knows():
    chance = np.zeros(16)
    chance[[0, 15]] = 1
    told = layout(Dense(np.full(16, -0.5), chances={"doors": chance}))
    # Columns 15 and 0 of 16 are 64 of 1024 columns each.
    np.testing.assert_array_equal(told.spans.doors, [[1024 - 64, 63]])
    assert told.spans.windows.shape == (0, 2)
    assert told.corners is None
    assert layout(Dense(np.full(16, -0.5))).spans is None


def test_more_columns_look_where_the_few_did():
    heading = 2 * np.pi * (np.arange(64) + 0.5) / 64 - np.pi
    wide = widened(Dense(-0.6 + 0.2 * np.sin(heading)), 1024)
    heading = 2 * np.pi * (np.arange(1024) + 0.5) / 1024 - np.pi
    np.testing.assert_allclose(wide.floor, -0.6 + 0.2 * np.sin(heading), atol=3e-4)


@pytest.mark.parametrize("turn", [0, 500])
def test_a_passage_is_closed_by_the_line_between_its_jambs(turn):
    """A wall at z = 2 camera heights; a part of it, over the edge or not, is seen through."""
    angle = column_heading(np.arange(1024, dtype=np.float64), 1024)
    with np.errstate(divide="ignore"):
        distance = np.where(np.cos(angle) > 0.3, 2 / np.cos(angle), 6.0)
    true = np.roll(-np.arctan(1 / distance), turn)
    seen = true.copy()
    inside = np.roll(np.abs(np.arange(1024) - 540) <= 60, turn)
    seen[inside] = -np.arctan(1 / 9.0)
    span = (np.array([[480.0, 600.0]]) + turn) % 1024
    np.testing.assert_allclose(closed(seen, span), true, atol=2e-3)
    np.testing.assert_array_equal(closed(seen, np.empty((0, 2))), seen)
    told = layout(Dense(seen, chances={"openings": inside * 1.0}))
    np.testing.assert_allclose(told.floor_boundary, true, atol=2e-3)
    wavering = layout(Dense(seen, chances={"openings": inside * 0.4, "doors": inside * 0.3}))
    np.testing.assert_allclose(wavering.floor_boundary, true, atol=2e-3)
    assert len(wavering.spans.openings) == len(wavering.spans.doors) == 0


def test_a_passage_without_an_edge_on_both_sides_stays_as_it_is():
    floor = np.full(1024, -0.5)
    floor[100:200] = -0.2
    floor[90:100] = np.nan
    np.testing.assert_array_equal(closed(floor, np.array([[100.0, 199.0]])), floor)
    everywhere = np.array([[0.0, 1023.0], [5.0, 6.0]])
    np.testing.assert_array_equal(closed(floor, everywhere), floor)
