"""Where cases run: addresses, scripts, shards."""
from __future__ import annotations

import pytest

from my_simulations.errors import CommandError
from my_simulations.studies.cluster_address import scheduler_address
from my_simulations.studies.folder import StudyFolder, shard_of
from my_simulations.studies.plan import WHOLE, Shard
from my_simulations.studies.slurm import job_script


@pytest.mark.parametrize("where, address", [
    ("", ""), ("dask://host:1234", "tls://host:1234"), ("dask://host", "tls://host:8786"),
    ("tls://10.0.0.1:1", "tls://10.0.0.1:1"), ("dask://[::1]:99", "tls://[::1]:99"),
    ("dask://[::1]", "tls://[::1]:8786")])
def test_addresses_are_those_of_tls(where, address):
    assert scheduler_address(where) == address


@pytest.mark.parametrize("where, told", [
    ("tcp://host:8786", "can run programs as you"), ("ws://host", "neither encrypted"),
    ("dask://", "known are"), ("k8s", "known are"), ("dask:/no/such.json", "no scheduler file")])
def test_other_places_are_refused(where, told):
    with pytest.raises(CommandError, match=told):
        scheduler_address(where)


def test_a_script_quotes_paths_and_runs_one_shard_a_task():
    script = job_script("my study!", "/home/me/a b.yaml", "/home/me/o ut", 7, 4, ["time=1:0:0"])
    assert "#SBATCH --job-name=my_study_\n" in script
    assert "#SBATCH --array=1-7\n#SBATCH --cpus-per-task=4\n" in script
    assert "run '/home/me/a b.yaml' \\\n  --out '/home/me/o ut' --slots 4 \\\n" in script
    assert script.endswith('--shard "$SLURM_ARRAY_TASK_ID/7"\n')


@pytest.mark.parametrize("option", ["--time=1", "time=1\nrm -rf", "array=3", "Time=1", "output=x"])
def test_options_that_would_break_the_script_are_refused(option):
    with pytest.raises(CommandError):
        job_script("s", "/s.yaml", "/s", 1, 1, [option])


def test_a_folder_keeps_its_number_of_shards(tmp_path):
    folder = StudyFolder(str(tmp_path))
    folder.check_shards(3)
    (tmp_path / "journal-2-of-3.jsonl").write_text('{"journal": 1, "cases": 1}\n')
    folder.check_shards(3)
    with pytest.raises(CommandError, match="in 3 shards, not in 1"):
        folder.check_shards(1)
    assert shard_of("x/journal-2-of-3.jsonl") == Shard(2, 3) and shard_of("journal.jsonl") == WHOLE
    assert not folder.is_complete()
