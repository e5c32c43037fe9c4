"""Changes structured inputs at random.

XML is a tree of `Element`, all else a tree of dictionaries, lists and scalars. Trees are never
changed in place: a changed one shares what it can with the one before.
"""
from __future__ import annotations

import json
import re
from random import Random
from typing import Any, Callable, Dict, Iterable, List, Mapping, NamedTuple, Tuple

Attributes = Tuple[Tuple[str, str], ...]
MOST_KEPT = 60
"""Examples that are kept of what belongs to one name."""

STRANGE_NUMBERS = ("0", "1", "-1", "0.5", "1e308", "-1e308", "1e-320", "nan", "inf", "-inf",
                   "1e999", "0x10", "1,5", "", "٣", "1e", "--1", "99999999999999999999", "-0",
                   "2147483648", "-2147483649", "1e-400", "18446744073709551616", "4.9e-324",
                   "1.7976931348623157e308", "1e155", "0.1 m", "90deg", "+1", ".5", "5.", "1e+05",
                   "1_000", "0b1", "infinity", "NaN", "-nan", "1.#INF")
STRANGE_TEXTS = ("a", "b", "link", "world", "a::b", "", " ", "é", "🤖", "__model__", "a" * 300,
                 "../x", "true", "false", "1", "0", "yes", "revolute", "fixed", "ball", "box",
                 "model://nowhere", "file:///dev/zero", "package://p/x.dae", "%s%n", "]]>", "&amp;",
                 "\t\n", "\x01", "\x7f", "\u202e", "\ufffe", "a\nb", "a/b", "::", "a::", "::a",
                 "__default__", "model://a/../../b", "package:///x", "file://",
                 "http://127.0.0.1:1/x", "~", "$(env HOME)", "${x}", "{0}", "<a/>", "&lt;", "null",
                 "None", "[]", "x" * 5000, "0 " * 500, "a" * 300 + "/" + "b" * 300, ".", "..",
                 "\\", "'", '"', "\r", "e\u0301", "\U0010ffff")


class Element(NamedTuple):
    """An element of XML, without the text after its end tag."""

    tag: str
    attributes: Attributes
    text: str
    children: "Tuple[Element, ...]"


def strange_text(text: str, others: List[str], chance: Random) -> str:
    """The text with a word changed, or another one."""
    kind = chance.random()
    if kind < 0.25 and others:
        return chance.choice(others)
    words = text.split()
    if kind < 0.35 or not words:
        return chance.choice(STRANGE_TEXTS)
    at = chance.randrange(len(words))
    if kind < 0.7:
        words[at] = chance.choice(STRANGE_NUMBERS)
    elif kind < 0.78:
        del words[at]
    elif kind < 0.86:
        words.insert(at, words[at])
    elif kind < 0.93:
        words[at] = words[at][:chance.randrange(len(words[at]) + 1)] + chance.choice(STRANGE_TEXTS)
    else:
        words[at] = f"-{words[at]}"
    return " ".join(words)


