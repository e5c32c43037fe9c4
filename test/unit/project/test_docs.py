"""The pages: links, sizes, commands and the walks through the code are right."""
from __future__ import annotations

import re
import sys
import xml.etree.ElementTree as ElementTree
from pathlib import Path
from typing import List, Tuple

import pytest
import yaml
from architecture_walks import walks

REPOSITORY = Path(__file__).resolve().parents[3]
sys.path.insert(0, str(REPOSITORY / "tools" / "generate"))

from supported_table import PAGE as SUPPORT
from supported_table import with_table

from my_simulations.plugins.registry import BUILT_IN, PROVIDED

README, MAINTAINERS = REPOSITORY / "README.md", REPOSITORY / "doc" / "dev" / "README.md"
USERS_PAGES = sorted((REPOSITORY / "doc").glob("*.md"))
MAINTAINERS_PAGES = [REPOSITORY / "CONTRIBUTING.md", *sorted(MAINTAINERS.parent.glob("*.md"))]
PAGES = [README, *USERS_PAGES, *MAINTAINERS_PAGES]
README_BYTES = 8192

BLOCK = re.compile(r"^```(\w*)[^\n]*\n(.*?)^```$", re.MULTILINE | re.DOTALL)
LINK = re.compile(r"!?\[[^\]]*\]\(([^)\s]+)\)")


def text_of(page):
    return page.read_text(encoding="utf-8")


def links(page):
    return LINK.findall(BLOCK.sub("", text_of(page)))


def anchors(page):
    """The anchors of a page's headings, as GitHub and GitLab make them."""
    found = set()
    for heading in re.findall(r"^#+ (.+)$", BLOCK.sub("", text_of(page)), re.MULTILINE):
        plain = re.sub(r"[^\w\- ]", "", heading.lower())
        found.add(plain.strip().replace(" ", "-"))
    return found


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.name)
def test_every_link_of_a_page_leads_somewhere(page):
    for link in links(page):
        if "://" in link:
            continue
        name, _, anchor = link.partition("#")
        target = (page.parent / name).resolve() if name else page
        assert target.exists(), f"{page.name}: {link}"
        if anchor:
            assert anchor in anchors(target), f"{page.name}: {link}"


def targets(page):
    return {(page.parent / link).resolve() for link in links(page) if "://" not in link}


def test_the_readme_links_every_page_for_users_and_the_index_every_page_for_maintainers():
    index = re.split(r"^## Documentation$", text_of(README), flags=re.MULTILINE)[1]
    rows = {REPOSITORY / link for row in re.findall(r"^\|.*$", index, re.MULTILINE)
            for link in LINK.findall(row)}
    assert {page.resolve() for page in rows} == {page.resolve() for page in USERS_PAGES}
    assert MAINTAINERS.resolve() in targets(README)
    assert {page.resolve() for page in MAINTAINERS_PAGES} - {MAINTAINERS.resolve()} <= (
        targets(MAINTAINERS))


def test_every_picture_is_shown_on_a_page():
    shown = {(page.parent / link).resolve() for page in PAGES for link in links(page)}
    pictures = {path.resolve() for path in (REPOSITORY / "doc" / "images").iterdir()}
    assert pictures <= shown


def test_readme_is_short_and_has_two_pictures():
    assert len(README.read_bytes()) <= README_BYTES
    assert len(re.findall(r"!\[[^\]]+\]\(doc/images/", text_of(README))) >= 2


def test_the_table_of_supported_elements_is_the_readers_own():
    page = text_of(SUPPORT)
    assert with_table(page) == page, "run tools/generate/supported_table.py"


def test_the_robots_page_lists_every_library_of_the_registry_and_no_other():
    page = text_of(REPOSITORY / "doc" / "robots.md")
    rows = {name for row in re.findall(r"^\| (`lib[^|]*) \|", page, re.MULTILINE)
            for name in re.findall(r"`(lib\w+\.so)`", row)}
    assert rows == set(BUILT_IN)
    assert [name for name in PROVIDED if f"`{name}`" not in page] == []


# -- launch files --------------------------------------------------------------------------------

LAUNCH_FILES = sorted([*(REPOSITORY / "launch").glob("*.launch"),
                       *(REPOSITORY / "compat").glob("*/launch/*.launch")])


