"""Tables of v1 from its files."""

import pytest

from panoplan.bench.v1.score import FIGURES, summary
from panoplan.bench.v1.tables import causes, methods, statistics
from panoplan.errors import InputError


def scene(name, hits, *, doors=0, error=0.5, **changes):
    counts = {figure: [hits, 10, 8] for figure in FIGURES}
    counts |= {"doors": [doors, 4, doors]}
    counts |= dict.fromkeys(("mean_iou", "floor_iou", "overlap_m2", "corner_cm", "ate_cm"))
    return {
        "scene": name,
        "keyframes": 100,
        "rooms": 10,
        "area_m2": 80.0,
        "cpu_seconds": 3.0,
        "failure": None,
        "scale_error_percent": error,
        "aligned": counts,
        "unaligned": None,
        **changes,
    }


def file_of(preset, family="flat", **shares):
    figures = {
        share.removeprefix("s").replace("_", "."): {"summary": summary(scenes), "scenes": scenes}
        for share, scenes in shares.items()
    }
    return {
        "benchmark": "v1",
        "settings": {"preset": preset},
        "figures": {"scenes_of": family, "shares": figures},
    }


FILES = [
    file_of("paper", s0_2=[scene("a", 4), scene("b", 2, error=-1.5, failure="lost")]),
    file_of(
        "default",
        s0_2=[scene("a", 5, doors=2), scene("b", 7)],
        s1=[scene("a", 5), scene("b", 7)],
    ),
]


def rows_of(text):
    return [line for line in text.splitlines() if line.startswith("| ")]


def test_means_are_over_scenes():
    row = next(line for line in rows_of(methods(FILES)) if line.startswith("| paper 20 %"))
    cells = [cell.strip() for cell in row.strip("|").split("|")]
    assert cells[1:5] == ["0.30 / 0.38"] * 4
    assert cells[5:9] == ["–"] * 4
    assert cells[9:] == ["1.00 %", "1", "3.0 s"]


def test_the_paper_stands_above_as_another_dataset():
    rows = rows_of(methods(FILES))
    assert rows[4].startswith("| *360-DFPE, 20 %, paper, its own data* | 0.80 / 0.83 | 0.68 / 0.71")
    assert [row.split()[1] for row in rows[6:9]] == ["paper", "default", "default"]


def test_methods_are_compared_scene_by_scene():
    text = methods(FILES)
    row = next(line for line in rows_of(text) if "default 20 % less paper 20 %" in line)
    # Recall: 0.1 and 0.5 more, precision 1/8 and 5/8.
    assert "| +30.0 [+10.0, +50.0] | +37.5 [+12.5, +62.5] |" in row
    row = next(line for line in rows_of(text) if "default 100 % less default 20 %" in line)
    assert "| +0.0 [+0.0, +0.0] |" in row


def test_the_baseline_has_one_row_and_is_compared_too():
    scan = file_of("points", s1=[scene("a", 2), scene("b", 2)])
    text = methods([scan, *FILES])
    assert any(line.startswith("| points | 0.20 / 0.25 |") for line in rows_of(text))
    assert any("| default 20 % less points | +" in line for line in rows_of(text))


def test_statistics_are_of_the_scenes():
    row = rows_of(statistics(FILES))[-1]
    assert row == "| Flats of a real size | 2 | 20 | 10.0 ± 0.0 | 80 ± 0 | 100 |"


def test_what_knowing_gains_is_told_scene_by_scene():
    known = {
        name: {"summary": summary(scenes), "scenes": scenes}
        for name, scenes in (
            ("nothing", [scene("a", 4), scene("b", 4)]),
            ("poses", [scene("a", 4), scene("b", 6)]),
        )
    }
    figures = {"scenes_of": "flat", "share": 0.2, "known": known}
    data = {"benchmark": "v1-ablation", "settings": {"preset": "default"}, "figures": figures}
    text = causes([data, *FILES])
    assert "2 scenes, default, 20 %" in text
    nothing, poses = rows_of(text)[2:]
    assert nothing.startswith("| nothing | 0.40 / 0.50 |")
    assert poses.startswith("| poses | 0.50 / 0.62 | 0.50 / 0.62 | 0.50 / 0.62 | +10.0 [+0.0, ")


def test_nothing_measured_is_no_table():
    assert statistics([]) == methods([]) == causes([]) == ""


def test_files_of_other_scenes_are_not_compared():
    other = file_of("paper", s0_2=[scene("c", 4), scene("b", 2)])
    with pytest.raises(InputError, match="one run's"):
        methods([other, FILES[1]])
