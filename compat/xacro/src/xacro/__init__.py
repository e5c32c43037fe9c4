"""xacro as ROS Noetic has it (1.14): pip's xacro 2.1 with the substitution arguments of roslaunch.

Both are one code base; 2.x differs in how it reads `$(find …)` and its like: it knows ament's
packages only. `import xacro` gives pip's module, with Noetic's function in that one place.
"""
import importlib.machinery
import importlib.util
import os
import sys
from types import ModuleType
from typing import Any, Iterator, List


def _site_folders() -> Iterator[str]:
    """Where pip's xacro may lie: on this Python's path, else in the workspace's environment."""
    yield from (entry for entry in sys.path if entry)
    python = os.environ.get("MY_SIMULATIONS_PYTHON", "")
    if python:
        version = f"python{sys.version_info[0]}.{sys.version_info[1]}"
        prefix = os.path.dirname(os.path.dirname(python))
        yield os.path.join(prefix, "lib", version, "site-packages")


def _load() -> ModuleType:
    """pip's xacro, as `sys.modules["xacro"]`. Raises ImportError."""
    ours = sys.modules[__name__]
    for folder in _site_folders():
        # This package has an __init__.py only.
        if not os.path.isfile(os.path.join(folder, "xacro", "cli.py")):
            continue
        spec = importlib.machinery.PathFinder.find_spec("xacro", [folder])
        if spec is None or spec.loader is None:
            continue
        module = importlib.util.module_from_spec(spec)
        sys.modules[__name__] = module
        try:
            spec.loader.exec_module(module)
        except BaseException:
            sys.modules[__name__] = ours
            raise
        return module
    raise ImportError("pip's xacro is not installed for this Python; source the setup file of the "
                      "workspace (devel/setup.bash), or run tools/run --set-up-only", name="xacro")


_LANGUAGE = ("arg", "if", "include", "insert_block", "macro", "property", "unless")


def _without_prefix(document: Any) -> str:
    """The elements of a robot that are named as those of xacro but lack its prefix; "" for none."""
    root = getattr(document, "documentElement", None)
    tags = {child.nodeName for child in root.childNodes} if root is not None else set()
    return ", ".join(f"<{tag}>" for tag in _LANGUAGE if tag in tags)


def _as_in_noetic(module: Any) -> None:
    """Give the module Noetic's substitution arguments and the options of its command line."""
    cwd, process_args, parse = module.eval_extension, module.process_args, module.parse

    def eval_extension(text: str) -> Any:
        """What `$(find p)`, `$(arg a)`, `$(env v)`, `$(eval …)` … stand for, as in roslaunch."""
        if text == "$(cwd)":
            return cwd(text)
        try:
            from roslaunch.substitution_args import ArgException, resolve_args
            from rospkg.common import ResourceNotFound
        except ImportError as fault:
            raise module.XacroException("substitution args not supported: ", exc=fault) from fault
        try:
            return resolve_args(text, context=module.substitution_args_context, resolve_anon=False)
        except ArgException as fault:
            raise module.XacroException("Undefined substitution argument", exc=fault) from fault
        except ResourceNotFound as fault:
            raise module.XacroException("resource not found:", exc=fault) from fault

    def without_old_options(argv: List[str], *args: Any, **options: Any) -> Any:
        """`--xacro-ns` asked for what has been the only way since Melodic."""
        kept = [word for word in argv if word != "--xacro-ns"]
        return process_args(kept, *args, **options)

    def parse_with_warning(inp: Any, filename: Any = None) -> Any:
        """Files of Indigo have elements without the prefix, which Noetic passes through."""
        document = parse(inp, filename)
        found = _without_prefix(document)
        if found:
            module.warning(f"{filename or 'the text'}: {found} without the prefix xacro: has no"
                           " effect; write <xacro:property> and so on")
        return document

    module.eval_extension = eval_extension
    module.parse = parse_with_warning
    module.process_args = without_old_options


_as_in_noetic(_load())
