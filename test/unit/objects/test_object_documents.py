from __future__ import annotations

import xml.etree.ElementTree as ElementTree
from pathlib import Path

import pytest

from my_simulations.errors import InputError
from my_simulations.objects.object_documents import read_document, root_tag

TUTORIAL = Path(__file__).resolve().parents[2] / "data" / "tutorial"


@pytest.mark.parametrize("prologue", [
    "", "<?xml version='1.0'?>\n", "\ufeff<?xml version='1.0'?>",
    "<!-- a <sdf> in a comment -->\n",
    "<?xml version='1.0'?><!DOCTYPE robot [<!ENTITY a 'b'>]>\n",
    "  \n<?note <x/>?><!-- -->"])
def test_the_root_element_is_found_whatever_comes_before(prologue):
    assert root_tag(prologue + "<robot name='a'><link name='b'/></robot>") == "robot"


@pytest.mark.parametrize("text,expected", [
    ("<sdf/>", "sdf"), ("<robot>", "robot"), ("", ""), ("no xml", ""),
    ("<!-- never closed <robot>", "")])
def test_text_without_a_root_element_has_no_tag(text, expected):
    assert root_tag(text) == expected


def test_the_tutorials_template_is_read_as_printed():
    text = read_document(str(TUTORIAL / "my_object_as_printed.urdf"))
    assert root_tag(text) == "robot"
    assert text.splitlines()[17].strip() == (
        '<mesh filename="package://my_simulations/Media/models/my_object.dae">')
    with pytest.raises(ElementTree.ParseError):
        ElementTree.fromstring(text)


def test_a_declared_encoding_is_decoded_and_no_longer_declared(tmp_path):
    path = tmp_path / "latin.urdf"
    path.write_bytes("<?xml version='1.0' encoding='ISO-8859-1'?><robot name='Gerät'/>"
                     .encode("latin-1"))
    text = read_document(str(path))
    assert ElementTree.fromstring(text.encode("utf-8")).get("name") == "Gerät"


@pytest.mark.parametrize("content,code", [
    (b"", "object-empty"), (b"  \n", "object-empty"), (b"<robot name='\xff'/>", "object-encoding"),
    (b"<?xml version='1.0' encoding='no-such'?><robot/>", "object-encoding"),
    (b"<?xml version='1.0' encoding='undefined'?><robot/>", "object-encoding")])
def test_an_unusable_file_is_an_input_error(tmp_path, content, code):
    path = tmp_path / "bad.urdf"
    path.write_bytes(content)
    with pytest.raises(InputError) as caught:
        read_document(str(path))
    assert caught.value.issues[0].code == code
    assert caught.value.issues[0].file == str(path)


def test_a_missing_file_is_an_input_error(tmp_path):
    with pytest.raises(InputError) as caught:
        read_document(str(tmp_path / "none.urdf"))
    assert caught.value.issues[0].code == "object-unreadable"


def test_a_folder_is_an_input_error(tmp_path):
    with pytest.raises(InputError):
        read_document(str(tmp_path))
