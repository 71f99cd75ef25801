"""Sheets read back: SVG by an XML parser, PDF by pdfminer."""

import io
from xml.etree import ElementTree

import numpy as np
import pytest
import shapely
from tests.exporters.storeys import ODD_NAMES, flat, turned_plan, two_storeys
from tests.metrics.plans import FLAT, plan, square

from panoplan.bench.readback import path_area
from panoplan.errors import InputError
from panoplan.exporters.sheet.compose import sheets
from panoplan.exporters.sheet.dimensions import text_box
from panoplan.exporters.sheet.marks import Shape, Words
from panoplan.exporters.sheet.pdf import sheets_pdf
from panoplan.exporters.sheet.svg import sheet_svg
from panoplan.formats.plan_json import plan_to_dict

SVG = "{http://www.w3.org/2000/svg}"
MM_PER_PT = 25.4 / 72


def areas(made):
    return {room["id"]: room["area"] for room in plan_to_dict(made)["rooms"] if room["area"]}


def svg_root(sheet):
    return ElementTree.fromstring(sheet_svg(sheet))


def pdf_pages(data):
    from pdfminer.high_level import extract_pages

    return list(extract_pages(io.BytesIO(data)))


def items(node, kind):
    found = [node] if isinstance(node, kind) else []
    return found + [
        i for child in (node if hasattr(node, "__iter__") else ()) for i in items(child, kind)
    ]


@pytest.mark.parametrize(
    "made", [plan(), turned_plan(0.4), two_storeys()], ids=["flat", "turned", "two"]
)
def test_svg_is_in_millimetres_and_its_areas_are_the_plans(made):
    found = {}
    for sheet in sheets(made, title="Flat"):
        root = svg_root(sheet)
        width, height = (float(root.get(key).removesuffix("mm")) for key in ("width", "height"))
        assert root.get("viewBox") == f"0 0 {width:g} {height:g}"
        for path in root.iter(f"{SVG}path"):
            if (path.get("id") or "").startswith("room_"):
                found[path.get("id")] = path_area(path.get("d")) * (sheet.denominator / 1000) ** 2
    assert found == pytest.approx(areas(made), rel=1e-3)


def test_every_layer_and_door_is_a_group_with_an_id():
    root = svg_root(sheets(flat(), title="Flat")[0])
    groups = [node.get("id") for node in root.iter(f"{SVG}g")]
    assert groups == [
        "rooms", "walls", "doors", "openings", "windows", "dimensions", "labels", "title",
    ]  # fmt: skip
    ids = [node.get("id") for node in root.iter() if node.get("id")]
    assert {"door_01", "opening_01", "window_01", "solid", "scale_bar", "arrow"} <= set(ids)
    assert len(ids) == len(set(ids))


def test_walls_are_dimensioned():
    root = svg_root(sheets(plan(), title="Flat")[0])
    told = [node.text for node in root.iter(f"{SVG}text")]
    assert {"4.00", "3.00", "5.00", "5.80", "1.80"} <= set(told)


def test_nothing_is_cropped_and_text_keeps_apart():
    rng = np.random.default_rng(1)
    rooms = [
        square(x, y, 1.9 - rng.uniform(0, 1.5)) for x in range(0, 12, 2) for y in range(0, 8, 2)
    ]
    for sheet in sheets(plan(rooms, names=["A rather long name"] * len(rooms)), title="t " * 200):
        page = shapely.box(0, 0, sheet.paper.width, sheet.paper.height)
        for marks in sheet.layers.values():
            for mark in marks:
                inside = (
                    text_box(mark)
                    if isinstance(mark, Words)
                    else shapely.MultiPoint(np.concatenate(mark.rings))
                )
                assert page.contains(inside)
        boxes = [
            text_box(m)
            for name in ("labels", "dimensions")
            for m in sheet.layers[name]
            if isinstance(m, Words)
        ]
        assert len(boxes) > len(rooms)
        for k, box in enumerate(boxes):
            assert not any(box.intersects(other) for other in boxes[:k])


def test_a_metre_is_a_centimetre_at_1_to_100_in_the_pdf():
    from pdfminer.layout import LTCurve, LTLine

    made = plan([2.5 * ring for ring in FLAT])
    (sheet,) = sheets(made, title="Flat")
    assert sheet.denominator == 100
    (page,) = pdf_pages(sheets_pdf([sheet]))
    assert page.width * MM_PER_PT == pytest.approx(297, abs=0.01)
    bar = next(m for m in sheet.layers["title"] if isinstance(m, Shape) and m.id == "scale_bar")
    metres = float(bar.title.split()[0])
    lengths = [(line.x1 - line.x0) * MM_PER_PT for line in items(page, LTLine)]
    assert any(length == pytest.approx(10 * metres, abs=0.01) for length in lengths)
    outlines = [
        shapely.Polygon(curve.pts).area * (MM_PER_PT / 10) ** 2
        for curve in items(page, LTCurve)
        if curve.fill and len(curve.pts) > 3
    ]
    for area in areas(made).values():
        assert min(abs(found / area - 1) for found in outlines) < 1e-3


def test_pdf_has_a_page_a_storey_with_names_as_text():
    pages = pdf_pages(sheets_pdf(sheets(two_storeys(), title="Two")))
    from pdfminer.layout import LTTextContainer

    told = ["".join(box.get_text() for box in items(page, LTTextContainer)) for page in pages]
    assert len(told) == 2
    for word in ("Hall", "Küche", "Bath & WC", "Two, Level 0", "1:50", "first view", "inner faces"):
        assert word in told[0]
    assert "Two, Level 1" in told[1]
    assert "Without a shape" in told[1]
    assert "12.0 m²" in told[0]


@pytest.mark.parametrize(("north", "name"), [(None, "first view"), (np.pi / 2, "north")])
def test_the_arrow_points_where_it_says(north, name):
    made = plan()
    (sheet,) = sheets(made, title="Flat", north=north)
    arrow = next(m for m in sheet.layers["title"] if isinstance(m, Shape) and m.id == "arrow")
    assert arrow.title == name
    tip, *rest = arrow.rings[0]
    expected = [1.0, 0.0] if north else [0.0, -1.0]
    assert (tip - np.mean(rest, axis=0)) / 7.0 == pytest.approx(expected, abs=1e-9)


def test_the_same_plan_gives_the_same_bytes():
    one, other = (sheets(flat(), title="Flat") for _ in range(2))
    assert sheets_pdf(one) == sheets_pdf(other)
    assert [sheet_svg(s) for s in one] == [sheet_svg(s) for s in other]


def test_names_are_never_markup():
    made = plan((*FLAT, square(8, 0, 3.0)), names=ODD_NAMES)
    root = svg_root(sheets(made, title="<b>$x$</b>")[0])
    tags = {node.tag.removeprefix(SVG) for node in root.iter()}
    assert tags == {"svg", "title", "rect", "g", "path", "text"}
    text = " ".join(node.text or "" for node in root.iter(f"{SVG}text"))
    assert "<script>" in text
    assert len(text) < 5000
    assert sheets_pdf(sheets(made, title="<b>$x$</b>")).startswith(b"%PDF")


@pytest.mark.parametrize(
    ("made", "told"),
    [(plan(unit="ch"), "camera heights"), (plan((None,)), "no room"), (plan((), ()), "no room")],
)
def test_what_cannot_be_drawn_to_scale_is_told(made, told):
    with pytest.raises(InputError, match=told):
        sheets(made, title="Flat")
