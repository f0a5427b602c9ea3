# What the command line's tests share: a folder of their own, and three assertions. $1 of each test is the program.
set -u
program=$1
shift
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder" || exit 1
failures=0

fail() {
  echo "FAILED: $*"
  failures=$((failures + 1))
}

# run STATUS ARGS...: runs the program, keeps stdout in out and stderr in err.
run() {
  local wanted=$1 status=0
  shift
  timeout 100 "$program" "$@" >out 2>err || status=$?
  [ "$status" = "$wanted" ] || fail "status $status, not $wanted: penumbra $* :: $(cat err)"
}

# rejected STATUS PATTERN ARGS...: exactly one line on stderr that matches, nothing on stdout, nothing written.
rejected() {
  local wanted=$1 pattern=$2 before after
  shift 2
  before=$(ls -A)
  run "$wanted" "$@"
  after=$(ls -A)
  [ "$(wc -l <err)" = 1 ] || fail "not one line: penumbra $* :: $(cat err)"
  grep -qE "^penumbra: .*$pattern" err || fail "no '$pattern': penumbra $* :: $(cat err)"
  [ ! -s out ] || fail "stdout: penumbra $* :: $(head -3 out)"
  [ "$(echo "$before" | grep -vxE 'out|err')" = "$(echo "$after" | grep -vxE 'out|err')" ] ||
    fail "left files: penumbra $* :: $after"
}

finish() {
  echo "$failures failures"
  [ "$failures" = 0 ]
  exit
}
