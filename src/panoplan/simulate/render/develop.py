"""From radiance to the picture that a 360° camera would have given."""

from __future__ import annotations

import io
from dataclasses import dataclass

import numpy as np
from numba import njit
from numpy.typing import NDArray
from PIL import Image
from scipy.ndimage import gaussian_filter, zoom

from panoplan.geometry.sphere import column_heading
from panoplan.simulate.render.materials import Float32Array
from panoplan.types.arrays import FloatArray

_GAMMA = 1 / 2.2
_TABLE = 4096
_STOPS = (-10.0, 10.0)
_COARSE = 16


@dataclass(frozen=True)
class Development:
    """What camera and software make of a scene's light.

    Attributes:
        exposure: brightness that the median comes out with, 0-1 on screen.
        flattening: how far large differences of brightness are evened out, as HDR does: 0-1.
        shoulder: how early highlights are compressed, 0-1.
        contrast: exponent around the middle.
        balance: gains of red, green and blue.
        saturation: 1 leaves colours.
        blur_px: standard deviation, pixels of a picture 1024 wide.
        noise: standard deviation on screen, 0-1.
        lens_step: difference in exposure of the camera's two lenses.
        nadir: what covers the ground below: "none", "dark" (tripod and hand), "blur" or "disc".
        nadir_rad: how far it reaches from straight down.
        jpeg: quality of the compression that the picture went through, 0 for none.
    """

    exposure: float = 0.6
    flattening: float = 0.3
    shoulder: float = 0.5
    contrast: float = 1.0
    balance: tuple[float, float, float] = (1.0, 1.0, 1.0)
    saturation: float = 1.0
    blur_px: float = 0.5
    noise: float = 0.005
    lens_step: float = 0.0
    nadir: str = "none"
    nadir_rad: float = 0.25
    jpeg: int = 0


def draw_development(rng: np.random.Generator) -> Development:
    """How some camera would do it."""
    warm = rng.normal(0, 0.06)
    return Development(
        exposure=float(rng.uniform(0.45, 0.75)),
        flattening=float(np.clip(rng.uniform(-0.1, 0.75), 0, 1)),
        shoulder=float(rng.uniform(0.2, 0.9)),
        contrast=float(rng.uniform(0.8, 1.3)),
        balance=(float(np.exp(warm)), float(np.exp(rng.normal(0, 0.02))), float(np.exp(-warm))),
        saturation=float(rng.uniform(0.5, 1.25)),
        blur_px=float(rng.uniform(0.3, 2.0)),
        noise=float(rng.exponential(0.006)),
        lens_step=float(rng.normal(0, 0.04)),
        nadir=str(rng.choice(["none", "dark", "blur", "disc"], p=[0.3, 0.4, 0.15, 0.15])),
        nadir_rad=float(rng.uniform(0.08, 0.4)),
        jpeg=int(rng.integers(50, 96)) if rng.random() < 0.7 else 0,
    )


def develop(
    radiance: Float32Array, development: Development, rng: np.random.Generator
) -> NDArray[np.uint8]:
    """The picture.

    Args:
        radiance: (H, W, 3) linear.
        development: what the camera does.
        rng: of noise and of the outline of what covers the nadir.

    Returns:
        (H, W, 3) sRGB-like.
    """
    height, width = radiance.shape[:2]
    d = development
    light = _log_brightness(radiance)
    median = float(np.median(light))
    flat = d.flattening * (_coarse(light) - median)
    heading = column_heading(np.arange(width, dtype=np.float64), width)
    step = (d.lens_step * np.tanh(4 * np.cos(heading + 0.3))).astype(np.float32)
    colour = _exposed(
        radiance,
        flat,
        step - np.float32(median),
        np.asarray(d.balance, dtype=np.float32),
        np.float32(d.saturation),
    )
    if d.blur_px > 0:
        colour = _blurred(colour, _taps(d.blur_px * width / 1024))
    screen = _toned(colour, *_tone_table(d))
    if d.nadir != "none":
        _cover_nadir(screen, d, rng)
    if d.noise > 0:
        grain = rng.standard_normal((height, width), dtype=np.float32)
        screen += np.float32(d.noise) * grain[..., None]
    picture = _eight_bits(screen)
    if d.jpeg == 0:
        return picture
    return np.asarray(Image.open(io.BytesIO(jpeg(picture, d.jpeg))))


@njit(cache=True)
def _log_brightness(radiance):
    height, width, _ = radiance.shape
    out = np.empty((height, width), dtype=np.float32)
    for i in range(height):
        for j in range(width):
            grey = 0.3 * radiance[i, j, 0] + 0.55 * radiance[i, j, 1] + 0.15 * radiance[i, j, 2]
            out[i, j] = np.log(grey + np.float32(1e-3))
    return out


