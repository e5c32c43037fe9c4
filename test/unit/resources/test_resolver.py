"""URIs become paths the way Gazebo finds them, without a network and without needless crawling."""
import os

import pytest

from my_simulations.resources.model_config import description_in, version_of
from my_simulations.resources.resolver import Resolver, ResourceNotFoundError
from my_simulations.resources.ros_packages import ExportedPaths, PackageIndex


@pytest.fixture
def tree(tmp_path):
    for path in ("first/crate/a.dae", "second/crate/a.dae", "second/lamp/b.dae",
                 "pkg/meshes/c.dae", "media/worlds/w.world", "media/Media/models/d.dae",
                 "media/models/e.dae", "base/f.dae", "late/g/h.dae", "media/with space.dae"):
        file = tmp_path / path
        file.parent.mkdir(parents=True, exist_ok=True)
        file.write_text(path)
    return tmp_path


@pytest.fixture
def resolver(tree):
    return Resolver(
        [str(tree / "first"), str(tree / "second")], [str(tree / "media")],
        {"pkg": str(tree / "pkg")}.get, lambda: ExportedPaths([str(tree / "late")], []))


def found(resolver, uri, tree, base=""):
    return os.path.relpath(resolver.resolve(uri, base), tree)


@pytest.mark.parametrize("uri, path, base", [
    ("model://crate/a.dae", "first/crate/a.dae", ""),           # model paths in their order
    ("model://lamp/b.dae", "second/lamp/b.dae", ""),
    ("model://pkg/meshes/c.dae", "pkg/meshes/c.dae", ""),       # a package
    ("model:///lamp/b.dae", "second/lamp/b.dae", ""),           # with slashes before the name
    ("package:///pkg/meshes/c.dae", "pkg/meshes/c.dae", ""),
    ("package://pkg/meshes/c.dae", "pkg/meshes/c.dae", ""),
    ("package://lamp/b.dae", "second/lamp/b.dae", ""),          # a model in place of a package
    ("f.dae", "base/f.dae", "base"),                            # the folder of the file
    ("file://f.dae", "base/f.dae", "base"),
    ("worlds/w.world", "media/worlds/w.world", ""),             # resource paths, media folders
    ("file://d.dae", "media/Media/models/d.dae", ""),
    ("e.dae", "media/models/e.dae", ""),
    ("file://with%20space.dae", "media/with space.dae", ""),
])
def test_a_uri_leads_to_the_first_path_that_has_it(resolver, tree, uri, path, base):
    assert found(resolver, uri, tree, base and str(tree / base)) == path


def test_devices_and_pipes_are_not_read(resolver, tree):
    os.mkfifo(tree / "first" / "crate" / "pipe.stl")
    for uri, path in (("model://crate/pipe.stl", "first/crate/pipe.stl"),
                      (f"file://{tree}/first/crate/pipe.stl", "first/crate/pipe.stl"),
                      ("/dev/zero", "/dev/zero")):
        with pytest.raises(ResourceNotFoundError,
                           match=f"{tree / path} is neither a file nor a folder"):
            resolver.resolve(uri)


def test_a_pipe_in_a_model_folder_is_not_its_description(tmp_path):
    os.mkfifo(tmp_path / "model.config")
    os.mkfifo(tmp_path / "model.sdf")
    assert description_in(str(tmp_path)) is None


def test_a_relative_path_is_looked_for_in_the_working_directory(resolver, tree, monkeypatch):
    monkeypatch.chdir(tree / "base")
    assert found(resolver, "f.dae", tree) == "base/f.dae"


def test_an_absolute_path_is_taken_as_it_is_then_under_the_model_paths(resolver, tree):
    assert found(resolver, str(tree / "base/f.dae"), tree) == "base/f.dae"
    assert found(resolver, "file://" + str(tree / "base/f.dae"), tree) == "base/f.dae"
    assert found(resolver, "/crate/a.dae", tree) == "first/crate/a.dae"


