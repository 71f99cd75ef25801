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
        "| sound | 1.3 ms | 0.50 | 204 ms | 18 ms | – | 372 MB |",
        "| default | 1.3 ms | 0.50 | 204 ms | 18 ms | 11.4 s | 372 MB |",
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


def test_a_file_that_is_no_benchmark(page):
    (page.parent / "results" / "a.json").write_text("{}")
    with pytest.raises(InputError, match="no benchmark file"):
        update(page, page.parent / "results")
    assert page.read_text() == PAGE
