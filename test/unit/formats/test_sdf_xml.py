"""Leniency with mistakes of markup, strictness with attacks."""
import os

import pytest
from reading import DATA, codes, errors, refusal, sdf, warnings

from my_simulations.errors import InputError, Severity
from my_simulations.formats.reading import parse_world, read_entity, read_world
from my_simulations.formats.xml.parsing import parse
from my_simulations.formats.xml.repair import balance_tags
from my_simulations.formats.xml.source import IssueCollector
from my_simulations.resources.resolver import Resolver

MODEL = '<model name="m"><link name="l"/></model>'


def read(text):
    return read_entity(text, Resolver())


def test_a_forgotten_end_tag_nests_nothing_that_follows():
    log = IssueCollector()
    root = parse("<r>\n<a>\n<b x='1'>\n</a>\n<a/></r>", "f", log)
    assert [child.tag for child in root] == ["a", "a"]
    (issue,) = log.issues
    assert (issue.line, issue.column, issue.severity) == (3, 1, Severity.WARNING)
    assert "<b>" in issue.message


def test_the_tutorials_template_with_its_open_mesh_is_read_with_a_warning_on_its_line(tmp_path):
    meshes = tmp_path / "objects" / "Media" / "models"
    meshes.mkdir(parents=True)
    (meshes / "my_object.dae").write_text("<COLLADA/>")
    with open(os.path.join(DATA, "tutorial", "my_object_as_printed.urdf")) as stream:
        text = stream.read()
    resolver = Resolver(find_package=lambda name: str(tmp_path / "objects"))
    model, issues = read_entity(text, resolver)
    line = next(n for n, t in enumerate(text.splitlines(), 1)
                if "<mesh" in t and "/>" not in t)
    assert [(i.code, i.line, i.severity) for i in issues] == [
        ("xml-malformed", line, Severity.WARNING)]
    link = model.links[0]
    assert link.inertial.mass == 5.0
    path = str(meshes / "my_object.dae")
    assert link.visuals[0].geometry.path == path
    assert link.collisions[0].geometry.path == path
    assert link.collisions[0].pose.position == (0.0, 0.0, 0.072)


@pytest.mark.parametrize("cut", range(1, len(sdf(MODEL)), 3))
def test_a_document_cut_anywhere_is_refused(cut):
    assert refusal(read, sdf(MODEL)[:cut]).first.severity is Severity.ERROR


def test_a_line_beyond_what_the_parser_counts_is_unknown_not_wrong():
    _, issues = read(sdf("\n" * 70000 + MODEL.replace("/>", "><mistake/></link>")))
    assert [(i.code, i.line) for i in issues] == [("unknown-element", 0)]
    assert issues[0].xpath == "/sdf/model/link/mistake"


def test_a_stray_end_tag_is_dropped_with_a_warning():
    model, issues = read(sdf("</wrong>\n" + MODEL))
    assert model.links[0].name == "l"
    assert warnings(issues) == ["xml-end-tag"]


def test_attributes_without_quotes_or_blanks_are_read():
    model, issues = read('<sdf version=1.6><model name="m"canonical_link="l"><link name=l/></model>'
                         "</sdf>")
    assert model.canonical_link == "l" and model.links[0].name == "l"
    assert set(codes(issues)) == {"xml-malformed"}


def test_hyphens_in_comments_and_text_behind_the_root_only_warn():
    model, issues = read(sdf("<!-- a -- b -->" + MODEL) + "\n<more/>")
    assert model.name == "m"
    assert errors(issues) == [] and set(warnings(issues)) == {"xml-malformed"}


def test_words_before_the_first_element_and_an_unknown_encoding_only_warn():
    text = "oops\n<?xml version='1.0' encoding='UT'?>\n" + sdf(MODEL.replace("/>", "><a/></link>"))
    model, issues = read(text)
    assert model.name == "m" and errors(issues) == []
    assert [(i.code, i.line) for i in issues] == [("xml-malformed", 1), ("unknown-element", 3)]


def test_an_undeclared_prefix_is_no_fault():
    model, issues = read(sdf('<model name="m"><ignition:thing>1</ignition:thing><link name="l"/>'
                             "</model>"))
    assert issues == []
    assert "ignition:thing" in model.extra[0]


