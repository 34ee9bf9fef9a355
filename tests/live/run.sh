#!/bin/sh
# kerf-live's page in headless Chromium.
#   tests/live/run.sh TOOLS_DIR SAMPLES_DIR polyp|apple|jello|model|scalpel|wound|pin|broken|sliders|reconnect|paused|press|first|path|late|steps|hold|look|gone|drop|keys|begin|guide|
#     bodies|gape|solids|images|stress|lasso|clamp|follow|record|twice
set -eu
here=$(dirname "$(realpath "$0")")
tools=$(realpath "$1")
PATH=$tools:$(realpath "$2"):$PATH
export PYTHONDONTWRITEBYTECODE=1
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
case $3 in
  polyp | model | scalpel | wound | reconnect | paused | first | path | late | look | gone | drop | keys | guide | bodies | gape | solids | images | follow | record) kerf-model polyp --frequency 8 -o "$work/polyp.ply" ;;
  apple) kerf-model apple -o "$work/apple.ply" ;;
  press) kerf-model block --edge 0.12 -o "$work/press.ply" && kerf-model sphere --frequency 12 -o "$work/ball.ply" ;;
  jello | pin | broken | sliders | steps | hold | stress | lasso | clamp | twice) kerf-model block --edge 0.08 -o "$work/jello.ply" ;;
esac
case $3 in
  polyp | apple | jello) check=check_live.py ;;
  first | path | late | steps | hold | look | gone | drop | keys | begin | guide) check=check_newcomer.py ;;
  bodies | gape | solids | images | stress | lasso | clamp | follow | record | twice) check=check_look.py ;;
  *) check=check_controls.py ;;
esac
python3 "$here/$check" "$tools" "$here/../../samples/scenes" "$work" "$3"
