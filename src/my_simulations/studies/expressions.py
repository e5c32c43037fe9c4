"""The language of measurements: expressions over poses, speeds, joints and contacts.

    expression = or;  or = and {"or" and};  and = not {"and" not};  not = "not" not | comparison
    comparison = sum [("<" | "<=" | ">" | ">=" | "==" | "!=") sum]
    sum = product {("+" | "-") product};  product = unary {("*" | "/") unary}
    unary = "-" unary | power;  power = value ["^" unary]
    value = number | "(" expression ")" | FUNCTION "(" expression {"," expression} ")"
          | ("contact" | "force") "(" name "," name ")"
          | signal {"." word}              e.g. pose.box.z, joint.robo::arm.rate, vary.height, time
    name = word {"::" word} | "'" any text "'"

A signal has one value for each sample of a run; a function such as `final` or `max` makes a number
of it. Nothing else is understood, and nothing is handed to Python's own parser or `eval`.
"""
from __future__ import annotations

import re
from dataclasses import dataclass
from typing import Callable, Dict, FrozenSet, Iterator, List, Optional, Tuple, Union

import numpy as np

from ..errors import SimulationError

Value = Union[float, bool, np.ndarray]

POSE_PARTS = ("x", "y", "z", "roll", "pitch", "yaw")
TWIST_PARTS = ("vx", "vy", "vz", "wx", "wy", "wz")
JOINT_PARTS = ("position", "rate")
_DEEPEST = 50
_LONGEST = 2000
_NOISE = 1e-9

_TOKEN = re.compile(r"\s*(?:(?P<number>(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?)"
                    r"|(?P<word>[A-Za-z_]\w*(?:::\w+)*)|'(?P<quoted>[^']+)'"
                    r"|(?P<sign><=|>=|==|!=|[-+*/^(),.<>]))")


class ExpressionError(SimulationError):
    """A measurement that is not understood; the text says where and what."""


@dataclass(frozen=True)
class Signal:
    """What is read from the world at each sample.

    Attributes:
        kind: pose, twist, speed, joint, contact, force, time or vary.
        names: the model, link, axis or parameter; both of a contact.
        part: component, such as "z"; "" where there is none.
    """

    kind: str
    names: Tuple[str, ...] = ()
    part: str = ""


Samples = Dict[Signal, np.ndarray]
"""The value of each signal at each sample; those of `time` in s."""


@dataclass(frozen=True)
class Expression:
    """A measurement that was understood.

    Attributes:
        text: as written.
        signals: what it reads.
        sampled: whether it needs values between the start and the end of a run.
        condition: whether its value is true or false.
        compared: text and value of each side of its comparisons that reads a signal.
    """

    text: str
    signals: FrozenSet[Signal]
    sampled: bool
    condition: bool
    _value: Callable[[Samples], Value]
    compared: Tuple[Tuple[str, Callable[[Samples], Value]], ...] = ()

    def value(self, samples: Samples) -> Union[float, bool]:
        """Its value in a run; NaN where none is defined, such as a division by zero."""
        with np.errstate(all="ignore"):
            found = self._value(samples)
        return bool(found) if self.condition else float(found)

    def measured(self, samples: Samples) -> List[str]:
        """What a run gave for each side of its comparisons, such as `final(speed.box) is 0.2`."""
        with np.errstate(all="ignore"):
            return [f"{text} is {_format_value(value(samples))}" for text, value in self.compared]


@dataclass(frozen=True)
class _Node:
    """A part of an expression.

    `series`: one value for each sample, else one in all. `inner`: the values between the first
    and the last sample matter.
    """

    value: Callable[[Samples], Value]
    series: bool = False
    condition: bool = False
    inner: bool = False
    signals: FrozenSet[Signal] = frozenset()


def _format_value(value: Value) -> str:
    """A number, or the range of a series; noise of the arithmetic counts as 0."""
    ends = [0.0 if abs(end) < _NOISE else float(end) for end in (np.min(value), np.max(value))]
    texts = list(dict.fromkeys(f"{end:.3g}" for end in ends))
    return " to ".join(texts)


