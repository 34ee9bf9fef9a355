# Sourced by tests that ask tools many things: what they must say, in words or when they refuse. Ends in `exit $failed`.
failed=0
fail() { echo "FAILED: $*"; failed=1; }
# says PATTERN COMMAND...: exit code 0, and a line of the output has the pattern.
says() {
  local pattern=$1 said
  shift
  said=$("$@" 2>&1) || fail "$* exits with $?: $said"
  grep -qE -e "$pattern" <<<"$said" || fail "$* does not say '$pattern' but: $said"
}
# refuses CODE PATTERN COMMAND...
refuses() {
  local code=$1 pattern=$2 said
  shift 2
  said=$("$@" 2>&1 >/dev/null)
  [ $? = "$code" ] || fail "$* does not exit with $code: $said"
  grep -qE -e "$pattern" <<<"$said" || fail "$* does not say '$pattern' but: $said"
}
