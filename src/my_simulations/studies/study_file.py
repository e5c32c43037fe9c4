"""Reads a study file: YAML, every fault with its line and key."""
from __future__ import annotations

import os
from typing import Any, Dict, List, Mapping, Optional, Sequence, Tuple

from ..errors import Issue, errors_of
from .expressions import Expression, ExpressionError, parse
from .scenario_files import SCENARIO, scenarios_named
from .study import Limits, Plan, Seeds, Study, Trajectory
from .value_reader import ValueReader, describe_value, read_document
from .variation import FORMS, SCENARIO_FORMS, Parameter, Target
from .variation_file import name_of_column, parameter_of

_KEYS = ("study", "world", "profile", "objects", "object_list", "models", "duration", "seeds",
         "plan", "vary", "measure", "require", "sample", "keep", "limits", "scenarios")
_SCENARIO_KEYS = ("study", "scenarios", "seeds", "plan", "vary", "limits")
_LIMITS = ("processor_seconds", "steps", "attempts", "memory_mb")
_SCENARIO_LIMITS = ("seconds", "attempts")
MOST_CASES = 10 ** 9


def read_study(file: str) -> Tuple[Study, List[Issue]]:
    """Read a study file; relative paths in it start at its folder.

    Returns:
        The study, and warnings.

    Raises:
        InputError: the file has faults; all of them are named.
    """
    return read_document(file, StudyReader, StudyReader.study)


