"""Which views are of one room, robust to doors that leak."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from scipy import ndimage
from scipy.cluster.hierarchy import fcluster, linkage
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components
from scipy.spatial import KDTree
from scipy.spatial.distance import squareform

from panoplan.config import FusionConfig, GroupingConfig
from panoplan.geometry.polar import at_boundaries, mutual_overlaps, passing_votes
from panoplan.stages.plan.fusion import NOBODY, Evidence, Territories, contest, fuse
from panoplan.stages.plan.sight import Sights
from panoplan.types.arrays import BoolArray, FloatArray

Group = tuple[int, ...]


@dataclass(frozen=True, eq=False)
class Grouping:
    """Views told apart by room.

    Attributes:
        rooms: views of each room, by their first view.
        evidences: what each room's views say together.
        territories: to which room each cell belongs.
        doorways: views from a doorway.
    """

    rooms: tuple[Group, ...]
    evidences: tuple[Evidence, ...]
    territories: Territories | None
    doorways: Group


def group(
    views: Sights,
    config: GroupingConfig,
    fusion: FusionConfig,
    known: Sequence[Group] | None = None,
) -> Grouping:
    """Tells views apart by room.

    Views are linked by their common area; groups of them that see each other's floor without a
    wall or a neck between are joined; a group whose cameras all stand on another's floor is none,
    its views go there.

    Args:
        views: any number.
        config: settings.
        fusion: settings of the fields.
        known: groups that were found before, where they are to stay; else they are found anew.

    Returns:
        The rooms.

    Source: docs/deviations.md, "Past the paper".
    """
    if len(views) == 0:
        return Grouping((), (), None, ())
    at_door = doorways(views, config)
    if at_door.all():
        at_door[:] = False
    inner = np.flatnonzero(~at_door)
    if known is None:
        groups = [
            tuple(int(inner[k]) for k in members)
            for members in linked(views.cameras[inner], views.profiles[inner], config)
        ]
    else:
        kept = (tuple(k for k in members if not at_door[k]) for members in known)
        groups = [members for members in kept if members]
    fields = {members: fuse(views.pick(members), fusion) for members in groups}
    for regroup in (_joined, _dissolved) if known is None else ():
        territories = contest([fields[members] for members in groups])
        groups = sorted(regroup(groups, views, territories, config, fusion))
        fields = {
            members: fields.get(members) or fuse(views.pick(members), fusion) for members in groups
        }
    evidences = tuple(fields[members] for members in groups)
    doors = tuple(int(k) for k in np.flatnonzero(at_door))
    return Grouping(tuple(groups), evidences, contest(evidences), doors)


def doorways(views: Sights, config: GroupingConfig) -> BoolArray:
    """Which views are from a doorway.

    Args:
        views: any number.
        config: settings.

    Returns:
        (V,) whether the camera stands near the boundary of another view, and deep inside none.
    """
    return at_boundaries(views.cameras, views.profiles, config.reach_ch, config.doorway_ch)


def linked(cameras: FloatArray, profiles: FloatArray, config: GroupingConfig) -> list[Group]:
    """Groups views by average linkage of their common areas.

    Args:
        cameras: (V, 2) positions, V ≥ 1.
        profiles: (V, B) ranges at evenly spaced headings.
        config: settings.

    Returns:
        Indices of the views of each group, by the first.
    """
    if len(cameras) == 1:
        return [(0,)]
    common = mutual_overlaps(cameras, profiles, config.reach_ch, config.cell_ch)
    np.subtract(1.0, common, out=common)
    distances = squareform(common, checks=False)
    # As large as a few hundred layouts.
    del common
    tree = linkage(distances, "average")
    labels = fcluster(tree, 1.0 - config.min_overlap, "distance")
    return sorted(tuple(np.flatnonzero(labels == k).tolist()) for k in np.unique(labels))


def _joined(
    groups: Sequence[Group],
    views: Sights,
    territories: Territories,
    config: GroupingConfig,
    fusion: FusionConfig,
) -> list[Group]:
    """Joins groups across lines that most views look through."""
    joined = np.zeros((len(groups), len(groups)), dtype=bool)
    for (one, other), points in sorted(_borders(territories, fusion.cell_ch).items()):
        seeing = views.pick((*groups[one], *groups[other]))
        through, ending = passing_votes(
            seeing.cameras, seeing.profiles, points, config.pass_tolerance_ch
        )
        passing = points[through > config.pass_share * (through + ending)]
        passage = _widest(passing, fusion.cell_ch)
        length = float(np.hypot(*np.ptp(passage, axis=0))) if len(passage) > 1 else 0.0
        if length < config.neck_min_ch:
            continue
        middle = passage.mean(axis=0)
        width = min(_width(territories, k, middle, length, fusion.cell_ch) for k in (one, other))
        # Where either is a sliver, there is no floor to be walked from one to the other.
        if width > config.neck_min_ch and length > config.neck_ratio * width:
            joined[one, other] = True
    count, part = connected_components(joined, directed=False)
    return [
        tuple(sorted(view for k in np.flatnonzero(part == n).tolist() for view in groups[k]))
        for n in range(count)
    ]


def _widest(points: FloatArray, cell: float) -> FloatArray:
    """The longest chain of a border's points: several doors side by side are no wide one."""
    if len(points) < 2:
        return points
    pairs = KDTree(points).query_pairs(_CHAIN_CELLS * cell, output_type="ndarray")
    touching = coo_array((np.ones(len(pairs)), tuple(pairs.T)), shape=(len(points),) * 2)
    count, part = connected_components(touching, directed=False)
    chains = (points[part == k] for k in range(count))
    return max(chains, key=lambda chain: float(np.hypot(*np.ptp(chain, axis=0))))


