import numpy as np
import pytest

from panoplan.simulate.columns import column_field, correlation
from panoplan.simulate.measured import MEASURED


def test_autocorrelation_along_the_columns_is_the_measured_one():
    rng = np.random.default_rng(0)
    fields = np.array([column_field(1024, rng) for _ in range(4000)])
    assert fields.std() == pytest.approx(1.0, abs=0.02)
    found = [np.mean(fields * np.roll(fields, lag, axis=1)) for lag in MEASURED.lags]
    np.testing.assert_allclose(found, MEASURED.autocorrelation, atol=0.03)
    # It falls below 1/e at 76 columns.
    lags = np.arange(200)
    assert np.argmax(correlation(lags) < np.exp(-1)) == pytest.approx(76, abs=10)


def test_correlation_is_an_angle_whatever_the_width():
    rng = np.random.default_rng(1)
    fields = np.array([column_field(256, rng) for _ in range(4000)])
    assert np.mean(fields * np.roll(fields, 16, axis=1)) == pytest.approx(0.43, abs=0.03)
