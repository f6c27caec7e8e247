"""Where the tasks of a sweep are worked on: here, on processes of this machine, or on a Dask cluster.

Whoever works on a task, the result is the same, and a worker that dies costs time and nothing else: its tasks are given
out again.
"""

import multiprocessing
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import FIRST_COMPLETED, Future, ProcessPoolExecutor, wait
from concurrent.futures.process import BrokenProcessPool
from typing import TypeVar

from slidepipe.errors import InputError, SlidepipeError

Task = TypeVar("Task")
Result = TypeVar("Result")
Work = Callable[[Task], Result]

MOST_DEATHS = 10
"""How often workers may die before something is wrong with the tasks themselves."""
CONNECT_S = 10


def here(work: Work[Task, Result], tasks: Sequence[Task]) -> Iterator[Result]:
    """Work on one task after the other in this process."""
    yield from map(work, tasks)


def on_processes(work: Work[Task, Result], tasks: Sequence[Task], count: int) -> Iterator[Result]:
    """Work on ``count`` processes; results come as they are ready.

    Raises
    ------
    SlidepipeError
        Workers died again and again.
    """
    left = dict(enumerate(tasks))
    deaths = 0
    while left:
        try:
            for number, result in _pool_round(work, left, count):
                del left[number]
                yield result
        except BrokenProcessPool:
            deaths += 1
            if deaths > MOST_DEATHS:
                raise SlidepipeError(
                    f"sweep: worker processes were ended {deaths} times: is there enough memory? try --workers 1"
                ) from None


def on_cluster(work: Work[Task, Result], tasks: Sequence[Task], address: str) -> Iterator[Result]:
    """Work on the cluster whose scheduler has this address; results come as they are ready.

    Raises
    ------
    InputError
        Dask is not installed, or nobody answers.
    """
    try:
        from distributed import Client, as_completed  # noqa: PLC0415  # an extra that few need
    except ImportError:
        raise InputError("--scheduler: needs Dask: pip install 'slidepipe[cluster]'") from None
    try:
        client = Client(address, timeout=CONNECT_S, set_as_default=False)
    except (OSError, ValueError) as error:
        raise InputError(f"--scheduler {address}: nobody answers there: {error}") from None
    with client:
        futures = client.map(work, tasks, pure=False, retries=MOST_DEATHS)
        for future in as_completed(futures, loop=client.loop):
            yield future.result()


def _pool_round(work: Work[Task, Result], left: dict[int, Task], count: int) -> Iterator[tuple[int, Result]]:
    """Give out what is left; ends with BrokenProcessPool where a worker dies."""
    # Spawned, not forked: threads of numpy, numba and MuJoCo do not survive a fork.
    context = multiprocessing.get_context("spawn")
    with ProcessPoolExecutor(min(count, len(left)), mp_context=context) as pool:
        numbers: dict[Future[Result], int] = {pool.submit(work, task): number for number, task in left.items()}
        waiting = set(numbers)
        try:
            while waiting:
                done, waiting = wait(waiting, return_when=FIRST_COMPLETED)
                for future in done:
                    yield numbers[future], future.result()
        finally:
            pool.shutdown(wait=False, cancel_futures=True)
