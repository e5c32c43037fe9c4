"""Studies on a local Dask cluster: worker processes, certificates made here, workers that die."""
from __future__ import annotations

import contextlib
import csv
import os
import re
import signal
import subprocess
import sys
import time
from pathlib import Path

import numpy as np
import pytest

from my_simulations.studies.command import main
from my_simulations.studies.journal import rows
from my_simulations.studies.plan import CasePlan
from my_simulations.studies.study_file import read_study

SOURCE = Path(__file__).resolve().parents[2] / "src"
ENVIRONMENT = {**os.environ, "PYTHONPATH": os.pathsep.join(
    [str(SOURCE), os.environ.get("PYTHONPATH", "")]), "DASK_LOGGING__DISTRIBUTED": "error"}
START_S = 90.0
BOX = """<sdf version="1.7"><model name="box"><link name="link">
<inertial><mass>1</mass><inertia><ixx>0.0067</ixx><iyy>0.0067</iyy><izz>0.0067</izz></inertia>
</inertial><collision name="c"><geometry><box><size>0.2 0.2 0.2</size></box></geometry>
</collision></link></model></sdf>"""
DROP = """models:
  box: {file: box.sdf, pose: [0, 0, 1]}
duration: 0.4
vary:
  height: {set: pose.box.z, range: {from: 0.2, to: 0.6, count: 30}}
measure:
  rest: final(pose.box.z)
"""


@pytest.fixture(scope="module")
def certificates(tmp_path_factory):
    """An authority, and one certificate of it for all sides; as doc/scale.md tells."""
    folder = tmp_path_factory.mktemp("tls")
    made = [
        "req -x509 -newkey rsa:2048 -nodes -days 1 -subj /CN=authority -keyout ca.key -out ca.pem",
        "req -newkey rsa:2048 -nodes -subj /CN=study -keyout study.key -out study.csr",
        "x509 -req -in study.csr -CA ca.pem -CAkey ca.key -CAcreateserial -days 1 -out study.pem"]
    for words in made:
        subprocess.run(["openssl", *words.split()], cwd=folder, check=True, capture_output=True)
    return folder


def tls(certificates, side="--tls"):
    return [f"{side}-ca{'-file' if side == '--tls' else ''}", str(certificates / "ca.pem"),
            f"{side}-cert", str(certificates / "study.pem"),
            f"{side}-key", str(certificates / "study.key")]


def study_tls(certificates):
    return ["--tls-ca", str(certificates / "ca.pem"), "--tls-cert", str(certificates / "study.pem"),
            "--tls-key", str(certificates / "study.key")]


class Cluster:
    """A scheduler and workers, each a process."""

    def __init__(self, folder, certificates):
        self.folder, self.certificates = folder, certificates
        self.file = folder / "scheduler.json"
        self.processes = []
        self.start("scheduler", "--protocol", "tls", "--host", "127.0.0.1", "--port", "0",
                   "--no-dashboard", "--scheduler-file", str(self.file))
        deadline = time.monotonic() + START_S
        while True:   # the file is there before all of it is written
            told = re.search(r'"tls://([\d.:]+)"', self.file.read_text()) \
                if self.file.exists() else None
            if told is not None:
                break
            assert time.monotonic() < deadline and self.processes[0].poll() is None
            time.sleep(0.05)
        self.address = told[1]

    def start(self, kind, *words):
        log = open(self.folder / f"{kind}-{len(self.processes)}.txt", "w")
        process = subprocess.Popen(
            [sys.executable, "-m", f"distributed.cli.dask_{kind}", *words,
             *tls(self.certificates)], env=ENVIRONMENT, cwd=self.folder, stdout=log,
            stderr=subprocess.STDOUT)
        self.processes.append(process)
        return process

    def worker(self, threads=1):
        return self.start("worker", f"tls://{self.address}", "--no-nanny", "--nthreads",
                          str(threads), "--no-dashboard", "--host", "127.0.0.1",
                          "--local-directory", str(self.folder / "scratch"))

    def close(self):
        for process in reversed(self.processes):
            process.terminate()
            with contextlib.suppress(subprocess.TimeoutExpired):
                process.wait(20)
            process.kill()
            process.wait()


@pytest.fixture
def cluster(tmp_path, certificates):
    made = Cluster(tmp_path, certificates)
    yield made
    made.close()


@pytest.fixture
def folder(tmp_path, monkeypatch):
    (tmp_path / "box.sdf").write_text(BOX)
    monkeypatch.chdir(tmp_path)
    return tmp_path


def table(folder, name):
    with open(folder / name / "results.csv", newline="") as stream:
        return list(csv.DictReader(stream))


