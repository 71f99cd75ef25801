import csv
import io

import pytest
from tests.exporters.storeys import ODD_NAMES, two_storeys
from tests.metrics.plans import FLAT, plan, square

from panoplan.exporters.schedule import room_schedule


def rows(made):
    return list(csv.DictReader(io.StringIO(room_schedule(made).decode("utf-8"), newline="")))


def test_a_line_a_room_with_the_area_rule():
    read = rows(two_storeys())
    assert [row["id"] for row in read] == ["room_01", "room_02", "room_03", "room_04"]
    assert [row["level"] for row in read] == ["0", "0", "0", "1"]
    assert [float(row["area_m2"]) for row in read] == pytest.approx([12, 11.4, 10.44, 12], rel=1e-3)
    assert float(read[0]["perimeter_m"]) == pytest.approx(14.0)
    assert read[0]["ceiling_height_m"] == "2.500"
    assert [row["doors"] for row in read] == ["1", "1", "0", "1"]
    assert all("inner faces" in row["area_rule"] for row in read)


def test_names_are_no_formulas():
    made = plan((*FLAT, square(8, 0, 3.0)), names=[*ODD_NAMES[:3], 'a "quoted", name\nline'])
    names = [row["name"] for row in rows(made)]
    assert names[0] == "'=1+1"
    assert names[1] == ODD_NAMES[1]
    assert names[3] == 'a "quoted", name line'