class XmlKnowledge:
    """Children, texts and attributes of elements, from documents and the tables of readers."""

    def __init__(self) -> None:
        self.children: Dict[str, List[Element]] = {}
        self.texts: Dict[str, List[str]] = {}
        self.attributes: Dict[str, List[Tuple[str, str]]] = {}
        self.tags: List[str] = []

    def learn(self, element: Element) -> None:
        """Keep names and values of a document."""
        if element.tag not in self.texts:
            self.tags.append(element.tag)
        texts = self.texts.setdefault(element.tag, [])
        if element.text and len(texts) < MOST_KEPT:
            texts.append(element.text)
        given = self.attributes.setdefault(element.tag, [])
        if len(given) < MOST_KEPT:
            given += element.attributes
        inside = self.children.setdefault(element.tag, [])
        for child in element.children:
            if len(inside) < MOST_KEPT:
                inside.append(child)
            self.learn(child)

    def learn_names(self, children: Mapping[str, Iterable[str]], attributes: Iterable[str]) -> None:
        """Keep which elements may stand in which, and names of attributes of any."""
        for tag, names in children.items():
            self.learn(Element(tag, (), "", tuple(Element(name, (), "", ())
                                                  for name in sorted(set(names)))))
        for given in self.attributes.values():
            given += [(name, "") for name in attributes]

    def change(self, root: Element, chance: Random) -> Element:
        """A document with one to four changes, most often one or two."""
        for _ in range(chance.choice((1, 1, 1, 2, 2, 3, 4))):
            changed = self._somewhere(root, chance)
            root = changed[0] if changed else root
        return root

    def _somewhere(self, element: Element, chance: Random) -> Tuple[Element, ...]:
        children = element.children
        if children and chance.random() < 0.8:
            at = chance.randrange(len(children))
            changed = self._somewhere(children[at], chance)
            return (element._replace(children=children[:at] + changed + children[at + 1:]),)
        return chance.choice(_CHANGES)(self, element, chance)

    def _text(self, element: Element, chance: Random) -> Tuple[Element, ...]:
        return (element._replace(
            text=strange_text(element.text, self.texts.get(element.tag, []), chance)),)

    def _attribute(self, element: Element, chance: Random) -> Tuple[Element, ...]:
        given = element.attributes
        known = self.attributes.get(element.tag, [])
        if not given:
            return self._more_attributes(element, chance)
        at = chance.randrange(len(given))
        name, value = given[at]
        same = [other for one, other in known[:20] if one == name]
        put = (name, strange_text(value, same, chance))
        return (element._replace(attributes=(*given[:at], put, *given[at + 1:])),)

    def _more_attributes(self, element: Element, chance: Random) -> Tuple[Element, ...]:
        known = self.attributes.get(element.tag) or [("name", "a")]
        name, value = chance.choice(known)
        return (element._replace(attributes=(
            *(pair for pair in element.attributes if pair[0] != name),
            (name, value or strange_text(value, [], chance)))),)

    def _fewer_attributes(self, element: Element, chance: Random) -> Tuple[Element, ...]:
        given = element.attributes
        at = chance.randrange(len(given)) if given else 0
        return (element._replace(attributes=given[:at] + given[at + 1:]),)

    def _known_child(self, element: Element, chance: Random) -> Tuple[Element, ...]:
        known = self.children.get(element.tag)
        if not known:
            return self._text(element, chance)
        child = chance.choice(known)
        if not child.children and not child.text:
            child = self._sample(child.tag, chance)
        at = chance.randint(0, len(element.children))
        return (element._replace(
            children=(*element.children[:at], child, *element.children[at:])),)

    def _sample(self, tag: str, chance: Random, depth: int = 0) -> Element:
        """An element of that name as documents have it, or with a few of its children."""
        texts, given = self.texts.get(tag), self.attributes.get(tag)
        known = self.children.get(tag)
        inside: Tuple[Element, ...] = ()
        if known and depth < 3:
            inside = tuple(self._sample(chance.choice(known).tag, chance, depth + 1)
                           for _ in range(chance.randrange(3)))
        text = chance.choice(texts) if texts else chance.choice(STRANGE_NUMBERS)
        pairs = dict([chance.choice(given)]) if given and chance.random() < 0.5 else {}
        return Element(tag, tuple(pairs.items()), "" if inside else text, inside)

    def _strange_child(self, element: Element, chance: Random) -> Tuple[Element, ...]:
        child = self._sample(chance.choice(self.tags), chance)
        return (element._replace(children=(*element.children, child)),)

    def _other(self, element: Element, chance: Random) -> Tuple[Element, ...]:
        return (self._sample(element.tag, chance),)

    def _renamed(self, element: Element, chance: Random) -> Tuple[Element, ...]:
        return (element._replace(tag=chance.choice(self.tags)),)

    def _nothing(self, element: Element, chance: Random) -> Tuple[Element, ...]:
        return ()

    def _twice(self, element: Element, chance: Random) -> Tuple[Element, ...]:
        return (element,) * chance.choice((2, 2, 2, 2, 2, 3, 3, 20))

    def _wrapped(self, element: Element, chance: Random) -> Tuple[Element, ...]:
        for _ in range(chance.choice((1, 1, 2, 3, 10, 70, 210))):
            element = Element(element.tag, element.attributes, "", (element,))
        return (element,)

    def _shuffled(self, element: Element, chance: Random) -> Tuple[Element, ...]:
        children = list(element.children)
        chance.shuffle(children)
        return (element._replace(children=tuple(children)),)

    def _unwrapped(self, element: Element, chance: Random) -> Tuple[Element, ...]:
        return element.children or (element,)


