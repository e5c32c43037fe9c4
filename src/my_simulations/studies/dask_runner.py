"""Runs the cases of a study on the workers of a Dask cluster; the only module that imports Dask.

Each worker keeps a pool of slots, made by a plugin of Dask's, and gets shards of cases of some ten
seconds, two at a time, so that it never waits. Only this process writes the journal. Connections
use TLS and certificates on both sides: a scheduler runs whatever who reaches it hands in.
"""
from __future__ import annotations

import asyncio
import itertools
import os
import time
from concurrent.futures import CancelledError
from dataclasses import dataclass, field
from queue import Empty, SimpleQueue
from typing import Any, Callable, Dict, Iterator, List, Optional, Set, Tuple

from distributed import Client, Future, TimeoutError, WorkerPlugin, get_worker
from distributed.comm.core import CommClosedError
from distributed.scheduler import KilledWorker
from distributed.security import Security

from ..errors import CommandError
from .case_output import CaseOutput
from .cluster_address import TlsFiles
from .plan import ALL_CASES, Case, CasePlan, Shard
from .row import NODE_LOST, Row
from .row_recorder import Recorder
from .slot_pool import SlotPool
from .study import Study
from .study_runner import Report, waiting_cases

_WINDOW = 2        # shards in flight on a worker
_SHARD_S = 10.0    # that a shard should take
_MOST_CASES = 5000  # of a shard
_POLL_S = 1.0      # between two queries of the list of workers
_CONNECT_S = 30.0
_GATHER_S = 10.0   # for the rows of a shard to arrive
_CONNECTED = "running"  # the status of a client whose scheduler answers

Result = Tuple[Row, Optional[CaseOutput]]


def security_of(files: TlsFiles) -> Security:
    """For Dask. Raises CommandError if files are missing or cannot be used."""
    given = {"tls_ca_file": files.ca, "tls_client_cert": files.cert, "tls_client_key": files.key}
    security = Security(require_encryption=True,
                        **{name: file for name, file in given.items() if file})
    if not security.tls_ca_file or not security.tls_client_cert:
        raise CommandError("a Dask cluster needs certificates: give --tls-ca, --tls-cert and"
                           " --tls-key, or set distributed.comm.tls in Dask's configuration"
                           " (doc/scale.md tells how to make them)")
    try:
        security.get_connection_args("client")
    except (OSError, ValueError) as fault:
        raise CommandError(f"the certificates cannot be used: {fault}") from None
    return security


class StudyWorker(WorkerPlugin):
    """What a worker has of a study: its plan, and slots with kept engines.

    Args:
        study: the study; the worker must see its files at the same paths.
        versions: of the driver.
        slots: how many cases run at a time; 0 for the worker's number of threads.
    """

    def __init__(self, study: Study, versions: Dict[str, str], slots: int) -> None:
        self._study = study
        self._versions = versions
        self._wanted = slots
        self._pool: Optional[SlotPool] = None
        self._plan: Optional[CasePlan] = None

    def __getstate__(self) -> Dict[str, Any]:
        """The pool stays on its worker."""
        return {**self.__dict__, "_pool": None, "_plan": None}

    def setup(self, worker: Any) -> None:
        """Called by Dask when the plugin reaches a worker."""
        self._plan = CasePlan(self._study)
        self._pool = SlotPool(self._plan, self._wanted or worker.state.nthreads)

    def teardown(self, worker: Any) -> None:
        """Called by Dask when the study is over, or the worker ends."""
        if self._pool is not None:
            self._pool.close()

    def run(self, cases: List[Tuple[int, str]]) -> List[Result]:
        """Run the cases of these numbers and ids; returns what has finished.

        Raises CommandError: a case has another id here: files or versions differ.
        """
        if self._plan is None or self._pool is None:
            return []
        found: List[Result] = []
        self._pool.run(self._cases(self._plan, cases),
                       lambda row, output: found.append((row, output)))
        return found

    def _cases(self, plan: CasePlan, wanted: List[Tuple[int, str]]) -> Iterator[Case]:
        for index, case_id in wanted:
            case = plan.case(index)
            if case.id != case_id:
                differ = [f"{name} {version} here, {self._versions.get(name)} where the study"
                          " was started" for name, version in plan.versions.items()
                          if version != self._versions.get(name)]
                raise CommandError(f"case {index} has another id on a worker: "
                                   + ("; ".join(differ) or "a file of the study is missing"
                                      " or differs"))
            yield case


def _run_shard(name: str, cases: List[Tuple[int, str]]) -> List[Result]:
    """The task: run by a worker."""
    results: List[Result] = get_worker().plugins[name].run(cases)
    return results


