#!/usr/bin/env bash
# penumbra compare, end to end: the same bytes twice and with one processor, its files, its cache, its refusals.
#   compare.sh PROGRAM
set -u
program=$1
work=$(mktemp -d) || exit 1
trap 'chmod -R u+rwx "$work"; rm -rf "$work"' EXIT
cd "$work" || exit 1
export XDG_CACHE_HOME=$work/cache
failures=0

fail() {
  echo "FAILED: $*"
  failures=$((failures + 1))
}

# run STATUS ARGUMENTS...: standard output to out, standard error to err
run() {
  local expected=$1 status
  shift
  "$program" "$@" >out 2>err
  status=$?
  [ "$status" -eq "$expected" ] || fail "status $status, not $expected: penumbra $*: $(head -3 err)"
}

# The one line on stderr says this.
says() {
  [ "$(wc -l <err)" -eq 1 ] || fail "not one line on stderr: $(cat err)"
  grep -q -- "$1" err || fail "stderr does not say '$1': $(cat err)"
}

without_times() { # median, min, max and stages are times
  sed -e '/"stages"/,/}/d' -e '/"\(time_ms\|median\|min\)":/d' -e '/"total"/,/}/d' "$1"
}

scene=(builtin:square --size 160x120 --reference-samples 64 --frames 1 -t hard -t pcss:samples=4)

echo "== twice, from the cache and traced again, with one processor"
run 0 compare "${scene[@]}" --save-dir a --json a.json -o a.png --html a.html
[ -s err ] && fail "a word on stderr: $(cat err)"
grep -q "million rays a second" out || fail "not traced: $(cat out)"
run 0 compare "${scene[@]}" --save-dir b --json b.json
grep -q "from the cache" out || fail "not from the cache: $(cat out)"
taskset -c "$(taskset -pc $$ | sed 's/.*: *\([0-9]*\).*/\1/')" "$program" \
  compare "${scene[@]}" --no-cache --save-dir c --json c.json >out 2>err ||
  fail "with one processor: $(cat err)"
grep -q "million rays a second" out || fail "--no-cache was not traced: $(cat out)"
expected="01-hard.exr 02-pcss-samples=4.exr mask.exr normal.exr position.exr reference.exr"
[ "$(cd a && echo *)" = "$expected" ] || fail "save-dir holds $(cd a && echo *)"
for name in $expected; do
  cmp -s "a/$name" "b/$name" && cmp -s "a/$name" "c/$name" || fail "$name differs"
done
for other in b c; do
  diff <(without_times a.json) <(without_times $other.json) >/dev/null || fail "$other.json differs in more than times"
done
grep -q '"label":.*"pcss:samples=4"' a.json || fail "label"
grep -q '"file":.*"02-pcss-samples=4.exr"' a.json || fail "file"
head -c 8 a.png | cmp -s - <(printf '\x89PNG\r\n\x1a\n') || fail "the sheet is no PNG"
for line in a/reference.exr a.png a.html a.json; do
  "$program" compare "${scene[@]}" --save-dir a --json a.json -o a.png --html a.html 2>err | grep -qx "$line" ||
    fail "$line is not printed"
done

echo "== JSON on standard output stands alone"
run 0 compare "${scene[@]}" --json -
[ "$(head -c 1 out)" = "{" ] && [ "$(tail -c 2 out)" = "}" ] || fail "not only JSON: $(head -3 out)"
grep -q '"file":.*null' out || fail "a file that was not saved has a name"

echo "== techniques"
run 0 compare "${scene[@]:0:7}" --json -
grep -q '"average"' out && fail "average ran without being asked for"
for name in $("$program" list techniques | awk '{print $1}'); do
  [ "$name" = average ] || grep -q "\"technique\":.*\"$name\"" out || fail "$name did not run"
done

echo "== a cache that cannot be used is ignored with one warning, a damaged file never believed"
entry=$(ls cache/penumbra/reference/*.visibility | head -1)
run 0 compare "${scene[@]}" --save-dir d
for entry in cache/penumbra/reference/*.visibility; do
  printf 'x' | dd of="$entry" bs=1 seek=500 conv=notrunc 2>/dev/null
done
run 0 compare "${scene[@]}" --save-dir d
says damaged
cmp -s a/reference.exr d/reference.exr || fail "a damaged cache was believed"
XDG_CACHE_HOME=/dev/null run 0 compare "${scene[@]}" --save-dir d
says "/dev/null"
cmp -s a/reference.exr d/reference.exr || fail "without a cache the reference differs"
(unset XDG_CACHE_HOME HOME; "$program" compare "${scene[@]}" >out 2>err) || fail "without HOME: $(cat err)"
says "no cache directory"

echo "== nothing to measure"
run 0 compare "${scene[@]}" --light-center 0,-5,0 --light-target 0,-9,0 --json - -o dark.png --html dark.html
grep -q '"mae":.*null' out || fail "undefined errors are not null"
grep -q '"pixels":.*0' out || fail "shadow pixels in the dark"
run 0 compare "${scene[@]}" --camera-target 0,99,0 --camera-position 0,50,0 --camera-up 1,0,0 --json - -o sky.png

echo "== refusals"
run 2 compare "${scene[@]}" --reference-samples 17
says "square number"
run 2 compare "${scene[@]}" --reference-samples 0
run 2 compare "${scene[@]}" --reference-samples 66049
run 2 compare "${scene[@]}" --reference-samples x
run 2 compare "${scene[@]}" -o sheet.exr
says "sheet.exr"
run 2 compare
run 2 compare missing.obj
run 2 compare "${scene[@]}" -t nothing
run 1 compare "${scene[@]}" -o missing/sheet.png
says "missing/sheet.png"
run 1 compare "${scene[@]}" --html missing/page.html
run 1 compare "${scene[@]}" --save-dir a.png
says "a.png"
run 1 compare "${scene[@]}" --save-dir missing/dir
ln -s /dev/full full.png
for option in -o --html --json; do
  run 1 compare "${scene[@]}" $option full.png
  says "full.png"
done
[ -e sheet.exr ] && fail "a refused file exists"

echo "== interrupted"
"$program" compare builtin:balls --no-cache --reference-samples 65536 --frames 1 -t hard -o never.png \
  --save-dir never >out 2>err &
child=$!
sleep 2
begun=$SECONDS
kill -INT $child
wait $child
status=$?
[ $status -eq 130 ] || fail "interrupted: status $status: $(cat err)"
[ $((SECONDS - begun)) -le 5 ] || fail "interrupted: it went on for $((SECONDS - begun)) s"
[ -e never.png ] && fail "an interrupted run left its sheet"
[ -z "$(ls -A never 2>/dev/null)" ] || fail "an interrupted run left $(ls -A never)"
[ -z "$(ls -A | grep '\.[A-Za-z0-9]\{6\}$')" ] || fail "temporary files: $(ls -A)"

[ $failures -eq 0 ] && echo "all passed"
[ $failures -eq 0 ]
