"""Many submissions: a window of them over the processes of this machine or of a cluster, and what is done already."""

from __future__ import annotations

import concurrent.futures
import contextlib
import json
import multiprocessing
import os
import signal
import sys
import threading
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

from autograder import sandbox, store, submission
from autograder.unit import block_of, fingerprint, judge


@dataclass(frozen=True)
class Place:
    """Where units are judged, from `processes` or `cluster.connect`.

    Attributes
    ----------
    level : str         isolation there
    window : int        units that are under way at a time: memory does not grow with their number
    submit : callable   the arguments of `unit.judge` -> a future of what it gives
    """

    level: str
    window: int
    submit: Callable


def run(units, job, place, progress) -> dict[str, int]:
    """Grade the units; results that are there already, of the same bytes and on the same terms, are kept.

    Parameters
    ----------
    units : list of Unit
    job : Job
    place : Place
    progress : callable     is told the unit, its result's status, and whether it was kept

    Returns
    -------
    dict                    how many results there are of each status

    Raises
    ------
    KeyboardInterrupt       after what was running has finished
    """
    states: dict[str, int] = {}

    def done(unit, status, kept):
        states[status] = states.get(status, 0) + 1
        progress(unit, status, kept)

    running: set[concurrent.futures.Future] = set()
    waiting, interrupted = iter(units), False
    while True:
        try:
            while not interrupted and len(running) < place.window:
                unit = next(waiting, None)
                if unit is None:
                    break
                block = _read(unit)
                before = _finished(unit, block, job)
                if unit.student in job.regrade:
                    before = None
                if before is not None and not _has(before, job.tasks):
                    done(unit, before["status"], True)
                else:
                    running.add(place.submit(unit, block, job, before))
            if not running:
                break
            finished, _ = concurrent.futures.wait(running, return_when=concurrent.futures.FIRST_COMPLETED)
            for future in finished:
                graded = future.result()
                store.write(graded.result, graded.pictures, job.out, graded.unit.folder)
                running.discard(future)
                done(graded.unit, graded.result["status"], False)
        except KeyboardInterrupt:
            if not interrupted:
                print("\nstopping: what runs is finished first", file=sys.stderr)
            interrupted = True
    if interrupted:
        raise KeyboardInterrupt
    return states


@contextlib.contextmanager
def processes(jobs):
    """A place of `jobs` processes on this machine."""
    context = multiprocessing.get_context("spawn")
    with concurrent.futures.ProcessPoolExecutor(jobs, context, initializer=_begin_process) as executor:
        yield Place(sandbox.strongest_level(), jobs + 1, lambda *work: executor.submit(judge, *work))


def _read(unit):
    try:
        return block_of(unit)
    except submission.Rejected as rejected:
        return rejected


def _finished(unit, block, job):
    """The finished result of the same bytes, terms and isolation, or None."""
    path = Path(job.out) / "results" / unit.folder / f"{unit.assignment}.json"
    try:
        result = json.loads(path.read_text(encoding="utf-8"))
        made = result["record"]
        same = made["source"] == fingerprint(block) and all(made[key] == value for key, value in job.terms.items())
        return result if same and result["isolation"] == job.level else None
    except (OSError, ValueError, KeyError, TypeError):
        return None


def _has(result, tasks):
    """Whether any of these tasks was there to judge."""
    return result["status"] != "rejected" and any(check["id"] in tasks for check in result["checks"])


def _begin_process():
    """A process of `processes`: Ctrl-C is its parent's to handle; without the parent it ends, and its sandboxes with it."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    threading.Thread(target=_end_with, args=(multiprocessing.parent_process(),), daemon=True).start()


def _end_with(parent):
    parent.join()
    os._exit(1)
