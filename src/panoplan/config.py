"""Settings: one frozen dataclass a stage, and the presets.

Each field's metadata says what it is, its unit, its range and what the paper prints for it
("not in the paper" where it prints nothing; the reason is then part of the text).
"""

from __future__ import annotations

import dataclasses
import difflib
import itertools
import types
import typing
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any, Literal

from panoplan.errors import ConfigError

NOT_PRINTED = "not in the paper"


def _setting(
    default: Any,
    doc: str,
    *,
    unit: str = "",
    low: float | None = None,
    high: float | None = None,
    paper: object = NOT_PRINTED,
) -> Any:
    return field(
        default=default,
        metadata={"doc": doc, "unit": unit, "low": low, "high": high, "paper": paper},
    )


@dataclass(frozen=True)
class RegistrationConfig:
    """Layout boundary to points in the plan (Eq. 1-2)."""

    min_depression_deg: float = _setting(
        2.0,
        "Columns whose boundary lies less than this below the level horizon are unknown: at 2° the "
        "range is 29 camera heights and an error of one row of 512 changes it by a fifth.",
        unit="deg",
        low=0.0,
        high=45.0,
    )
    height_from_pose: bool = _setting(
        True,
        "Camera height of a keyframe follows its pose, h_i = 1 + s (y_1 - y_i); otherwise h = 1.",
        paper=False,
    )
    sigma_ranges_ch: tuple[float, ...] = _setting(
        (0.33, 0.83, 1.17, 1.67, 2.33, 3.33),
        "Ranges at which `sigma_deg` is given, increasing.",
        unit="camera heights",
        low=0.0,
        high=100.0,
    )
    sigma_deg: tuple[float, ...] = _setting(
        (0.89, 0.67, 0.48, 0.58, 0.70, 0.82),
        "Standard deviation of a boundary's elevation at those ranges: MAD-sigma of a layout "
        "network on 69 real panoramas. A network's own figure counts where it is larger.",
        unit="deg",
        low=1e-3,
        high=45.0,
    )
    scale_bias: float = _setting(
        0.02,
        "Standard deviation of the common scale of one panorama's ranges; 1.5 % (MAD) to 2.8 % on "
        "the same panoramas.",
        low=0.0,
        high=0.5,
    )

    def __post_init__(self) -> None:
        """Checks that the two tables match."""
        ranges = self.sigma_ranges_ch
        if len(ranges) != len(self.sigma_deg) or any(b <= a for a, b in itertools.pairwise(ranges)):
            raise ConfigError(
                "registration.sigma_ranges_ch", repr(ranges), "increasing, one for each sigma_deg"
            )


@dataclass(frozen=True)
class ScaleConfig:
    """Relative scale by entropy minimisation (Eq. 3-4)."""

    warmup: int | float | Literal["converged"] = _setting(
        "converged",
        "How long keyframes are collected before the scale is frozen: a count, a fraction of a "
        "walk whose length is known (0-1], or until the estimate has settled.",
        paper=0.2,
    )
    warmup_min: int = _setting(
        40,
        "Fewest keyframes before the first estimate; on simulated flats the error halves from 20 "
        "keyframes to 80.",
        low=2,
        high=10_000,
    )
    warmup_max: int = _setting(
        150,
        "The scale is frozen after so many keyframes in any case, so that a stream starts.",
        low=2,
        high=100_000,
    )
    warmup_growth: float = _setting(
        1.25,
        "The estimate is made anew whenever so many times more keyframes wait.",
        low=1.01,
        high=10.0,
    )
    settle_tolerance: float = _setting(
        0.005,
        "Estimates within this share of one another count as the same.",
        low=0.0,
        high=1.0,
    )
    settle_count: int = _setting(
        4,
        "So many estimates in a row must be the same for the scale to be frozen.",
        low=2,
        high=1000,
    )
    window: int = _setting(
        10,
        "Keyframes a sliding window; it shrinks when there are fewer.",
        low=2,
        high=1000,
        paper=10,
    )
    window_stride: int = _setting(
        3,
        "Keyframes from one window to the next.",
        low=1,
        high=1000,
        paper=1,
    )
    steps: tuple[float, ...] = _setting(
        (0.5, 0.1, 0.01),
        "Step sizes of the coarse-to-fine search, in units of `step_unit`.",
        paper=(0.5, 0.1, 0.01),
    )
    step_unit: Literal["keyframe_step", "absolute"] = _setting(
        "keyframe_step",
        "What a step of the search is measured in: camera heights a median keyframe step, or "
        "camera heights a trajectory unit (as printed; means nothing in arbitrary units).",
        paper="absolute",
    )
    absolute_range: tuple[float, float] = _setting(
        (0.1, 10.0),
        "Range of s for `step_unit = absolute`; with `keyframe_step` the range follows the data.",
    )
    sub_step: bool = _setting(
        True,
        "Goes on below the last step until a step is 0.2 % of s, then fits a parabola.",
        paper=False,
    )
    cells_ch: tuple[float, ...] = _setting(
        (0.05,),
        "Cell sizes of the histogram; entropies are averaged over them. Near the noise of a good "
        "layout: wider cells cannot see a misalignment of a few centimetres.",
        unit="camera heights",
        low=1e-3,
        high=1.0,
    )
    saturation: float = _setting(
        0.0,
        "Where above zero, the histogram is not normalised: a cell counts as min(count, "
        "saturation) / saturation, as in the public code; 0 is the normalised histogram.",
        unit="points",
        low=0.0,
        high=1e6,
        paper=0.0,
    )
    combine: Literal["optimum", "mean"] = _setting(
        "optimum",
        "The best candidate of the last level for all windows together, or the mean over levels "
        "and windows of the best of each, as in the public code.",
        paper="optimum",
    )
    facings: int = _setting(
        4,
        "Directions into which wall points are sorted by the side the wall is seen from, so that "
        "the two faces of one wall never share a cell; 1 turns this off. Without it a scale a few "
        "per cent low, which lays both faces on one another, has the lower entropy.",
        low=1,
        high=16,
        paper=1,
    )
    control: bool = _setting(
        True,
        "Subtracts the entropy at -s, where the layouts are as crowded but cannot agree. Otherwise "
        "crowding alone lowers the entropy, and on long walks the smallest s of all may win.",
        paper=False,
    )
    intrusion: float = _setting(
        0.2,
        "Weight, in nats, of the share of wall points that lie where another view of the window "
        "sees free floor, when the search chooses between optima. Entropy alone lays the layouts "
        "of a few photos on one another by chance.",
        low=0.0,
        high=100.0,
        paper=0.0,
    )
    smooth: bool = _setting(
        True,
        "Each point is shared among the four nearest cells, so that the curve is smooth.",
        paper=False,
    )
    max_range_ch: float = _setting(
        4.0,
        "Farther points take no part: their range error exceeds every cell.",
        unit="camera heights",
        low=0.5,
        high=100.0,
        paper="unlimited",
    )
    columns: int = _setting(
        256,
        "Columns of a layout that take part; neighbours are correlated over tens of columns.",
        low=16,
        high=16384,
        paper="all",
    )


