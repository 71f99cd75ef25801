from dataclasses import replace

from tests.metrics.plans import plan

from panoplan.exporters.metres import metres_told
from panoplan.types.plan import MetricScale


def with_lengths(sigmas):
    made = replace(plan(), metric=MetricScale("length", 0.0123))
    room = made.rooms[0]
    walls = [
        replace(wall, length_sigma=sigma) for wall, sigma in zip(room.walls, sigmas, strict=True)
    ]
    return replace(made, rooms=(replace(room, walls=tuple(walls)),))


def test_the_source_and_both_kinds_of_uncertainty_are_told():
    assert metres_told(with_lengths((0.01, 0.02, 0.03, None))) == (
        "Metres by length: ± 1.2 % of all lengths in common, and ± 2.0 cm of each wall's own "
        "(median)."
    )


def test_what_is_not_known_is_not_told():
    made = with_lengths((None,) * 4)
    assert metres_told(made) == "Metres by length: ± 1.2 % of all lengths in common."
    assert "not known" in metres_told(replace(made, metric=None))
