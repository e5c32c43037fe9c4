"""Inputs that are nearly right: documents made by the grammars of the readers, then damaged."""
from __future__ import annotations

from typing import Any, Dict, Iterable, List, Mapping

from hypothesis import strategies as st

NUMBERS = ("0", "1", "-1", "0.5", "1e308", "-1e308", "1e-320", "nan", "inf", "-inf", "1e999",
           "0x10", "1,5", "", "٣", "1e", "--1", "99999999999999999999")
NAMES = ("a", "b", "link", "world", "a::b", "", " ", "é", "🤖", "__model__", "a" * 300, "../x")
WORDS = ("true", "false", "1", "0", "yes", "revolute", "fixed", "ball", "box", "model://nowhere",
         "file:///dev/zero", "package://p/x.dae", "%s%n", "]]>", "&amp;")

words = st.one_of(st.sampled_from(NUMBERS), st.sampled_from(NAMES), st.sampled_from(WORDS),
                  st.lists(st.sampled_from(NUMBERS), max_size=9).map(" ".join), st.text(max_size=8))


def xml_text(text: str) -> str:
    """As content or attribute of an element."""
    for plain, escaped in (("&", "&amp;"), ("<", "&lt;"), ('"', "&quot;")):
        text = text.replace(plain, escaped)
    return text.encode("utf-8", "replace").decode("utf-8")


@st.composite
def xml(draw: Any, root: str, children: Mapping[str, Iterable[str]],
        attributes: Iterable[str]) -> str:
    """A document of known elements, most of them where they belong.

    `children`: by element, those that may stand in it.
    """
    everything = sorted({*children, *(one for inside in children.values() for one in inside)})
    names = sorted(attributes)
    budget = [draw(st.integers(1, 40))]

    def element(tag: str, depth: int) -> str:
        budget[0] -= 1
        given = "".join(
            f' {name}="{xml_text(draw(words))}"'
            for name in sorted(draw(st.sets(st.sampled_from(names), max_size=3))))
        inside: List[str] = []
        known = sorted(children.get(tag, ()))
        while budget[0] > 0 and depth < 12 and known and draw(st.integers(0, 3)):
            strange = draw(st.integers(0, 9)) == 0
            inside.append(element(draw(st.sampled_from(everything if strange else known)),
                                  depth + 1))
        if not inside:
            inside = [xml_text(draw(words))]
        return f"<{tag}{given}>{''.join(inside)}</{tag}>"

    return draw(damaged(element(root, 0)))


@st.composite
def damaged(draw: Any, text: str) -> str:
    """The text, or the text with a few slices missing, doubled or replaced."""
    for _ in range(draw(st.sampled_from((0, 0, 0, 1, 2)))):
        start = draw(st.integers(0, len(text)))
        end = min(len(text), start + draw(st.integers(0, 30)))
        put = draw(st.sampled_from(("", text[start:end] * 2, "\0", "<", ">", "\ufffe", "]]>",
                                    "<!--", "<!DOCTYPE a [", "'", "&#0;", "\ud800",
                                    "<?xml version='1.1'?>")))
        text = text[:start] + put + text[end:]
    return text


def tree_of(tables: Iterable[Any], readers: Mapping[str, str]) -> Dict[str, List[str]]:
    """From the readers' own tables: by element, the children that it may have.

    `readers`: the element that a table is about, by the name of its dataclass.
    """
    found: Dict[str, List[str]] = {}

    def add(tag: str, children: Mapping[str, Any]) -> None:
        found.setdefault(tag, []).extend(name.strip("/") for name in children)
        for name, entry in children.items():
            inside = getattr(entry, "children", None)
            if inside:
                add(name, inside)

    for table in tables:
        add(readers.get(table.of.__name__, table.of.__name__.lower()), table.children)
    return found


json_values = st.recursive(
    st.one_of(st.none(), st.booleans(), st.integers(-2**70, 2**70),
              st.floats(allow_nan=False, allow_infinity=False), words),
    lambda inside: st.one_of(st.lists(inside, max_size=4),
                             st.dictionaries(words, inside, max_size=4)), max_leaves=6)


@st.composite
def changed(draw: Any, tree: Any) -> Any:
    """A JSON tree in which a few values are others, missing or doubled."""
    for _ in range(draw(st.integers(0, 4))):
        tree = _with_change(draw, tree)
    return tree


def _with_change(draw: Any, tree: Any) -> Any:
    what = draw(st.integers(0, 5))
    if isinstance(tree, dict) and tree and what > 1:
        key = draw(st.sampled_from(sorted(tree)))
        if what == 2:
            return {name: value for name, value in tree.items() if name != key}
        return {**tree, key: _with_change(draw, tree[key])}
    if isinstance(tree, list) and tree and what > 1:
        at = draw(st.integers(0, len(tree) - 1))
        if what == 2:
            return [*tree, tree[at]]
        return [*tree[:at], _with_change(draw, tree[at]), *tree[at + 1:]]
    return draw(json_values)