@dataclass(frozen=True)
class RoomsConfig:
    """Room identification (Eq. 5-6, Algorithm 1)."""

    clip_radius_ch: float = _setting(
        3.0,
        "Clipping radius r of Eq. 6: layouts are good to a tenth of the range up to about there.",
        unit="camera heights",
        low=0.2,
        high=100.0,
    )
    clip_quartiles: float = _setting(
        0.0,
        "Where above zero, only points farther than so many lower quartiles of the ranges are "
        "clipped, as in the public code; 0 clips all beyond the radius.",
        low=0.0,
        high=1000.0,
        paper=0.0,
    )
    cell_ch: float = _setting(
        0.05,
        "Cell of the room density maps: 7 to 8 cm at eye level.",
        unit="camera heights",
        low=0.005,
        high=1.0,
    )
    normalise: Literal["running_max", "max", "coverage"] = _setting(
        "coverage",
        "How a room's density is normalised: by its maximum at each update (Algorithm 1 as "
        "printed; old evidence halves every time), once by the maximum, or by the views that could "
        "see the cell.",
        paper="running_max",
    )
    beyond_weight: float = _setting(
        0.3,
        "Weight of a view's evidence against a cell that lies farther than `wall_band_ch` beyond "
        "its boundary: hidden, hence little against.",
        low=0.0,
        high=1.0,
    )
    wall_band_ch: float = _setting(
        0.2,
        "How far beyond its boundary a view speaks against a cell with full weight.",
        unit="camera heights",
        low=0.0,
        high=10.0,
    )
    threshold: float = _setting(
        0.5,
        "Density from which a cell belongs to a room.",
        low=0.0,
        high=1.0,
        paper=0.5,
    )
    membership: Literal["camera", "overlap"] = _setting(
        "overlap",
        "What makes a keyframe a room's: its camera's density in the room's map, or the overlap of "
        "its clipped layout with the room's mask, over the smaller of the two. The latter also "
        "holds for a camera in a doorway and is not led astray by one leaking view.",
        paper="camera",
    )
    overlap_min: float = _setting(
        0.5,
        "Overlap from which a keyframe belongs to a known room.",
        low=0.0,
        high=1.0,
    )
    overlap_stay: float = _setting(
        0.4,
        "The same for the room that the camera was last in.",
        low=0.0,
        high=1.0,
    )
    absorb_keyframes: int = _setting(
        2,
        "A room of at most so many keyframes is absorbed when most of it proves to be other rooms: "
        "a layout from a doorway may be of parts of two rooms. 0 absorbs none.",
        low=0,
        high=1000,
        paper=0,
    )
    absorb_share: float = _setting(
        0.5, "Share of such a room that must lie in other rooms.", low=0.0, high=1.0
    )
    merge_overlap: float = _setting(
        0.6,
        "Two rooms whose masks overlap by more than this share are joined; 1 joins none.",
        low=0.0,
        high=1.0,
        paper=1.0,
    )
    merge_over: Literal["smaller", "union"] = _setting(
        "smaller",
        "What the overlap of two rooms is a share of; the public code takes the union, which "
        "never joins a part with its whole.",
    )
    leave_after: int = _setting(
        2,
        "Keyframes in a row assigned elsewhere after which a room counts as left.",
        low=1,
        high=100,
        paper=1,
    )


@dataclass(frozen=True)
class PlanesConfig:
    """Wall pieces and their planes."""

    max_residual_ch: float = _setting(
        0.03,
        "Largest distance of an inlier from its plane.",
        unit="camera heights",
        low=1e-4,
        high=1.0,
        paper=0.03,
    )
    min_inlier_ratio: float = _setting(
        0.9,
        "Pieces with a smaller share of inliers are rejected.",
        low=0.0,
        high=1.0,
        paper=0.9,
    )
    iterations: int = _setting(
        50,
        "RANSAC iterations a piece: at the inlier ratio asked for, the chance of never drawing "
        "two inliers is below 1e-30.",
        low=1,
        high=10_000,
    )
    min_columns: int = _setting(
        6,
        "Pieces of fewer columns (of 1024; in proportion otherwise) are rejected.",
        low=2,
        high=1000,
    )
    max_range_ch: float = _setting(
        6.0,
        "Points farther than this are not wall evidence: one degree is 0.6 camera heights there.",
        unit="camera heights",
        low=0.5,
        high=100.0,
        paper="unlimited",
    )
    merge_corners_columns: float = _setting(
        0.0,
        "Corners nearer than so many columns (of 1024; in proportion otherwise) are merged into "
        "their mean, as in the public code.",
        unit="columns",
        low=0.0,
        high=500.0,
        paper=0.0,
    )
    resplit: bool = _setting(
        True,
        "A piece without a plane is split where it bends most and tried again: a third of the "
        "corners of a real layout network are missing.",
        paper=False,
    )


@dataclass(frozen=True)
class OrientationConfig:
    """Bayesian filter of wall directions (Eq. 7)."""

    sigma0_deg: float = _setting(
        4.0,
        "Noise of a wall direction next to the camera.",
        unit="deg",
        low=0.01,
        high=180.0,
    )
    sigma_per_ch_deg: float = _setting(
        4.0,
        "Growth of that noise with the distance of the wall (lambda).",
        unit="deg per camera height",
        low=0.0,
        high=180.0,
    )
    full_length_ch: float = _setting(
        1.0,
        "Shorter walls are noisier in proportion: the direction of a line through noisy "
        "points is as uncertain as the line is short; 0 turns this off.",
        unit="camera heights",
        low=0.0,
        high=100.0,
        paper=0.0,
    )
    gate_deg: float = _setting(
        60.0,
        "An observation farther than this from every direction starts a new one.",
        unit="deg",
        low=0.0,
        high=90.0,
        paper=60.0,
    )
    initial_sigma_deg: float = _setting(
        360.0,
        "Standard deviation with which a direction starts.",
        unit="deg",
        low=0.01,
        high=3600.0,
        paper=360.0,
    )
    final_sigma_deg: float = _setting(
        18.0,
        "Directions less certain than this are dropped at the end; the best-supported is "
        "kept and flagged when none is left.",
        unit="deg",
        low=0.01,
        high=3600.0,
        paper=18.0,
    )


