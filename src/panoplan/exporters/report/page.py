"""A report as one HTML file that needs nothing else."""

from __future__ import annotations

import base64
import hashlib
import html
import io
import json
from collections.abc import Callable, Mapping
from concurrent.futures import ThreadPoolExecutor
from importlib import resources
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from panoplan.exporters.model.texture import SMALLEST_PX
from panoplan.exporters.report.data import report_data
from panoplan.formats.image import read_panorama
from panoplan.types.plan import FloorPlan

_PANORAMAS_BYTES = 14 * 2**20
_PANORAMA_BYTES = 300 * 2**10
_MODEL_BYTES = 3 * 2**20
_THREADS = 4
_SIZES = ((2048, 80), (1536, 78), (1024, 78), (1024, 60), (768, 55), (512, 50), (512, 30))


def report_html(
    plan: FloorPlan,
    title: str,
    images: Mapping[str, Path],
    model: Callable[[], bytes],
    progress: Callable[[int, int], None] = lambda done, total: None,
) -> bytes:
    """A report: plan, model, panoramas, scale, what was left out; offline, at most 25 MB.

    Names are data in it: they are set as text by its script, and its policy lets no other run.

    Args:
        plan: metric.
        title: of the report.
        images: panorama by keyframe, as many as there are; made smaller to fit.
        model: makes a GLB of the rooms, which is left out where it is larger than 3 MiB; called
            while panoramas are made.
        progress: called with (panoramas done, panoramas in all).

    Raises:
        InputError: not metric or without rooms, or an image that cannot be used.
    """
    data = report_data(plan, title)
    own = resources.files("panoplan.exporters.report")
    script, style, notices = (
        own.joinpath(name).read_text("utf-8") for name in ("report.js", "report.css", "NOTICES.txt")
    )
    data["notices"] = notices
    shown = [pose.id for pose in plan.trajectory if pose.id in images]
    limit = min(_PANORAMA_BYTES, _PANORAMAS_BYTES // max(len(shown), 1))
    data["panoramas"] = {}
    # Most of the work is in Pillow, which lets threads run beside one another.
    with ThreadPoolExecutor(_THREADS) as pool:
        made = pool.map(lambda name: _small_jpeg(images[name], limit), shown)
        rooms = model()
        for number, (name, picture) in enumerate(zip(shown, made, strict=True)):
            data["panoramas"][name] = _base64(picture)
            progress(number + 1, len(shown))
    data["model"] = _base64(rooms) if len(rooms) <= _MODEL_BYTES else None
    return _page(data, script, style).encode("utf-8")


def _page(data: dict[str, Any], script: str, style: str) -> str:
    # No "</script>" and no "<!--" may stand in it.
    script = script.replace("</script", "<\\/script").replace("<!--", "<\\!--")
    allowed = base64.b64encode(hashlib.sha256(script.encode("utf-8")).digest()).decode()
    policy = (
        f"default-src 'none'; script-src 'sha256-{allowed}'; style-src 'unsafe-inline'; "
        "img-src data: blob:; connect-src data: blob:; worker-src blob:; base-uri 'none'; "
        "form-action 'none'"
    )
    text = json.dumps(data, ensure_ascii=False, allow_nan=False).replace("<", "\\u003c")
    return (
        '<!doctype html>\n<html lang="en">\n<head>\n<meta charset="utf-8">\n'
        f'<meta http-equiv="Content-Security-Policy" content="{policy}">\n'
        '<meta name="viewport" content="width=device-width, initial-scale=1">\n'
        f"<title>{html.escape(data['title'])}</title>\n<style>\n{style}</style>\n</head>\n<body>\n"
        '<div id="report"><noscript>This report needs JavaScript; it loads nothing from the '
        "network.</noscript></div>\n"
        f'<script type="application/json" id="data">{text}</script>\n'
        f"<script>{script}</script>\n</body>\n</html>\n"
    )


def _base64(data: bytes) -> str:
    return base64.b64encode(data).decode("ascii")


def _small_jpeg(path: Path, limit: int) -> bytes:
    """A panorama as JPEG of at most so many bytes, as large and good as that allows."""
    image = read_panorama(path, widest=_SIZES[0][0], smallest=SMALLEST_PX)
    made = b""
    for width, quality in _SIZES:
        made = _jpeg(image, width, quality)
        if len(made) <= limit:
            break
    return made


def _jpeg(image: NDArray[np.uint8], width: int, quality: int) -> bytes:
    from PIL import Image

    picture = Image.fromarray(image)
    wide = min(width, picture.width)
    picture = picture.resize((wide, wide // 2), resample=Image.Resampling.BOX)
    stream = io.BytesIO()
    picture.save(stream, format="JPEG", quality=quality)
    return stream.getvalue()