@pytest.mark.parametrize("path", LAUNCH_FILES, ids=lambda path: path.name)
def test_every_launch_argument_is_documented(path):
    for argument in ElementTree.parse(path).getroot().findall("arg"):
        if argument.get("value") is None:
            assert argument.get("doc"), f"{path.name}: {argument.get('name')}"


def test_the_lab_sheets_page_lists_the_arguments_of_my_world():
    root = ElementTree.parse(REPOSITORY / "launch" / "my_world.launch").getroot()
    rows = re.findall(r"^\| (`[^|]*) \|", text_of(REPOSITORY / "doc" / "lab_sheet.md"),
                      re.MULTILINE)
    named = {name for row in rows for name in re.findall(r"`(\w+)`", row)}
    assert {argument.get("name") for argument in root.findall("arg")} <= named


def test_the_lab_sheets_page_names_every_launch_file_of_a_world():
    page = text_of(REPOSITORY / "doc" / "lab_sheet.md")
    others = {"upload_param.launch", "spawn_object_urdf.launch", "view_robot.launch"}
    for path in (REPOSITORY / "launch").glob("*.launch"):
        assert path.name in others or path.name in page


# -- commands ------------------------------------------------------------------------------------

def commands() -> List[Tuple[str, List[str]]]:
    """The commands in the pages' shell blocks, as words, with the page they stand on."""
    found = []
    for page in PAGES:
        for language, body in BLOCK.findall(text_of(page)):
            if language == "bash":
                for line in body.replace("\\\n", " ").splitlines():
                    found.append((page.name, line.split()))
    return found


PACKAGES = {"my_simulations": REPOSITORY, "gazebo_ros": REPOSITORY / "compat" / "gazebo_ros"}


def test_programs_and_launch_files_of_commands_exist():
    checked = 0
    for page, words in commands():
        for tool, package, name in zip(words, words[1:], words[2:]):
            if package not in PACKAGES or tool not in ("rosrun", "roslaunch"):
                continue
            folder = PACKAGES[package] / ("scripts" if tool == "rosrun" else "launch")
            assert list(folder.glob(f"{name}*")), f"{page}: {' '.join(words)}"
            checked += 1
    assert checked > 10


def test_repository_paths_in_commands_exist():
    for page, words in commands():
        for word in words:
            path = re.search(r"(?:^|my_simulations/|clone/)((?:tools|test|docker)/[\w./-]+)$", word)
            if path:
                assert (REPOSITORY / path.group(1)).exists(), f"{page}: {' '.join(words)}"


def test_options_of_tools_in_the_pages_are_understood():
    known = "".join(text_of(REPOSITORY / "tools" / name)
                    for name in ("run", "test", "lib/command.sh"))
    for page in PAGES:
        for options in re.findall(r"tools/(?:run|test)((?:\s+--[a-z-]+)+)", text_of(page)):
            for option in options.split():
                assert re.search(rf"{option}\b", known), f"{page.name}: {option}"


def test_modules_named_on_the_pages_exist():
    modules = {path.name for path in (REPOSITORY / "src").rglob("*.py")}
    modules |= {path.name for folder in ("test", "tools", "scripts", "examples")
                for path in (REPOSITORY / folder).rglob("*.py")}
    for page in PAGES:
        for name in re.findall(r"`[\w/]*?(\w+\.py)`", text_of(page)):
            assert name in modules, f"{page.name}: {name}"


def quoted_messages():
    """The fixed parts of our messages in the first column of the troubleshooting page."""
    others = ("/usr/bin/env", "Could not find a package", "RLException")
    page = text_of(REPOSITORY / "doc" / "troubleshooting.md")
    rows = [row for row in re.findall(r"^\| `([^|`]*)` \|", page, re.MULTILINE)
            if not row.startswith(others)]
    parts = [part.strip(" ,;") for row in rows for part in row.split("…")]
    return [part for part in parts if part]


def test_messages_of_the_troubleshooting_page_are_those_of_the_programs():
    files = [path for folder in ("src", "tools", "web/js") for path in
             (REPOSITORY / folder).rglob("*") if path.suffix in (".py", ".sh", ".ts")]
    # String literals over several lines are joined.
    text = re.sub(r"""["']\s*\n\s*f?["']|\\\n""", "", "\n".join(map(text_of, files)))
    found = quoted_messages()
    assert len(found) > 10
    assert [part for part in found if part not in text] == []