@dataclass(frozen=True)
class ShapeConfig:
    """Room shape by iterative shortest path (Eq. 8-11)."""

    method: Literal["ispa", "fusion"] = _setting(
        "fusion",
        "How a room gets its shape: iSPA of the paper, or its views fused and its walls fitted to "
        "the raw columns (`grouping`, `fusion`, `outline`).",
        paper="ispa",
    )

    grids: tuple[int, ...] = _setting(
        (64, 96, 96),
        "Cells along the longer side of the room's box, one number a round.",
        paper=(64, 96, 96),
    )
    fixed_cell_ch: float = _setting(
        0.0,
        "Where above zero, the cell of every round instead of `grids` (first row of Table III).",
        unit="camera heights",
        low=0.0,
        high=1.0,
        paper=0.0,
    )
    limit_edges: bool = _setting(
        True,
        "Whether the first round limits the length of edges.",
        paper=True,
    )
    max_edge_cells: float = _setting(
        15.0,
        "Longest edge of the first round.",
        unit="cells",
        low=2.0,
        high=1000.0,
    )
    edge_length: Literal["euclidean", "manhattan"] = _setting(
        "euclidean",
        "How the length of an edge is measured against that limit; the public code adds |dx| and "
        "|dy|.",
    )
    max_edge_angle_deg: float = _setting(
        90.0,
        "Largest angle between an edge and the nearest wall direction; 90 allows all, and walls "
        "whose direction was not found.",
        unit="deg",
        low=0.0,
        high=90.0,
        paper=90.0,
    )
    cost_unit: Literal["camera_height", "cell"] = _setting(
        "camera_height",
        "The length that L_plane and L_mask are costs of: per cell they change from grid to grid.",
    )
    band_in_cells: float = _setting(
        2.0,
        "Corner candidates lie at most so far inside the mask.",
        unit="cells",
        low=0.0,
        high=100.0,
    )
    band_out_cells: float = _setting(
        3.0,
        "Corner candidates lie at most so far outside the mask.",
        unit="cells",
        low=0.5,
        high=100.0,
    )
    refine_cells: float = _setting(
        2.5,
        "Later rounds look for corners at most so far from earlier ones.",
        unit="cells",
        low=0.5,
        high=100.0,
    )
    wall_sigma_ch: float = _setting(
        0.03,
        "Width of a wall in the evidence map: the tolerance of L_plane.",
        unit="camera heights",
        low=1e-3,
        high=1.0,
    )
    wall_near_ch: float = _setting(
        1.2,
        "Walls nearer than this are drawn with `wall_sigma_ch`, farther ones wider with the "
        "square of the distance, as measured range errors grow.",
        unit="camera heights",
        low=0.1,
        high=100.0,
    )
    wall_merge_ch: float = _setting(
        0.2,
        "Wall evidence within this reach is one wall: its ridge counts as 1.",
        unit="camera heights",
        low=0.0,
        high=10.0,
    )
    wall_floor: float = _setting(
        0.5,
        "Evidence that a wall needs to count as 1; a single near view gives 1.",
        low=1e-6,
        high=100.0,
    )
    mask_margin_ch: float = _setting(
        0.05,
        "The mask of L_mask is shrunk by this much, so that edges may run along its rim.",
        unit="camera heights",
        low=0.0,
        high=1.0,
        paper=0.0,
    )
    core_depth_ch: float = _setting(
        0.2,
        "Deeper inside, the mask is core, which no edge should cut off; a corridor of 0.8 m still "
        "has one.",
        unit="camera heights",
        low=0.0,
        high=10.0,
    )
    core_factor: float = _setting(
        10.0,
        "How many times more L_mask counts in the core; otherwise cutting off a long thin arm is "
        "cheaper than going around it.",
        low=0.0,
        high=1000.0,
        paper=0.0,
    )
    weight_orientation: float = _setting(
        0.6,
        "Cost of a radian between an edge and the nearest wall direction (lambda_ori).",
        low=0.0,
        high=1e4,
    )
    weight_plane: float = _setting(
        1.0,
        "Cost of a camera height of edge off every wall (lambda_plane).",
        low=0.0,
        high=1e4,
    )
    weight_mask: float = _setting(
        4.0,
        "Cost of a camera height of edge inside the mask (lambda_mask).",
        low=0.0,
        high=1e4,
    )
    weight_complexity: float = _setting(
        0.12,
        "Cost of a corner (lambda_complex).",
        low=0.0,
        high=1e4,
    )
    min_area_ch2: float = _setting(
        0.1,
        "Smaller masks have no shape.",
        unit="square camera heights",
        low=0.0,
        high=100.0,
    )


@dataclass(frozen=True)
class GroupingConfig:
    """Which views are of one room, looked at together; goes past the paper."""

    cell_ch: float = _setting(
        0.07, "Cell in which common areas are counted.", unit="camera heights", low=0.01, high=1.0
    )
    reach_ch: float = _setting(
        7.0,
        "A view says nothing of what is farther away: there an error of 1° is two thirds of a "
        "camera height.",
        unit="camera heights",
        low=0.5,
        high=100.0,
    )
    min_overlap: float = _setting(
        0.6,
        "Views are linked while the mean of their common areas, each over the smaller of the two, "
        "is at least this; any value of .5-.8 gives nearly the same rooms.",
        low=0.05,
        high=1.0,
    )
    doorway_ch: float = _setting(
        0.17,
        "A camera this near to another view's boundary, and no deeper inside any, stands in a "
        "doorway: its layout is several times worse and shows two rooms.",
        unit="camera heights",
        low=0.0,
        high=2.0,
    )
    pass_tolerance_ch: float = _setting(
        0.14,
        "A view ends at a place where its range differs by less than this.",
        unit="camera heights",
        low=0.01,
        high=1.0,
    )
    pass_share: float = _setting(
        0.6,
        "Two groups of views are joined across a line where more than this share of the views that "
        "reach it look through it, as at the bend of a corridor.",
        low=0.0,
        high=1.0,
    )
    neck_ratio: float = _setting(
        0.75,
        "... if that line is at least so long against the narrower side's width: people name what "
        "lies behind a narrower passage another room.",
        low=0.0,
        high=10.0,
    )
    neck_min_ch: float = _setting(
        0.4,
        "... and at least so long, with floor at least so wide on both sides.",
        unit="camera heights",
        low=0.0,
        high=10.0,
    )
    around_views: int = _setting(
        64,
        "Views looked at together when a room is left; of a room of more, some spread evenly over "
        "it. At the end of the walk all are.",
        unit="views",
        low=1,
        high=1_000_000,
    )


