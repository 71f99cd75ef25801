"""A plan as IFC4: spaces with quantities, walls, openings, doors, windows, storeys."""

from __future__ import annotations

import math
import uuid
from collections.abc import Mapping, Sequence
from typing import Any

import shapely

from panoplan.errors import MissingExtraError
from panoplan.exporters.bodies import Interval, WallBody, body_of, wall_bodies
from panoplan.exporters.geojson import Anchor
from panoplan.exporters.heights import CEILING_M, ceilings, door_head, elevations, window_edges
from panoplan.exporters.labels import printable
from panoplan.exporters.sheet.title import AREA_RULE
from panoplan.exporters.storeys import Storey, metric_storeys, room_area
from panoplan.formats.plan_json import plan_to_text
from panoplan.types.plan import Aperture, FloorPlan, Room

_LEAF_M = 0.04
_BEYOND_M = 0.05
_NO_TIME = "1970-01-01T00:00:00"
_NAMESPACE = uuid.UUID("6f0bb0de-65d5-4a04-a5c5-1c1f4a0d7d0c")


def plan_ifc(
    plan: FloorPlan, title: str, *, north: float | None = None, anchor: Anchor | None = None
) -> bytes:
    """A plan as IFC4 in metres, in the plan frame; the same plan gives the same bytes.

    Each room is an IfcSpace with base quantities, each piece of wall an IfcWall, each aperture an
    IfcOpeningElement that cuts its wall; doors and windows fill theirs. Heights and thicknesses
    that a plan does not tell are assumed (`exporters.heights`, `exporters.bodies`) and noted in
    the property set Panoplan.

    Args:
        plan: metric.
        title: of project and building.
        north: rad, from the plan's second axis towards its first, the model's true north; None
            for the anchor's.
        anchor: where the plan's origin lies on the globe, the site's place; None where not known.

    Raises:
        InputError: not metric or without rooms; MissingExtraError: ifcopenshell is not installed.
    """
    floors = metric_storeys(plan)
    writer = _Writer(plan, title, north, anchor)
    heights, rises = ceilings(floors), elevations(floors)
    for floor in floors:
        writer.storey(floor, rises[floor.level], heights)
    return writer.text()