def test_a_cluster_makes_the_table_of_one_machine(folder, cluster, certificates):
    (folder / "s.yaml").write_text(DROP + "keep:\n  trajectory: {every: 0.1}\n")
    for _ in range(2):
        cluster.worker()
    on = ["--on", f"dask://{cluster.address}", *study_tls(certificates)]
    assert main(["study", "run", "s.yaml", "--out", "cluster", *on]) == 0
    assert main(["study", "run", "s.yaml", "--out", "here", "--slots", "2"]) == 0
    tables = [table(folder, name) for name in ("cluster", "here")]
    for name, found in zip(("cluster", "here"), tables):
        for row in found:  # in which file a trajectory is depends on when it came
            with np.load(folder / name / row.pop("trajectory")) as kept:
                row["poses"] = kept[row["case"] + ".pose"].tolist()
    assert tables[0] == tables[1]
    by_id = [{row.case: (row.hash, row.values, row.step) for row in
              rows(str(folder / name / "journal.jsonl"))} for name in ("cluster", "here")]
    assert by_id[0] == by_id[1] and len(by_id[0]) == 30
    # A second run has nothing to do; the scheduler file is another way to name the cluster.
    assert main(["study", "resume", "cluster", "--on", f"dask:{cluster.file}",
                 *study_tls(certificates)]) == 0
    assert len(list(rows(str(folder / "cluster" / "journal.jsonl")))) == 30


def wait_for_rows(journal, count, driver):
    deadline = time.monotonic() + START_S
    while not journal.exists() or journal.read_bytes().count(b"\n") <= count:
        assert time.monotonic() < deadline and driver.poll() is None
        time.sleep(0.005)


def started(folder, cluster, certificates, text, name):
    (folder / f"{name}.yaml").write_text(text)
    return subprocess.Popen(
        [sys.executable, "-m", "my_simulations.studies", "run", f"{name}.yaml", "--on",
         f"dask://{cluster.address}", *study_tls(certificates)], env=ENVIRONMENT, cwd=folder,
        stdout=subprocess.DEVNULL, stderr=open(folder / f"{name}.err", "w"))


def test_a_killed_worker_costs_no_case(folder, cluster, certificates):
    text = DROP.replace("count: 30", "count: 200")
    first = cluster.worker()
    cluster.worker()
    driver = started(folder, cluster, certificates, text, "s")
    wait_for_rows(folder / "s" / "journal.jsonl", 5, driver)
    first.send_signal(signal.SIGKILL)
    assert driver.wait(120) == 0, (folder / "s.err").read_text()
    found = table(folder, "s")
    assert [int(row["index"]) for row in found] == list(range(200))
    assert {row["status"] for row in found} == {"ok"}
    ids = {case.id for case in CasePlan(read_study(str(folder / "s.yaml"))[0]).cases()}
    assert {row["case"] for row in found} == ids
    journal = list(rows(str(folder / "s" / "journal.jsonl")))
    assert len(journal) == 200


def test_a_killed_driver_goes_on_to_the_same_table(folder, cluster, certificates):
    text = DROP.replace("count: 30", "count: 100")
    cluster.worker()
    driver = started(folder, cluster, certificates, text, "s")
    wait_for_rows(folder / "s" / "journal.jsonl", 5, driver)
    driver.kill()
    driver.wait()
    before = (folder / "s" / "journal.jsonl").read_bytes().count(b"\n")
    assert main(["study", "resume", "s", "--on", f"dask://{cluster.address}",
                 *study_tls(certificates)]) == 0
    assert 5 < before <= 101
    journal = list(rows(str(folder / "s" / "journal.jsonl")))
    assert sorted(row.index for row in journal) == list(range(100))


def test_a_lost_scheduler_ends_the_run_which_goes_on_elsewhere(folder, cluster, certificates):
    cluster.worker()
    driver = started(folder, cluster, certificates, DROP.replace("count: 30", "count: 200"), "s")
    wait_for_rows(folder / "s" / "journal.jsonl", 5, driver)
    cluster.processes[0].kill()
    assert driver.wait(120) == 2, (folder / "s.err").read_text()
    assert "`study resume` goes on" in (folder / "s.err").read_text()
    assert main(["study", "resume", "s", "--slots", "2"]) == 0
    journal = list(rows(str(folder / "s" / "journal.jsonl")))
    assert sorted(row.index for row in journal) == list(range(200))


ROSTEST = """import os, signal, sys, time
if sys.argv[-1].endswith("poison.test"):
    with open(f"/proc/{os.getppid()}/stat") as stat:
        os.kill(int(stat.read().split()[3]), signal.SIGKILL)
    time.sleep(60)
folder = sys.argv[sys.argv.index("--results-base-dir") + 1] + "/study"
os.makedirs(folder)
with open(folder + "/rosunit-t.xml", "w") as stream:
    stream.write("<testsuite><testcase classname='C' name='t'/></testsuite>")
"""


