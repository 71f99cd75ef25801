"""DXF read back by ezdxf."""

import io
import itertools
import sys
from dataclasses import replace

import numpy as np
import pytest
import shapely
from tests.exporters.storeys import ODD_NAMES, flat, turned_plan, two_storeys
from tests.metrics.plans import FLAT, plan, square

from panoplan.errors import InputError, MissingExtraError
from panoplan.exporters.dxf import plan_dxf

ezdxf = pytest.importorskip("ezdxf", reason="the extra 'export' is not installed")
bbox = pytest.importorskip("ezdxf.bbox")


def read(made):
    return ezdxf.read(io.StringIO(plan_dxf(made).decode("utf-8")))


def of(document, kind, layer):
    return document.modelspace().query(f'{kind}[layer=="{layer}"]')


def test_metres_layers_and_a_clean_audit():
    document = read(plan())
    audit = document.audit()
    assert not audit.errors
    assert not audit.fixes
    assert (document.header["$INSUNITS"], document.header["$MEASUREMENT"]) == (6, 1)
    layers = {layer.dxf.name for layer in document.layers}
    expected = {"A-WALL", "A-DOOR", "A-GLAZ", "A-AREA", "A-AREA-IDEN", "A-ANNO-DIMS"}
    assert expected <= layers


def test_rooms_are_closed_and_their_areas_are_the_plans():
    lines = of(read(plan()), "LWPOLYLINE", "A-AREA")
    assert all(line.closed for line in lines)
    found = [shapely.Polygon(line.get_points("xy")).area for line in lines]
    assert found == pytest.approx([12.0, 11.4, 10.44], rel=1e-3)


@pytest.mark.parametrize("angle", [0.0, 0.4, 2.0])
def test_dimensions_measure_the_walls(angle):
    made = turned_plan(angle)
    walls = [wall for room in made.rooms for wall in room.walls]
    found = of(read(made), "DIMENSION", "A-ANNO-DIMS")
    assert len(found) == len(walls)
    for wall, dimension in zip(walls, found, strict=True):
        ends = np.array([dimension.dxf.defpoint2, dimension.dxf.defpoint3])[:, :2]
        assert sorted(ends.tolist()) == [
            pytest.approx(e) for e in sorted([list(wall.a), list(wall.b)])
        ]
        length = float(np.hypot(*(wall.b - wall.a)))
        assert dimension.get_measurement() == pytest.approx(length, abs=1e-3)
        assert dimension.get_geometry_block() is not None
        # The dimension line lies inside the room.
        inside = np.array(dimension.dxf.defpoint)[:2]
        x, y = wall.b - wall.a
        assert np.dot(inside - wall.a, [-y, x]) > 0


def test_lengths_have_a_decimal_point():
    document = read(plan())
    (first, *_) = of(document, "DIMENSION", "A-ANNO-DIMS")
    assert first.override().get("dimdsep") == ord(".")
    told = [item.plain_text() for item in first.get_geometry_block().query("MTEXT")]
    assert told == [f"{first.get_measurement():.2f}"]


def test_names_lie_clear_of_the_dimensions_in_large_and_in_small_rooms():
    document = read(plan((square(0, 0, 4.0), square(5, 0, 0.9)), names=("Hall", "Closet")))
    styles = [item.dxf.dimstyle for item in of(document, "DIMENSION", "A-ANNO-DIMS")]
    assert styles == ["PANOPLAN"] * 4 + ["PANOPLAN-SMALL"] * 4
    lettering = [
        item
        for dimension in of(document, "DIMENSION", "A-ANNO-DIMS")
        for item in dimension.get_geometry_block().query("MTEXT")
    ]
    boxes = bounding_boxes([*of(document, "TEXT", "A-AREA-IDEN"), *lettering])
    for one, other in itertools.combinations(boxes, 2):
        assert not one.intersects(other)


def bounding_boxes(entities):
    boxes = [bbox.extents([entity]) for entity in entities]
    return [shapely.box(*box.extmin.vec2, *box.extmax.vec2) for box in boxes]


def test_a_storey_has_its_own_layers():
    document = read(two_storeys())
    assert not document.audit().errors
    rings = [line.get_points("xy") for line in of(document, "LWPOLYLINE", "A-AREA-L1")]
    assert sorted(shapely.Polygon(ring).area for ring in rings) == pytest.approx([4.0, 16.0])
    assert len(of(document, "LWPOLYLINE", "A-DOOR-L1")) == 1
    assert len(of(document, "LWPOLYLINE", "A-DOOR-L0")) == 1
    assert not len(of(document, "LWPOLYLINE", "A-AREA"))


def test_shared_walls_are_hatched():
    (hatch,) = of(read(flat(doors=(), openings=())), "HATCH", "A-WALL-PATT")
    rings = [[(x, y) for x, y, _ in path.vertices] for path in hatch.paths]
    # 0.2 m along 3 m between LEFT and RIGHT, and along 5.8 m below TOP.
    area = 0.2 * 3.0 + 0.2 * 6.0 + 0.2 * 1.8
    assert sum(shapely.Polygon(ring).area for ring in rings) == pytest.approx(area, rel=0.05)


def test_no_wall_is_hatched_through_a_door():
    document = read(flat())
    hatches = of(document, "HATCH", "A-WALL-PATT")
    solid = [
        shapely.Polygon([(x, y) for x, y, _ in path.vertices])
        for hatch in hatches
        for path in hatch.paths
    ]
    doors = [
        shapely.Polygon(item.get_points("xy")) for item in of(document, "LWPOLYLINE", "A-DOOR")
    ]
    assert doors
    assert not shapely.union_all(solid).intersects(shapely.union_all(doors))


def test_names_are_text_and_no_codes():
    made = plan((*FLAT, square(8, 0, 3.0)), names=ODD_NAMES)
    document = read(made)
    assert not document.audit().errors
    told = [text.dxf.text for text in of(document, "TEXT", "A-AREA-IDEN")]
    assert "<script>alert(1)</script>" in told
    assert "% %c ^ J /U+0041 {\\b}" in told
    assert max(map(len, told)) <= 60


def test_the_same_plan_gives_the_same_bytes():
    assert plan_dxf(plan()) == plan_dxf(plan())


def test_a_wall_without_length_has_no_dimension():
    made = plan((square(0, 0),))
    walls = made.rooms[0].walls
    still = replace(walls[0], b=walls[0].a)
    room = replace(made.rooms[0], walls=(still, *walls[1:]))
    document = read(replace(made, rooms=(room,)))
    assert len(of(document, "DIMENSION", "A-ANNO-DIMS")) == 3
    assert not document.audit().errors


def test_what_is_missing_is_told(monkeypatch):
    monkeypatch.setitem(sys.modules, "ezdxf", None)
    with pytest.raises(MissingExtraError, match=r"pip install 'panoplan\[export\]'"):
        plan_dxf(plan())


def test_camera_heights_are_no_metres():
    with pytest.raises(InputError, match="--camera-height"):
        plan_dxf(plan(unit="ch"))
