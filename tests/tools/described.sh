#!/bin/bash
# What tools say of themselves: completion that bash takes and that offers every option of --help, choices after an option that has
# them; zsh's, tried in one (where zsh is); manual pages with all their parts.   described.sh BUILD_DIR
set -euo pipefail
build=$1
fail() { echo "FAILED: $*" >&2; exit 1; }

for script in "$build"/share/bash-completion/completions/*; do
  name=$(basename "$script")
  tool=$build/tools/$name
  # shellcheck disable=SC1090
  source "$script"
  complete() {  # the words so far: what is offered for the last one
    COMP_WORDS=("$@") COMP_CWORD=$(($# - 1)) COMPREPLY=()
    "_${name//-/_}"
    echo "${COMPREPLY[*]}"
  }
  offered=" $(complete "$name" -) "
  "$tool" --help | grep -oE '^ +(-[a-z],)?--[a-z-]+' | grep -oE -- '--[a-z-]+' | while read -r option; do
    [[ $offered == *" $option "* ]] || fail "$name: bash is not offered $option"
  done
if command -v zsh >/dev/null; then
  made=$(timeout 60 zsh -f "$(dirname "$0")/completes.zsh" "$build/share/zsh/vendor-completions" "kerf-score --jag")
  [ "$made" = "kerf-score --jagged " ] || fail "zsh makes '$made' of 'kerf-score --jag'"
fi
  [ "$(complete "$name" --progress n)" = never ] || fail "$name --progress n: '$(complete "$name" --progress n)'"
  unset -f complete
  if command -v zsh >/dev/null; then
    folder=$build/share/zsh/vendor-completions
    zsh -n "$folder/_$name" || fail "$name: zsh"
    made=$(timeout 60 zsh -f "$(dirname "$0")/completes.zsh" "$folder" "$name --progress al")
    [ "$made" = "$name --progress always " ] || fail "$name: zsh makes '$made' of '$name --progress al'"
  fi
  page=$build/share/man/man1/$name.1
  if command -v lowdown >/dev/null; then
    for part in NAME SYNOPSIS DESCRIPTION OPTIONS EXAMPLES "EXIT STATUS"; do grep -qx ".SH $part" "$page" || fail "$page has no $part"; done
if command -v zsh >/dev/null; then
  made=$(timeout 60 zsh -f "$(dirname "$0")/completes.zsh" "$build/share/zsh/vendor-completions" "kerf-score --jag")
  [ "$made" = "kerf-score --jagged " ] || fail "zsh makes '$made' of 'kerf-score --jag'"
fi
    sed -n '/^\.SH DESCRIPTION/,/^\.SH OPTIONS/p' "$page" | grep '^[A-Z][a-z]' >/dev/null || fail "$page: DESCRIPTION is empty"
    ! grep -q '^@' "$page" || fail "$page has a place left open"
  fi
  code=0; "$tool" --describe fish 2>/dev/null >&2 || code=$?
  [ $code = 2 ] || fail "$name --describe fish ended with $code, not 2"
done
if command -v zsh >/dev/null; then
  made=$(timeout 60 zsh -f "$(dirname "$0")/completes.zsh" "$build/share/zsh/vendor-completions" "kerf-score --jag")
  [ "$made" = "kerf-score --jagged " ] || fail "zsh makes '$made' of 'kerf-score --jag'"
fi
