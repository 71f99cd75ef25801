"""A sheet as SVG: a group a layer, millimetres as user units, text as text."""

from __future__ import annotations

from xml.etree import ElementTree

from panoplan.exporters.sheet.marks import Mark, Shape, Sheet
from panoplan.types.arrays import FloatArray

_FONT = "'DejaVu Sans', Verdana, Arial, sans-serif"


def sheet_svg(sheet: Sheet) -> bytes:
    """A sheet as SVG whose user unit is a millimetre of paper; same sheet, same bytes."""
    width, height = _number(sheet.paper.width), _number(sheet.paper.height)
    root = ElementTree.Element(
        "svg",
        {
            "xmlns": "http://www.w3.org/2000/svg",
            "width": f"{width}mm",
            "height": f"{height}mm",
            "viewBox": f"0 0 {width} {height}",
            "font-family": _FONT,
            "role": "img",
        },
    )
    ElementTree.SubElement(root, "title").text = f"{sheet.title}, 1:{sheet.denominator}"
    ElementTree.SubElement(
        root, "rect", {"width": width, "height": height, "fill": "#FFFFFF", "stroke": "none"}
    )
    for name, marks in sheet.layers.items():
        group = ElementTree.SubElement(root, "g", {"id": name})
        for mark in marks:
            _add(group, mark)
    ElementTree.indent(root, "")
    return bytes(ElementTree.tostring(root, encoding="utf-8", xml_declaration=True))


def _add(group: ElementTree.Element, mark: Mark) -> None:
    if isinstance(mark, Shape):
        fields = {
            "d": "".join(_path(ring, mark.closed) for ring in mark.rings),
            "fill": mark.fill or "none",
            "fill-rule": "evenodd",
            "stroke": mark.stroke or "none",
        }
        if mark.stroke:
            fields["stroke-width"] = _number(mark.width)
        if mark.dash:
            fields["stroke-dasharray"] = " ".join(_number(length) for length in mark.dash)
        if mark.id:
            fields["id"] = mark.id
        node = ElementTree.SubElement(group, "path", fields)
        if mark.title:
            ElementTree.SubElement(node, "title").text = mark.title
        return
    x, y = (_number(value) for value in mark.at)
    fields = {
        "x": x,
        "y": y,
        "font-size": _number(mark.size),
        "fill": mark.colour,
        "text-anchor": mark.anchor,
        "dominant-baseline": "central",
    }
    if mark.bold:
        fields["font-weight"] = "bold"
    if mark.angle_deg:
        fields["transform"] = f"rotate({_number(-mark.angle_deg)} {x} {y})"
    ElementTree.SubElement(group, "text", fields).text = mark.text


def _path(ring: FloatArray, closed: bool) -> str:
    points = "L".join(f"{_number(x)} {_number(y)}" for x, y in ring)
    return f"M{points}{'Z' if closed else ''}"


def _number(value: float) -> str:
    return f"{value + 0.0:.4f}".rstrip("0").rstrip(".")