def _first_time(values: np.ndarray, times: np.ndarray) -> float:
    found = np.flatnonzero(values)
    return float(times[found[0]]) if len(found) else float("nan")


def _time_true(values: np.ndarray, times: np.ndarray) -> float:
    """A sample counts for the time since the one before."""
    return float(np.sum(np.diff(times)[np.asarray(values[1:], bool)]))


# name: function of (values, times), whether it takes a condition, whether it gives one, whether it
# needs what is between start and end.
_REDUCERS: Dict[str, Tuple[Callable[[np.ndarray, np.ndarray], Value], bool, bool, bool]] = {
    "initial": (lambda values, times: values[0], False, False, False),
    "final": (lambda values, times: values[-1], False, False, False),
    "max": (lambda values, times: float(np.max(values)), False, False, True),
    "min": (lambda values, times: float(np.min(values)), False, False, True),
    "mean": (lambda values, times: float(np.mean(values)), False, False, True),
    "rms": (lambda values, times: float(np.sqrt(np.mean(values ** 2))), False, False, True),
    "any": (lambda values, times: bool(np.any(values)), True, True, True),
    "all": (lambda values, times: bool(np.all(values)), True, True, True),
    "first": (_first_time, True, False, True),
    "duration": (_time_true, True, False, True),
}
_FUNCTIONS: Dict[str, Tuple[Callable[..., Value], int]] = {
    "abs": (np.abs, 1), "sqrt": (np.sqrt, 1), "sin": (np.sin, 1), "cos": (np.cos, 1),
    "atan2": (np.arctan2, 2), "hypot": (np.hypot, 2)}
_COMPARISONS: Dict[str, Callable[[Value, Value], Value]] = {
    "<": lambda a, b: a < b, "<=": lambda a, b: a <= b, ">": lambda a, b: a > b,
    ">=": lambda a, b: a >= b, "==": lambda a, b: a == b, "!=": lambda a, b: a != b}
_ARITHMETIC: Dict[str, Callable[..., Value]] = {
    "+": np.add, "-": np.subtract, "*": np.multiply, "/": np.divide, "^": np.float_power}
_KNOWN = ("pose", "twist", "speed", "joint", "time", "vary", "contact", "force")


def parse(text: str) -> Expression:
    """Understand a measurement. Raises ExpressionError: it is not in the language."""
    if len(text) > _LONGEST:
        raise ExpressionError(f"an expression has at most {_LONGEST} characters")
    parser = _Parser(text)
    node = parser.parse_all()
    if node.series and node.condition:  # a condition of a run: whether it ever held
        node = _reduce_series("any", node)
    if node.series:
        raise ExpressionError(f"'{text}' has a value for each sample: say which, for example"
                              f" final({text}) or max({text})")
    return Expression(text, node.signals, node.inner, node.condition, node.value,
                      tuple(parser.compared.items()))