def _coarse(light: Float32Array) -> Float32Array:
    """Brightness without its detail."""
    height, width = light.shape
    n = max(height // _COARSE, 1)
    step = height // n
    small = light[: n * step].reshape(n, step, width // step, step).mean(axis=(1, 3))
    smooth = gaussian_filter(small, 1.2, mode=("nearest", "wrap"))
    padded = np.pad(smooth, ((0, 0), (1, 1)), mode="wrap")
    large = zoom(padded, step, order=1, mode="nearest", grid_mode=True)
    return np.asarray(large[:height, step:-step], dtype=np.float32)


@njit(cache=True)
def _exposed(radiance, flat, step, balance, saturation):
    """Radiance times the gains: less where it is bright all around, and each lens's own."""
    out = np.empty_like(radiance)
    height, width, _ = radiance.shape
    for i in range(height):
        for j in range(width):
            gain = np.exp(step[j] - flat[i, j])
            r = radiance[i, j, 0] * gain * balance[0]
            g = radiance[i, j, 1] * gain * balance[1]
            b = radiance[i, j, 2] * gain * balance[2]
            mean = (r + g + b) / np.float32(3)
            out[i, j, 0] = max(mean + saturation * (r - mean), np.float32(0))
            out[i, j, 1] = max(mean + saturation * (g - mean), np.float32(0))
            out[i, j, 2] = max(mean + saturation * (b - mean), np.float32(0))
    return out


def _taps(sigma: float) -> Float32Array:
    """(3,) weights of a pixel, its neighbours and theirs."""
    taps = np.exp(-0.5 * (np.arange(3) / max(sigma, 1e-3)) ** 2)
    return np.asarray(taps / (taps[0] + 2 * taps[1:].sum()), dtype=np.float32)


@njit(cache=True)
def _blurred(colour, taps):
    """Blur along columns, then along rows; the picture wraps at its sides."""
    height, width, _ = colour.shape
    upright = np.empty_like(colour)
    for i in range(height):
        a, b = max(i - 1, 0), min(i + 1, height - 1)
        aa, bb = max(i - 2, 0), min(i + 2, height - 1)
        for j in range(width):
            for c in range(3):
                upright[i, j, c] = (
                    taps[0] * colour[i, j, c]
                    + taps[1] * (colour[a, j, c] + colour[b, j, c])
                    + taps[2] * (colour[aa, j, c] + colour[bb, j, c])
                )
    out = np.empty_like(colour)
    for i in range(height):
        for j in range(width):
            a, b = (j - 1) % width, (j + 1) % width
            aa, bb = (j - 2) % width, (j + 2) % width
            for c in range(3):
                out[i, j, c] = (
                    taps[0] * upright[i, j, c]
                    + taps[1] * (upright[i, a, c] + upright[i, b, c])
                    + taps[2] * (upright[i, aa, c] + upright[i, bb, c])
                )
    return out


def _tone_table(d: Development) -> tuple[Float32Array, np.float32]:
    """Screen values at even steps of the logarithm of light, and the logarithm's offset.

    The median comes out at `exposure`; highlights roll off.
    """
    linear = 2.0 ** np.linspace(*_STOPS, _TABLE)
    knee = 0.3 + 4 * (1 - d.shoulder)

    def raw(light: FloatArray) -> FloatArray:
        return np.asarray((light * (1 + light / knee**2) / (1 + light)) ** (_GAMMA * d.contrast))

    middle = float(raw(np.ones(1))[0])
    table = np.clip(raw(linear) / middle * d.exposure, 0, 1)
    return table.astype(np.float32), np.float32(_STOPS[0])


@njit(cache=True)
def _toned(colour, table, lowest):
    out = np.empty_like(colour)
    flat, into = colour.reshape(-1), out.reshape(-1)
    last = len(table) - 1
    factor = np.float32(last) / (np.float32(-2) * lowest)
    for k in range(len(flat)):
        stop = (np.log2(flat[k] + np.float32(1e-6)) - lowest) * factor
        into[k] = table[int(min(max(stop, np.float32(0)), np.float32(last)))]
    return out


@njit(cache=True)
def _eight_bits(screen):
    out = np.empty(screen.shape, dtype=np.uint8)
    flat, into = screen.reshape(-1), out.reshape(-1)
    for k in range(len(flat)):
        into[k] = np.uint8(
            min(max(flat[k] * 255 + np.float32(0.5), np.float32(0)), np.float32(255))
        )
    return out


def _cover_nadir(screen: Float32Array, d: Development, rng: np.random.Generator) -> None:
    """Tripod and hand, a smear or a disc over the ground below the camera, in place."""
    height, width = screen.shape[:2]
    heading = column_heading(np.arange(width, dtype=np.float64), width)
    edge = np.full(width, d.nadir_rad)
    if d.nadir == "dark":
        for k in range(1, 7):
            edge += (
                d.nadir_rad * 0.35 / k * rng.normal() * np.cos(k * heading + rng.uniform(0, 6.3))
            )
    rows = np.clip(height - edge / np.pi * height, height * 0.8, height).astype(int)
    below = np.arange(height)[:, None] >= rows[None]
    if d.nadir == "dark":
        tone = (rng.uniform(0.02, 0.25) + rng.normal(0, 0.02, 3)).astype(np.float32)
        shade = 1 + 0.4 * np.cos(3 * heading + rng.uniform(0, 6.3)).astype(np.float32)
        screen[below] = (tone * shade[:, None])[np.nonzero(below)[1]]
    elif d.nadir == "disc":
        grey = rng.uniform(0, 1) + rng.normal(0, 0.05, 3)
        screen[below] = grey.astype(np.float32)
    else:
        screen[below] = screen[rows[0] - 1].mean(axis=0)


def jpeg(picture: NDArray[np.uint8], quality: int) -> bytes:
    """A picture (H, W, 3) as a JPEG file of a quality from 1 to 95."""
    buffer = io.BytesIO()
    Image.fromarray(picture).save(buffer, format="JPEG", quality=quality)
    return buffer.getvalue()