def missing(resolver, uri):
    with pytest.raises(ResourceNotFoundError) as caught:
        resolver.resolve(uri)
    return caught.value


def test_what_is_nowhere_raises_with_every_place_tried(resolver, tree):
    fault = missing(resolver, "model://gone/x.dae")
    assert fault.uri == "model://gone/x.dae"
    places = [str(tree / place / "gone/x.dae") for place in ("first", "second", "late")]
    assert fault.tried == [*places, "ROS package gone"]
    assert str(fault) == f"'model://gone/x.dae' was not found: searched {', '.join(places)}"


def test_a_message_names_three_places_and_counts_the_others(tmp_path):
    resolver = Resolver([str(tmp_path / str(number)) for number in range(40)])
    text = str(missing(resolver, "model://gone"))
    assert text.endswith(f"{tmp_path}/2/gone, 37 more places")


def test_an_absolute_path_is_not_joined_to_the_folders_in_messages(resolver):
    for uri in ("/no/such/a.dae", "file:///no/such/a.dae"):
        assert str(missing(resolver, uri)) == f"{uri!r} was not found"


def test_an_unknown_package_is_named(resolver):
    fault = missing(resolver, "package://gone/a.dae")
    assert str(fault) == "'package://gone/a.dae' was not found: there is no ROS package 'gone'"


def test_files_of_an_unknown_package_have_one_text(resolver):
    texts = {resolver.explain(missing(resolver, f"package://gone/{name}.dae"), "install it")
             for name in ("a", "b")}
    assert texts == {("is in the ROS package 'gone', which was not found", "install it")}


def test_the_same_path_in_this_package_is_suggested_for_an_unknown_package(tmp_path):
    (tmp_path / "Media").mkdir()
    (tmp_path / "Media" / "x.dae").write_text("")
    resolver = Resolver(own=[str(tmp_path)])
    uri = "package://cob_gazebo_objects/Media/x.dae"
    assert resolver.explain(missing(resolver, uri), "give up") == (
        f"{uri!r} was not found",
        "did you mean package://my_simulations/Media/x.dae? Otherwise give up")
    fault = missing(resolver, uri + "2")
    assert resolver.explain(fault, "give up")[1] == "give up"


def test_a_model_or_package_is_suggested_for_an_absolute_path_of_another_machine(tree):
    resolver = Resolver([str(tree / "first")], packages=lambda: [str(tree / "second")])
    model = missing(resolver, "/home/other/models/crate/a.dae")
    assert "did you mean model://crate/a.dae?" in resolver.explain(model, "")[1]
    (tree / "second" / "b.dae").write_text("")
    package = missing(resolver, "file:///home/other/ws/src/second/b.dae")
    assert "did you mean package://second/b.dae?" in resolver.explain(package, "")[1]
    assert resolver.explain(missing(resolver, "/home/other/nothing/x.dae"), "")[1] == ""


@pytest.mark.parametrize("scheme", ["", "file://"])
def test_a_model_in_the_home_folder_of_another_machine_is_taken_from_the_model_folders(
        resolver, tree, scheme):
    home = f"{scheme}/home/other/.gazebo/models"
    assert found(resolver, f"{home}/lamp/b.dae", tree) == "second/lamp/b.dae"
    assert found(resolver, f"{home}/lamp", tree) == "second/lamp"
    assert resolver.replaced_home(f"{home}/lamp/b.dae") == "model://lamp/b.dae"
    for other in (f"{home}/nowhere/b.dae", f"{home}/", f"{home}/lamp/other.dae",
                  "/home/other/models/lamp/b.dae", "model://lamp/b.dae",
                  "home/.gazebo/models/lamp/b.dae"):
        assert resolver.replaced_home(other) == ""
    with pytest.raises(ResourceNotFoundError):
        resolver.resolve(f"{home}/nowhere/b.dae")


