# shellcheck shell=bash
# The checks of the sources that run no test; their versions are pinned in requirements-test.txt and
# test/page/package-lock.json.

# style_command NAME: set STYLE_COMMAND; the workspace must have the test tools.
style_command() {
  case $1 in
    commit-subjects) STYLE_COMMAND=("$VENV/bin/python3" tools/lib/commit_subjects.py "$CLONE") ;;
    ruff) STYLE_COMMAND=("$VENV/bin/python3" -m ruff check --no-cache .) ;;
    import-contracts)
      STYLE_COMMAND=(env PYTHONPATH="$CLONE/src" "$VENV/bin/python3" "$VENV/bin/lint-imports" --no-cache) ;;
    mypy)
      STYLE_COMMAND=("$VENV/bin/python3" -m mypy --cache-dir "$OWN/mypy"
        src compat/gazebo_ros/src compat/controller_manager/src) ;;
    page-types)
      STYLE_COMMAND=("$PAGE_CHECKS/node_modules/.bin/tsc" -p "$PAGE_CHECKS/tsconfig.json") ;;
    page-style)
      STYLE_COMMAND=("$PAGE_CHECKS/node_modules/.bin/eslint"
        --config "$PAGE_CHECKS/eslint.config.mjs" web/js test/page tools) ;;
    *) return 1 ;;
  esac
}