_CHANGES: Tuple[Callable[..., Tuple[Element, ...]], ...] = (
    *[XmlKnowledge._text] * 4, *[XmlKnowledge._attribute] * 4, *[XmlKnowledge._known_child] * 5,
    *[XmlKnowledge._nothing] * 2, *[XmlKnowledge._twice] * 2, XmlKnowledge._more_attributes,
    XmlKnowledge._fewer_attributes, XmlKnowledge._strange_child, XmlKnowledge._other,
    XmlKnowledge._renamed, XmlKnowledge._wrapped, XmlKnowledge._shuffled, XmlKnowledge._unwrapped)

_ESCAPES = str.maketrans({"&": "&amp;", "<": "&lt;", '"': "&quot;"})


def xml_text(root: Element) -> str:
    out: List[str] = []
    _write(root, out.append)
    return "".join(out)


def _write(element: Element, put: Callable[[str], None]) -> None:
    tag, attributes, text, children = element
    if attributes:
        put(f"<{tag}" + "".join(f' {name}="{value.translate(_ESCAPES)}"'
                                for name, value in attributes))
    else:
        put(f"<{tag}")
    if not text and not children:
        put("/>")
        return
    put(f">{text.translate(_ESCAPES)}" if text else ">")
    for child in children:
        _write(child, put)
    put(f"</{tag}>\n")


def element_of(parsed: Any) -> Element:
    """Convert an element of lxml."""
    return Element(str(parsed.tag), tuple((str(n), str(v)) for n, v in parsed.attrib.items()),
                   (parsed.text or "").strip(),
                   tuple(element_of(child) for child in parsed if isinstance(child.tag, str)))


STRANGE_SCALARS: Tuple[Any, ...] = (
    None, True, False, 0, -1, 1, 2**31, -2**63, 2**70, 10**400, 0.0, -0.0, 0.5, 1e308, -1e308,
    5e-324, 1e155, float("nan"), float("inf"), float("-inf"), "", [], {}, [[]], [0.0] * 3,
    [0.0] * 7, [1.0] * 7, {"kind": "group"}, {"": None})


class TreeKnowledge:
    """As `XmlKnowledge`, of dictionaries and lists.

    Args:
        strange: scalars that are put in, besides texts.
    """

    def __init__(self, strange: Tuple[Any, ...] = STRANGE_SCALARS) -> None:
        self.values: Dict[str, List[Any]] = {}
        self.keys: List[str] = []
        self._strange = strange

    def learn(self, tree: Any) -> None:
        """Keep names and values of a document."""
        if isinstance(tree, dict):
            for key, value in tree.items():
                if key not in self.values:
                    self.keys.append(key)
                values = self.values.setdefault(key, [])
                if len(values) < MOST_KEPT:
                    values.append(value)
                self.learn(value)
        elif isinstance(tree, list):
            for value in tree:
                self.learn(value)

    def change(self, tree: Any, chance: Random) -> Any:
        """A tree with one to four changes, most often one or two."""
        for _ in range(chance.choice((1, 1, 1, 2, 2, 3, 4))):
            tree = self._somewhere(tree, "", chance)
        return tree

    def _somewhere(self, tree: Any, name: str, chance: Random) -> Any:
        if tree and isinstance(tree, (dict, list)) and chance.random() < 0.8:
            if isinstance(tree, dict):
                key = chance.choice(list(tree))
                return {**tree, key: self._somewhere(tree[key], str(key), chance)}
            at = chance.randrange(len(tree))
            return [*tree[:at], self._somewhere(tree[at], name, chance), *tree[at + 1:]]
        if isinstance(tree, dict) and chance.random() < 0.8:
            return self._fields(tree, chance)
        if isinstance(tree, list) and tree and chance.random() < 0.8:
            return _items(tree, chance)
        return self._value(tree, name, chance)

    def _fields(self, tree: Dict[Any, Any], chance: Random) -> Dict[Any, Any]:
        kind = chance.randrange(5)
        changed = dict(tree)
        if kind == 0 and changed:
            del changed[chance.choice(list(changed))]
        elif kind == 1 and changed:
            value = changed.pop(chance.choice(list(changed)))
            changed[chance.choice(self.keys or ["a"])] = value
        elif kind == 2 and len(changed) > 1:
            one, other = chance.choice(list(changed)), chance.choice(list(changed))
            changed[one], changed[other] = changed[other], changed[one]
        elif kind == 3:
            changed[chance.choice(STRANGE_TEXTS)] = self._value(None, "", chance)
        elif self.keys:
            key = chance.choice(self.keys)
            changed[key] = chance.choice(self.values[key])
        return changed

    def _value(self, value: Any, name: str, chance: Random) -> Any:
        kind = chance.randrange(10)
        known = self.values.get(name)
        if kind < 2 and known:
            return chance.choice(known)
        if kind < 5:
            return chance.choice(self._strange)
        if kind < 7:
            return strange_text(value, [], chance) if isinstance(value, str) else (
                chance.choice(STRANGE_TEXTS))
        if kind == 7 and isinstance(value, (int, float)):
            return _other_number(value, chance)
        if kind == 8:
            for _ in range(chance.choice((1, 1, 2, 30, 70))):
                value = [value] if chance.random() < 0.5 else {name or "a": value}
            return value
        return chance.choice(self.values[chance.choice(self.keys)]) if self.keys else value