@dataclass(frozen=True)
class MisplacedConfig:
    """Cameras of a tour that stand in a wrong place; goes past the paper."""

    min_step: float = _setting(
        1.0,
        "Cameras whose median step is shorter than this multiple of the median range are a walk, "
        "whose odometry holds them; only the stills of a tour are placed one by one. Walks have "
        "0.24-0.45, tours 1.6-5.",
        low=0.0,
        high=100.0,
    )
    depth_ch: float = _setting(
        0.25,
        "A boundary so deep in another view's free space contradicts it.",
        unit="camera heights",
        low=0.01,
        high=5.0,
    )
    reach_ch: float = _setting(
        4.0, "Ranges beyond it say nothing.", unit="camera heights", low=0.5, high=100.0
    )
    innocent_share: float = _setting(
        0.2,
        "Up to this share of a boundary lies in the free space of views that stand right, where "
        "one stops at an opening through which the other looks.",
        low=0.0,
        high=1.0,
    )
    conflict_share: float = _setting(
        0.5, "From this share on two views cannot both stand right.", low=0.0, high=1.0
    )
    conflict_nats: float = _setting(
        5.0, "How much two such views speak against their places.", unit="nats", low=0.0, high=100.0
    )
    same_door_ch: float = _setting(
        0.3,
        "Passages of one room nearer to each other are one.",
        unit="camera heights",
        low=0.0,
        high=2.0,
    )
    wall_ch: float = _setting(
        0.15,
        "The two sides of a door lie up to so far apart, a thick wall.",
        unit="camera heights",
        low=0.0,
        high=1.0,
    )
    door_sigma_ch: float = _setting(
        0.08,
        "Standard deviation of where a view sees a door's middle.",
        unit="camera heights",
        low=0.005,
        high=1.0,
    )
    met_share: float = _setting(
        0.6, "Share of doors whose other side is seen, too.", low=0.01, high=0.99
    )
    chance: float = _setting(
        0.05, "Chance that a door finds another side by accident.", low=1e-6, high=1.0
    )
    backed_share: float = _setting(
        0.2,
        "Share of a room's boundary that has another room's wall right behind it, above which it "
        "rather stands where it should: usual are 0.5, and 0.05 in a wrong place.",
        low=0.01,
        high=0.5,
    )
    wall_nats: float = _setting(
        4.0, "How much such walls speak at most.", unit="nats", low=0.0, high=100.0
    )
    near_ch: float = _setting(
        0.5,
        "Views that stand wrong by less are left to the adjustment.",
        unit="camera heights",
        low=0.0,
        high=5.0,
    )
    search_ch: float = _setting(
        3.5,
        "How far views may have been misplaced, to be placed anew.",
        unit="camera heights",
        low=0.1,
        high=100.0,
    )
    min_gain: float = _setting(
        7.0, "Evidence that it takes to doubt where views stand.", unit="nats", low=0.0, high=100.0
    )
    margin: float = _setting(
        4.0,
        "Evidence for a new place over any other; with less, the views are left out.",
        unit="nats",
        low=0.0,
        high=100.0,
    )

    def __post_init__(self) -> None:
        """Checks that the two shares are in order."""
        if self.conflict_share <= self.innocent_share:
            raise ConfigError(
                "misplaced.conflict_share",
                repr(self.conflict_share),
                f"more than innocent_share = {self.innocent_share}",
            )


@dataclass(frozen=True)
class FusionConfig:
    """A room's views fused into one signed distance field; goes past the paper."""

    cell_ch: float = _setting(
        0.035, "Cell of the field, 5 cm.", unit="camera heights", low=0.005, high=0.5
    )
    truncation_ch: float = _setting(
        0.2,
        "Distances to a view's boundary count up to this, 0.3 m: about twice a wall's thickness.",
        unit="camera heights",
        low=0.02,
        high=2.0,
    )
    blur_ch: float = _setting(
        0.15,
        "Standard deviation a range has at least when views vote. Without it one view of a nearby "
        "piece of furniture outvotes all that see past it.",
        unit="camera heights",
        low=0.0,
        high=2.0,
    )
    beyond_weight: float = _setting(
        0.1,
        "Weight of a view for what lies farther behind its boundary than the truncation: it sees "
        "nothing there, yet there is rather no room.",
        low=0.0,
        high=1.0,
    )
    reach_ch: float = _setting(
        9.0,
        "A view says nothing of what is farther away.",
        unit="camera heights",
        low=0.5,
        high=100.0,
    )
    opening_cells: int = _setting(
        5,
        "What is narrower than so many cells is no part of a room: slits between a wall and what "
        "stands before it.",
        unit="cells",
        low=1,
        high=100,
    )
    min_area_ch2: float = _setting(
        0.12,
        "Smallest room, 0.25 m²: a closet.",
        unit="square camera heights",
        low=0.0,
        high=100.0,
    )
    min_hole_ch2: float = _setting(
        0.04,
        "Smallest hole, 0.08 m²: a pillar.",
        unit="square camera heights",
        low=0.0,
        high=100.0,
    )


@dataclass(frozen=True)
class OutlineConfig:
    """Straight walls from a fused field and the raw columns; goes past the paper."""

    step_ch: float = _setting(
        0.035,
        "Distance of the outline's points.",
        unit="camera heights",
        low=0.005,
        high=0.5,
    )
    point_sigma_ch: float = _setting(
        0.03,
        "Standard deviation of the outline's points about a wall.",
        unit="camera heights",
        low=0.001,
        high=1.0,
    )
    corner_cost: float = _setting(
        8.0,
        "A corner must save so much of the points' squared distances over `point_sigma_ch`²: on "
        "simulated flats this gives as many corners as there are.",
        low=0.0,
        high=1e6,
    )
    fit_reach_ch: float = _setting(
        0.1,
        "Columns this near to a wall take part in its fit.",
        unit="camera heights",
        low=0.01,
        high=1.0,
    )
    fit_rounds: int = _setting(
        3, "Fits in a row, after the first with half, a third, ... of that reach.", low=1, high=20
    )
    grazing_deg: float = _setting(
        10.0,
        "A wall seen at a smaller angle than this to it is not fitted: an error of range moves "
        "columns along it.",
        unit="deg",
        low=0.0,
        high=89.0,
    )
    turn_sigma_deg: float = _setting(
        3.0,
        "Standard deviation of a wall's direction about that of its piece of the outline, so that "
        "a short wall is not turned by a few columns.",
        unit="deg",
        low=0.01,
        high=90.0,
    )
    straight_deg: float = _setting(
        10.0,
        "Neighbouring pieces that turn by less than this and lie on one line are one wall.",
        unit="deg",
        low=0.0,
        high=45.0,
    )
    correlation_columns: float = _setting(
        76.0,
        "Columns of 1024 after which errors of one view are independent, measured on real "
        "predictions: so many count as one when a wall's uncertainty is told.",
        low=1.0,
        high=1024.0,
    )