class _Parser:
    def __init__(self, text: str) -> None:
        self._text = text
        self._tokens = list(_tokens(text))
        self._at = 0
        self._depth = 0
        self.compared: Dict[str, Callable[[Samples], Value]] = {}

    def parse_all(self) -> _Node:
        node = self._or()
        if self._at < len(self._tokens):
            raise self._make_error("an operator or the end")
        return node

    # -- tokens ----------------------------------------------------------------------------------

    def _peek(self) -> Tuple[str, str]:
        return self._tokens[self._at][:2] if self._at < len(self._tokens) else ("end", "")

    def _accept(self, *signs: str) -> Optional[str]:
        kind, text = self._peek()
        if kind in ("sign", "word") and text in signs:
            self._at += 1
            return text
        return None

    def _need(self, sign: str) -> None:
        if not self._accept(sign):
            raise self._make_error(f"'{sign}'")

    def _make_error(self, expected: str) -> ExpressionError:
        if self._at < len(self._tokens):
            _, found, column = self._tokens[self._at]
            return ExpressionError(f"'{self._text}': expected {expected} at column {column},"
                                   f" found '{found}'")
        return ExpressionError(f"'{self._text}': expected {expected} at the end")

    # -- operators -------------------------------------------------------------------------------

    def _or(self) -> _Node:
        self._depth += 1
        if self._depth > _DEEPEST:
            raise ExpressionError(f"an expression is nested at most {_DEEPEST} deep")
        node = self._and()
        while self._accept("or"):
            node = self._conditions(np.logical_or, node, self._and(), "or")
        self._depth -= 1
        return node

    def _and(self) -> _Node:
        node = self._not()
        while self._accept("and"):
            node = self._conditions(np.logical_and, node, self._not(), "and")
        return node

    def _not(self) -> _Node:
        negations = 0
        while self._accept("not"):
            negations += 1
        node = self._comparison()
        if not negations:
            return node
        self._check(node, True, "'not'")
        inner = node.value
        return node if negations % 2 == 0 else _with(node, lambda s: np.logical_not(inner(s)))

    def _comparison(self) -> _Node:
        node = self._side()
        sign = self._accept(*_COMPARISONS)
        if not sign:
            return node[1]
        sides = [node, self._side()]
        self.compared.update((text, side.value) for text, side in sides if side.signals)
        return self._joined(_COMPARISONS[sign], [side for _, side in sides], sign, condition=True)

    def _side(self) -> Tuple[str, _Node]:
        """A side of a comparison, with its text."""
        first = self._at
        node = self._sum()
        begin = self._tokens[first][2] - 1
        end = (self._tokens[self._at][2] - 1 if self._at < len(self._tokens) else len(self._text))
        begin -= self._text[begin - 1:begin] == "'"     # the column is that of the quoted name
        return self._text[begin:end].strip(), node

    def _sum(self) -> _Node:
        node = self._product()
        while True:
            sign = self._accept("+", "-")
            if not sign:
                return node
            node = self._joined(_ARITHMETIC[sign], [node, self._product()], sign)

    def _product(self) -> _Node:
        node = self._unary()
        while True:
            sign = self._accept("*", "/")
            if not sign:
                return node
            node = self._joined(_ARITHMETIC[sign], [node, self._unary()], sign)

    def _unary(self) -> _Node:
        signs = 0
        while self._accept("-"):
            signs += 1
        node = self._value()
        if self._accept("^"):
            node = self._joined(_ARITHMETIC["^"], [node, self._exponent()], "^")
        return self._joined(np.negative, [node], "-") if signs % 2 else node

    def _exponent(self) -> _Node:
        negative = self._accept("-")
        node = self._value()
        return self._joined(np.negative, [node], "-") if negative else node

    # -- values ----------------------------------------------------------------------------------

    def _value(self) -> _Node:
        kind, text = self._peek()
        if self._accept("("):
            node = self._or()
            self._need(")")
            return node
        if kind == "number":
            self._at += 1
            number = float(text)
            return _Node(lambda samples: number)
        if kind != "word":
            raise self._make_error("a value")
        self._at += 1
        if text in ("contact", "force"):
            return self._pair(text)
        if text in _KNOWN:
            return self._signal(text)
        if self._accept("("):
            return self._call(text)
        self._at -= 1
        raise self._make_error("a number, a function or one of " + ", ".join(_KNOWN))

    def _call(self, name: str) -> _Node:
        if name not in _REDUCERS and name not in _FUNCTIONS:
            self._at -= 2
            raise self._make_error("a function: " + ", ".join([*_REDUCERS, *_FUNCTIONS]))
        given = [self._or()]
        while self._accept(","):
            given.append(self._or())
        self._need(")")
        count = _FUNCTIONS[name][1] if name in _FUNCTIONS else 1
        if name in ("min", "max") and len(given) == 2:
            return self._joined(np.minimum if name == "min" else np.maximum, given, name)
        if len(given) != count:
            raise ExpressionError(f"'{self._text}': {name} takes {count} values,"
                                  f" not {len(given)}")
        if name in _FUNCTIONS:
            return self._joined(_FUNCTIONS[name][0], given, name)
        if not given[0].series:
            raise ExpressionError(f"'{self._text}': {name} takes what has a value for each sample,"
                                  " such as pose.box.z")
        if name not in ("initial", "final"):
            self._check(given[0], _REDUCERS[name][1], name)
        return _reduce_series(name, given[0])

    def _pair(self, kind: str) -> _Node:
        self._need("(")
        first = self._name()
        self._need(",")
        second = self._name()
        self._need(")")
        return _of_signal(Signal(kind, (first, second)), kind == "contact")

    def _signal(self, kind: str) -> _Node:
        if kind == "time":
            return _of_signal(Signal("time"))
        self._need(".")
        name = self._name()
        if kind == "vary":
            signal = Signal("vary", (name,))
            return _Node(lambda samples: samples[signal][0], signals=frozenset([signal]))
        if kind == "speed":
            return _of_signal(Signal("speed", (name,)))
        parts = {"pose": POSE_PARTS, "twist": TWIST_PARTS, "joint": JOINT_PARTS}[kind]
        self._need(".")
        part = self._accept(*parts)
        if not part:
            raise self._make_error("one of " + ", ".join(parts))
        return _of_signal(Signal(kind, (name,), part))

    def _name(self) -> str:
        kind, text = self._peek()
        if kind not in ("word", "quoted"):
            raise self._make_error("a name")
        self._at += 1
        return text

    # -- joining ---------------------------------------------------------------------------------

    def _check(self, node: _Node, condition: bool, where: str) -> None:
        if node.condition != condition:
            wanted = "a condition" if condition else "a number"
            raise ExpressionError(f"'{self._text}': {where} takes {wanted}")

    def _joined(self, function: Callable[..., Value], nodes: List[_Node], where: str,
                condition: bool = False) -> _Node:
        for node in nodes:
            self._check(node, False, where)
        return _combine_nodes(function, nodes, condition)

    def _conditions(self, function: Callable[..., Value], first: _Node, second: _Node,
                    where: str) -> _Node:
        self._check(first, True, where)
        self._check(second, True, where)
        return _combine_nodes(function, [first, second], True)


