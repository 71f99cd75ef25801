import numpy as np
import pytest

from panoplan.errors import InputError
from panoplan.layouts.contract import ModelSpec, Output
from panoplan.layouts.decode import decode

COLUMNS = 16
FLOOR = np.linspace(-0.9, -0.3, COLUMNS)


def spec(**outputs):
    return ModelSpec("image", 256, 512, {n: Output(n, m) for n, m in outputs.items()})


def test_a_depth_and_a_ratio_become_elevations():
    depth = np.full((1, COLUMNS), 2.0)
    told = decode(
        spec(floor_boundary="depth", ceiling_boundary="height_ratio"),
        {"floor_boundary": depth, "ceiling_boundary": np.array([[0.8]])},
        "m",
    )
    np.testing.assert_allclose(told.floor, -np.arctan(1 / 2))
    np.testing.assert_allclose(told.ceiling, np.arctan(0.8 / 2))


@pytest.mark.parametrize(
    ("meaning", "number", "sigma"),
    [
        ("sigma", 0.1, 0.1),
        ("log_sigma", np.log(0.1), 0.1),
        ("laplace_scale", 0.1, 0.1 * np.sqrt(2)),
        ("log_laplace_scale", np.log(0.1), 0.1 * np.sqrt(2)),
    ],
)
def test_each_sigma_is_a_standard_deviation(meaning, number, sigma):
    told = decode(
        spec(floor_boundary="elevation", floor_sigma=meaning),
        {"floor_boundary": FLOOR, "floor_sigma": np.full(COLUMNS, number)},
        "m",
    )
    np.testing.assert_allclose(told.sigma, sigma)


def test_logits_are_probabilities():
    told = decode(
        spec(floor_boundary="depression", corners="logit", confidence="logit"),
        {"floor_boundary": -FLOOR, "corners": np.full(COLUMNS, 2.0), "confidence": np.zeros(1)},
        "m",
    )
    np.testing.assert_allclose(told.floor, FLOOR)
    np.testing.assert_allclose(told.chances["corners"], 1 / (1 + np.exp(-2)))
    assert told.confidence == 0.5


def test_columns_that_begin_at_the_edge_are_moved_by_half_a_column():
    outputs = spec(floor_boundary="elevation").outputs
    edge = ModelSpec("image", 256, 512, outputs, pixel_centre=0.0)
    told = decode(edge, {"floor_boundary": FLOOR}, "m")
    np.testing.assert_allclose(told.floor[:-1], (FLOOR[1:] + FLOOR[:-1]) / 2)
    np.testing.assert_allclose(told.floor[-1], (FLOOR[-1] + FLOOR[0]) / 2)


def test_values_that_are_no_elevation_are_unknown():
    values = FLOOR.copy()
    values[3], values[5] = -2, np.nan
    told = decode(spec(floor_boundary="elevation"), {"floor_boundary": values}, "m")
    assert np.flatnonzero(np.isnan(told.floor)).tolist() == [3, 5]


@pytest.mark.parametrize(
    ("tensors", "told"),
    [
        ({"floor_boundary": np.zeros(18), "corners": np.zeros(18)}, "18 columns"),
        ({"floor_boundary": FLOOR, "corners": np.zeros(32)}, "corners of 32 columns"),
    ],
)
def test_tensors_that_do_not_fit_are_refused(tensors, told):
    with pytest.raises(InputError, match=told):
        decode(spec(floor_boundary="elevation", corners="logit"), tensors, "m")


def test_a_missing_channel_is_refused():
    outputs = {"floor_boundary": Output("rows", "elevation", 2)}
    with pytest.raises(InputError, match="a channel 2"):
        decode(ModelSpec("image", 256, 512, outputs), {"rows": np.zeros((1, 2, 16))}, "m")