@pytest.mark.parametrize(("there", "base"), [
    ("ws/course/models", "ws/course/worlds/deep"), ("ws/course/models", "ws/course/models/sofa"),
    ("ws/course", "ws/course/worlds"), ("ws/other/models", ""), ("ws/other/models", "elsewhere")])
def test_a_folder_of_models_that_is_not_listed_is_found_near_the_file_or_in_a_package(
        tmp_path, there, base):
    (tmp_path / there / "desk").mkdir(parents=True)
    (tmp_path / there / "desk" / "a.dae").write_text("")
    (tmp_path / "ws" / "course").mkdir(exist_ok=True)
    (tmp_path / "ws" / "course" / "package.xml").write_text("<package/>")
    resolver = Resolver(packages=lambda: [str(tmp_path / "ws" / "other")])
    base = str(tmp_path / base) if base else ""
    assert resolver.add_unlisted_folder("model://desk/a.dae", base) == str(tmp_path / there)
    assert found(resolver, "model://desk/a.dae", tmp_path) == f"{there}/desk/a.dae"


@pytest.mark.parametrize("uri", ["model://chair/a.dae", "model://desk/other.dae", "model://",
                                 "model://../desk/a.dae", "package://desk/a.dae", "desk/a.dae"])
def test_models_above_the_package_of_a_file_are_not_looked_for(tmp_path, uri):
    for path in ("models/chair/a.dae", "course/models/desk/a.dae", "course/package.xml"):
        (tmp_path / path).parent.mkdir(parents=True, exist_ok=True)
        (tmp_path / path).write_text("")
    assert Resolver().add_unlisted_folder(uri, str(tmp_path / "course" / "worlds")) == ""


def test_only_two_folders_are_searched_for_a_file_in_no_package(tmp_path):
    (tmp_path / "desk").mkdir()
    (tmp_path / "desk" / "a.dae").write_text("")
    for base, found in (("worlds", str(tmp_path)), ("course/worlds", "")):
        assert Resolver().add_unlisted_folder("model://desk/a.dae", str(tmp_path / base)) == found


def test_a_home_folder_that_is_there_is_used(resolver, tree):
    path = tree / "home" / ".gazebo" / "models" / "lamp" / "b.dae"
    path.parent.mkdir(parents=True)
    path.write_text("own")
    assert resolver.resolve(str(path)) == str(path)
    assert resolver.replaced_home(str(path)) == ""


@pytest.mark.parametrize("uri", ["", "  ", "__default__", "http://example.invalid/a.dae", "model://",
                                 "package://"])
def test_what_names_no_file_here_raises(resolver, uri):
    with pytest.raises(ResourceNotFoundError):
        Resolver().resolve(uri)


def test_exported_paths_are_asked_for_only_when_the_others_hold_no_answer(tree):
    asked = []

    def exported():
        asked.append(1)
        return ExportedPaths([str(tree / "late")], [])

    resolver = Resolver([str(tree / "first")], [], lambda name: None, exported)
    resolver.resolve("model://crate/a.dae")
    assert asked == []
    resolver.resolve("model://g/h.dae")
    resolver.resolve("model://g/h.dae")
    assert asked == [1]


def test_the_package_finder_is_asked_for_packages_only(tree):
    def find(name):
        raise AssertionError(name)

    resolver = Resolver([str(tree / "first")], [str(tree / "media")], find)
    resolver.resolve("model://crate/a.dae")
    resolver.resolve("e.dae")


class FakeRospack:
    def __init__(self, folders):
        self.folders = folders

    def list(self):
        return list(self.folders)

    def get_path(self, name):
        return self.folders[name]


def test_packages_export_model_and_media_folders(tmp_path):
    (tmp_path / "package.xml").write_text(
        '<package><export>\n<!-- <gazebo_ros gazebo_model_path="${prefix}/old"/> -->'
        '<gazebo_ros gazebo_model_path="${prefix}/models:/elsewhere"\n'
        " gazebo_media_path='${prefix}'/></export></package>")
    index = PackageIndex(FakeRospack({"a": str(tmp_path), "gone": str(tmp_path / "gone")}))
    paths = index.exported()
    assert paths.models == [f"{tmp_path}/models", "/elsewhere"]
    assert paths.media == [str(tmp_path)]


