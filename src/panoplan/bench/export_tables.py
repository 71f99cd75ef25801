"""Tables of exports and of the textured model."""

from __future__ import annotations

from typing import Any

from panoplan.bench.markdown import number, table
from panoplan.bench.record import of_benchmark


def formats(files: list[dict[str, Any]]) -> str:
    """What each format took, and how well it was read back."""
    parts = []
    for data in of_benchmark(files, "exports"):
        f, machine = data["figures"], data["machine"]
        rows = [
            [
                kind,
                number(row["seconds"], 1, " s"),
                number(row["cpu_seconds"], 1, " s"),
                number(row["bytes"] / 1e6, 2, " MB"),
                number(row["area_error_percent"], 4, " %"),
            ]
            for kind, row in f["formats"].items()
        ]
        heads = ["format", "command", "of CPU", "size", "area of a room read back, largest error"]
        dxf = f["dxf"]
        parts.append(
            f"Exports of {f['scene']} ({f['rooms']} rooms, {f['images']} panoramas), a command "
            f"each, start of Python included, on {machine['cores']} cores "
            f"({machine['processor']}).\n\n{table(heads, rows)}\n"
            f"The audit of the DXF finds {dxf['faults']} faults; its {dxf['dimensions']} "
            f"dimensions are at most {number(dxf['dimension_error_mm'], 3)} mm off the walls. The "
            f"validator of the IFC finds {f['ifc']['errors']} errors.\n"
        )
    return "\n".join(parts)


def areas(files: list[dict[str, Any]]) -> str:
    """The area of each room against the true one."""
    parts = []
    for f in (data["figures"] for data in of_benchmark(files, "exports")):
        rows = []
        for line in f["areas"]:
            true, told, sigma = line["true_m2"], line["area_m2"], line["area_sigma_m2"]
            off = None if told is None else 100 * (told / true - 1)
            rows.append(
                [
                    line["label"] or line["room"],
                    number(true, 2, " m²"),
                    number(told, 2, " m²") + ("" if sigma is None else f" ± {sigma:.2f}"),
                    number(off, 1, " %"),
                ]
            )
        heads = ["room", "true", "plan", "off by"]
        parts.append(f"Areas of the rooms of {f['scene']}.\n\n{table(heads, rows)}")
    return "\n".join(parts)


def model(files: list[dict[str, Any]]) -> str:
    """How well the textured model shows what photos show."""
    rows = []
    for f in (data["figures"] for data in of_benchmark(files, "model")):
        for name in ("all_photos", "without_the_five"):
            part = f[name]
            each = " ".join(number(row["psnr_db"], 1) for row in part["cameras"])
            share = sum(row["pixels_share"] for row in part["cameras"]) / len(part["cameras"])
            rows.append(
                [
                    f"{f['scene']}, {name.replace('_', ' ')}",
                    str(f["photos"]),
                    number(part["psnr_db"], 1, " dB"),
                    each,
                    number(100 * share, 0, " %"),
                    "yes" if f["true_depth"] else "–",
                    number(part["glb_bytes"] / 1e6, 2, " MB"),
                ]
            )
    if not rows:
        return ""
    heads = ["scene, texture of", "photos", "PSNR", "of each camera", "pixels compared",
             "depth known", "GLB"]  # fmt: skip
    return (
        "The textured model rendered from five of the cameras against their photos: without the "
        "cone below the camera, and, where the true depth is known, without what lies more than "
        f"10 cm off the model (furniture, panes).\n\n{table(heads, rows)}"
    )
