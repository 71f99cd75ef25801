"""Independent pieces of work on a Ray cluster."""

from __future__ import annotations

import logging
from collections.abc import Callable, Iterator, Sequence
from typing import Any

from panoplan.bench.parallel import Result, Work, WorkerLostError, Workers
from panoplan.errors import InputError, MissingExtraError

_RETRIES = 5


def on_ray(address: str) -> Workers:
    """Workers of a Ray cluster, one a processor that it has.

    Work of a machine that is lost is done again on another. Every machine needs the same version of
    panoplan; none needs to see the files of another.

    Args:
        address: of the cluster, as Ray takes it ("auto", "host:6379", "ray://host:10001").

    Returns:
        The workers. Where work is lost time and again they raise WorkerLostError.

    Raises:
        InputError: no cluster there.
        MissingExtraError: Ray is not installed.
    """
    try:
        import ray
    except ImportError:
        raise MissingExtraError("work on a cluster", "ray", "ray") from None
    try:
        ray.init(
            address, ignore_reinit_error=True, log_to_driver=False, logging_level=logging.ERROR
        )
    except (ConnectionError, ValueError, RuntimeError) as error:
        raise InputError("--ray", f"no cluster at {address} ({error})", "its address") from None

    def finished(
        function: Callable[[Work], Result], work: Sequence[Work], /
    ) -> Iterator[tuple[int, Result]]:
        remote: Any = ray.remote(num_cpus=1, max_retries=_RETRIES)(_call)
        place = {remote.remote(function, item): number for number, item in enumerate(work)}
        left = list(place)
        try:
            while left:
                (ready,), left = ray.wait(left, num_returns=1)
                yield place[ready], ray.get(ready)
        except (ray.exceptions.WorkerCrashedError, ray.exceptions.NodeDiedError) as error:
            raise WorkerLostError(f"work on the cluster was lost: {error}") from None
        except ray.exceptions.RayTaskError as error:
            raise error.cause from None
        finally:
            for task in left:
                ray.cancel(task)

    return finished


def _call(function: Callable[[Work], Result], item: Work) -> Result:
    return function(item)
