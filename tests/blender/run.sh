#!/bin/sh
# run.sh TEST BUILD_DIR [NAME...]: installs the add-on's zip as a user does, into folders of its own, and runs a test in Blender.
# TEST: tools, module (test_addon.py with that backend; NAME: of its functions), window (test_window.py, with a screen of its own),
# compare (compare.py, which measures; NAME: a model). KERF_BACKEND: of window and compare, TOOLS, MODULE or AUTO.
set -eu
here=$(cd "$(dirname "$0")" && pwd)
root=$(cd "$here/../.." && pwd)
kind=$1 build=$2
shift 2
export KERF_BACKEND="${KERF_BACKEND:-AUTO}"
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
mkdir "$work/tmp" "$work/scripts"
"$root/blender/zip" "$work/kerf_fracture.zip"
export BLENDER_USER_SCRIPTS="$work/scripts" BLENDER_USER_CONFIG="$work/config" TMPDIR="$work/tmp"
export PATH="$build/tools:$PATH" PYTHONPATH="$build/python" PYTHONDONTWRITEBYTECODE=1
blender -b --factory-startup --python-exit-code 1 \
  --python-expr "import bpy; bpy.ops.preferences.addon_install(filepath='$work/kerf_fracture.zip')" >"$work/log" 2>&1 || { cat "$work/log"; exit 1; }
case $kind in
  tools|module)
    KERF_BACKEND=$(echo "$kind" | tr '[:lower:]' '[:upper:]') \
      blender -b --factory-startup --python-exit-code 1 --python "$here/test_addon.py" -- "$@" ;;
  window)
    xvfb-run -a -s '-screen 0 800x600x24' \
      blender --factory-startup --python-exit-code 1 --enable-event-simulate --window-geometry 0 0 800 600 --python "$here/test_window.py"
    ;;
  compare)
    blender -b --factory-startup --python-exit-code 1 --python "$here/compare.py" -- "$@" | grep '^|' ;;
  *) echo "run.sh: unknown test $kind" >&2; exit 2 ;;
esac