@dataclass(frozen=True)
class LevelsConfig:
    """Storeys, told apart by the height of the cameras; goes past the paper."""

    step_ch: float = _setting(
        1 / 3,
        "A change of the camera's height by more than this may start a level: half a metre at a "
        "usual camera height.",
        unit="camera heights",
        low=0.05,
        high=100.0,
    )
    keyframes: int = _setting(
        4,
        "It is lasting when so many keyframes in a row stay within half a step of one another; "
        "until then they wait. 0: all is one level.",
        low=0,
        high=1000,
    )


@dataclass(frozen=True)
class AdjustConfig:
    """Planar bundle adjustment of cameras and walls; goes past the paper."""

    rounds: int = _setting(
        2,
        "Adjustments in a row, each from rooms told apart anew with the cameras of the last. "
        "0: cameras stay where the odometry has them.",
        low=0,
        high=10,
    )
    iterations: int = _setting(
        4, "Gauss-Newton steps for each of `odometry_multiples`.", low=1, high=100
    )
    stride: int = _setting(
        4,
        "Every so many columns (of 1024; in proportion otherwise) are used; neighbours err alike.",
        low=1,
        high=64,
    )
    min_views: int = _setting(
        4,
        "Fewer views of a room that is left are not adjusted by themselves, only with all others "
        "at the end: they hardly tell how far the odometry is off.",
        low=2,
        high=1000,
    )
    reach_ch: float = _setting(
        0.3,
        "Columns this near to a wall take part: a drift of half a metre.",
        unit="camera heights",
        low=0.01,
        high=5.0,
    )
    grazing_deg: float = _setting(
        15.0,
        "A wall seen at a smaller angle to it pulls at no camera.",
        unit="deg",
        low=0.0,
        high=89.0,
    )
    min_columns: int = _setting(
        24,
        "Fewer columns (of 1024) on a wall say little of its direction.",
        low=2,
        high=1024,
    )
    correlation_columns: float = _setting(
        76.0,
        "Columns of 1024 after which errors of one view are independent, measured on real "
        "predictions.",
        low=1.0,
        high=1024.0,
    )
    common_share: float = _setting(
        0.015,
        "Part of a range's error that a panorama's columns have in common: `scale_bias`, which "
        "the factor takes up.",
        low=0.0,
        high=1.0,
    )
    factor_sigma: float = _setting(
        0.03,
        "Standard deviation of the factor on a view's ranges, measured on real predictions.",
        low=0.0001,
        high=1.0,
    )
    robust_sigmas: float = _setting(
        2.0, "Residuals beyond so many sigmas pull less and less.", low=0.1, high=100.0
    )
    faces_deg: float = _setting(
        0.15,
        "Standard deviation of the angle between the two faces of a wall, a centimetre over four "
        "metres; robust, as what faces may as well be two walls.",
        unit="deg",
        low=1e-3,
        high=90.0,
    )
    gap_sigma_ch: float = _setting(
        0.03,
        "Standard deviation of what lies between the two faces of a wall of a tour's rooms about "
        "a thickness that all have in common, and of that about `partition.thickness_ch`; robust.",
        unit="camera heights",
        low=0.001,
        high=1.0,
    )
    odometry_ch: float = _setting(
        0.02,
        "Standard deviation of the odometry's position after one camera height of way; it grows "
        "with the root of the way.",
        unit="camera heights",
        low=1e-6,
        high=1.0,
    )
    odometry_deg: float = _setting(0.1, "The same of its heading.", unit="deg", low=1e-4, high=90.0)
    odometry_scale: float = _setting(
        0.0015, "The same of the logarithm of its scale, which changes slowly.", low=1e-6, high=1.0
    )
    sigma_factor: float = _setting(
        1.35,
        "Factor on the standard deviations of where rooms lie: odometry errs alike over many "
        "steps, which the adjustment takes for independent. Measured on simulated flats.",
        low=0.1,
        high=10.0,
    )
    odometry_multiples: tuple[float, ...] = _setting(
        (0.02, 0.1, 0.25, 0.5, 1.0, 2.0, 4.0),
        "Multiples of the odometry's sigmas that are tried, increasing; the one with most "
        "evidence is taken, then that of heading and scale alone.",
        low=0.001,
        high=1000.0,
    )

    def __post_init__(self) -> None:
        """Checks that the multiples increase."""
        multiples = self.odometry_multiples
        if any(b <= a for a, b in itertools.pairwise(multiples)):
            raise ConfigError("adjust.odometry_multiples", repr(multiples), "increasing multiples")


@dataclass(frozen=True)
class PartitionConfig:
    """One plan of all rooms; goes past the paper."""

    parallel_deg: float = _setting(
        8.0,
        "Walls of two rooms within this angle may be the faces of one.",
        unit="deg",
        low=0.1,
        high=45.0,
    )
    min_facing_ch: float = _setting(
        0.15,
        "Walls that face each other over less than this share nothing.",
        unit="camera heights",
        low=0.0,
        high=10.0,
    )
    max_overlap_ch: float = _setting(
        0.25,
        "Faces that are crossed by more than this are not of one wall.",
        unit="camera heights",
        low=0.0,
        high=2.0,
    )
    max_thickness_ch: float = _setting(
        0.3,
        "Faces farther apart than this are not of one wall: 45 cm.",
        unit="camera heights",
        low=0.0,
        high=2.0,
    )
    min_thickness_ch: float = _setting(
        0.035,
        "No wall is thinner: 5 cm. Faces closer than this are moved apart.",
        unit="camera heights",
        low=0.0,
        high=1.0,
    )
    thickness_ch: float = _setting(
        0.08,
        "Thickness assumed where no other wall's was measured: 12 cm, a usual inner wall.",
        unit="camera heights",
        low=0.0,
        high=1.0,
    )
    thickness_sigma_ch: float = _setting(
        0.02,
        "Standard deviation of assumed thicknesses.",
        unit="camera heights",
        low=0.001,
        high=1.0,
    )
    unfitted_sigma_ch: float = _setting(
        0.1,
        "Standard deviation of a wall that no raw column lies on, as at an opening.",
        unit="camera heights",
        low=0.001,
        high=10.0,
    )
    min_area_ch2: float = _setting(
        0.1,
        "A room that loses all but this to others is none: a quarter of a square metre.",
        unit="square camera heights",
        low=0.0,
        high=100.0,
    )


