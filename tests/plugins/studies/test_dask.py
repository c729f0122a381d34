"""A study on a cluster: a real scheduler and real workers on this machine, one of which is killed in the middle."""

from __future__ import annotations

import json
import os
import signal
import subprocess
import sys
import threading
import time

import pytest
from studies import lines, written

pytest.importorskip("distributed", reason="dask.distributed is not installed")
SIZES = "[sweep]\nbasis.size = [10, 11, 12, 13, 14, 15, 16, 17, 18, 19, 20, 21]\n"


def dask(*arguments: object, log) -> subprocess.Popen[bytes]:
    command = [sys.executable, "-m", "dask", *map(str, arguments)]
    return subprocess.Popen(command, stdout=log, stderr=log, start_new_session=True)


@pytest.fixture
def cluster(tmp_path):
    """The address of a scheduler with two workers, and these, which have no nanny: what is killed stays dead."""
    found = tmp_path / "scheduler.json"
    processes = []
    with (tmp_path / "cluster.log").open("wb") as log:
        common = ("--no-dashboard", "--scheduler-file", found)
        processes.append(dask("scheduler", "--host", "127.0.0.1", "--port", 0, *common, log=log))
        while not found.exists():
            time.sleep(0.05)
        processes += [dask("worker", "--nthreads", 1, "--no-nanny", *common, log=log) for _ in range(2)]
        yield json.loads(found.read_text())["address"], processes[1:]
        for process in processes:
            process.kill()
            process.wait()


@pytest.mark.long
def test_all_results_are_there_and_right_when_a_worker_is_killed_in_the_middle(orbiframe, tmp_path, cluster):
    address, workers = cluster
    study = written(tmp_path, SIZES)
    assert orbiframe("run", study, "--workers", 1, "--into", tmp_path / "alone").status == 0
    journal = tmp_path / "quick" / "journal.jsonl"

    def kill_one():
        while not journal.exists() or journal.read_bytes().count(b"\n") < 3:
            time.sleep(0.02)
        os.kill(workers[0].pid, signal.SIGKILL)

    killer = threading.Thread(target=kill_one)
    killer.start()
    ran = orbiframe("run", study, "--scheduler", address, "--json")
    killer.join()
    assert workers[0].wait() == -signal.SIGKILL
    assert ran.status == 0, ran.err
    said = json.loads(ran.out)
    assert (said["done"], said["failed"], said["lost"]) == (12, 0, 0)
    assert (tmp_path / "quick" / "table.jsonl").read_bytes() == (tmp_path / "alone" / "table.jsonl").read_bytes()
    processes = {timing["process"] for timing in lines(tmp_path / "quick" / "timings.jsonl")}
    assert len(processes) == 2
    assert os.getpid() not in processes


@pytest.mark.long
def test_a_cluster_can_be_started_here(orbiframe, tmp_path):
    study = written(tmp_path, "[until]\nstart = 10\nmost = 40\nbelow = 0.001\n")
    ran = orbiframe("run", study, "--scheduler", "local", "--workers", 2, "--json")
    assert ran.status == 0, ran.err
    assert json.loads(ran.out)["done"] == 3


def test_a_scheduler_that_does_not_answer_is_said(orbiframe, tmp_path, monkeypatch):
    from orbiframe_studies import dask_hands

    monkeypatch.setattr(dask_hands, "_PATIENCE", "1s")
    ran = orbiframe("run", written(tmp_path, SIZES), "--scheduler", "tcp://127.0.0.1:9", "--workers", 1)
    assert (ran.status, "no dask scheduler answers at 'tcp://127.0.0.1:9'" in ran.err) == (1, True), ran.err


def test_what_travels_is_small():
    import pickle
    from pathlib import Path

    from orbiframe_studies.one_fit import Terms
    from orbiframe_studies.plan import Fit

    from orbiframe import Registry

    sent = (
        Registry.discover(),
        Terms(Path("/a"), None, (), True, None),
        Fit("k" * 64, Path("/b"), "b", {}, "", {}, None),
    )
    assert len(pickle.dumps(sent)) < 3000
