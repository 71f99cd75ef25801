"""What other libraries read in exported files: the floor area of each room, lengths, complaints."""

from __future__ import annotations

import csv
import io
import json
import re
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import Any
from xml.etree import ElementTree

import numpy as np
import shapely

from panoplan.errors import MissingExtraError

_SVG = "{http://www.w3.org/2000/svg}"
_MM_PER_PT = 25.4 / 72


def svg_areas(files: Sequence[Path]) -> list[float]:
    """m² of the paths of rooms on sheets whose user unit is a millimetre, by the scale in words."""
    found = []
    for path in files:
        root = ElementTree.fromstring(path.read_bytes())
        square_m = _square_metres(root.findtext(f"{_SVG}title") or "")
        for node in root.iter(f"{_SVG}path"):
            if node.get("id", "").startswith("room_"):
                found.append(square_m * path_area(node.get("d", "")))
    return found


def pdf_areas(files: Sequence[Path]) -> list[float]:
    """m² of every filled area of a PDF's pages, by the scale that stands on each."""
    try:
        from pdfminer.high_level import extract_pages
        from pdfminer.layout import LTCurve, LTTextContainer
    except ImportError:
        raise MissingExtraError("reading a PDF back", "pdfminer.six", "dev") from None
    found = []
    for page in (page for path in files for page in extract_pages(path)):
        words = " ".join(box.get_text() for box in page if isinstance(box, LTTextContainer))
        square_m = _square_metres(words) * _MM_PER_PT**2
        found += [
            square_m * float(shapely.Polygon(curve.pts).area)
            for curve in page
            if isinstance(curve, LTCurve) and curve.fill and len(curve.pts) > 3
        ]
    return found


def _square_metres(words: str) -> float:
    """Square metres that a square millimetre stands for, by the scale in a text."""
    scale = re.search(r"\b1:(\d+)\b", words)
    return float("nan") if scale is None else (float(scale[1]) / 1000) ** 2


def path_area(text: str) -> float:
    """Square user units within an SVG path of straight lines, holes taken off.

    Args:
        text: the path's `d`: closed rings, absolute.
    """
    total = 0.0
    for ring in text.strip("M").split("M"):
        numbers = [float(word) for word in re.split("[ L]", ring.strip("Z"))]
        x, y = np.array(numbers).reshape(-1, 2).T
        total += float(np.sum(x * np.roll(y, -1) - np.roll(x, -1) * y)) / 2
    return abs(total)


def dxf(files: Sequence[Path]) -> tuple[list[float], list[float], int]:
    """m² of each closed line on A-AREA, metres that each dimension measures, faults audited."""
    import ezdxf

    document = ezdxf.readfile(files[0])
    audit = document.audit()
    space: Any = document.modelspace()
    areas = [
        float(shapely.Polygon(line.get_points("xy")).area)
        for line in space.query("LWPOLYLINE")
        if re.fullmatch(r"A-AREA(-L-?\d+)?", line.dxf.layer) and line.closed
    ]
    lengths = [float(item.get_measurement()) for item in space.query("DIMENSION")]
    return areas, lengths, len(audit.errors) + len(audit.fixes)


def geojson_areas(files: Sequence[Path]) -> list[float]:
    """m² of the polygons of units."""
    features = json.loads(files[0].read_bytes())["features"]
    return [
        float(shapely.geometry.shape(feature["geometry"]).area)
        for feature in features
        if feature["properties"]["feature_type"] == "unit"
    ]


def ifc(files: Sequence[Path]) -> tuple[list[float], int]:
    """m² of the spaces, by the volume of their bodies over the height, and the validator's errors.

    The base quantities have to say the same; where one does not by 0.1 %, its area is NaN.
    """
    import ifcopenshell
    import ifcopenshell.geom
    import ifcopenshell.util.element
    import ifcopenshell.util.shape
    import ifcopenshell.validate

    validate: Any = ifcopenshell.validate
    geometry: Any = ifcopenshell.geom
    file: Any = ifcopenshell.open(str(files[0]))
    log = validate.json_logger()
    validate.validate(file, log)
    areas = []
    for space in file.by_type("IfcSpace"):
        body = geometry.create_shape(geometry.settings(), space).geometry
        (told,) = ifcopenshell.util.element.get_psets(space, qtos_only=True).values()
        area = float(ifcopenshell.util.shape.get_volume(body)) / told["Height"]
        same = abs(told["NetFloorArea"] / area - 1) < 1e-3
        areas.append(area if same else float("nan"))
    return areas, len(log.statements)


def glb_areas(files: Sequence[Path]) -> list[float]:
    """m² of the triangles of each floor."""
    import trimesh

    scene = trimesh.load_scene(io.BytesIO(files[0].read_bytes()), file_type="glb")
    return [
        float(mesh.area)
        for name, mesh in scene.geometry.items()
        if re.fullmatch(r"room_\d+_floor", name)
    ]


def csv_areas(files: Sequence[Path]) -> list[float]:
    """m² in the room schedule."""
    with files[0].open(encoding="utf-8", newline="") as stream:
        return [float(row["area_m2"]) for row in csv.DictReader(stream)]


def html_areas(files: Sequence[Path]) -> list[float]:
    """m² in the data of a report."""
    page = files[0].read_text(encoding="utf-8")
    data = re.search(r'<script type="application/json" id="data">(.*?)</script>', page, re.S)
    storeys = [] if data is None else json.loads(data[1])["storeys"]
    return [float(room["area"]) for storey in storeys for room in storey["rooms"]]


AREAS: Mapping[str, Callable[[Sequence[Path]], list[float]]] = {
    "svg": svg_areas,
    "pdf": pdf_areas,
    "dxf": lambda files: dxf(files)[0],
    "geojson": geojson_areas,
    "ifc": lambda files: ifc(files)[0],
    "glb": glb_areas,
    "csv": csv_areas,
    "html": html_areas,
}
"""Areas by the kind of export."""


def largest_error(found: Sequence[float], wanted: Sequence[float]) -> float | None:
    """The largest relative deviation of what was wanted from the nearest value found.

    Args:
        found: values read back, in any order; more of them than wanted do no harm.
        wanted: one or more, above 0.

    Returns:
        The deviation; None where fewer were found than wanted, or one is NaN.
    """
    values: Any = np.asarray(found, dtype=np.float64)
    if len(values) < len(wanted) or np.isnan(values).any():
        return None
    return max(float(np.abs(values / value - 1).min()) for value in wanted)