def _combine_nodes(function: Callable[..., Value], nodes: List[_Node], condition: bool) -> _Node:
    values = [node.value for node in nodes]
    return _Node(lambda samples: function(*[value(samples) for value in values]),
                 any(node.series for node in nodes), condition, any(node.inner for node in nodes),
                 frozenset().union(*(node.signals for node in nodes)))


def _with(node: _Node, value: Callable[[Samples], Value]) -> _Node:
    return _Node(value, node.series, node.condition, node.inner, node.signals)


def _of_signal(signal: Signal, condition: bool = False) -> _Node:
    return _Node(lambda samples: samples[signal], True, condition, False, frozenset([signal]))


def _reduce_series(name: str, node: _Node) -> _Node:
    function, _, gives, inner = _REDUCERS[name]
    if name in ("initial", "final"):
        gives = node.condition
    time = Signal("time")

    def value(samples: Samples) -> Value:
        times = samples[time]
        return function(np.broadcast_to(np.asarray(node.value(samples)), times.shape), times)

    return _Node(value, False, gives, node.inner or inner, node.signals | {time})


def _tokens(text: str) -> Iterator[Tuple[str, str, int]]:
    """Kind, text and column (from 1) of each token."""
    at, end = 0, len(text.rstrip())
    while at < end:
        found = _TOKEN.match(text, at)
        if found is None or found.lastgroup is None:
            at += len(text[at:]) - len(text[at:].lstrip())
            raise ExpressionError(f"'{text}': unexpected '{text[at]}' at column {at + 1}")
        yield found.lastgroup, found.group(found.lastgroup), found.start(found.lastgroup) + 1
        at = found.end()
