#!/usr/bin/env bash
# Every file of Debian's assimp-testmodels: a picture, or one clear line; nothing crashes, nothing outlasts its bound.
models=/usr/share/assimp/models
[ -d "$models" ] || exit 77
. "$(dirname "$0")/common.sh"
pictures=0
while IFS= read -r file; do
  status=0
  timeout 60 "$program" render "$file" --size 32x24 --map 32 --frames 1 -t hard -o x.png >out 2>err || status=$?
  errors=$(grep -cv '^penumbra: warning: ' err)
  case $status in
    0)
      pictures=$((pictures + 1))
      [ -s x.png ] && [ "$errors" = 0 ] || fail "$file: $(cat err)"
      ;;
    2)
      [ ! -e x.png ] && [ "$errors" = 1 ] && grep -qF "penumbra: $file: " err || fail "$file: $(cat err)"
      case $file in */invalid/*) [ "$(wc -l <err)" = 1 ] || fail "$file: more than one line" ;; esac
      ;;
    *) fail "$file: status $status: $(cat err)" ;;
  esac
  rm -f x.png
done < <(find "$models" -type f | sort)
echo "$pictures pictures"
[ "$pictures" -ge 250 ] || fail "only $pictures pictures"
finish
