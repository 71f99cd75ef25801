import numpy as np

from panoplan.bench.v1.predict import Prediction
from panoplan.bench.v1.score import FIGURES, score
from panoplan.bench.v1.store import KeptScene
from panoplan.simulate.buildings import rectangle
from panoplan.types.pose import Trajectory
from panoplan.types.truth import GroundTruth, TruePlan, TrueRoom


def test_a_failure_has_found_nothing_of_the_rooms_entered_and_of_each_door_once():
    rooms = (
        TrueRoom("room_01", "", rectangle(4, 3)),
        TrueRoom("room_02", "", rectangle(3, 3, (4.1, 0))),
    )
    faces = tuple(np.array([[x, 1.0], [x, 1.8]]) for x in (4.0, 4.1))
    camera = Trajectory(("1",), np.eye(3)[None], np.array([[2.0, 0.0, 1.0]]))
    truth = GroundTruth(TruePlan(rooms, doors=faces), camera)
    row = score(KeptScene(truth, 1, 1.5, None), Prediction(None, "lost", 0.5))
    assert row["failure"] == "lost"
    for alignment in ("aligned", "unaligned"):
        counts = [row[alignment][name] for name in FIGURES]
        assert counts == [[0, 1, 0], [0, 1, 0], [0, 1, 0], [0, 4, 0], [0, 1, 0]]