def _other_number(value: Any, chance: Random) -> Any:
    factor = chance.choice((-1, 2, 10, 1e-3, 1e3, 1e200, -1e308, 0, 1e-320))
    try:
        return value * factor
    except OverflowError:
        return -value


def _items(tree: List[Any], chance: Random) -> List[Any]:
    at, kind = chance.randrange(len(tree)), chance.randrange(4)
    if kind == 0:
        return tree[:at] + tree[at + 1:]
    if kind == 1:
        return tree[:at] + [tree[at]] * chance.choice((2, 2, 3, 20)) + tree[at + 1:]
    if kind == 2:
        other = chance.randrange(len(tree))
        swapped = list(tree)
        swapped[at], swapped[other] = swapped[other], swapped[at]
        return swapped
    return tree[::-1]


class Raw(str):
    """Stands in YAML as it is."""


STRANGE_YAML: Tuple[Any, ...] = (*STRANGE_SCALARS, *map(Raw, (
    "*a", "&a x", "&a [*a]", "!!python/name:os.system", "2001-01-01", "0o17", "017", "1:30:00",
    "-190:20:30", "!!binary eA==", "!!binary x", "=", "<<", "0b11", "1_000", ".nan", "-.inf",
    "!!float x", "!!int ''", "!!int '0x'", "!!bool maybe", "!!set {a}", "!!omap [a: 1]", "!!null x",
    "!!timestamp x", "!!str 1", "!!seq a", "!!map [a]", "!a b", "? a", "- a", "{a: 1, a: 2}", "[",
    "}", "'", '"', "|\n  a", ">-\n a", "# x", "@", "%", "`", "--- ", "...", "yes", "~", "0x", "+",
    "0.", "1e5", "{[1]: 2}", "{{}: 1}", "!!pairs [a: 1]", "{<<: 1}", "{<<: [{a: 1}, 2]}",
    "{<<: {a: 1}}",
    "0x" + "f" * 5000, "0b" + "1" * 2000, "9" * 5000, "\u0085", "\ufeff", "\t")))
_PLAIN = re.compile(r"[A-Za-z_][\w/.:-]*\Z")


def yaml_text(tree: Any, chance: Random) -> str:
    """Return a YAML document, in flow or block style."""
    if chance.random() < 0.3:
        return _flow(tree)
    out: List[str] = []
    _block(tree, 0, out.append)
    return "".join(out)


def _block(tree: Any, depth: int, put: Callable[[str], None]) -> None:
    lead = "  " * depth
    if isinstance(tree, dict) and tree and depth < 60:
        for key, value in tree.items():
            if isinstance(value, dict) and value:
                put(f"{lead}{_scalar(key)}:\n")
                _block(value, depth + 1, put)
            else:
                put(f"{lead}{_scalar(key)}: {_flow(value)}\n")
    else:
        put(f"{lead}{_flow(tree)}\n")


def _flow(tree: Any) -> str:
    if isinstance(tree, dict):
        return "{" + ", ".join(f"{_scalar(k)}: {_flow(v)}" for k, v in tree.items()) + "}"
    if isinstance(tree, list):
        return "[" + ", ".join(map(_flow, tree)) + "]"
    return _scalar(tree)


def _scalar(value: Any) -> str:
    if isinstance(value, Raw):
        return str(value)
    if isinstance(value, str):
        return value if _PLAIN.match(value) else json.dumps(value, ensure_ascii=False)
    if isinstance(value, float):
        return {"nan": ".nan", "inf": ".inf", "-inf": "-.inf"}.get(repr(value), repr(value))
    if isinstance(value, int) and abs(value) > 2**200:
        return "1" + "0" * 400
    return json.dumps(value)
