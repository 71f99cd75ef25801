import pytest

from panoplan.bench.metric import SOURCES, measure
from panoplan.config import preset


def test_each_source_of_metres_is_measured():
    result = measure(range(7, 8), preset("default"), lambda done, total: None, grades=["mild"])
    (scene,) = result["mild"]["scenes"]
    assert scene["seed"] == 7
    for name in SOURCES:
        assert result["mild"]["summary"][name]["flats"] == 1
        assert abs(scene[name]["size_error_percent"]) < 4
        assert 0 < scene[name]["size_sigma_percent"] < 5
        assert result["mild"]["summary"][name]["lengths_within_2_sigma"] > 0.8
    # One taped wall, which counts not itself.
    assert result["mild"]["summary"]["length"]["length_error_percent_median"] <= 1.0
    walls = [scene[name]["walls"] for name in ("camera height", "length")]
    assert walls[0] == pytest.approx(walls[1] + 1)
