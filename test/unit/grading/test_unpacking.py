"""Submissions that are archives."""
from __future__ import annotations

import io
import os
import stat
import tarfile
import zipfile

import pytest

from my_simulations.grading.grader import unpack_submission
from my_simulations.grading.submission import submissions_of
from my_simulations.grading.submission_files import MOST_FILES
from my_simulations.grading.submission_files import content_of as files_of
from my_simulations.resources.database.archive import ArchiveError

MOST_BYTES = 1 << 20


def entry(name, mode):
    info = zipfile.ZipInfo(name)
    info.external_attr = mode << 16
    return info


def write_zip(path, *entries):
    with zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED) as packed:
        for name, content in entries:
            packed.writestr(name, content)


def content_of(path, folder):
    """Student, contents of the files by name, and the names of those that can be executed."""
    folder.mkdir()
    (submission,) = submissions_of([str(path)])
    with unpack_submission(submission, str(folder), MOST_BYTES) as found:
        assert found.student == submission.student
        files = dict(files_of(found.path).files)
        contents = {}
        for name, full in files.items():
            with open(full, encoding="utf-8") as stream:
                contents[name] = stream.read()
        runs = [name for name, full in files.items() if os.access(full, os.X_OK)]
    assert os.listdir(folder) == []
    return submission.student, contents, runs


def test_a_zip_file_is_unpacked_without_links_and_files_of_the_packer(tmp_path):
    write_zip(tmp_path / "Anna Größe.zip", ("lab/go.py", "go"), ("lab\\world\\a.world", "a"),
              (entry("lab/spawn.sh", stat.S_IFREG | 0o755), "spawn"),
              (entry("lab/secret", stat.S_IFLNK | 0o777), "/etc/passwd"),
              ("__MACOSX/lab/._go.py", "mac"))
    assert content_of(tmp_path / "Anna Größe.zip", tmp_path / "out") == (
        "Anna Größe", {"lab/go.py": "go", "lab/world/a.world": "a", "lab/spawn.sh": "spawn"},
        ["lab/spawn.sh"])


@pytest.mark.parametrize("ending", ["tar.gz", "tgz"])
def test_a_tar_file_is_unpacked_without_links(tmp_path, ending):
    with tarfile.open(tmp_path / f"ben.{ending}", "w:gz") as packed:
        link = tarfile.TarInfo("lab/secret")
        link.type, link.linkname = tarfile.SYMTYPE, "/etc/passwd"
        packed.addfile(link)
        program = tarfile.TarInfo("lab/go.py")
        program.size, program.mode = 2, 0o755
        packed.addfile(program, io.BytesIO(b"go"))
    assert content_of(tmp_path / f"ben.{ending}", tmp_path / "out") == (
        "ben", {"lab/go.py": "go"}, ["lab/go.py"])


def test_an_archive_as_the_only_file_of_a_folder_is_the_submission(tmp_path):
    (tmp_path / "carl").mkdir()
    write_zip(tmp_path / "carl" / "LAB.ZIP", ("go.py", "go"))
    assert content_of(tmp_path / "carl", tmp_path / "out")[1] == {"go.py": "go"}
    (tmp_path / "carl" / "read me.txt").write_text("more")
    (submission,) = submissions_of([str(tmp_path / "carl")])
    with unpack_submission(submission, str(tmp_path), MOST_BYTES) as found:
        assert found is submission


def test_an_archive_in_an_archive_is_unpacked_once(tmp_path):
    inner = [tmp_path / f"{number}.zip" for number in range(3)]
    write_zip(inner[0], ("lab/go.py", "go"))
    for outer, one in zip(inner[1:], inner):
        write_zip(outer, ("upload/lab.zip", one.read_bytes()))
    assert content_of(inner[1], tmp_path / "out")[1] == {"lab/go.py": "go"}
    (submission,) = submissions_of([str(inner[2])])
    with unpack_submission(submission, str(tmp_path), MOST_BYTES) as found:
        assert [name for name, _ in files_of(found.path).files] == ["upload/lab.zip"]


def test_an_archive_in_an_archive_that_does_harm_is_refused(tmp_path):
    write_zip(tmp_path / "bomb.zip", ("go.py", bytes(MOST_BYTES + 1)))
    write_zip(tmp_path / "dora.zip", ("bomb.zip", (tmp_path / "bomb.zip").read_bytes()))
    with pytest.raises(ArchiveError, match="1048576 bytes"):
        content_of(tmp_path / "dora.zip", tmp_path / "out")
    assert os.listdir(tmp_path / "out") == []


@pytest.mark.parametrize("name, content, reason", [
    ("go.py", bytes(MOST_BYTES + 1), "more than 20000 files or 1048576 bytes"),
    ("../go.py", b"", "outside its folder"), ("/tmp/go.py", b"", "outside its folder"),
    ("a\\..\\..\\go.py", b"", "outside its folder"),
    (300 * "a/" + "go.py", b"", "more than 50 folders in each other")],
    ids=["bomb", "dots", "absolute", "backslashes", "deep"])
def test_an_archive_that_does_harm_is_refused(tmp_path, name, content, reason):
    write_zip(tmp_path / "dora.zip", (name, content))
    with pytest.raises(ArchiveError, match=reason):
        content_of(tmp_path / "dora.zip", tmp_path / "out")
    assert sorted(os.listdir(tmp_path)) == ["dora.zip", "out"]
    assert os.listdir(tmp_path / "out") == []


def test_a_damaged_or_encrypted_archive_is_refused(tmp_path):
    (tmp_path / "damaged.zip").write_bytes(b"PK")
    with pytest.raises(ArchiveError, match="broken"):
        content_of(tmp_path / "damaged.zip", tmp_path / "first")
    write_zip(tmp_path / "encrypted.zip", ("go.py", "go"))
    packed = bytearray((tmp_path / "encrypted.zip").read_bytes())
    packed[packed.index(b"PK\x01\x02") + 8] |= 1     # the flag of encryption in the directory
    (tmp_path / "encrypted.zip").write_bytes(packed)
    with pytest.raises(ArchiveError, match="'go.py' is encrypted"):
        content_of(tmp_path / "encrypted.zip", tmp_path / "second")


def test_an_archive_of_too_many_files_is_refused(tmp_path):
    write_zip(tmp_path / "many.zip", *((f"{number}", b"") for number in range(MOST_FILES + 1)))
    with pytest.raises(ArchiveError, match=f"more than {MOST_FILES} files"):
        content_of(tmp_path / "many.zip", tmp_path / "out")
    assert os.listdir(tmp_path / "out") == []
