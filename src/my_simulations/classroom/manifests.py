"""A class as containers: a file for Docker Compose, manifests for Kubernetes."""
from __future__ import annotations

from typing import Any, Dict, List, Mapping

import yaml

from ..errors import CommandError
from .class_plan import ClassPlan, Student, launch_text

_PORT = 11346           # of the editor in each container
_USER = 1000            # of the image (docker/Dockerfile)
WORLD = "/gazebo/get_world_properties"
"""Service that answers while the world runs."""

_COMMAND = ["sh", "-c", "printenv LAUNCH | exec roslaunch -"]
ENTRY = "/home/student/simulation_ws/src/my_simulations/docker/entrypoint"
"""Program of the image that runs a command of ROS."""


def compose(plan: ClassPlan, tokens: Mapping[str, str]) -> str:
    """A file for `docker compose`: a service, a network and a volume for each student.

    Args:
        plan: the class.
        tokens: of the editors, by name of the student.
    """
    services: Dict[str, Any] = {}
    for student in plan.students:
        services[student.name] = {
            "image": plan.image, "container_name": container_name(plan, student),
            "hostname": student.name, "init": True,
            "restart": "unless-stopped", "command": _COMMAND,
            "environment": {"MY_SIMULATIONS_EDITOR_TOKEN": tokens[student.name],
                            "LAUNCH": launch_text(plan, _PORT).replace("$", "$$")},
            "ports": [f"{plan.host}:{student.port}:{_PORT}"],
            "cpus": float(plan.limits.processors), "mem_limit": f"{plan.limits.memory_mb:.0f}m",
            "pids_limit": plan.limits.processes, "cap_drop": ["ALL"],
            "security_opt": ["no-new-privileges:true"],
            "networks": [student.name],
            "volumes": [f"{student.name}:/home/student/{plan.submission}"]}
    names = [student.name for student in plan.students]
    # No container reaches another one: each has a network of its own.
    return _text({"name": label(plan.name), "services": services,
                  "networks": {name: {} for name in names},
                  "volumes": {name: {} for name in names}})


def kubernetes(plan: ClassPlan, tokens: Mapping[str, str]) -> str:
    """Manifests for `kubectl apply -f`: a namespace, and four objects for each student.

    Raises CommandError if the names of two students are the same in Kubernetes.
    """
    names: Dict[str, str] = {}
    for student in plan.students:
        other = names.setdefault(label(student.name), student.name)
        if other != student.name:
            raise CommandError(f"students {other!r} and {student.name!r} have the same name in "
                               f"Kubernetes, {label(student.name)!r}: rename one of them")
    namespace = {"apiVersion": "v1", "kind": "Namespace", "metadata": {"name": label(plan.name)}}
    objects: List[Dict[str, Any]] = [namespace, _network_policy(plan)]
    for student in plan.students:
        objects += [_secret(plan, student, tokens[student.name]), _claim(plan, student),
                    _deployment(plan, student), _service(plan, student)]
    return "---\n".join(map(_text, objects))


def _meta(plan: ClassPlan, name: str) -> Dict[str, Any]:
    return {"name": label(name), "namespace": label(plan.name),
            "labels": {"app": "my-simulations", "class": label(plan.name)}}


def _secret(plan: ClassPlan, student: Student, token: str) -> Dict[str, Any]:
    return {"apiVersion": "v1", "kind": "Secret", "metadata": _meta(plan, student.name),
            "type": "Opaque", "stringData": {"token": token}}


def _claim(plan: ClassPlan, student: Student) -> Dict[str, Any]:
    return {"apiVersion": "v1", "kind": "PersistentVolumeClaim",
            "metadata": _meta(plan, student.name),
            "spec": {"accessModes": ["ReadWriteOnce"],
                     "resources": {"requests": {"storage": f"{plan.limits.file_mb:.0f}M"}}}}


def _deployment(plan: ClassPlan, student: Student) -> Dict[str, Any]:
    selector = {"app": "my-simulations", "student": label(student.name)}
    limits = {"cpu": str(plan.limits.processors), "memory": f"{plan.limits.memory_mb:.0f}M"}
    token = {"secretKeyRef": {"name": label(student.name), "key": "token"}}
    container = {
        "name": "world", "image": plan.image, "args": _COMMAND,
        "env": [{"name": "MY_SIMULATIONS_EDITOR_TOKEN", "valueFrom": token},
                {"name": "LAUNCH", "value": launch_text(plan, _PORT).replace("$(", "$$(")}],
        "ports": [{"containerPort": _PORT, "name": "editor"}],
        "resources": {"limits": limits, "requests": {"cpu": "250m", "memory": limits["memory"]}},
        "readinessProbe": {"exec": {"command": [ENTRY, "rosservice", "call", WORLD]},
                           "periodSeconds": 10, "timeoutSeconds": 10},
        "securityContext": {"allowPrivilegeEscalation": False, "capabilities": {"drop": ["ALL"]}},
        "volumeMounts": [{"name": "submission", "mountPath": f"/home/student/{plan.submission}"}]}
    pod = {"automountServiceAccountToken": False, "enableServiceLinks": False,
           "hostname": label(student.name),
           "securityContext": {"runAsNonRoot": True, "runAsUser": _USER, "fsGroup": _USER,
                               "seccompProfile": {"type": "RuntimeDefault"}},
           "containers": [container],
           "volumes": [{"name": "submission",
                        "persistentVolumeClaim": {"claimName": label(student.name)}}]}
    return {"apiVersion": "apps/v1", "kind": "Deployment", "metadata": _meta(plan, student.name),
            "spec": {"replicas": 1, "strategy": {"type": "Recreate"},
                     "selector": {"matchLabels": selector},
                     "template": {"metadata": {"labels": selector}, "spec": pod}}}


def _service(plan: ClassPlan, student: Student) -> Dict[str, Any]:
    return {"apiVersion": "v1", "kind": "Service", "metadata": _meta(plan, student.name),
            "spec": {"selector": {"app": "my-simulations", "student": label(student.name)},
                     "ports": [{"name": "editor", "port": student.port, "targetPort": "editor"}]}}


def _network_policy(plan: ClassPlan) -> Dict[str, Any]:
    """No pod of the class opens connections; each one accepts those to its editor."""
    return {"apiVersion": "networking.k8s.io/v1", "kind": "NetworkPolicy",
            "metadata": _meta(plan, "editors-only"),
            "spec": {"podSelector": {"matchLabels": {"app": "my-simulations"}},
                     "policyTypes": ["Ingress", "Egress"], "egress": [],
                     "ingress": [{"ports": [{"port": _PORT, "protocol": "TCP"}]}]}}


def container_name(plan: ClassPlan, student: Student) -> str:
    """Name of a student's container for docker and podman."""
    return f"{label(plan.name)}-{student.name}"


def label(name: str) -> str:
    """A name as Kubernetes accepts it (RFC 1123)."""
    kept = "".join(letter if letter.isalnum() and letter.isascii() else "-"
                   for letter in name.lower()).strip("-")
    return kept[:63].rstrip("-") or "class"


def _text(document: Dict[str, Any]) -> str:
    return yaml.safe_dump(document, sort_keys=False, default_flow_style=False)
