"""Families of made-up buildings with stated statistics: the scenes of the benchmark."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.special import ndtri

from panoplan.errors import InputError
from panoplan.simulate.buildings import Building
from panoplan.simulate.film import film
from panoplan.simulate.houses import Style, make_house, make_storeys
from panoplan.simulate.joining import Joinery
from panoplan.simulate.noise import NoiseModel
from panoplan.simulate.scene import Grade, SimulatedScene, noise_model, recorded
from panoplan.simulate.walks import stills

TUNING_SEEDS = range(25)
"""Scenes to develop on."""
REPORTED_SEEDS = range(25, 50)
"""Scenes that figures are reported of; nothing is chosen by them."""

MOST_STOREYS = 4
_BLOCK = 50
_STRIDES = (37, 29)
_GOLDEN = (np.sqrt(5) - 1) / 2


@dataclass(frozen=True)
class Family:
    """Buildings that have sizes and a style in common.

    Attributes:
        name: of the family.
        rooms: (mean, standard deviation) of the number of rooms over 50 seeds.
        area_m2: (mean, standard deviation) of the floor area over 50 seeds.
        style: of the houses.
        heavy_tailed: whether the number of rooms is lognormal, else normal.
        rooms_law: mean and standard deviation of that normal, or of the logarithm.
        room_m2_law: the same of the logarithm of the area a room.
        fewest, most: limits of the number of rooms.
    """

    name: str
    rooms: tuple[float, float]
    area_m2: tuple[float, float]
    style: Style
    heavy_tailed: bool
    rooms_law: tuple[float, float]
    room_m2_law: tuple[float, float]
    fewest: int
    most: int

    def size(self, seed: int) -> tuple[int, float]:
        """Number of rooms and area in m² of a seed's building.

        Any 50 seeds from a multiple of 50 on stand on a lattice of quantiles, so that their mean
        and standard deviation are the family's, and any run of seeds is spread over all sizes.
        """
        block, place = divmod(seed, _BLOCK)
        within = (0.5 + block * _GOLDEN) % 1.0
        first, second = (ndtri(((k * place) % _BLOCK + within) / _BLOCK) for k in _STRIDES)
        count = self.rooms_law[0] + self.rooms_law[1] * first
        count = np.exp(count) if self.heavy_tailed else count
        rooms = int(np.clip(np.rint(count), self.fewest, self.most))
        return rooms, rooms * float(np.exp(self.room_m2_law[0] + self.room_m2_law[1] * second))


# The laws are those with which 50 seeds have the stated means and standard deviations.
_MP3D_FPE = Family(
    name="mp3d-fpe",
    rooms=(13.7, 9.0),
    area_m2=(686.0, 760.0),
    style=Style(
        shapes=((3, 12, "I", 1.0), (4, 24, "L", 1.0), (6, 24, "T", 1.0), (8, 60, "U", 0.9),
                (9, 60, "O", 0.9), (14, 60, "H", 0.9)),
        corridor_m=(1.3, 2.6),
        widest_band_m=11.0,
        closet_share=0.16,
        closet_m=(1.3, 3.2),
        least_room_m2=3.0,
        spread=0.55,
        skewed_share=0.4,
        feature_share=0.5,
        pillared_m2=45.0,
        ceiling_m=(2.5, 3.4),
        doors=Joinery(0.6, 0.3, (0.75, 1.1), 0.15, 5.0),
    ),
    heavy_tailed=True,
    rooms_law=(2.40, 0.665),
    room_m2_law=(3.66, 0.555),
    fewest=3,
    most=45,
)  # fmt: skip
_FLAT = Family(
    name="flat",
    rooms=(7.0, 2.0),
    area_m2=(105.0, 44.0),
    style=Style(
        shapes=((3, 12, "I", 1.0), (6, 12, "L", 0.7), (7, 12, "T", 0.3), (8, 12, "U", 0.15)),
        corridor_m=(1.1, 1.6),
        widest_band_m=5.5,
        closet_share=0.14,
        closet_m=(1.1, 2.4),
        least_room_m2=2.5,
        spread=0.4,
        skewed_share=1 / 3,
        feature_share=0.35,
        pillared_m2=28.0,
        ceiling_m=(2.35, 2.9),
        doors=Joinery(0.7, 0.3, (0.7, 0.95), 0.03, 4.0),
    ),
    heavy_tailed=False,
    rooms_law=(7.05, 2.07),
    room_m2_law=(2.65, 0.205),
    fewest=3,
    most=12,
)
_FAMILIES = {family.name: family for family in (_MP3D_FPE, _FLAT)}
FAMILIES: tuple[str, ...] = tuple(_FAMILIES)
"""Names of the families."""


def family_of(name: str) -> Family:
    """A family by its name.

    Raises:
        InputError: there is none of that name.
    """
    if name not in _FAMILIES:
        raise InputError("family", repr(name), " | ".join(FAMILIES))
    return _FAMILIES[name]


def make_building(family: str, seed: int, storeys: int = 1) -> Building:
    """The building of a family and a seed.

    Args:
        family: one of `FAMILIES`.
        seed: ≥ 0; the same seed gives the same building.
        storeys: how many; each has as many rooms as the building of one.

    Raises:
        InputError: no such family, a negative seed, or not 1 to 4 storeys.
    """
    known = family_of(family)
    if seed < 0:
        raise InputError("seed", str(seed), "0 or more")
    if not 1 <= storeys <= MOST_STOREYS:
        raise InputError("storeys", str(storeys), f"1 to {MOST_STOREYS}")
    rooms, area = known.size(seed)
    if storeys > 1:
        rng = np.random.default_rng([FAMILIES.index(family), seed, storeys])
        name = f"{family}_{seed:04d}_{storeys}_storeys"
        return make_storeys(name, known.style, rooms, area, storeys, rng)
    rng = np.random.default_rng([FAMILIES.index(family), seed])
    return make_house(f"{family}_{seed:04d}", known.style, rooms, area, rng)


def simulate_scene(
    family: str,
    seed: int,
    grade: Grade | NoiseModel = "measured",
    *,
    as_stills: bool = False,
    storeys: int = 1,
    metres_per_su: float | None = None,
) -> SimulatedScene:
    """A scene of a family: the building of a seed, filmed on a walk through all its rooms.

    Args:
        family: one of `FAMILIES`.
        seed: ≥ 0; building and walk do not depend on the grade.
        grade: name of a grade, or a noise model.
        as_stills: sparse photos instead of a walk.
        storeys: how many, 1 to 4.
        metres_per_su: metres a trajectory unit; log-uniform over 0.1-10 where None.

    Raises:
        InputError: no such family or grade, a negative seed, or so many storeys.
    """
    building = make_building(family, seed, storeys)
    # The scenes of one storey are frozen, and so is what they are drawn by.
    root = [FAMILIES.index(family), seed, 1, *([storeys] if storeys > 1 else [])]
    return _recorded(building, root, grade, as_stills, metres_per_su)


def simulate_in(
    building: Building,
    seed: int,
    grade: Grade | NoiseModel = "measured",
    *,
    as_stills: bool = False,
) -> SimulatedScene:
    """A scene in a given building, filmed as those of the families are.

    Args:
        building: connected.
        seed: of the walk and the errors, ≥ 0.
        grade: name of a grade, or a noise model.
        as_stills: sparse photos instead of a walk.

    Raises:
        InputError: no such grade, a negative seed, or a building that cannot be walked.
    """
    if seed < 0:
        raise InputError("seed", str(seed), "0 or more")
    return _recorded(building, [len(FAMILIES), seed, 1], grade, as_stills, None)


def _recorded(
    building: Building,
    root: list[int],
    grade: Grade | NoiseModel,
    as_stills: bool,
    metres_per_su: float | None,
) -> SimulatedScene:
    way_rng, unit_rng, noise_rng, drift_rng = (
        np.random.default_rng(s) for s in np.random.SeedSequence(root).spawn(4)
    )
    unit = float(10 ** unit_rng.uniform(-1, 1)) if metres_per_su is None else metres_per_su
    way = stills(building, way_rng) if as_stills else film(building, way_rng)
    return recorded(building, way, noise_model(grade), unit, noise_rng, drift_rng)
