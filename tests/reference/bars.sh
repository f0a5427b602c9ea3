#!/usr/bin/env bash
# What compare must find on the bunny in the standard set-up with --split.
#   bars.sh PROGRAM ratio     pcss beats hard by 2.5 in mean absolute error
#   bars.sh PROGRAM average   1024 hard shadow maps, a truth of their own, agree with the reference within 0.004
set -u
program=$1
bunny=/usr/share/glmark2/models/bunny.obj
[ -r $bunny ] || { echo "no $bunny"; exit 77; }
work=$(mktemp -d) || exit 1
trap 'rm -rf "$work"' EXIT

mean() { # of the Nth result
  grep '"mae"' "$work/out.json" | sed -n "$1p" | sed 's/.*:[[:space:]]*//; s/,//'
}
holds() { # AWK CONDITION WITH a AND b
  awk -v a="$1" -v b="$2" "BEGIN { exit !($3) }" || { echo "FAILED: $3 with a = $1, b = $2"; exit 1; }
}
case $2 in
ratio)
  "$program" compare $bunny --split --size 512x384 --reference-samples 256 --frames 1 --no-cache -t hard -t pcss \
    --json "$work/out.json" || exit 1
  holds "$(mean 1)" "$(mean 2)" "a > 0 && b > 0 && a / b >= 2.5"
  ;;
average)
  "$program" compare $bunny --split --size 512x384 --map 1024 --frames 1 --no-cache -t average:samples=1024 \
    --json "$work/out.json" || exit 1
  holds "$(mean 1)" 0.004 "a > 0 && a <= b"
  ;;
esac
