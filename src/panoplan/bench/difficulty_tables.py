"""Tables of how hard simulated scenes are, and of how simulated layouts err."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from panoplan.bench.difficulty import JUDGED
from panoplan.bench.markdown import table
from panoplan.bench.record import of_benchmark
from panoplan.simulate.measured import MEASURED

_LABELS = {
    "mean_iou": "mean IoU",
    "corner_cm": "corners, median cm",
    "wall_cm": "walls, median cm",
    "floor_iou": "floor IoU",
    "hits_50": "rooms at IoU .5",
    "hits_70": "rooms at IoU .7",
}
_SURFACES = ("wall", "door", "opening", "window")
_Errors = dict[str, Any]


def figures(files: list[dict[str, Any]]) -> str:
    """The method's figures on the real layouts beside those on simulated ones, in Markdown.

    Args:
        files: benchmark files.
    """
    rows = []
    for data in _figures(files):
        for key, told in (("stated", "with"), ("unstated", "without")):
            of = data[key]
            for name, label in _LABELS.items():
                low, high, middle = of["band"][name]
                verdict = ("yes" if of["within"][name] else "no") if name in JUDGED else "–"
                band = f"{_form(low, '.3g')} to {_form(high, '.3g')}"
                real = _form(of["real"][name], ".3g")
                rows.append([f"{label}, {told}", real, _form(middle, ".3g"), band, verdict])
    heads = ["figure, with or without stated σ", "real", "seeds, median", "5 % to 95 %", "within"]
    return table(heads, rows) if rows else ""


def errors(files: list[dict[str, Any]]) -> str:
    """The errors of layouts, measured and simulated, in Markdown.

    Args:
        files: benchmark files.
    """
    found = _figures(files)
    if not found:
        return ""
    first = found[0]
    columns = [_measured(), *(first[f"errors_{k}"] for k in ("homes", "real", "simulated"))]
    heads = ["", "real, 69 panoramas of two homes", "simulated open homes",
             f"real home, its {first['cameras']} cameras", "the same simulated"]  # fmt: skip
    return table(heads, [[label, *map(told, columns)] for label, told in _rows()])


def _figures(files: list[dict[str, Any]]) -> list[dict[str, Any]]:
    return [data["figures"] for data in of_benchmark(files, "difficulty")]


def _rows() -> list[tuple[str, Callable[[_Errors], str]]]:
    """Labels, and what is told of the errors in each row."""
    ends = [*MEASURED.from_m[1:], 6.0]
    rows: list[tuple[str, Callable[[_Errors], str]]] = [
        (f"{low:g}-{high:g} m: bias°, MAD-σ°, 90th percentile m, gross", _bin(k))
        for k, (low, high) in enumerate(zip(MEASURED.from_m, ends, strict=True))
    ]
    rows += [(f"gross on {surface}s", _gross(surface)) for surface in _SURFACES]
    rows += [(f"{kind}s: gone through, stopped at", _stops(kind)) for kind in ("door", "opening")]
    lags = ", ".join(map(str, MEASURED.lags))
    return [
        *rows,
        (
            "depth of leaks m: median, 90th percentile",
            lambda e: _forms((e["leak_median_m"], ".2f"), (e["leak_percentile_90_m"], ".1f")),
        ),
        (
            "scale of a panorama: std, MAD-σ",
            lambda e: _forms((e["scale_std"], ".1%"), (e["scale_mad_sigma"], ".1%")),
        ),
        (
            f"autocorrelation at {lags} columns",
            lambda e: _forms(*((value, ".2f") for value in e["autocorrelation"])),
        ),
        (
            "panoramas over 25 % gross, under 5 %",
            lambda e: _forms((e["bad_views"], ".0%"), (e["good_views"], ".0%")),
        ),
    ]


def _bin(k: int) -> Callable[[_Errors], str]:
    return lambda e: _forms(
        (e["bias_deg"][k], "+.2f"),
        (e["sigma_deg"][k], ".2f"),
        (e["percentile_90_m"][k], ".2f"),
        (e["gross_share"][k], ".1%"),
    )


def _gross(surface: str) -> Callable[[_Errors], str]:
    return lambda e: _form(e["gross_by_surface"][surface], ".1%")


def _stops(kind: str) -> Callable[[_Errors], str]:
    return lambda e: _forms((e["through"][kind], ".1%"), (e["stops"][kind], ".0%"))


def _forms(*values: tuple[float | None, str]) -> str:
    return ", ".join(_form(value, form) for value, form in values)


def _form(value: float | None, form: str) -> str:
    """A number; a dash where nothing was seen that it could be of."""
    return "–" if value is None else f"{value:{form}}"


def _measured() -> _Errors:
    """What was measured, in the form of an `ErrorTable`."""
    return {
        "bias_deg": MEASURED.bias_deg,
        "sigma_deg": MEASURED.sigma_deg,
        "percentile_90_m": MEASURED.percentile_90_m,
        "gross_share": MEASURED.gross_share,
        "gross_by_surface": {s: getattr(MEASURED, f"gross_{s}") for s in _SURFACES},
        "through": {"door": MEASURED.door_through, "opening": MEASURED.opening_through},
        "stops": {"door": MEASURED.door_stops, "opening": MEASURED.opening_stops},
        "leak_median_m": MEASURED.leak_median_m,
        "leak_percentile_90_m": MEASURED.leak_percentile_90_m,
        "scale_std": MEASURED.scale_std,
        "scale_mad_sigma": MEASURED.scale_mad_sigma,
        "autocorrelation": MEASURED.autocorrelation,
        "bad_views": MEASURED.bad_views,
        "good_views": MEASURED.good_views,
    }
