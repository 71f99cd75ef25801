"""All formats that a plan is exported to, by name."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path

from panoplan.errors import InputError
from panoplan.exporters.geojson import Anchor
from panoplan.formats.atomic import make_folder, write_together
from panoplan.types.plan import FloorPlan

Files = Mapping[str, bytes]

TEXEL_M = 0.0125
"""Size of a texel of the GLB."""

_WIDEST_PX = 4096
"""Width of the panoramas that it is textured from, at most."""

_REPORT_TEXEL_M = 0.04
_REPORT_PX = 1024
"""Width of the panoramas that the model in the report is textured from: its texels are coarse."""


@dataclass(frozen=True)
class ExportOptions:
    """What exports are told beside the plan.

    Attributes:
        title: of drawings.
        north: rad, heading of north in the plan, from its second axis towards its first; None
            where not known.
        paper: "A4" to "A0" for sheets, None for what suits.
        anchor: where the plan's origin lies on the globe, for GeoJSON and IFC; None where not
            known.
        images: panorama of each keyframe, for the GLB's texture; empty for plain colours.
        progress: called with (surfaces textured, surfaces in all).
    """

    title: str
    north: float | None = None
    paper: str | None = None
    anchor: Anchor | None = None
    images: Mapping[str, Path] = field(default_factory=dict)
    progress: Callable[[int, int], None] = lambda done, total: None


def _svg(plan: FloorPlan, options: ExportOptions) -> Files:
    from panoplan.exporters.sheet.compose import sheets
    from panoplan.exporters.sheet.svg import sheet_svg

    made = sheets(plan, title=options.title, north=options.north, paper=options.paper)
    if len(made) == 1:
        return {"sheet.svg": sheet_svg(made[0])}
    return {f"sheet_{number}.svg": sheet_svg(sheet) for number, sheet in enumerate(made, 1)}


def _pdf(plan: FloorPlan, options: ExportOptions) -> Files:
    from panoplan.exporters.sheet.compose import sheets
    from panoplan.exporters.sheet.pdf import sheets_pdf

    made = sheets(plan, title=options.title, north=options.north, paper=options.paper)
    return {"sheet.pdf": sheets_pdf(made)}


def _dxf(plan: FloorPlan, options: ExportOptions) -> Files:
    from panoplan.exporters.dxf import plan_dxf

    return {"plan.dxf": plan_dxf(plan)}


def _geojson(plan: FloorPlan, options: ExportOptions) -> Files:
    from panoplan.exporters.geojson import plan_geojson

    return {"plan.geojson": plan_geojson(plan, options.anchor)}


def _ifc(plan: FloorPlan, options: ExportOptions) -> Files:
    from panoplan.exporters.ifc import plan_ifc

    made = plan_ifc(plan, options.title, north=options.north, anchor=options.anchor)
    return {"plan.ifc": made}


def _glb(plan: FloorPlan, options: ExportOptions) -> Files:
    return {"plan.glb": _model(plan, options, TEXEL_M, _WIDEST_PX, options.progress)}


def _html(plan: FloorPlan, options: ExportOptions) -> Files:
    from panoplan.exporters.report.page import report_html

    def model() -> bytes:
        return _model(plan, options, _REPORT_TEXEL_M, _REPORT_PX, lambda done, total: None)

    page = report_html(plan, options.title, options.images, model, options.progress)
    return {"report.html": page}


def _model(
    plan: FloorPlan,
    options: ExportOptions,
    texel_m: float,
    widest: int,
    progress: Callable[[int, int], None],
) -> bytes:
    from panoplan.exporters.model.glb import plan_glb
    from panoplan.exporters.model.surfaces import plan_surfaces
    from panoplan.exporters.model.texture import pictures, read_photos

    surfaces = plan_surfaces(plan)
    photos = read_photos(plan, options.images, widest)
    made = pictures(surfaces, photos, texel_m, progress) if photos else {}
    return plan_glb(plan, surfaces, made)


def _csv(plan: FloorPlan, options: ExportOptions) -> Files:
    from panoplan.exporters.schedule import room_schedule

    return {"rooms.csv": room_schedule(plan)}


KINDS: Mapping[str, Callable[[FloorPlan, ExportOptions], Files]] = {
    "svg": _svg,
    "pdf": _pdf,
    "dxf": _dxf,
    "geojson": _geojson,
    "ifc": _ifc,
    "glb": _glb,
    "csv": _csv,
    "html": _html,
}
"""Exporters by the name that the command line knows."""


def export(
    plan: FloorPlan, kinds: Sequence[str], folder: Path, options: ExportOptions
) -> list[Path]:
    """Writes a plan in some formats; where one fails, none is written.

    Args:
        plan: metric.
        kinds: names of `KINDS`.
        folder: where to; made where it does not exist.
        options: what they are told.

    Returns:
        The files in the order of `kinds`.

    Raises:
        InputError: no kind or an unknown one, a plan that cannot be exported so, or a place that
            cannot be written; MissingExtraError: a library is not installed.
    """
    for kind in kinds or [""]:
        if kind not in KINDS:
            raise InputError("--to", repr(kind), "some of " + ",".join(KINDS))
    files: dict[str, bytes] = {}
    for kind in kinds:
        files.update(KINDS[kind](plan, options))
    make_folder(folder)
    write_together({folder / name: data for name, data in files.items()})
    return [folder / name for name in files]
