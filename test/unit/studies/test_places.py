"""Where cases run: addresses, scripts, shards."""
from __future__ import annotations

from dataclasses import replace

import pytest

from my_simulations.errors import CommandError
from my_simulations.studies.cluster_address import scheduler_address
from my_simulations.studies.folder import StudyFolder, shard_of
from my_simulations.studies.journal import Journal
from my_simulations.studies.plan import ALL_CASES, CasePlan, Shard
from my_simulations.studies.row import FAILED, OK, REFUSED, Row
from my_simulations.studies.slurm import job_script
from my_simulations.studies.study_file import read_study


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


def test_a_percent_sign_of_the_folder_is_no_pattern_of_the_log():
    script = job_script("s", "/s.yaml", "/home/me/50%A", 1, 1)
    assert '#SBATCH --output="/home/me/50%%A/slurm/%A_%a.txt"\n' in script
    assert "--out /home/me/50%A " in script


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
    assert shard_of("x/journal-2-of-3.jsonl") == Shard(2,
                                                       3) and shard_of("journal.jsonl") == ALL_CASES


def row(case):
    return Row(OK, case.id, case.index, case.seed)


def test_a_folder_is_complete_once_each_case_of_the_plan_has_a_row(tmp_path):
    (tmp_path / "s.yaml").write_text("duration: 1\nseeds: 4\n")
    plan = CasePlan(read_study(str(tmp_path / "s.yaml"))[0])
    folder = StudyFolder(str(tmp_path))
    header = {"study": "s", "file": plan.study.file}
    former = Row(OK, 16 * "0", 0, 0)
    for shard, found in ((Shard(1, 2), [former, row(plan.case(0)), row(plan.case(2))]),
                         (Shard(2, 2), [former, row(plan.case(1))])):
        journal = Journal(folder.journal_of(shard), header)
        journal.append(found)
        journal.close()
        assert not folder.is_complete(plan)
    assert folder.status_counts(plan)[OK] == 3
    assert folder.status_counts(plan, Shard(2, 2))[OK] == 1
    journal = Journal(folder.journal_of(Shard(2, 2)), header)
    journal.append([row(plan.case(3))])
    journal.close()
    assert folder.is_complete(plan) and folder.status_counts(plan)[OK] == 4


def test_the_causes_of_a_shard_are_counted(tmp_path):
    (tmp_path / "s.yaml").write_text("duration: 1\nseeds: 8\n")
    plan = CasePlan(read_study(str(tmp_path / "s.yaml"))[0])
    folder = StudyFolder(str(tmp_path))
    one, two, three, four = (plan.case(index) for index in (0, 2, 4, 6))
    journal = Journal(folder.journal_of(Shard(1, 2)), {"study": "s", "file": plan.study.file})
    journal.append([replace(row(one), status=FAILED, issue="low"),
                    replace(row(two), status=REFUSED, issue="no box"),
                    replace(row(three), status=REFUSED, issue="no box"),
                    replace(row(four), status=REFUSED, issue="no box"), row(four),
                    Row(REFUSED, 16 * "0", 0, 0, issue="of a former id")])
    journal.close()
    assert folder.causes(plan) == folder.causes(plan, Shard(1, 2)) == [
        (REFUSED, "no box", 2, two.id), (FAILED, "low", 1, one.id)]
    assert folder.causes(plan, Shard(2, 2)) == []


@pytest.mark.parametrize("left", ["", '{"journal": 1, "stu'])
def test_a_journal_without_its_first_line_is_none_yet(tmp_path, left):
    folder = StudyFolder(str(tmp_path))
    (tmp_path / "journal-1-of-2.jsonl").write_text(left)  # killed before it was written
    with pytest.raises(CommandError, match="no study .*start one"):
        folder.header()
    Journal(folder.journal_of(Shard(2, 2)), {"study": "s", "file": "x"}).close()
    assert folder.header()["file"] == "x"
    assert folder.missing_shards() == [Shard(1, 2)]