def test_an_unknown_package_is_none():
    assert PackageIndex(FakeRospack({})).find("nothing") is None


def test_the_environment_gives_gazebos_variables_and_our_own_models(tree, monkeypatch):
    monkeypatch.setenv("GAZEBO_MODEL_PATH", f"{tree / 'second'}:")
    monkeypatch.setenv("GAZEBO_RESOURCE_PATH", str(tree / "media"))
    monkeypatch.setenv("HOME", str(tree))
    (tree / ".gazebo/models/sun").mkdir(parents=True)
    resolver = Resolver.from_environment()
    assert found(resolver, "model://crate/a.dae", tree) == "second/crate/a.dae"
    assert found(resolver, "worlds/w.world", tree) == "media/worlds/w.world"
    assert found(resolver, "model://sun", tree) == ".gazebo/models/sun"
    assert resolver.model_file("model://ground_plane").endswith("models/ground_plane/model.sdf")
    assert resolver.resolve("worlds/empty.world").endswith("empty.world")
    own = resolver.resolve("package://my_simulations/models/ground_plane/model.sdf")
    assert own == resolver.model_file("model://ground_plane")


def test_buildings_that_were_drawn_are_models_after_all_others(tree, monkeypatch):
    monkeypatch.setenv("GAZEBO_MODEL_PATH", str(tree / "second"))
    monkeypatch.setenv("HOME", str(tree))
    drawn = tree / "building_editor_models"
    assert str(drawn) not in Resolver.from_environment().model_folders()
    for name in ("Cottage", "crate"):
        (drawn / name).mkdir(parents=True)
        (drawn / name / "a.dae").write_text("")
    resolver = Resolver.from_environment()
    assert found(resolver, "model://Cottage", tree) == "building_editor_models/Cottage"
    assert found(resolver, "model://crate/a.dae", tree) == "second/crate/a.dae"


def config(folder, text, name="model.config"):
    (folder / name).write_text(text)


def test_the_highest_version_that_is_known_is_taken(tmp_path):
    for name in ("a.sdf", "b.sdf", "c.sdf"):
        (tmp_path / name).write_text("")
    config(tmp_path, "<model><sdf version='1.4'>a.sdf</sdf><sdf version='1.10'>c.sdf</sdf>"
                     "<sdf version='1.7'>b.sdf</sdf></model>")
    assert description_in(str(tmp_path)) == str(tmp_path / "b.sdf")


def test_without_versions_the_first_is_taken(tmp_path):
    for name in ("a.sdf", "b.sdf"):
        (tmp_path / name).write_text("")
    config(tmp_path, "<model><sdf>a.sdf</sdf><sdf>b.sdf</sdf></model>", "manifest.xml")
    assert description_in(str(tmp_path)) == str(tmp_path / "a.sdf")


def test_a_folder_without_config_may_hold_one_description(tmp_path):
    assert description_in(str(tmp_path)) is None
    (tmp_path / "only.urdf").write_text("")
    assert description_in(str(tmp_path)) == str(tmp_path / "only.urdf")
    config(tmp_path, "this is not XML")
    assert description_in(str(tmp_path)) == str(tmp_path / "only.urdf")


def test_a_folder_without_description_is_not_a_model(tmp_path):
    (tmp_path / "thing").mkdir()
    with pytest.raises(ResourceNotFoundError) as caught:
        Resolver([str(tmp_path)]).model_file("model://thing")
    assert str(tmp_path / "thing" / "model.config") in caught.value.tried


def test_versions_compare_by_their_numbers():
    assert version_of("1.10") > version_of("1.7") > version_of("")
