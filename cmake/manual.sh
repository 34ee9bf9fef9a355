#!/bin/sh
# A tool's manual page: what the tool says of its options, and the prose of its page in docs/tools as the description.
#   cmake/manual.sh TOOL PAGE.md >TOOL.1       needs lowdown, which turns Markdown into roff
set -eu
tool=$1 page=$2
prose=$(mktemp)
trap 'rm -f "$prose"' EXIT
sed -e 1d -e '/^## Synopsis/,$d' -e 's/^## /# /' "$page" | lowdown -tman | sed -e 's/^\.SH/.SS/' >"$prose"
"$tool" --describe man | sed -e "/^@DESCRIPTION@$/{
r $prose
d
}"