@dataclass(frozen=True)
class AperturesConfig:
    """Doors, openings and windows; goes past the paper."""

    min_width_ch: float = _setting(
        0.15,
        "Nothing narrower is told: 23 cm.",
        unit="camera heights",
        low=0.0,
        high=2.0,
    )
    door_width_ch: float = _setting(
        0.53,
        "Width assumed of a door of which only the place is known: 80 cm.",
        unit="camera heights",
        low=0.1,
        high=2.0,
    )
    widest_door_ch: float = _setting(
        0.8,
        "Where nobody says what a passage is, a wider one is an opening: 1.2 m.",
        unit="camera heights",
        low=0.1,
        high=10.0,
    )
    min_part: float = _setting(
        0.3,
        "Of what a view sees around a corner, parts smaller than this are left out.",
        low=0.0,
        high=1.0,
    )
    nearest_ch: float = _setting(
        0.15,
        "A camera as near as this to a wall, as in a doorway, says nothing of it.",
        unit="camera heights",
        low=0.0,
        high=2.0,
    )
    farthest_ch: float = _setting(
        2.7,
        "A view need not show what is farther away, and a leak there is an error: 4 m.",
        unit="camera heights",
        low=0.5,
        high=100.0,
    )
    leak_ch: float = _setting(
        0.2,
        "A boundary that lies so far behind a wall, and `leak_share` of its range, leaks: 30 cm.",
        unit="camera heights",
        low=0.01,
        high=10.0,
    )
    leak_share: float = _setting(
        0.15, "The same, relative to the range: networks err more far away.", low=0.0, high=10.0
    )
    longest_step_ch: float = _setting(
        1.0,
        "Between cameras farther apart than this, as of stills, nobody walked straight.",
        unit="camera heights",
        low=0.05,
        high=100.0,
    )
    same_wall_ch: float = _setting(
        0.35,
        "Sightings farther apart than this across the wall are not of one thing.",
        unit="camera heights",
        low=0.0,
        high=2.0,
    )
    same_share: float = _setting(
        0.3, "Sightings of one thing have at least this share of it in common.", low=0.0, high=1.0
    )
    min_support: float = _setting(
        0.4, "Share of the views that look at a door or window and show it.", low=0.0, high=1.0
    )
    min_support_opening: float = _setting(
        0.5,
        "The same of openings, which real networks make up more often.",
        low=0.0,
        high=1.0,
    )


