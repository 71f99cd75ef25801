"""Tables of walks and tours, from figures as the benchmarks write them."""

from panoplan.bench.pose_tables import plans, tours, walks

MACHINE = {"machine": {"cores": 2, "processor": "any"}, "settings": {"preset": "default"}}


def _group(count, misplaced, median_m=None):
    told = {"median_m": median_m, "p90_m": median_m, "heading_deg": None}
    return {"photos": count, "misplaced": misplaced, **told}


def _tour(scene, photos, group, found=None):
    scores = [{"iou": 0.3, "hits": 6, "true": 6}, {"iou": 0.5, "hits": found, "true": 6}]
    return {
        "scene": scene,
        "layouts": "files",
        "plan": found and {"rooms": {"scores": scores}},
        "photos": photos,
        "groups": [group],
        "cpu_seconds": 9.6,
        "draws": [],
    }


def test_tours_are_summed_over_photos():
    drawn = {**_tour("", 3, _group(1, [])), "draws": []}
    figures = [
        {**_tour("one", 8, _group(6, ["a"], 0.123), 5), "draws": [drawn]},
        _tour("two", 12, _group(9, [], 0.05), 3),
    ]
    text = tours([{"benchmark": "tour", "figures": figures, **MACHINE}])
    assert "| one | 8 | 6 | 1 | 12.3 cm | 12.3 cm | – | 5 of 6 | 10 s |" in text
    assert "| one, draw 0 | 3 | 1 | 0 | – | – | – | – | 10 s |" in text
    assert "| all | 20 | 15 (75 %) | 1 (6.7 %) | – | – | – | 8 of 12 |" in text
    apart = [*figures, _tour("three", 2, _group(1, []))]
    text = tours([{"benchmark": "tour", "figures": apart, **MACHINE}])
    assert "| 8 of 12, 1 without a plan |" in text


def test_walks_tell_errors_at_the_end_and_as_given():
    figures = {
        "scene": "one",
        "keyframes": 300,
        "maps": [290, 8],
        "final": {"length_m": 40.4, "ate_percent_of_length": 0.0312},
        "as_given": {"ate_percent_of_length": 0.0871, "worst_cm": 9.04},
        "keyframes_a_cpu_second": 4.56,
        "cpu_s_first": {"median": 0.1, "95 %": 0.2},
        "cpu_s_last": {"median": 0.1, "95 %": 0.25},
        "plan_lag_s": {"median": 0.9, "95 %": 1.61, "longest": 2.0},
    }
    text = walks([{"benchmark": "odometry", "figures": [figures], **MACHINE}])
    row = "| one | 300 | 298 in 2 | 40 m | 0.031 % | 0.087 % | 9.0 cm | 4.6 | 1.25 | 1.6 s |"
    assert row in text


def test_nothing_measured_is_no_table():
    assert walks([]) == tours([]) == ""


def _rooms(half, seven):
    scores = [
        {"iou": iou, "hits": hits, "predicted": 7, "true": 6}
        for iou, hits in ((0.3, 6), (0.5, half), (0.7, seven))
    ]
    return {"rooms": {"scores": scores, "mean_iou": 0.9}}


def test_plans_are_summed_over_walks():
    figures = [
        {"scene": "one", "plans": {"true_poses_true_layouts": _rooms(6, 6),
                                   "true_layouts": _rooms(6, 5), "images_alone": _rooms(4, 2)}},
        {"scene": "two", "plans": {"true_poses_true_layouts": _rooms(6, 6),
                                   "true_layouts": _rooms(6, 6), "images_alone": _rooms(5, 3)}},
        {"scene": "three"},
    ]  # fmt: skip
    text = plans([{"benchmark": "odometry", "figures": figures, **MACHINE}])
    assert (
        "| one | 6 / 6 of 6, 7 told | 0.900 | 6 / 5 of 6, 7 told | 0.900 | 4 / 2 of 6, 7 told |"
        in text
    )
    assert (
        "| all | 12 / 12 of 12, 14 told | – | 12 / 11 of 12, 14 told | – | 9 / 5 of 12, 14 told |"
        in text
    )
    assert "three" not in text
    assert plans([{"benchmark": "odometry", "figures": figures[2:], **MACHINE}]) == ""