def test_a_case_that_ends_its_node_is_told_from_its_neighbours(folder, cluster, certificates):
    # A launch file whose test kills the worker stands for what takes a node down; it needs no ROS:
    # a program called rostest is what the workers find.
    (folder / "bin").mkdir()
    rostest = folder / "bin" / "rostest"
    rostest.write_text(f"#!{sys.executable}\n{ROSTEST}")
    rostest.chmod(0o755)
    with_ros = {**ENVIRONMENT, "PATH": f"{folder / 'bin'}:{os.environ['PATH']}",
                "ROS_PACKAGE_PATH": "/nowhere"}
    for name in ("a", "b", "poison", "z"):
        (folder / f"{name}.test").write_text("<launch/>")
    (folder / "s.yaml").write_text("scenarios: '*.test'\n")
    respawn = folder / "respawn"
    respawn.write_text(f"""#!/bin/bash
while [ ! -e {folder}/over ]; do
  {sys.executable} -m distributed.cli.dask_worker tls://{cluster.address} --no-nanny --nthreads 2 \\
    --no-dashboard --host 127.0.0.1 {' '.join(tls(certificates))} >> {folder}/workers.txt 2>&1
done
""")
    loop = subprocess.Popen(["bash", str(respawn)], env=with_ros, cwd=folder)
    try:
        assert main(["study", "run", "s.yaml", "--on", f"dask://{cluster.address}",
                     *study_tls(certificates)]) == 1
    finally:
        (folder / "over").touch()
        cluster.processes[0].terminate()  # its workers end with it
        loop.wait(90)
    found = {row["scenario"]: row["status"] for row in table(folder, "s")}
    assert found == {"a.test": "ok", "b.test": "ok", "poison.test": "node lost", "z.test": "ok"}


def test_connections_without_encryption_or_certificates_are_refused(folder, capsys, certificates):
    (folder / "s.yaml").write_text(DROP)
    run = ["study", "run", "s.yaml", "--on"]
    assert main([*run, "tcp://127.0.0.1:8786"]) == 2
    assert "neither encrypted nor asks for a certificate" in capsys.readouterr().err
    assert main([*run, "dask://127.0.0.1:8786"]) == 2
    assert "needs certificates" in capsys.readouterr().err
    broken = folder / "broken.pem"
    broken.write_text("no certificate")
    assert main([*run, "dask://127.0.0.1:8786", "--tls-ca", str(broken), "--tls-cert", str(broken),
                 "--tls-key", str(broken)]) == 2
    assert "certificates cannot be used" in capsys.readouterr().err
    assert main([*run, "somewhere"]) == 2
    assert "known are slurm, dask://HOST:PORT" in capsys.readouterr().err


def test_a_worker_with_other_files_is_told(folder, cluster, certificates, capsys, monkeypatch):
    (folder / "s.yaml").write_text(DROP)
    cluster.worker()
    monkeypatch.setattr("my_simulations.studies.plan.versions",
                        lambda: {"my_simulations": "0.0.0"})
    assert main(["study", "run", "s.yaml", "--on", f"dask://{cluster.address}",
                 *study_tls(certificates)]) == 2
    assert "has another id on a worker: my_simulations" in capsys.readouterr().err


def test_dask_jobqueue_hands_the_certificates_to_its_workers(folder, certificates):
    """The script of doc/scale.md for Slurm through Dask."""
    import dask_jobqueue
    from distributed.security import Security
    security = Security(require_encryption=True, tls_ca_file=str(certificates / "ca.pem"),
                        tls_scheduler_cert=str(certificates / "study.pem"),
                        tls_scheduler_key=str(certificates / "study.key"),
                        tls_worker_cert=str(certificates / "study.pem"),
                        tls_worker_key=str(certificates / "study.key"),
                        tls_client_cert=str(certificates / "study.pem"),
                        tls_client_key=str(certificates / "study.key"))
    cluster = dask_jobqueue.SLURMCluster(
        cores=8, processes=1, memory="16GB", walltime="01:00:00", protocol="tls://",
        interface="lo", security=security, shared_temp_directory=str(folder),
        scheduler_options={"dashboard": False})
    try:
        script = cluster.job_script()
        assert cluster.scheduler_address.startswith("tls://")
    finally:
        cluster.close()
    assert "#SBATCH --cpus-per-task=8" in script and "#SBATCH -t 01:00:00" in script
    assert "tls://" in script and "--tls-ca-file" in script and "--nthreads 8" in script