@dataclass(frozen=True)
class TourConfig:
    """Joining sparse photos into one frame."""

    max_features: int = _setting(
        8192, "Most features an image, the largest first.", low=64, high=100_000
    )
    first_octave: int = _setting(
        -1,
        "Octave in which features begin: −1 doubles the image. Photos metres apart share few "
        "features, and many of these are small.",
        low=-1,
        high=3,
    )
    peak_threshold: float = _setting(0.003, "Least contrast of a feature, of 1.", low=0.0, high=1.0)
    lowest_elevation_deg: float = _setting(
        -60.0,
        "Below it no features: there is the tripod, the photographer, or floor so near that no "
        "photo metres away sees it alike.",
        unit="deg",
        low=-90.0,
        high=0.0,
    )
    highest_elevation_deg: float = _setting(
        75.0,
        "Above it no features: an equirectangular image is smeared there.",
        unit="deg",
        low=0.0,
        high=90.0,
    )
    horizon_deg: float = _setting(
        1.5,
        "Features nearer the horizon than this are left out: their height above or below the "
        "cameras, which the direction to another camera is told by, is not known.",
        unit="deg",
        low=0.1,
        high=30.0,
    )
    max_ratio: float = _setting(
        0.9,
        "Matches are mutual nearest neighbours nearer than this share of the second one.",
        low=0.0,
        high=1.0,
    )
    match_cell_deg: float = _setting(
        1.2,
        "One match a cell of this side, in both images: a texture must not outvote the room.",
        unit="deg",
        low=0.0,
        high=30.0,
    )
    max_matches: int = _setting(450, "Most matches of two photos.", low=8, high=10_000)
    match_sigma_deg: float = _setting(
        0.3,
        "Standard deviation of an angle of a match, with what cameras are tilted and differ in "
        "height.",
        unit="deg",
        low=0.01,
        high=5.0,
    )
    yaw_step_deg: float = _setting(
        1.5, "Yaws of the vote, one such step apart.", unit="deg", low=0.5, high=10.0
    )
    direction_step_deg: float = _setting(
        3.0, "Directions of the vote, one such step apart.", unit="deg", low=0.5, high=20.0
    )
    vote_share: float = _setting(
        0.1, "Share of inliers that the vote reckons with.", low=0.001, high=0.9
    )
    evidence_cell_deg: float = _setting(
        12.0,
        "Matches of one cell of this side are not independent: a poster or a chandelier must not "
        "decide.",
        unit="deg",
        low=1.0,
        high=90.0,
    )
    evidence_cap: float = _setting(
        6.0, "Most evidence of such a cell.", unit="nats", low=0.1, high=100.0
    )
    surface_cap: float = _setting(
        8.0,
        "Most evidence of all that lies on one floor or ceiling: tiles repeat themselves.",
        unit="nats",
        low=0.1,
        high=1000.0,
    )
    hypotheses: int = _setting(
        5, "Yaws with directions that are kept of two photos.", low=1, high=100
    )
    wall_width_deg: float = _setting(
        3.0,
        "Pieces of a layout's walls within this of a common heading count for it.",
        unit="deg",
        low=0.1,
        high=20.0,
    )
    wall_sigma_deg: float = _setting(
        0.7,
        "Standard deviation of the heading of a layout's walls.",
        unit="deg",
        low=0.05,
        high=10.0,
    )
    wall_share: float = _setting(
        0.5,
        "Where less than this share of the walls runs along one heading or across it, it is "
        "believed less.",
        low=0.01,
        high=1.0,
    )
    right_angle_share: float = _setting(
        0.8,
        "Probability that the walls of two rooms are at right angles: a prior, not a rule.",
        low=0.0,
        high=0.99,
    )
    shortest_ch: float = _setting(
        0.05, "Least distance of two photos.", unit="camera heights", low=1e-3, high=10.0
    )
    longest_ch: float = _setting(
        12.0,
        "Photos farther apart than this are not compared.",
        unit="camera heights",
        low=1.0,
        high=1000.0,
    )
    length_cap: float = _setting(
        3.0,
        "Most evidence of a cell of matches for a distance.",
        unit="nats",
        low=0.1,
        high=100.0,
    )
    length_surface_cap: float = _setting(
        4.0,
        "Most evidence of all matches on floor and ceiling for a distance.",
        unit="nats",
        low=0.1,
        high=1000.0,
    )
    usual_ch: float = _setting(
        0.7,
        "Photos nearer than this are less likely the nearer they are.",
        unit="camera heights",
        low=0.01,
        high=10.0,
    )
    usual_spread: float = _setting(
        0.8, "By so much, as a standard deviation of the logarithm.", low=0.1, high=10.0
    )
    length_modes: int = _setting(4, "Distances that are kept of a hypothesis.", low=1, high=50)
    length_drop: float = _setting(
        12.0,
        "Distances of so much less evidence than the best one are dropped.",
        unit="nats",
        low=0.0,
        high=1000.0,
    )
    wall_patches: float = _setting(
        16.0,
        "So many independent pieces a layout's boundary is worth: its errors are alike over 27°.",
        low=1.0,
        high=1000.0,
    )
    same_room: float = _setting(
        0.4, "Probability that two photos compared are of one room.", low=0.01, high=0.99
    )
    walls_cap: float = _setting(
        10.0,
        "Most evidence of two rooms' walls: rectangles fit rectangles.",
        unit="nats",
        low=0.0,
        high=1000.0,
    )
    same_room_near_ch: float = _setting(
        0.7,
        "Two photos nearer than this in one room must have much in common.",
        unit="camera heights",
        low=0.0,
        high=10.0,
    )
    same_room_evidence: float = _setting(
        75.0,
        "Evidence of matches that is as much as photos so near in one room have at the least.",
        unit="nats",
        low=1.0,
        high=1e5,
    )
    same_room_cost: float = _setting(
        25.0,
        "What speaks against two photos so near in one room with nothing in common.",
        unit="nats",
        low=0.0,
        high=1000.0,
    )
    candidate_evidence: float = _setting(
        8.0,
        "Relative poses of two photos with less evidence are not tried.",
        unit="nats",
        low=0.0,
        high=1000.0,
    )
    chance_evidence: float = _setting(
        3.0,
        "Taken from what the matches of a pair say: so much they find by chance at one time in a "
        "hundred.",
        unit="nats",
        low=0.0,
        high=100.0,
    )
    placings: int = _setting(
        40, "So many relative poses are tried to lay one group onto another.", low=1, high=10_000
    )
    trial_evidence: float = _setting(
        20.0,
        "Places of a group with less evidence are not settled: the search over yaws, directions "
        "and distances alone finds about 12 by chance.",
        unit="nats",
        low=0.0,
        high=1000.0,
    )
    merge_evidence: float = _setting(
        38.0,
        "Least evidence gained by merging two groups, over all pairs across. On rendered tours, "
        "whose tiles, doors and lamps repeat themselves, wrong merges gain less or do not lead.",
        unit="nats",
        low=0.0,
        high=1e9,
    )
    merge_margin: float = _setting(
        10.0,
        "Least lead over the second-best place.",
        unit="nats",
        low=0.0,
        high=1000.0,
    )
    rivals: int = _setting(
        5, "So many places of a group are settled and compared.", low=2, high=1000
    )
    rival_share: float = _setting(
        0.4,
        "Places of less than this share of the best one's evidence are no rivals: a pose graph "
        "adds to what was told with an error, not to what is wrong.",
        low=0.0,
        high=1.0,
    )
    place_apart_ch: float = _setting(
        0.35, "Places farther apart than this are two.", unit="camera heights", low=0.0, high=10.0
    )
    place_apart_deg: float = _setting(
        6.0, "Headings farther apart than this are two.", unit="deg", low=0.0, high=90.0
    )
    edge_evidence: float = _setting(
        10.0,
        "Hypotheses with more evidence take part in the pose graph where they are near its poses.",
        unit="nats",
        low=0.0,
        high=1000.0,
    )
    near_yaw_deg: float = _setting(6.0, "How near that is in yaw.", unit="deg", low=0.0, high=90.0)
    near_direction_deg: float = _setting(
        15.0, "How near that is in direction.", unit="deg", low=0.0, high=90.0
    )
    yaw_floor_deg: float = _setting(
        0.3,
        "Added to the standard deviation of a yaw: tilt is common to all matches of a photo.",
        unit="deg",
        low=0.0,
        high=10.0,
    )
    direction_floor_deg: float = _setting(
        0.7,
        "Added to that of a direction: cameras differ in height and tilt.",
        unit="deg",
        low=0.0,
        high=10.0,
    )
    length_floor: float = _setting(0.05, "Added to that of a length, relative.", low=0.0, high=1.0)
    graph_rounds: int = _setting(
        2, "So often the pose graph is solved, with what pairs tell found anew.", low=1, high=100
    )
    graph_loss: float = _setting(
        2.0,
        "Scale of the pose graph's Cauchy loss.",
        unit="standard deviations",
        low=0.1,
        high=100.0,
    )
    apart_deg: float = _setting(
        8.0, "Hypotheses nearer one another than this are one.", unit="deg", low=0.1, high=90.0
    )


@dataclass(frozen=True)
class Config:
    """All settings of a run."""

    preset: str = _setting("default", "The preset these settings started from.")
    seed: int = _setting(0, "Seed of every random choice.", low=0, high=2**63 - 1)
    registration: RegistrationConfig = field(default_factory=RegistrationConfig)
    scale: ScaleConfig = field(default_factory=ScaleConfig)
    rooms: RoomsConfig = field(default_factory=RoomsConfig)
    planes: PlanesConfig = field(default_factory=PlanesConfig)
    orientation: OrientationConfig = field(default_factory=OrientationConfig)
    shape: ShapeConfig = field(default_factory=ShapeConfig)
    levels: LevelsConfig = field(default_factory=LevelsConfig)
    misplaced: MisplacedConfig = field(default_factory=MisplacedConfig)
    grouping: GroupingConfig = field(default_factory=GroupingConfig)
    fusion: FusionConfig = field(default_factory=FusionConfig)
    outline: OutlineConfig = field(default_factory=OutlineConfig)
    adjust: AdjustConfig = field(default_factory=AdjustConfig)
    partition: PartitionConfig = field(default_factory=PartitionConfig)
    apertures: AperturesConfig = field(default_factory=AperturesConfig)
    tour: TourConfig = field(default_factory=TourConfig)

    def __post_init__(self) -> None:
        """Checks every field's type and range."""
        _check(self, "")