def test_blanks_and_comments_before_the_declaration_keep_the_lines():
    text = ("\n<!-- made by hand -->\n<?xml version='1.0'?>\n"
            + sdf('\n<model name="m"><link name="l"><mistake/></link></model>'))
    _, issues = read(text)
    assert [(i.code, i.line) for i in issues] == [("unknown-element", 5)]


@pytest.mark.parametrize("encoding", ["utf-8", "utf-16", "iso-8859-1", "utf-8-sig"])
def test_bytes_are_read_in_their_declared_encoding(encoding):
    declared = "utf-8" if encoding == "utf-8-sig" else encoding
    text = f'<?xml version="1.0" encoding="{declared}"?>' + sdf(MODEL.replace('"m"', '"möbel"'))
    model, issues = read(text.encode(encoding))
    assert model.name == "möbel" and issues == []


def test_text_may_declare_any_encoding():
    text = '<?xml version="1.0" encoding="UTF-16"?>' + sdf(MODEL.replace('"m"', '"möbel"'))
    assert read(text)[0].name == "möbel"


def test_bytes_that_are_not_of_their_encoding_are_read_as_latin_1_with_a_warning():
    model, issues = read(sdf(MODEL.replace('"m"', '"möbel"')).encode("latin-1"))
    assert model.name == "möbel" and warnings(issues) == ["xml-encoding"]


@pytest.mark.parametrize("encoding, line", [("undefined", 1), ("no-such", 1), ("hex", 1),
                                            ("us-ascii", 2), ("utf-8", 2), ("utf-16", 2)])
def test_a_wrong_declared_encoding_is_told_with_its_line(encoding, line):
    text = f'<?xml version="1.0" encoding="{encoding}"?>\n' + sdf(MODEL.replace('"m"', '"möbel"'))
    model, issues = read(text.encode("latin-1"))
    assert model.name == "möbel"
    assert [(issue.code, issue.line) for issue in issues] == [("xml-encoding", line)]


@pytest.mark.parametrize("blanks", ["", " "])
def test_utf_8_that_declares_utf_16_is_read_as_it_is(blanks):
    text = '<?xml version="1.0" encoding="utf-16"?>' + sdf(MODEL.replace('"m"', '"möbel"'))
    model, issues = read((text + blanks).encode())
    assert model.name == "möbel" and issues == []


HOSTILE = {
    "deep": "<a>" * 200000,
    "deep and closed": sdf("<model name='m'>" * 50000 + "</model>" * 50000),
    "many strays": "<x>" + "</y>" * 200000 + "</x>",
    "many angles": "<" * 2000000,
    "many quotes": "<a b=\"" * 200000,
    "many comments": "<!--" * 500000,
    "billion laughs": "<!DOCTYPE r [<!ENTITY a 'x'>" + "".join(
        f"<!ENTITY a{n} '{('&a%s;' % (n - 1 if n else '')) * 10}'>" for n in range(20)) + "]>"
    "<r>&a19;</r>",
    "external": "<!DOCTYPE r [<!ENTITY e SYSTEM 'file:///dev/zero'>]><r>&e;</r>",
    "external dtd": "<!DOCTYPE r SYSTEM 'http://example.invalid/r.dtd'><r/>",
}


@pytest.mark.parametrize("name", sorted(HOSTILE))
def test_hostile_documents_are_refused(name):
    # Expanding or walking any of them would never end, or exhaust the stack.
    with pytest.raises(InputError):
        read(HOSTILE[name])


def test_models_that_include_each_other_are_an_error_not_a_loop(tmp_path):
    for name, other in (("a", "b"), ("b", "a")):
        folder = tmp_path / name
        folder.mkdir()
        (folder / "model.sdf").write_text(sdf(
            f'<model name="{name}"><link name="l"/><include><uri>model://{other}</uri></include>'
            "</model>"))
    _, issues = read_entity(sdf("<world name='w'><include><uri>model://a</uri></include></world>"),
                            Resolver([str(tmp_path)]))
    assert errors(issues) == ["include-cycle"]


def test_balancing_leaves_a_sound_text_as_it_is():
    text = '<a b="x > y"><!-- <c> --><![CDATA[<d>]]><e/>text</a>\n'
    result = balance_tags(text)
    assert (result.text, result.elements, result.repairs) == (text.rstrip(), 2, [])


