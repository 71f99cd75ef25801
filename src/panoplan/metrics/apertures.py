"""Doors, openings and windows: which were found."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from scipy.optimize import linear_sum_assignment

from panoplan.metrics.rooms import Score
from panoplan.types.arrays import FloatArray

WITHIN_M = 0.4
"""Distance of two midpoints up to which a door, opening or window is found."""

THICKEST_M = 0.5
"""Parallel segments nearer than this may be the two faces of one wall."""

_PARALLEL = 0.9


def merged_faces(segments: Sequence[FloatArray]) -> list[FloatArray]:
    """Makes one of the segments on the two faces of one wall.

    Args:
        segments: (2, 2) each, metres.

    Returns:
        Of each two that are parallel, nearer than a wall is thick and side by side over half of
        the longer one, their mean; the others as they are.
    """
    left = [np.asarray(segment, dtype=np.float64) for segment in segments]
    out = []
    while left:
        one = left.pop(0)
        length = float(np.hypot(*(one[1] - one[0])))
        along = (one[1] - one[0]) / max(length, 1e-9)
        faces = [one]
        for other in list(left):
            theirs = other[1] - other[0]
            longer = max(length, float(np.hypot(*theirs)))
            apart = other.mean(axis=0) - one.mean(axis=0)
            at, off = apart @ along, apart @ np.array([along[1], -along[0]])
            if (
                abs(theirs @ along) > _PARALLEL * np.hypot(*theirs)
                and abs(off) < THICKEST_M
                and abs(at) < longer / 2
            ):
                faces.append(other if theirs @ along > 0 else other[::-1])
                left = [item for item in left if item is not other]
        out.append(np.mean(faces, axis=0))
    return out


def aperture_score(true: Sequence[FloatArray], predicted: Sequence[FloatArray]) -> Score:
    """Counts segments whose midpoint is found, one to one.

    Args:
        true: (2, 2) each, metres; the faces of one wall are merged first.
        predicted: (2, 2) each, metres.

    Returns:
        The score of the matching with most pairs of midpoints within 0.4 m.
    """
    faces = merged_faces(true)
    if not faces or not predicted:
        return Score(0, len(faces), len(predicted))
    ours = np.array([segment.mean(axis=0) for segment in predicted])
    theirs = np.array([segment.mean(axis=0) for segment in faces])
    apart = np.hypot(*(theirs[:, None] - ours[None]).transpose(2, 0, 1))
    # A pair counts first, then how near it is.
    cost = np.where(apart <= WITHIN_M, apart / WITHIN_M / (1 + len(apart)) - 1.0, 0.0)
    rows, columns = linear_sum_assignment(cost)
    hits = int(np.sum(apart[rows, columns] <= WITHIN_M))
    return Score(hits, len(faces), len(predicted))