_PAPER: dict[str, Any] = {
    "registration": {"height_from_pose": False},
    "scale": {
        "warmup": 0.2,
        "window_stride": 1,
        "step_unit": "absolute",
        "sub_step": False,
        "facings": 1,
        "control": False,
        "intrusion": 0.0,
        "smooth": False,
        "max_range_ch": 100.0,
        "columns": 16384,
    },
    "rooms": {
        "normalise": "running_max",
        "membership": "camera",
        "merge_overlap": 1.0,
        "absorb_keyframes": 0,
        "leave_after": 1,
    },
    "planes": {"resplit": False, "max_range_ch": 100.0},
    "orientation": {"full_length_ch": 0.0},
    "shape": {
        "method": "ispa",
        "core_factor": 0.0,
        "mask_margin_ch": 0.0,
        "wall_merge_ch": 10.0,
        "wall_floor": 1e-6,
    },
}

# The public code's settings as observed (docs/deviations.md). Its thresholds are metres; here they
# are camera heights of 1.5 m.
_RELEASED: dict[str, Any] = {
    "registration": {"height_from_pose": False},
    "scale": {
        "warmup": 1.0,
        "window_stride": 1,
        "steps": (0.5, 0.1, 0.01, 0.001),
        "step_unit": "absolute",
        "sub_step": False,
        "saturation": 20.0,
        "combine": "mean",
        "facings": 1,
        "control": False,
        "intrusion": 0.0,
        "smooth": False,
        "max_range_ch": 100.0,
        "columns": 16384,
    },
    "rooms": {
        "clip_radius_ch": 4.0,
        "clip_quartiles": 6.0,
        "normalise": "running_max",
        "membership": "camera",
        "merge_overlap": 0.5,
        "merge_over": "union",
        "absorb_keyframes": 0,
        "leave_after": 1,
    },
    "planes": {
        "min_inlier_ratio": 0.8,
        "merge_corners_columns": 50.0,
        "min_columns": 50,
        "resplit": False,
        "max_range_ch": 100.0,
    },
    "orientation": {
        "sigma0_deg": 30.0,
        "sigma_per_ch_deg": 43.0,
        "full_length_ch": 0.0,
        "gate_deg": 30.0,
        "final_sigma_deg": 3600.0,
    },
    "shape": {
        "method": "ispa",
        "grids": (96, 128, 128),
        "edge_length": "manhattan",
        "max_edge_angle_deg": 15.0,
        "cost_unit": "cell",
        "band_in_cells": 0.0,
        "band_out_cells": 4.0,
        "refine_cells": 4.0,
        "core_factor": 0.0,
        "mask_margin_ch": 0.0,
        "wall_merge_ch": 10.0,
        "wall_floor": 1e-6,
        "weight_orientation": 115.0,
        "weight_plane": 10.0,
        "weight_mask": 100.0,
        "weight_complexity": 10.0,
    },
}

_CHANGES: dict[str, dict[str, Any]] = {
    "default": {},
    "sound": {"shape": {"method": "ispa"}},
    "paper": _PAPER,
    "released": _RELEASED,
}

PRESETS = tuple(_CHANGES)


def preset(name: str) -> Config:
    """The settings of a preset: "paper", "released", "sound" or "default".

    Raises:
        ConfigError: no such preset.
    """
    if name not in _CHANGES:
        raise ConfigError("preset", repr(name), " or ".join(sorted(_CHANGES)))
    return override(Config(preset=name), _CHANGES[name])


def override(config: Config, changes: Mapping[str, Any]) -> Config:
    """`config` with nested changes.

    Args:
        config: where to start from.
        changes: nested mappings of field names to values, as TOML has them.

    Returns:
        The new settings.

    Raises:
        ConfigError: an unknown key (with the nearest known one), a wrong type, or out of range.
    """
    return typing.cast(Config, _replace(config, changes, ""))


def as_dict(config: Config) -> dict[str, Any]:
    """The settings as nested plain values (tuples become lists), for TOML and JSON."""
    return typing.cast(dict[str, Any], _plain(dataclasses.asdict(config)))


def _plain(value: Any) -> Any:
    if isinstance(value, dict):
        return {key: _plain(item) for key, item in value.items()}
    return [_plain(item) for item in value] if isinstance(value, tuple) else value


def _replace(node: Any, changes: Mapping[str, Any], path: str) -> Any:
    names = [f.name for f in dataclasses.fields(node)]
    new = {}
    for key, value in changes.items():
        where = f"{path}{key}"
        if key not in names:
            near = difflib.get_close_matches(key, names, n=1)
            raise ConfigError(
                where,
                "an unknown setting",
                f"{path}{near[0]}" if near else "one of " + ", ".join(names),
            )
        old = getattr(node, key)
        if dataclasses.is_dataclass(old):
            if not isinstance(value, Mapping):
                raise ConfigError(where, repr(value), "a table of settings")
            new[key] = _replace(old, value, where + ".")
        else:
            new[key] = tuple(value) if isinstance(value, list) else value
    return dataclasses.replace(node, **new)


def _check(node: Any, path: str) -> None:
    hints = typing.get_type_hints(type(node))
    for item in dataclasses.fields(node):
        value, where = getattr(node, item.name), f"{path}{item.name}"
        if dataclasses.is_dataclass(value):
            _check(value, where + ".")
            continue
        if not _fits(value, hints[item.name]):
            wanted = str(hints[item.name]).replace("typing.", "").removeprefix("<class '")
            raise ConfigError(where, repr(value), wanted.removesuffix("'>"))
        low, high = item.metadata.get("low"), item.metadata.get("high")
        for number in value if isinstance(value, tuple) else (value,):
            if (
                isinstance(number, (int, float))
                and not isinstance(number, bool)
                and not ((low is None or number >= low) and (high is None or number <= high))
            ):
                raise ConfigError(where, repr(value), f"{low} to {high} {item.metadata['unit']}")


def _fits(value: Any, hint: Any) -> bool:
    origin = typing.get_origin(hint)
    if origin in (types.UnionType, typing.Union):
        return any(_fits(value, option) for option in typing.get_args(hint))
    if origin is Literal:
        return value in typing.get_args(hint)
    if origin is tuple:
        args = typing.get_args(hint)
        if not isinstance(value, tuple) or not value:
            return False
        if args[-1] is Ellipsis:
            return all(_fits(item, args[0]) for item in value)
        return len(args) == len(value) and all(map(_fits, value, args))
    if hint is float:
        return isinstance(value, (int, float)) and not isinstance(value, bool) and value == value
    if hint is int:
        return isinstance(value, int) and not isinstance(value, bool)
    return isinstance(value, hint)
