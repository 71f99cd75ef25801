"""Real layouts against simulated ones of the same cameras; here both are simulated."""

import json

import numpy as np
import pytest

from panoplan.bench import difficulty, difficulty_tables
from panoplan.bench.difficulty import measure, read_twin
from panoplan.bench.record import to_json
from panoplan.config import Config
from panoplan.errors import InputError
from panoplan.formats.sequence import write_sequence
from panoplan.simulate.families import simulate_scene


@pytest.fixture(scope="module")
def tour(tmp_path_factory):
    folder = tmp_path_factory.mktemp("tours") / "tour"
    scene = simulate_scene("flat", 19, "measured", as_stills=True, metres_per_su=1.0)
    write_sequence(folder, "tour", scene.keyframes, scene.truth, scene.camera_height_m)
    return scene, folder


def test_the_twin_sees_what_the_scene_saw(tour):
    scene, folder = tour
    twin = read_twin(folder)
    assert twin.way.rooms.tolist() == list(scene.keyframe_rooms)
    for keyframe, view in zip(twin.keyframes, twin.views(), strict=True):
        told = twin.camera_height_m / np.tan(-keyframe.layout.floor_boundary)
        assert np.median(np.abs(told - view.closed_range_m)) < 0.3
    first, again, other = twin.simulated(0), twin.simulated(0), twin.simulated(1)
    np.testing.assert_array_equal(first[3].floor_boundary, again[3].floor_boundary)
    assert (first[3].floor_boundary != other[3].floor_boundary).any()


def test_layouts_of_the_twin_tell_no_more_than_the_real_ones(tour):
    _, folder = tour
    bare = folder.parent / "bare"
    exact = simulate_scene("flat", 19, "exact", as_stills=True, metres_per_su=1.0)
    write_sequence(bare, "bare", exact.keyframes, exact.truth, exact.camera_height_m)
    assert read_twin(folder).simulated(0)[0].floor_sigma is not None
    assert read_twin(bare).simulated(0)[0].floor_sigma is None


def test_figures_bands_and_tables(tour, monkeypatch):
    _, folder = tour
    monkeypatch.setattr(difficulty, "_HOMES", range(100, 102))
    seen = []
    result = measure(folder, Config(), lambda *told: seen.append(told), seeds=range(2))
    assert seen[-1] == (4, 4)
    for key in ("stated", "unstated"):
        of = result[key]
        low, high, middle = of["band"]["mean_iou"]
        ious = sorted(row["mean_iou"] for row in of["seeds"])
        assert ious[0] <= low <= middle <= high <= ious[-1]
        assert middle == pytest.approx(np.mean(ious))
        inside = low <= of["real"]["mean_iou"] <= high
        assert of["within"]["mean_iou"] == inside
        assert 0.6 < of["real"]["mean_iou"] < 1
    files = [
        {
            "benchmark": "difficulty",
            "settings": {"preset": "default"},
            "figures": json.loads(to_json(result)),
        }
    ]
    assert "| mean IoU, with |" in difficulty_tables.figures(files)
    told = difficulty_tables.errors(files)
    assert "| gross on openings | 31.0% |" in told
    files[0]["figures"]["errors_real"]["leak_median_m"] = None
    assert "| –, " in difficulty_tables.errors(files)
    assert difficulty_tables.errors([]) == difficulty_tables.figures([]) == ""


def test_a_folder_without_a_plan_is_refused(tour, tmp_path):
    scene, _ = tour
    write_sequence(tmp_path / "bare", "bare", scene.keyframes, None, scene.camera_height_m)
    with pytest.raises(InputError):
        read_twin(tmp_path / "bare")
