"""Where a plan's metres come from and how sure they are, in words."""

from __future__ import annotations

import numpy as np

from panoplan.types.plan import FloorPlan


def metres_told(plan: FloorPlan) -> str:
    """The source of the metres, its ± in per cent, and the median ± of walls' own lengths in cm."""
    metric = plan.metric
    if metric is None:
        return "It is not known where the metres come from."
    told = f"Metres by {metric.source}: ± {100 * metric.sigma:.1f} % of all lengths in common"
    walls = [wall for room in plan.rooms for wall in room.walls]
    own = [wall.length_sigma for wall in walls if wall.length_sigma is not None]
    if own:
        told += f", and ± {100 * float(np.median(own)):.1f} cm of each wall's own (median)"
    return told + "."
