#!/usr/bin/env bash
# Outputs appear whole or not at all: full disk, interruption, links, overwriting.
. "$(dirname "$0")/common.sh"
small="builtin:boxes --size 256x192 --map 32 --frames 1 -t hard"

# Nothing but what stands there already.
only() {
  [ "$(ls -A | grep -vxE 'out|err' | sort | tr '\n' ' ')" = "$1" ] || fail "files: '$(ls -A | tr '\n' ' ')' not '$1'"
}

# A disk that fills up: no file may grow beyond 2 KB.
limited() {
  local status=0
  (ulimit -f 2 && timeout 100 "$program" "$@" >out 2>err) || status=$?
  [ "$status" = 1 ] || fail "full disk: status $status: $*"
  [ "$(wc -l <err)" = 1 ] && grep -qE '^penumbra: cannot write .*: File too large' err || fail "full disk: $(cat err)"
}
limited render $small -o x.png
limited render $small -o x.exr
only ""
echo before >x.png
limited render $small -o x.png
[ "$(cat x.png)" = before ] || fail "an output was destroyed that could not be replaced"
only "x.png "

# Overwriting, also through a link, with the usual permissions.
run 0 render $small -o x.png
head -c 8 x.png | grep -q PNG || fail "not overwritten"
[ "$(stat -c %a x.png)" = "$(printf '%o' $((0666 & ~$(umask))))" ] || fail "permissions $(stat -c %a x.png)"
mkdir real
echo before >real/y.png
ln -s real/y.png y.png
run 0 render $small -o y.png
[ -L y.png ] && head -c 8 real/y.png | grep -q PNG || fail "a link was replaced instead of followed"
ln -s real/z.png z.png
run 0 render $small -o z.png
[ -L z.png ] && head -c 8 real/z.png | grep -q PNG || fail "a link to a new file was replaced instead of followed"

# Standard output that cannot be written.
status=0
"$program" list scenes >/dev/full 2>err || status=$?
[ "$status" = 1 ] && grep -q 'standard output' err || fail "full standard output: $status $(cat err)"
status=0
"$program" render $small -o x.png --json - >/dev/full 2>err || status=$?
[ "$status" = 1 ] || fail "full standard output with --json -: $status"

# A cache folder without room (a file system of 0 bytes) costs the driver its cache, not the run.
XDG_CACHE_HOME=/proc run 0 render $small -o x.png --verbose
grep -q "shader cache is off" err || fail "no word about the driver's cache: $(cat err)"
XDG_CACHE_HOME=relative run 0 render $small -o x.png
[ ! -e relative ] || fail "a relative XDG_CACHE_HOME was used"

# Ctrl-C in the middle of a frame that takes long: 130 within a second, nothing left behind.
rm -rf ./*
cat >interrupt.py <<'PY'
import subprocess, sys, time, signal
p = subprocess.Popen([sys.argv[1], "render", "builtin:balls", "-t", "average:samples=60000", "-o", "z.png"],
                     stderr=subprocess.PIPE,
                     preexec_fn=lambda: signal.signal(signal.SIGINT, signal.default_int_handler))
time.sleep(2.5)
assert p.poll() is None, "ended by itself: %r" % p.returncode
start = time.time()
p.send_signal(signal.SIGINT)
status = p.wait(10)
assert status == 130, "status %r" % status
# A sanitizer's own memory takes the system its time to take back.
assert time.time() - start < float(sys.argv[2]), "took %.1f s" % (time.time() - start)
assert p.stderr.read() == b"", "said something"
PY
if command -v python3 >/dev/null; then
  patience=1
  ldd "$program" | grep -q libasan && patience=8
  python3 interrupt.py "$program" $patience || fail "interrupt"
  rm -f interrupt.py
  only ""
fi
finish
