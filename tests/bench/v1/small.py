"""Small scenes for the tests of the benchmark."""

from dataclasses import dataclass

from panoplan.bench.parallel import processes
from panoplan.bench.v1.scenes import Simulated
from panoplan.bench.v1.store import Store
from panoplan.bench.v1.study import Runner
from panoplan.simulate.scene import simulate_flat


@dataclass(frozen=True)
class Small(Simulated):
    """A flat of few keyframes in a unit of 0.25 m."""

    def simulated(self):
        return simulate_flat(
            self.seed, self.grade, rooms=5, step_m=2.0, keyframes_per_room=4, metres_per_su=0.25
        )


def runner(folder, progress=lambda *_: None):
    """Does the work here and keeps it in a folder."""
    return Runner(Store(folder), processes(1), progress)
