"""Array types and the checks that every type of this package makes of its arrays."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from panoplan.errors import InputError

FloatArray = NDArray[np.float64]
IntArray = NDArray[np.int64]
BoolArray = NDArray[np.bool_]


def frozen_array(
    name: str, value: ArrayLike, shape: tuple[int | None, ...], *, finite: bool = True
) -> FloatArray:
    """A read-only float64 copy of `value`, checked.

    Args:
        name: what the array is, for the message.
        value: numbers.
        shape: expected shape, None where any length will do.
        finite: whether NaN and infinity are refused.

    Returns:
        A read-only C-contiguous float64 array that shares no memory with `value`.

    Raises:
        InputError: not numbers, wrong shape, or not finite.
    """
    try:
        array: NDArray[Any] = np.asarray(value)
    except ValueError as error:
        raise InputError(name, str(error), "an array of numbers") from None
    if array.dtype.kind not in "fiu":
        raise InputError(name, f"an array of type {array.dtype}", "real numbers")
    if array.ndim != len(shape) or any(
        want is not None and have != want for have, want in zip(array.shape, shape, strict=True)
    ):
        wanted = "(" + ", ".join("N" if n is None else str(n) for n in shape) + ")"
        raise InputError(name, f"shape {array.shape}", f"shape {wanted}")
    if finite and not np.isfinite(array).all():
        raise InputError(name, "NaN or infinity", "finite numbers")
    copy = np.array(array, dtype=np.float64, order="C", copy=True)
    copy.setflags(write=False)
    return copy