@dataclass
class _Flight:
    """A shard on its way."""

    worker: str
    cases: List[Case]
    future: Future
    alone: bool


@dataclass
class _Node:
    """A worker, as seen from here."""

    threads: int
    flights: List[_Flight] = field(default_factory=list)
    began: float = field(default_factory=time.monotonic)
    done: int = 0

    def shard_size(self, slots: int) -> int:
        """Cases of a shard that takes about _SHARD_S."""
        if not self.done:
            return slots
        rate = self.done / max(time.monotonic() - self.began, 1e-3)
        return max(slots, min(_MOST_CASES, int(rate * _SHARD_S)))


class DaskRunner:
    """Runs all cases that have no row yet on a cluster.

    A worker that is lost costs nothing but time: its cases run again, one at a time, so that one
    that ends its node is told from its neighbours; it is `node lost` after the attempts that the
    study allows.

    Args:
        plan: the cases.
        recorder: keeps the rows.
        finished: ids of the cases that have a row, as numbers.
        slots: how many cases run at a time on a worker; 0 for its number of threads.
        address: of the scheduler, `tls://HOST:PORT`, or the path of its scheduler file.
        tls: certificates.
        told: hears of each row.
        say: hears what the run waits for.
    """

    def __init__(self, plan: CasePlan, recorder: Recorder, finished: Set[int], slots: int,
                 address: str, tls: TlsFiles, told: Report, say: Callable[[str], None]) -> None:
        self._plan = plan
        self._recorder = recorder
        self._finished = finished
        self._slots = slots
        self._address = address
        self._security = security_of(tls)
        self._told = told
        self._say = say
        self._nodes: Dict[str, _Node] = {}
        self._ended: "SimpleQueue[Future]" = SimpleQueue()
        self._flights: Dict[str, _Flight] = {}
        self._again: List[Case] = []      # left over, not run yet
        self._suspects: List[Case] = []   # were on a worker that was lost
        self._losses: Dict[str, int] = {}  # of a case that ran alone
        self._left = 0

    def run(self, shard: Shard = ALL_CASES) -> None:
        """Run the cases of a shard; returns when all are done.

        Raises:
            CommandError: the scheduler cannot be reached or was lost, or a worker cannot run cases.
        """
        client = self._connect_client()
        name = f"my_simulations study {self._plan.study.file}"
        try:
            self._register(client, name)
            self._drive(client, name, shard)
        except CommandError:
            raise
        except (Exception, asyncio.CancelledError) as fault:
            if client.status == _CONNECTED and not isinstance(fault, (OSError, CommClosedError)):
                raise
            # A lost connection gives different errors to a call, a row, and the client, which
            # cancels all futures first and is closed later.
            raise CommandError(f"the Dask scheduler {self._address} was lost:"
                               f" {str(fault) or type(fault).__name__}; `study resume` goes on"
                               ) from None
        finally:
            self._recorder.close()
            self._leave(client, name)

    # -- the connection ----------------------------------------------------------------------------

    def _connect_client(self) -> Client:
        where: Dict[str, Any] = ({"scheduler_file": self._address}
                                 if os.path.isabs(self._address) else {"address": self._address})
        try:
            client = Client(**where, security=self._security, timeout=_CONNECT_S,
                            set_as_default=False)
        except Exception as fault:  # of many kinds: certificates, names, ports, files
            raise CommandError(f"there is no Dask scheduler at {self._address} that these"
                               f" certificates fit: {fault}") from None
        if not client.scheduler.address.startswith("tls://"):
            client.close()
            raise CommandError(f"the scheduler at {self._address} does not use TLS")
        return client

    def _register(self, client: Client, name: str) -> None:
        plugin = StudyWorker(self._plan.study, self._plan.versions, self._slots)
        # By the name of before 2023.9, which Python 3.8 has.
        register = getattr(client, "register_plugin", None) or client.register_worker_plugin
        register(plugin, name=name)

    def _leave(self, client: Client, name: str) -> None:
        try:
            if client.status == _CONNECTED:
                client.cancel([flight.future for flight in self._flights.values()])
                client.unregister_worker_plugin(name)
            client.close(timeout=5)
        except (Exception, asyncio.CancelledError) as fault:  # workers end their engines when idle
            self._say("the cluster could not be told that the study is over:"
                      f" {str(fault) or type(fault).__name__}")

    # -- sharing out -------------------------------------------------------------------------------

    def _drive(self, client: Client, name: str, shard: Shard) -> None:
        """Send the cases of a shard to the workers and collect the rows, until all have run."""
        cases = waiting_cases(self._plan, shard, self._finished)
        self._left = len(range(shard.index - 1, len(self._plan), shard.of)) - len(self._finished)
        first = next(cases, None)
        cases = cases if first is None else itertools.chain([first], cases)
        over = first is None
        polled_at, told = float("-inf"), False
        while not over:
            if time.monotonic() - polled_at > _POLL_S:
                self._update_workers(client)
                polled_at = time.monotonic()
                if not self._nodes and not told:
                    self._say("waiting for a worker")
                told = not self._nodes
            for address, node in self._nodes.items():
                self._fill(client, name, address, node, cases)
            over = not self._flights and bool(self._nodes) and not self._suspects
            self._collect(0.0 if over else _POLL_S)

    def _update_workers(self, client: Client) -> None:
        """Read the list of workers; cases of workers that have left run again."""
        threads: Dict[str, int] = client.nthreads()
        for address in [address for address in self._nodes if address not in threads]:
            for flight in self._nodes.pop(address).flights:
                self._remove_lost(flight)
        for address, count in threads.items():
            self._nodes.setdefault(address, _Node(count))

    def _fill(self, client: Client, name: str, address: str, node: _Node,
              cases: Iterator[Case]) -> None:
        slots = self._slots or node.threads
        if self._suspects:
            if not node.flights:
                self._send(client, name, address, node, [self._suspects.pop()], alone=True)
            return
        while len(node.flights) < _WINDOW and not any(flight.alone for flight in node.flights):
            fair = max(slots, self._left // (_WINDOW * len(self._nodes)))
            size = min(node.shard_size(slots), fair)
            chosen, self._again = self._again[:size], self._again[size:]
            chosen += itertools.islice(cases, size - len(chosen))
            if not chosen:
                return
            self._send(client, name, address, node, chosen, alone=False)

    def _send(self, client: Client, name: str, address: str, node: _Node, cases: List[Case],
              alone: bool) -> None:
        future = client.submit(_run_shard, name, [(case.index, case.id) for case in cases],
                               workers=[address], allow_other_workers=False, pure=False, retries=0)
        flight = _Flight(address, cases, future, alone)
        node.flights.append(flight)
        self._flights[future.key] = flight
        future.add_done_callback(self._ended.put)

    def _collect(self, seconds: float) -> None:
        """Take what has come back; wait so long for the first."""
        ended: List[Future] = []
        try:
            ended.append(self._ended.get(timeout=seconds) if seconds else self._ended.get_nowait())
            while True:
                ended.append(self._ended.get_nowait())
        except Empty:
            pass
        for future in ended:
            flight = self._flights.get(future.key)
            if flight is not None:
                self._process_result(flight)

    def _process_result(self, flight: _Flight) -> None:
        try:
            results: List[Result] = flight.future.result(timeout=_GATHER_S)
        except TimeoutError:  # its worker ended between the last case and now, or the net is slow
            self._ended.put(flight.future)
            return
        except (KilledWorker, CancelledError):
            if flight.future.client.status != _CONNECTED:
                raise  # the client cancels all futures when the scheduler is lost
            self._remove_lost(flight)
            return
        except Exception as fault:  # such as a module that is not installed there
            if flight.future.status != "error":
                raise  # of the connection, not of the task
            kind = "" if isinstance(fault, CommandError) else f"{type(fault).__name__}: "
            raise CommandError(f"worker {flight.worker}: {kind}{fault}") from None
        self._remove(flight)
        done = set()
        for row, output in results:
            self._add_row(row, output)
            done.add(row.case)
        self._again += [case for case in flight.cases if case.id not in done]
        node = self._nodes.get(flight.worker)
        if node is not None:
            node.done += len(results)

    def _add_row(self, row: Row, output: Optional[CaseOutput]) -> None:
        self._recorder.add(row, output)
        self._left -= 1
        self._told(row)

    def _remove(self, flight: _Flight) -> None:
        self._flights.pop(flight.future.key, None)
        node = self._nodes.get(flight.worker)
        if node is not None and flight in node.flights:
            node.flights.remove(flight)

    def _remove_lost(self, flight: _Flight) -> None:
        """The worker of a shard has gone."""
        self._remove(flight)
        flight.future.cancel()
        if not flight.alone:
            self._suspects += flight.cases
            return
        (case,) = flight.cases
        losses = self._losses[case.id] = self._losses.get(case.id, 0) + 1
        if losses < self._plan.study.limits.attempts:
            self._suspects.append(case)
            return
        self._add_row(Row(NODE_LOST, case.id, case.index, case.seed, dict(case.settings),
                       attempt=losses, issue=f"the worker {flight.worker} was lost while only this"
                                             " case ran on it"), None)
