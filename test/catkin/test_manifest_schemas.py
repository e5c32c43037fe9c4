"""Container files and the job files of doc/ci.md against schemas of the programs that read them.

The schemas are those of Docker Compose, Kubernetes, GitHub and GitLab, as two packages carry them.
"""
from __future__ import annotations

import importlib.util
import json
import re
from pathlib import Path

import pytest
import yaml
from jsonschema import Draft4Validator, Draft7Validator

from my_simulations.classroom.class_file import read_class
from my_simulations.classroom.manifests import compose, kubernetes

REPOSITORY = Path(__file__).resolve().parents[2]
KINDS = {"Namespace": "core.v1", "Secret": "core.v1", "PersistentVolumeClaim": "core.v1",
         "Service": "core.v1", "Deployment": "apps.v1", "NetworkPolicy": "networking.v1"}
CLASS = """class: Robotics 26
students: [anna, ben_2, "{long}"]
port: 12000
args: {{robot: true}}
limits: {{memory_mb: 1500.4, processors: 2}}
"""


def packaged(package, *inside):
    folder = Path(importlib.util.find_spec(package).origin).parent
    return json.loads(folder.joinpath(*inside).read_text(encoding="utf-8"))


def faults(validator, document):
    return [f"{'.'.join(map(str, one.absolute_path))}: {one.message[:300]}"
            for one in validator.iter_errors(document)]


def builtin(name):
    return Draft7Validator(packaged("check_jsonschema", "builtin_schemas", "vendor", name))


@pytest.fixture(scope="module")
def definitions():
    return packaged("kubernetes_validate", "kubernetes-json-schema", "v1.24.0-local-strict",
                    "_definitions.json")["definitions"]


@pytest.fixture
def plan(tmp_path):
    (tmp_path / "class.yaml").write_text(CLASS.format(long="x" + 31 * "y"))
    return read_class(str(tmp_path / "class.yaml"))[0]


@pytest.fixture
def tokens(plan):
    return {student.name: f"token-{student.number}" for student in plan.students}


def test_the_compose_file_fits_its_schema(plan, tokens):
    validator = builtin("compose-spec.json")
    found = yaml.safe_load(compose(plan, tokens))
    assert faults(validator, found) == []
    assert found["name"] == "robotics-26"    # Compose permits no spaces and no capitals
    found["services"]["anna"]["cpu"] = 2
    assert faults(validator, found)


def test_the_compose_file_of_the_repository_fits_the_schema():
    text = (REPOSITORY / "docker" / "compose.yaml").read_text(encoding="utf-8")
    assert faults(builtin("compose-spec.json"), yaml.safe_load(text)) == []


def test_kubernetes_manifests_fit_the_strict_schemas_of_their_kinds(plan, tokens, definitions):
    for one in yaml.safe_load_all(kubernetes(plan, tokens)):
        kind = f"io.k8s.api.{KINDS[one['kind']]}.{one['kind']}"
        validator = Draft4Validator({"$ref": f"#/definitions/{kind}", "definitions": definitions})
        assert faults(validator, one) == []
        if "spec" in one:
            one["spec"]["replica"] = 1
            assert faults(validator, one)


@pytest.mark.parametrize("at, schema", [(0, "github-workflows.json"), (1, "gitlab-ci.json")])
def test_the_job_files_of_the_documentation_fit_their_schemas(at, schema):
    page = (REPOSITORY / "doc" / "ci.md").read_text(encoding="utf-8")
    job = yaml.load(re.findall("```yaml\n(.*?)```", page, re.DOTALL)[at], yaml.BaseLoader)
    assert faults(builtin(schema), job) == []
