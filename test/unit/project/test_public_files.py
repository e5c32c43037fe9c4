"""The files for a public repository run what the repository has."""
from __future__ import annotations

import re
import subprocess
from pathlib import Path

import pytest
import yaml

REPOSITORY = Path(__file__).resolve().parents[3]
STYLES = (REPOSITORY / "tools" / "lib" / "style.sh").read_text()


def steps(job):
    workflow = yaml.safe_load((REPOSITORY / ".github" / "workflows" / "ci.yml").read_text())
    return "\n".join(step.get("run", "") for step in workflow["jobs"][job]["steps"])


@pytest.mark.parametrize("job, program", [("tests", ".ci/run"), ("packages", "tools/release")])
def test_a_job_calls_the_program_that_people_call(job, program):
    assert re.search(rf"^{re.escape(program)}\b", steps(job), re.MULTILINE)
    assert (REPOSITORY / program).stat().st_mode & 0o111


def test_a_hook_runs_a_check_of_the_workspace():
    hooks = yaml.safe_load((REPOSITORY / ".pre-commit-config.yaml").read_text())["repos"]
    assert [one["repo"] for one in hooks] == ["local"]
    checks = set()
    for hook in hooks[0]["hooks"]:
        program, *names = hook["entry"].split()
        assert program == "tools/style" and hook["language"] == "script"
        checks |= set(names)
    assert checks == set(re.findall(r"^    ([a-z-]+)\)", STYLES, re.MULTILINE))


def test_a_check_without_a_workspace_says_how_to_get_one(tmp_path):
    done = subprocess.run(
        [REPOSITORY / "tools" / "style", "ruff"], capture_output=True, text=True,
        env={"PATH": "/usr/bin:/bin", "HOME": str(tmp_path), "MY_SIMULATIONS_WS": str(tmp_path)})
    assert done.returncode == 1
    assert f"{tmp_path} has no test tools" in done.stderr and "tools/test" in done.stderr


@pytest.mark.parametrize("address", ["", "git@host:me/it.git", "https://me:secret@host/it",
                                     "http://host/it"])
def test_a_release_needs_a_public_address(tmp_path, address):
    done = subprocess.run([REPOSITORY / "tools" / "release", tmp_path / "made", address or "/it"],
                          capture_output=True, text=True)
    assert done.returncode == 1
    assert "the public address of the repository is not known" in done.stderr


@pytest.mark.parametrize("name", ["bug_report", "feature_request"])
def test_a_form_asks_for_something(name):
    form = yaml.safe_load((REPOSITORY / ".github" / "ISSUE_TEMPLATE" / f"{name}.yml").read_text())
    assert form["name"] and form["description"]
    assert any(field.get("validations", {}).get("required") for field in form["body"])
    assert all(field["attributes"]["label"] for field in form["body"])


def test_links_of_the_security_policy_lead_to_pages():
    text = (REPOSITORY / "SECURITY.md").read_text()
    links = re.findall(r"\]\(([^)#]+)", text)
    assert {"doc/security.md", "CONTRIBUTING.md"} == set(links)
    assert "@" not in text  # mail to the project is not read
