"""Work on a local Ray cluster of two machines, one of them lost midway."""

import threading
import time

import pytest

from panoplan.bench.parallel import mapped
from panoplan.errors import InputError

pytest.importorskip("ray", reason="the extra ray is not installed")
pytestmark = pytest.mark.filterwarnings("default")


def squared(item):
    """The square; number 0 never comes back from the machine that it is first given to."""
    import ray

    folder, number = item
    if number == 0:
        first = not list(folder.glob("0-*"))
        (folder / f"0-{ray.get_runtime_context().get_node_id()}").touch()
        while first:
            time.sleep(0.1)
    return number**2


def broken(_):
    raise InputError("a scene", "nothing", "something")


@pytest.fixture(scope="module")
def cluster():
    import ray
    from ray.cluster_utils import Cluster

    made = Cluster(initialize_head=True, head_node_args={"num_cpus": 0})
    machines = [made.add_node(num_cpus=1) for _ in range(2)]
    yield made, machines
    ray.shutdown()
    made.shutdown()


def test_an_error_of_the_work_is_raised_here(cluster):
    from panoplan.bench.cluster import on_ray

    with pytest.raises(InputError, match="a scene: found nothing"):
        mapped(broken, [1], on_ray(cluster[0].address), lambda *_: None)


def test_work_of_a_lost_machine_is_done_by_another(cluster, tmp_path):
    from panoplan.bench.cluster import on_ray

    workers = on_ray(cluster[0].address)
    threading.Thread(target=_lose, args=(*cluster, tmp_path), daemon=True).start()
    work, done = [(tmp_path, number) for number in range(6)], []
    results = mapped(squared, work, workers, lambda *now: done.append(now))
    assert results == [0, 1, 4, 9, 16, 25]
    assert done[-1] == (6, 6)
    # It was begun on both.
    begun = {path.name for path in tmp_path.glob("0-*")}
    assert begun == {f"0-{machine.node_id}" for machine in cluster[1]}


def _lose(cluster, machines, folder):
    """Kills the machine that number 0 is on."""
    while not (begun := list(folder.glob("0-*"))):
        time.sleep(0.05)
    lost = next(m for m in machines if begun[0].name == f"0-{m.node_id}")
    cluster.remove_node(lost, allow_graceful=False)