class StudyReader(ValueReader):
    def study(self, tree: Any, file: str) -> Optional[Study]:
        """The study; None if it is not a mapping at all."""
        if not isinstance(tree, Mapping):
            self.fault((), f"a study must be a mapping, is {describe_value(tree)}")
            return None
        if "scenarios" in tree:
            return self._scenario_study(tree, file)
        top = self.mapping(tree, (), _KEYS)
        if "duration" not in top:
            self.fault((), "'duration' is missing: s of sim time of each case", code="study-key")
        measure = self._expressions(top, "measure")
        require = self._expressions(top, "require", conditions=True)
        if "measure" in top and "require" in top:
            for name in {name for name, _ in measure} & {name for name, _ in require}:
                self.fault(("require", name), f"'{name}' is measured, too; use another name")
        vary = self.mapping(top.get("vary"), ("vary",))
        plan = self._plan(top.get("plan"))
        parameters = self._parameters(vary, plan, FORMS)
        self._check_names(measure + require, vary)
        study = Study(
            self._name(top, file), file,
            self.world(top.get("world", "worlds/empty.world"), ("world",)),
            self.text(top["profile"], ("profile",)) if "profile" in top else "",
            self.names(top.get("objects"), ("objects",)),
            self.file(top["object_list"], ("object_list",)) if "object_list" in top else "",
            self.models(top.get("models")),
            self.number(top.get("duration", 1), ("duration",), above=0.0, most=1e6),
            self._seeds(top.get("seeds")), plan, parameters, measure, require,
            self.number(top.get("sample", 0.01), ("sample",), above=0.0),
            self._trajectory(top.get("keep")), self._limits(top.get("limits"), _LIMITS))
        self._check_count(study)
        return study

    def _scenario_study(self, tree: Mapping[str, Any], file: str) -> Study:
        for key in tree:
            if key in _KEYS and key not in _SCENARIO_KEYS:
                self.fault((key,), f"'{key}' is of studies of worlds: a scenario says itself what"
                                   " runs and what is tested", "keys beside 'scenarios' are "
                           + ", ".join(_SCENARIO_KEYS), "study-key")
        top = self.mapping({key: value for key, value in tree.items() if key not in _KEYS
                            or key in _SCENARIO_KEYS}, (), _SCENARIO_KEYS)
        names = self._scenarios(top["scenarios"], file)
        plan = self._plan(top.get("plan"))
        chosen = Parameter(SCENARIO, Target(SCENARIO), names)
        parameters = (chosen, *self._parameters(self.mapping(top.get("vary"), ("vary",)), plan,
                                                SCENARIO_FORMS))
        study = Study(
            self._name(top, file), file, "", "", (), "", (), 0.0, self._seeds(top.get("seeds")),
            plan, parameters, (), (), 1.0, None,
            self._limits(top.get("limits"), _SCENARIO_LIMITS), names)
        self._check_count(study)
        return study

    def _scenarios(self, value: Any, file: str) -> Tuple[str, ...]:
        found: Dict[str, None] = {}
        patterns = self.names(value, ("scenarios",))
        for pattern in patterns:
            names = scenarios_named(pattern, file) if pattern else ()
            if pattern and not names:
                self.fault(("scenarios",), f"no file is named '{pattern}'",
                           "paths start at the folder of the study, or with package://PACKAGE/",
                           "file-not-found")
            found.update(dict.fromkeys(names))
        if not patterns:
            self.fault(("scenarios",), "'scenarios' must name roslaunch files with tests, such as"
                                       " test/*.test")
        return tuple(found)

    def _name(self, top: Mapping[str, Any], file: str) -> str:
        stem = os.path.splitext(os.path.basename(file))[0]
        return self.text(top.get("study", stem), ("study",))

    def _parameters(self, vary: Mapping[str, Any], plan: Plan, forms: Sequence[str]
                    ) -> Tuple[Parameter, ...]:
        found = [parameter_of(self, name, value, ("vary", name), forms)
                 for name, value in vary.items()]
        parameters = tuple(parameter for parameter in found if parameter is not None)
        for parameter in parameters:
            if not plan.cases and not parameter.count:
                self.fault(("vary", parameter.name),
                           f"'{parameter.name}' has a distribution, of which a grid draws"
                           " 'samples' values", "add samples: 10, or plan: {random: CASES}")
        return parameters

    def _check_count(self, study: Study) -> None:
        if study.count > MOST_CASES and not errors_of(self.issues):
            self.fault(("vary",), f"a study has at most {MOST_CASES} cases, this one has"
                                  f" {study.count}")

    def _seeds(self, value: Any) -> Seeds:
        if value is None:
            return Seeds()
        if isinstance(value, list):
            listed = tuple(self.integer(item, ("seeds",)) for item in value)
            if not listed or len(set(listed)) < len(listed):
                self.fault(("seeds",), "'seeds' must be a list of different numbers")
            return Seeds(listed=listed)
        if isinstance(value, Mapping):
            inside = self.mapping(value, ("seeds",), ("first", "count"))
            return Seeds(self.integer(inside.get("first", 0), ("seeds", "first")),
                         self.integer(inside.get("count"), ("seeds", "count"), 1))
        return Seeds(0, self.integer(value, ("seeds",), 1))

    def _plan(self, value: Any) -> Plan:
        if value is None or value == "grid":
            return Plan()
        inside = self.mapping(value, ("plan",), ("random", "seed"))
        seed = self.integer(inside.get("seed", 0), ("plan", "seed"))
        if "random" in inside:
            return Plan(self.integer(inside["random"], ("plan", "random"), 1, MOST_CASES), seed)
        return Plan(0, seed)

    def _expressions(self, top: Mapping[str, Any], key: str, conditions: bool = False
                     ) -> Tuple[Tuple[str, Expression], ...]:
        found = []
        varied = top.get("vary")
        for name, text in self.mapping(top.get(key), (key,)).items():
            path = (key, name)
            name_of_column(self, name, path)
            if isinstance(varied, Mapping) and name in varied:
                self.fault(path, f"'{name}' is varied, too; use another name", code="study-key")
            try:
                expression = parse(self.text(text, path) or "0 == 0")
            except ExpressionError as fault:
                self.fault(path, str(fault), "doc/studies.md lists what can be measured",
                           "study-expression")
                continue
            if conditions and not expression.condition:
                self.fault(path, f"'{text}' is a number, 'require' takes conditions",
                           "compare it with another number", "study-expression")
            found.append((name, expression))
        return tuple(found)

    def _check_names(self, expressions: Sequence[Tuple[str, Expression]],
                     vary: Mapping[str, Any]) -> None:
        for name, expression in expressions:
            for signal in expression.signals:
                if signal.kind == "vary" and signal.names[0] not in vary:
                    self.fault(("measure", name), f"'{name}': '{signal.names[0]}' is not varied",
                               code="study-expression")

    def _trajectory(self, value: Any) -> Optional[Trajectory]:
        keep = self.mapping(value, ("keep",), ("trajectory",))
        if "trajectory" not in keep:
            return None
        path = ("keep", "trajectory")
        inside = self.mapping(keep["trajectory"], path, ("every", "models"))
        return Trajectory(self.number(inside.get("every", 0.02), (*path, "every"), above=0.0),
                          self.names(inside.get("models"), (*path, "models")))

    def _limits(self, value: Any, known: Sequence[str]) -> Limits:
        inside = self.mapping(value, ("limits",), known)
        default = Limits()
        return Limits(
            self.number(inside.get("processor_seconds", default.processor_seconds),
                        ("limits", "processor_seconds"), above=0.0),
            self.integer(inside.get("steps", default.steps), ("limits", "steps"), 1),
            self.integer(inside.get("attempts", default.attempts), ("limits", "attempts"), 1, 10),
            self.number(inside.get("memory_mb", default.memory_mb), ("limits", "memory_mb"),
                        above=0.0),
            self.number(inside.get("seconds", default.seconds), ("limits", "seconds"), above=0.0))
