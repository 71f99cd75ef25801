"""Tables from benchmark files, into pages with marks."""

import json

import pytest

from panoplan.bench.table import update
from panoplan.errors import InputError

FIGURES = {
    "update_ms_median": 1.26,
    "update_late_over_early": 0.5,
    "leaving_ms_median": 204.4,
    "plan_ms": 17.6,
    "finish_s": 11.44,
    "peak_memory_mb": 372.5,
}
PAGE = "before\n<!-- measured: runtime -->\nold\n<!-- end of measured -->\nafter\n"


def _file(folder, name, preset="default", **changes):
    data = {
        "benchmark": "runtime",
        "commit": "abc",
        "machine": {"cores": 2, "processor": "a processor"},
        "figures": FIGURES,
        "settings": {"preset": preset},
        **changes,
    }
    (folder / name).write_text(json.dumps(data))


@pytest.fixture
def page(tmp_path):
    (tmp_path / "results").mkdir()
    path = tmp_path / "page.md"
    path.write_text(PAGE)
    return path


def test_rows_are_the_figures_by_preset_and_the_rest_of_the_page_stays(page):
    _file(page.parent / "results", "a.json")
    _file(page.parent / "results", "b.json", "sound", figures={**FIGURES, "finish_s": None})
    assert update(page, page.parent / "results")
    text = page.read_text()
    assert text.startswith("before\n<!-- measured: runtime -->\nA walk of 2,000 keyframes")
    assert text.endswith("<!-- end of measured -->\nafter\n")
    assert "old" not in text
    rows = [line for line in text.splitlines() if line.startswith("| ")][2:]
    assert rows == [
        "| sound | 1.3 ms | 0.50 | 204 ms | 18 ms | – | 372 MB | 2 cores, a processor |",
        "| default | 1.3 ms | 0.50 | 204 ms | 18 ms | 11.4 s | 372 MB | 2 cores, a processor |",
    ]
    assert not update(page, page.parent / "results")


@pytest.mark.parametrize(
    ("text", "told"),
    [
        ("no marks", "no place for tables"),
        (PAGE.replace("runtime", "weather"), "the table weather"),
        (None, "nothing"),
    ],
)
def test_pages_that_cannot_be_filled(page, text, told):
    if text is None:
        page.unlink()
    else:
        page.write_text(text)
    with pytest.raises(InputError, match=told):
        update(page, page.parent / "results")


def test_where_each_file_is_from(page):
    _file(page.parent / "results", "a.json")
    _file(page.parent / "results", "b.json", "sound", commit=None)
    page.write_text(PAGE.replace("runtime", "files"))
    update(page, page.parent / "results")
    assert [line for line in page.read_text().splitlines() if line.startswith("| ")][2:] == [
        "| `a.json` | default | abc | 2 cores, a processor |",
        "| `b.json` | sound | – | 2 cores, a processor |",
    ]


@pytest.mark.parametrize("settings", [None, {"preset": "best"}])
def test_a_file_that_is_no_benchmark(settings, page):
    if settings is None:
        (page.parent / "results" / "a.json").write_text("{}")
    else:
        _file(page.parent / "results", "a.json", settings=settings)
    with pytest.raises(InputError, match="no benchmark file"):
        update(page, page.parent / "results")
    assert page.read_text() == PAGE


def test_a_source_of_metres_that_no_flat_had_is_no_row(page):
    length = {
        "flats": 3,
        "size_error_percent_median": 0.11,
        "size_sigma_percent_median": 0.51,
        "size_within_1_sigma": 1.0,
        "size_within_2_sigma": 1.0,
        "lengths_within_1_sigma": None,
        "lengths_within_2_sigma": None,
        "length_error_percent_median": 0.24,
        "length_error_percent_median_from_1_m": None,
    }
    none = {name: {"flats": 0} for name in ("length", "door height")}
    figures = {
        "mild": {"summary": {**none, "length": length}},
        "hard": {"summary": none},
    }
    _file(page.parent / "results", "a.json", benchmark="metric", figures=figures)
    page.write_text(PAGE.replace("runtime", "metric"))
    assert update(page, page.parent / "results")
    rows = [line for line in page.read_text().splitlines() if line.startswith("| ")][2:]
    assert rows == ["| length, mild | 3 | 0.11 % | 0.51 % | 1.00 / 1.00 | 0.24 % | – | – |"]


def test_exports_areas_and_models_are_told(page):
    dxf = {"faults": 0, "dimensions": 90, "dimension_error_mm": 0.0009}
    row = {"seconds": 1.26, "cpu_seconds": 0.9, "bytes": 62141, "area_error_percent": 0.00064}
    room = {"room": "a", "label": "den", "true_m2": 10.0, "area_m2": 10.2, "area_sigma_m2": 0.3}
    lost = {"room": "b", "label": "", "true_m2": 2.0, "area_m2": None, "area_sigma_m2": None}
    figures = {"scene": "home", "rooms": 2, "images": 3, "formats": {"svg": row}, "dxf": dxf,
               "ifc": {"errors": 0}, "areas": [room, lost]}  # fmt: skip
    camera = {"id": "k", "psnr_db": 20.25, "pixels_share": 0.8}
    part = {"glb_bytes": 3e6, "psnr_db": 20.25, "cameras": [camera]}
    shown = {"scene": "home", "photos": 9, "true_depth": True, "all_photos": part,
             "without_the_five": {**part, "psnr_db": 18.0}}  # fmt: skip
    _file(page.parent / "results", "a.json", benchmark="exports", figures=figures)
    _file(page.parent / "results", "b.json", benchmark="model", figures=shown)
    page.write_text(PAGE.replace("runtime", "exports, areas, model"))
    assert update(page, page.parent / "results")
    text = page.read_text()
    for line in (
        "| svg | 1.3 s | 0.9 s | 0.06 MB | 0.0006 % |",
        "| den | 10.00 m² | 10.20 m² ± 0.30 | 2.0 % |",
        "| b | 2.00 m² | – | – |",
        "| home, all photos | 9 | 20.2 dB | 20.2 | 80 % | yes | 3.00 MB |",
        "| home, without the five | 9 | 18.0 dB | 20.2 | 80 % | yes | 3.00 MB |",
    ):
        assert line in text.splitlines()
