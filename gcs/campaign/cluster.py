"""A Dask cluster as the executor of a campaign (``--scheduler``); imported only where one is named."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from concurrent.futures import Executor, Future
from contextlib import contextmanager
from typing import Any, TypeVar

from distributed import Client, Nanny, get_worker
from distributed.comm.addressing import parse_address, parse_host_port
from distributed.diagnostics.plugin import NannyPlugin

from gcs.errors import GcsError, UnusableInput
from gcs.numerics import choose_kernels, differences

R = TypeVar("R")


class ChosenKernels(NannyPlugin):
    """Start workers with the numeric code of all flights: they load numpy before any call."""

    name = "cooplift-kernels"

    def __init__(self, restart: bool) -> None:
        """``restart``: workers that run already."""
        self.restart = restart

    def setup(self, nanny: Nanny) -> None:
        """Set the environment in which a worker is started, and that of the worker."""
        for environment in (nanny.pre_spawn_env, nanny.env):
            choose_kernels(environment)


class ClusterExecutor(Executor):
    """Carries out calls on workers with the numeric code of all flights only."""

    def __init__(self, client: Client) -> None:
        self._executor: Executor = client.get_executor(pure=False)

    def submit(self, call: Callable[..., R], /, *args: Any, **keywords: Any) -> Future[R]:
        """Carry out ``call``; its future raises :class:`GcsError` where the worker has other numeric code."""
        return self._executor.submit(_checked, call, *args, **keywords)

    def shutdown(self, wait: bool = True, *, cancel_futures: bool = False) -> None:
        """Wait for the calls, or drop those that have not begun."""
        self._executor.shutdown(wait=wait)


def _checked(call: Callable[..., R], /, *args: Any, **keywords: Any) -> R:
    if others := differences():
        raise GcsError(f"worker {get_worker().address}: {others}: start again to resume, and the worker with a nanny")
    return call(*args, **keywords)


@contextmanager
def cluster(address: str) -> Iterator[Executor]:
    """Connect to the scheduler at ``address``. Raises :class:`UnusableInput` if there is none.

    Workers share the file system of this machine. Those with other numeric code are started anew.
    """
    try:
        parse_host_port(parse_address(address)[1])  # the client would not end without a port
        client = Client(address, set_as_default=False)
    except (OSError, ValueError) as error:
        raise UnusableInput(f"--scheduler {address}: no Dask scheduler answers there: {error}") from None
    with client:
        client.register_plugin(ChosenKernels(restart=any(client.run(differences).values())))
        yield ClusterExecutor(client)