def test_every_parameter_of_the_node_is_documented():
    page = text_of(REPOSITORY / "doc" / "ros_api.md")
    names = set()
    for path in (REPOSITORY / "src" / "my_simulations" / "ros").rglob("*.py"):
        names.update(re.findall(r'"~([a-z_/]+)"', text_of(path)))
        names.update(re.findall(r'parameters, "([a-z_]+)"', text_of(path)))
    assert len(names) > 10
    for name in names:
        assert f"`~{name}`" in page, name


def test_keys_named_on_the_pages_are_hotkeys_of_the_editor():
    keys = set(re.findall(r"keys: '([^']+)'", text_of(REPOSITORY / "web" / "js" / "hotkeys.ts")))
    for name in ("world_editor", "building_editor", "lab_sheet", "first_hour"):
        page = REPOSITORY / "doc" / f"{name}.md"
        for key in re.findall(r"\bCtrl\+(?:Shift\+)?[A-Z]\b|\bF\d+\b", text_of(page)):
            assert key in keys, f"{page.name}: {key}"


# -- continuous integration ----------------------------------------------------------------------

def test_job_files_are_yaml_with_jobs():
    bodies = [yaml.safe_load(body) for language, body in BLOCK.findall(
        text_of(REPOSITORY / "doc" / "ci.md")) if language == "yaml"]
    github, gitlab = bodies
    steps = github["jobs"]["test"]["steps"]
    assert any("tools/run --set-up-only" in step.get("run", "") for step in steps)
    assert any('tools/run" --set-up-only' in line
               for line in gitlab["simulation"]["before_script"])
    always = [step for step in steps if "if" not in step]    # others follow a failure
    for lines in ("\n".join(step.get("run", "") for step in always),
                  "\n".join(gitlab["simulation"]["script"])):
        assert "catkin_make run_tests_my_package" in lines
        assert lines.rstrip().splitlines()[-1].strip() == (
            "catkin_test_results build/test_results"), "its status is the job's"


# -- the package's papers ------------------------------------------------------------------------

def test_maintainers_have_an_address_that_catkin_takes():
    for path in [REPOSITORY / "package.xml", *(REPOSITORY / "compat").glob("*/package.xml")]:
        (maintainer,) = ElementTree.parse(path).getroot().findall("maintainer")
        address = maintainer.get("email")
        assert re.fullmatch(r"[\w.+-]+@[\w-]+(\.[\w-]+)*\.[a-z]{2,6}", address), path
        assert not address.endswith((".invalid", ".example", ".test")), path


def test_changelog_is_catkins():
    lines = text_of(REPOSITORY / "CHANGELOG.rst").splitlines()
    assert lines[1] == "Changelog for package my_simulations"
    assert set(lines[0]) == set(lines[2]) == {"^"} and len(lines[0]) >= len(lines[1])
    sections = [line for line, under in zip(lines, lines[1:]) if under and set(under) == {"-"}]
    released = sections[sections[0] == "Forthcoming":]
    assert all(re.fullmatch(r"\d+\.\d+\.\d+ \(\d{4}-\d\d-\d\d\)", name) for name in released)


# -- the walks through the code ----------------------------------------------------------

@pytest.mark.parametrize("title, stated, rows", walks(), ids=lambda value: str(value)[:20])
def test_walk_counts_its_modules_right(title, stated, rows):
    modules = [module for module, _ in rows]
    assert stated == (len(set(modules)), len(modules) - len(set(modules)))
    assert all(one != other for one, other in zip(modules, modules[1:]))


@pytest.mark.parametrize("title, stated, rows", walks(), ids=lambda value: str(value)[:20])
def test_modules_and_functions_of_a_walk_exist(title, stated, rows):
    for module, names in rows:
        page = module.startswith("web/")
        path = REPOSITORY / f"{module}.ts" if page else (
            REPOSITORY / "src" / "my_simulations" / f"{module}.py")
        text = text_of(path)
        for name in names:
            pattern = (rf"^\s*(?:async |export |function |override |#)*{name}(?:<.*>)?\(" if page
                       else rf"^\s*(?:async )?def {name}\(")
            assert re.search(pattern, text, re.MULTILINE), f"{title}: {module} {name}"