class _Writer:
    """An IFC file that grows element by element."""

    def __init__(
        self, plan: FloorPlan, title: str, north: float | None, anchor: Anchor | None
    ) -> None:
        try:
            import ifcopenshell
            import ifcopenshell.api
        except ImportError:
            raise MissingExtraError("IFC", "ifcopenshell", "export") from None
        self._run = ifcopenshell.api.run
        self._key = uuid.uuid5(_NAMESPACE, plan_to_text(plan))
        self._file = self._run("project.create_file", version="IFC4")
        project = self._entity("IfcProject", title)
        metres = self._run("unit.add_si_unit", self._file, unit_type="LENGTHUNIT")
        area = self._run("unit.add_si_unit", self._file, unit_type="AREAUNIT")
        volume = self._run("unit.add_si_unit", self._file, unit_type="VOLUMEUNIT")
        project.UnitsInContext = self._file.createIfcUnitAssignment([metres, area, volume])
        model = self._run("context.add_context", self._file, context_type="Model")
        if north is None and anchor is not None:
            north = anchor.north
        if north is not None:
            ahead = (math.sin(north), math.cos(north))
            model.TrueNorth = self._file.createIfcDirection(ahead)
        self._body = self._run(
            "context.add_context",
            self._file,
            context_type="Model",
            context_identifier="Body",
            target_view="MODEL_VIEW",
            parent=model,
        )
        site = self._entity("IfcSite", "Site")
        if anchor is not None:
            site.RefLatitude = _angle(anchor.latitude_deg)
            site.RefLongitude = _angle(anchor.longitude_deg)
        self._building = self._entity("IfcBuilding", title)
        self._place(site, None, 0.0)
        self._place(self._building, site, 0.0)
        self._parts(project, [site])
        self._parts(site, [self._building])
        self._storeys: list[Any] = []

    def storey(self, floor: Storey, rise: float, heights: Mapping[str, float]) -> None:
        """Adds a storey with all it holds, its floor at a height."""
        made = self._entity("IfcBuildingStorey", floor.name)
        made.Elevation = float(rise)
        self._place(made, self._building, rise)
        self._storeys.append(made)
        self._parts(made, [self._space(room, made, heights[room.id]) for room in floor.rooms])
        bodies = wall_bodies(floor)
        walls = {}
        for body in bodies:
            beside = [heights[room.id] for room in floor.rooms if _is_of(room, body)]
            walls[body.id] = self._wall(body, made, max(beside))
        leaves = []
        kinds: tuple[tuple[str, tuple[Aperture, ...]], ...] = (
            ("IfcDoor", floor.doors),
            ("IfcWindow", floor.windows),
            ("", floor.openings),
        )
        for kind, items in kinds:
            for item in items:
                ceiling = min((heights[r] for r in item.rooms if r in heights), default=CEILING_M)
                edges = _edges(kind, ceiling)
                leaf = self._leaf(kind, item, made, edges) if kind else None
                around = body_of(item, bodies)
                if around is not None:
                    self._cut(walls[around.id], around, item, edges, leaf)
                if leaf is not None:
                    leaves.append(leaf)
        self._relate(
            "IfcRelContainedInSpatialStructure",
            RelatingStructure=made,
            RelatedElements=[*walls.values(), *leaves],
        )

    def text(self) -> bytes:
        """The file, with ids and time that depend on the plan only."""
        self._parts(self._building, self._storeys)
        for number, item in enumerate(self._file.by_type("IfcRoot")):
            item.GlobalId = self._guid(str(number))
        name = self._file.header.file_name
        name.time_stamp = _NO_TIME
        name.originating_system = "panoplan"
        return str(self._file.to_string()).encode("utf-8")

    def _guid(self, name: str) -> str:
        from ifcopenshell.guid import compress

        return str(compress(uuid.uuid5(self._key, name).hex))

    def _entity(self, kind: str, name: str) -> Any:
        return self._run("root.create_entity", self._file, ifc_class=kind, name=printable(name))

    def _relate(self, kind: str, **fields: Any) -> None:
        self._file.create_entity(kind, GlobalId=self._guid("relation"), **fields)

    def _parts(self, whole: Any, parts: Sequence[Any]) -> None:
        self._relate("IfcRelAggregates", RelatingObject=whole, RelatedObjects=list(parts))

    def _place(self, product: Any, within: Any, rise: float) -> None:
        """Puts a product at a height in the frame of another, or of the world."""
        file = self._file
        point = file.createIfcCartesianPoint((0.0, 0.0, float(rise)))
        frame = file.createIfcAxis2Placement3D(point)
        parent = None if within is None else within.ObjectPlacement
        product.ObjectPlacement = file.createIfcLocalPlacement(parent, frame)

    def _extrude(self, product: Any, area: Any, within: Any, low: float, high: float) -> None:
        """Gives a product a body: an area from one height above its floor to another."""
        file = self._file

        def curve(ring: Any) -> Any:
            points = shapely.get_coordinates(ring)[:-1].tolist()
            corners = [file.createIfcCartesianPoint(point) for point in points]
            return file.createIfcPolyline([*corners, corners[0]])

        outer, *inner = (curve(ring) for ring in (area.exterior, *area.interiors))
        if inner:
            profile = file.createIfcArbitraryProfileDefWithVoids("AREA", None, outer, inner)
        else:
            profile = file.createIfcArbitraryClosedProfileDef("AREA", None, outer)
        base = file.createIfcAxis2Placement3D(file.createIfcCartesianPoint((0.0, 0.0, float(low))))
        up = file.createIfcDirection((0.0, 0.0, 1.0))
        solid = file.createIfcExtrudedAreaSolid(profile, base, up, float(high - low))
        shape = file.createIfcShapeRepresentation(self._body, "Body", "SweptSolid", [solid])
        self._place(product, within, 0.0)
        product.Representation = file.createIfcProductDefinitionShape(None, None, [shape])

    def _quantities(self, product: Any, name: str, **values: float) -> None:
        made = self._run("pset.add_qto", self._file, product=product, name=name)
        self._run("pset.edit_qto", self._file, qto=made, properties=values)

    def _properties(self, product: Any, **values: Any) -> None:
        made = self._run("pset.add_pset", self._file, product=product, name="Panoplan")
        self._run("pset.edit_pset", self._file, pset=made, properties=values)

    def _space(self, room: Room, storey: Any, height: float) -> Any:
        area = _largest(room_area(room))
        made = self._entity("IfcSpace", room.id)
        made.LongName = printable(room.name)
        made.CompositionType, made.PredefinedType = "ELEMENT", "INTERNAL"
        self._extrude(made, area, storey, 0.0, height)
        self._quantities(
            made,
            "Qto_SpaceBaseQuantities",
            NetFloorArea=float(area.area),
            NetPerimeter=float(area.length),
            Height=float(height),
            NetVolume=float(area.area * height),
        )
        sigma = {} if room.area_sigma is None else {"AreaStandardDeviation": room.area_sigma}
        self._properties(
            made, HeightIsAssumed=room.ceiling_height is None, AreaRule=AREA_RULE, **sigma
        )
        return made

    def _wall(self, body: WallBody, storey: Any, height: float) -> Any:
        made = self._entity("IfcWall", body.id)
        made.PredefinedType = "SOLIDWALL"
        self._extrude(made, body.footprint, storey, 0.0, height)
        self._quantities(
            made,
            "Qto_WallBaseQuantities",
            Length=body.length,
            Width=float(body.thickness),
            Height=float(height),
            GrossFootprintArea=float(body.footprint.area),
            GrossVolume=float(body.footprint.area * height),
        )
        self._properties(made, ThicknessIsAssumed=body.outer)
        return made

    def _cut(self, wall: Any, body: WallBody, item: Aperture, edges: Interval, leaf: Any) -> None:
        """Cuts an opening through all of a wall's body, and fills it where there is a leaf."""
        hole = self._entity("IfcOpeningElement", f"{item.id} in {body.id}")
        hole.PredefinedType = "OPENING"
        line = shapely.LineString(item.segment)
        across = line.buffer(body.thickness + _BEYOND_M, cap_style="flat")
        self._extrude(hole, across, wall, *edges)
        self._relate("IfcRelVoidsElement", RelatingBuildingElement=wall, RelatedOpeningElement=hole)
        if leaf is not None:
            self._relate(
                "IfcRelFillsElement", RelatingOpeningElement=hole, RelatedBuildingElement=leaf
            )

    def _leaf(self, kind: str, item: Aperture, storey: Any, edges: Interval) -> Any:
        made = self._entity(kind, item.id)
        line = shapely.LineString(item.segment)
        self._extrude(made, line.buffer(_LEAF_M / 2, cap_style="flat"), storey, *edges)
        made.OverallWidth = float(line.length)
        made.OverallHeight = float(edges[1] - edges[0])
        self._properties(made, HeightIsAssumed=True, Sources=" ".join(item.sources))
        return made


def _is_of(room: Room, body: WallBody) -> bool:
    return any(wall.id in body.faces for wall in room.walls)


def _edges(kind: str, ceiling: float) -> Interval:
    if kind == "IfcWindow":
        return window_edges(ceiling)
    return 0.0, door_head(ceiling) if kind else ceiling


def _largest(area: Any) -> Any:
    return max(shapely.get_parts(area), key=lambda part: float(part.area))


def _angle(degrees: float) -> tuple[int, int, int, int]:
    """Degrees, minutes, seconds and millionths of a second, all of one sign."""
    sign = -1 if degrees < 0 else 1
    seconds, millionths = divmod(round(abs(degrees) * 3600e6), 10**6)
    minutes, second = divmod(seconds, 60)
    return sign * (minutes // 60), sign * (minutes % 60), sign * second, sign * millionths