_CHAIN_CELLS = 3.0


def _borders(territories: Territories, cell: float) -> dict[tuple[int, int], FloatArray]:
    """Midpoints of the cell sides between each two rooms that touch."""
    owner = territories.owner
    found: dict[tuple[int, int], list[FloatArray]] = {}
    for axis in (0, 1):
        low = owner[:-1] if axis == 0 else owner[:, :-1]
        high = owner[1:] if axis == 0 else owner[:, 1:]
        touching = np.argwhere((low != high) & (low != NOBODY) & (high != NOBODY))
        middles = touching + np.where([axis == 0, axis == 1], 1.0, 0.5)
        one, other = low[tuple(touching.T)], high[tuple(touching.T)]
        pairs = np.stack([np.minimum(one, other), np.maximum(one, other)], axis=1)
        for pair in np.unique(pairs, axis=0):
            chosen = (pairs == pair).all(axis=1)
            key = (int(pair[0]), int(pair[1]))
            found.setdefault(key, []).append((middles[chosen] + territories.first_cell) * cell)
    return {pair: np.concatenate(points) for pair, points in found.items()}


def _width(
    territories: Territories, room: int, middle: FloatArray, reach: float, cell: float
) -> float:
    """Diameter of the largest circle inside a room whose centre is near a point."""
    owner = territories.owner
    margin = int(np.ceil(2 * reach / cell)) + 1
    at = np.floor(middle / cell).astype(int) - territories.first_cell
    low = np.maximum(at - margin, 0)
    own = np.pad(owner[low[0] : at[0] + margin, low[1] : at[1] + margin] == room, 1)
    radius = ndimage.distance_transform_edt(own)[1:-1, 1:-1]
    near = int(np.ceil(reach / cell))
    start = np.maximum(at - low - near, 0)
    around = radius[start[0] : at[0] - low[0] + near, start[1] : at[1] - low[1] + near]
    return 2 * cell * float(around.max(initial=0.0))


def _dissolved(
    groups: Sequence[Group],
    views: Sights,
    territories: Territories,
    config: GroupingConfig,
    fusion: FusionConfig,
) -> list[Group]:
    """Gives the views of groups that hold no floor under their own cameras to those that do."""
    owners = [
        Counter(territories.owner_at(views.cameras[k], fusion.cell_ch) for k in group)
        for group in groups
    ]
    homeless = {
        index
        for index, count in enumerate(owners)
        if count[index] == 0 and set(count) - {NOBODY, index}
    }
    members = {index: list(g) for index, g in enumerate(groups) if index not in homeless}
    for index in sorted(homeless):
        home, _ = max(
            ((k, n) for k, n in owners[index].items() if k in members),
            key=lambda item: (item[1], -item[0]),
            default=(index, 0),
        )
        members.setdefault(home, []).extend(groups[index])
    return [tuple(sorted(group)) for group in members.values()]
