"""IFC read back by ifcopenshell's validator and its geometry kernel."""

import sys
from dataclasses import replace

import numpy as np
import pytest
from tests.exporters.storeys import ODD_NAMES, flat, two_storeys
from tests.metrics.plans import FLAT, plan, square

from panoplan.errors import MissingExtraError
from panoplan.exporters.geojson import Anchor
from panoplan.exporters.heights import DOOR_HEAD_M
from panoplan.exporters.ifc import plan_ifc

pytest.importorskip("ifcopenshell", reason="the extra 'export' is not installed")


def parsed(data):
    import ifcopenshell

    return ifcopenshell.file.from_string(data.decode("utf-8"))


def opened(made):
    return parsed(plan_ifc(made, "Flat"))


def complaints(file):
    import ifcopenshell.validate

    log = ifcopenshell.validate.json_logger()
    ifcopenshell.validate.validate(file, log)
    return log.statements


def volume(product):
    import ifcopenshell.geom
    import ifcopenshell.util.shape

    shape = ifcopenshell.geom.create_shape(ifcopenshell.geom.settings(), product)
    return ifcopenshell.util.shape.get_volume(shape.geometry)


def quantities(product):
    import ifcopenshell.util.element

    sets = ifcopenshell.util.element.get_psets(product, qtos_only=True)
    (found,) = sets.values()
    return found


@pytest.mark.parametrize("made", [flat(), two_storeys(), plan((square(0, 0),), ())])
def test_the_validator_has_nothing_to_say(made):
    assert complaints(opened(made)) == []


def test_the_validator_can_complain():
    file = opened(flat())
    file.by_type("IfcSpace")[0].GlobalId = "short"
    assert complaints(file)


def test_spaces_have_the_plans_areas_and_heights():
    file = opened(flat())
    spaces = file.by_type("IfcSpace")
    assert [space.LongName for space in spaces] == ["Room 1", "Room 2", "Room 3"]
    told = [quantities(space) for space in spaces]
    assert [q["NetFloorArea"] for q in told] == pytest.approx([12.0, 11.4, 10.44], rel=1e-3)
    for space, quantity in zip(spaces, told, strict=True):
        assert quantity["Height"] == 2.5
        assert volume(space) == pytest.approx(quantity["NetVolume"], rel=1e-3)
        assert volume(space) == pytest.approx(2.5 * quantity["NetFloorArea"], rel=1e-3)


def test_a_door_cuts_its_wall():
    file = opened(flat())
    (wall,) = [w for w in file.by_type("IfcWall") if w.Name == "shared_01"]
    (opening,) = [r.RelatedOpeningElement for r in wall.HasOpenings]
    (door,) = [r.RelatedBuildingElement for r in opening.HasFillings]
    assert (door.is_a(), door.Name) == ("IfcDoor", "door_01")
    assert door.OverallWidth == pytest.approx(0.9)
    assert door.OverallHeight == pytest.approx(DOOR_HEAD_M)
    gross = quantities(wall)
    assert gross["GrossVolume"] == pytest.approx(0.2 * 3.0 * 2.5, rel=1e-3)
    cut = gross["GrossVolume"] - volume(wall)
    assert cut == pytest.approx(0.2 * 0.9 * DOOR_HEAD_M, rel=1e-3)


def test_a_storey_each_with_what_it_holds():
    import ifcopenshell.util.element

    file = opened(two_storeys())
    low, high = file.by_type("IfcBuildingStorey")
    assert (low.Elevation, high.Elevation) == (0.0, pytest.approx(2.8))
    names = [
        {p.Name for p in ifcopenshell.util.element.get_decomposition(storey) if p.is_a("IfcSpace")}
        for storey in (low, high)
    ]
    assert names == [{"room_01", "room_02", "room_03"}, {"room_04"}]
    doors = [
        [p.Name for p in ifcopenshell.util.element.get_contained(storey) if p.is_a("IfcDoor")]
        for storey in (low, high)
    ]
    assert doors == [["door_01"], ["door_02"]]


def test_the_hole_of_a_room_is_no_space():
    file = opened(two_storeys())
    assert volume(file.by_type("IfcSpace")[3]) == pytest.approx((16.0 - 4.0) * 2.5, rel=1e-3)


def test_an_opening_is_a_hole_without_a_door():
    made = flat(openings=())
    window = made.windows[0]
    opening = replace(window, id="opening_09", walls=("wall_03",), rooms=("room_01",))
    file = opened(replace(made, windows=(), openings=(opening,)))
    (hole,) = [o for o in file.by_type("IfcOpeningElement") if "opening_09" in o.Name]
    assert not hole.HasFillings
    assert hole.VoidsElements[0].RelatingBuildingElement.Name == "wall_03"


def test_names_are_data():
    file = opened(plan((*FLAT, square(8, 0, 3.0)), names=ODD_NAMES))
    names = [space.LongName for space in file.by_type("IfcSpace")]
    assert names[1] == ODD_NAMES[1]
    assert max(map(len, names)) <= 60
    assert complaints(file) == []


def test_the_same_plan_gives_the_same_bytes():
    one = plan_ifc(flat(), "Flat")
    assert one == plan_ifc(flat(), "Flat")
    file = opened(flat())
    ids = [item.GlobalId for item in file.by_type("IfcRoot")]
    assert len(ids) == len(set(ids))
    other = plan_ifc(plan([1.01 * np.asarray(ring) for ring in FLAT]), "Flat")
    assert one != other


def test_what_is_missing_is_told(monkeypatch):
    monkeypatch.setitem(sys.modules, "ifcopenshell", None)
    with pytest.raises(MissingExtraError, match=r"IFC needs ifcopenshell.*panoplan\[export\]"):
        plan_ifc(flat(), "Flat")


def test_north_and_the_place_are_the_models():
    north = np.deg2rad(30)
    made = plan_ifc(flat(), "Flat", anchor=Anchor(-48.1, 11.5125, north))
    file = parsed(made)
    (model,) = file.by_type("IfcGeometricRepresentationContext", include_subtypes=False)
    # 30° from the second axis towards the first.
    assert model.TrueNorth.DirectionRatios == pytest.approx((0.5, 3**0.5 / 2))
    (site,) = file.by_type("IfcSite")
    assert site.RefLatitude == (-48, -6, 0, 0)
    assert site.RefLongitude == (11, 30, 45, 0)
    assert complaints(file) == []
    known = parsed(plan_ifc(flat(), "Flat", north=north))
    (told,) = known.by_type("IfcGeometricRepresentationContext", include_subtypes=False)
    assert told.TrueNorth.DirectionRatios == model.TrueNorth.DirectionRatios
    (plain,) = opened(flat()).by_type("IfcGeometricRepresentationContext", include_subtypes=False)
    assert plain.TrueNorth is None