@pytest.mark.parametrize("inside, code", [
    ("<a " + " ".join(f"b{i}='1'" for i in range(5000)) + "/>", "xml-too-large"),
    ("<a " + " ".join(f"b{i}=1" for i in range(5000)) + "/>", "xml-too-large"),
    ("<a b='" * 5000, "xml-malformed"),
    ("<a>" * 200000, "xml-too-deep"),
    ("<a/>" * 2000001, "xml-too-large"),
])
def test_masses_are_refused(inside, code):
    fault = refusal(parse_world, f"<sdf version='1.6'><world name='w'>{inside}</world></sdf>",
                    Resolver())
    assert fault.first.code == code


def test_a_file_larger_than_is_read_is_refused_without_reading_it_whole(tmp_path):
    path = tmp_path / "big.world"
    with open(path, "wb") as stream:
        stream.write(b"<sdf version='1.6'><world name='")
        stream.seek(1 << 30)
        stream.write(b"'/></sdf>")
    assert refusal(read_world, str(path), Resolver()).first.code == "xml-too-large"


def test_unknown_names_without_end_are_not_all_told():
    _, issues = parse_world("<sdf version='1.6'><world name='w'>" + "".join(
        f"<x{i}/>" for i in range(3000)) + "</world></sdf>", Resolver())
    assert len(issues) < 1000 and issues[-1].code == "unknown-many"


@pytest.mark.parametrize("text", [
    '<sdf version="1.7"><!– a light –>{}</sdf>', '<sdf version="1.7"><!— a light —>{}</sdf>',
    '<sdf version="1.7"><!- a light ->{}</sdf>', '<sdf version="1.7">‹!– a light –›{}</sdf>'])
def test_a_comment_of_a_word_processor_is_a_comment_with_a_warning_that_says_how_to_write_it(text):
    model, issues = read(text.format(MODEL))
    assert [link.name for link in model.links] == ["l"]
    assert "a comment begins with <!-- and ends with -->" in issues[-1].message
    assert {issue.severity for issue in issues} == {Severity.WARNING}


def test_elements_in_typographic_brackets_are_read_and_their_lines_kept():
    text = '<sdf version="1.7">\n‹model name="m"›\n<link name="l"/>‹/model›\n<wrong/>\n</sdf>'
    model, issues = read(text)
    assert model.name == "m" and [link.name for link in model.links] == ["l"]
    assert ("‹ and › stand here for < and >" in issues[0].message) and issues[0].line == 2


def test_a_guillemet_in_a_text_is_none_of_our_business():
    _, issues = read('<sdf version="1.7"><!-- ‹ 3 › -->' + MODEL + "</sdf>")
    assert issues == []


def test_typographic_quotes_are_quotes_with_a_warning():
    model, issues = read('<sdf version=“1.7”><model name=”m”><link name=‘l’/></model></sdf>')
    assert model.name == "m" and model.links[0].name == "l"
    assert "the quotes of an attribute are typographic ones" in issues[0].message


@pytest.mark.parametrize("text, meant", [
    ("<sfd version='1.7'/>", "did you mean sdf?"), ("<robto/>", "did you mean robot?"),
    ("<wrold/>", "did you mean world?"), ("<modle/>", "did you mean model?"),
    ("<sdf version='1.7'>\n<wrold/></sdf>", "line 2 has <wrold>; did you mean world?"),
    ("<sdf version='1.7'><modle/></sdf>", "line 1 has <modle>; did you mean model?")])
def test_a_misspelt_root_is_answered_with_the_one_that_was_meant(text, meant):
    with pytest.raises(InputError) as refused:
        read(text)
    assert meant in refused.value.issues[0].hint


def test_a_misspelt_world_is_answered_with_the_name_that_was_meant():
    with pytest.raises(InputError) as refused:
        parse_world("<sdf version='1.7'><wrold name='w'/></sdf>", Resolver())
    assert "did you mean world?" in refused.value.issues[0].hint


def test_an_included_model_of_a_misspelt_name_is_answered_with_one_that_is_there(tmp_path):
    for name in ("sun", "ground_plane"):
        (tmp_path / name).mkdir()
    text = ("<sdf version='1.7'><world name='w'><include><uri>model://sunn</uri></include>"
            "</world></sdf>")
    _, issues = parse_world(text, Resolver([str(tmp_path)]))
    assert issues[0].hint.startswith("did you mean model://sun? Otherwise install it")
