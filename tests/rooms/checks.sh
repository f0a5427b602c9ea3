#!/bin/sh
# checks.sh FOLDER: each check of rooms.sh passes a small house in FOLDER, and names what is wrong once something is.
set -u
rooms=$(cd "$(dirname "$0")" && pwd)/rooms.sh
rm -rf "$1"
mkdir -p "$1" && cd "$1" || exit 2
wrong=0

# says STATUS TEXT CHECK...: the check ends with this status, and one of its lines has this text.
says() {
  status=$1 text=$2
  shift 2
  "$rooms" "$@" >out 2>&1
  got=$?
  if [ $got -ne "$status" ] || { [ -n "$text" ] && ! grep -qF -- "$text" out; }; then
    echo "rooms.sh $*: status $got instead of $status, or not '$text' in:"
    sed 's/^/  /' out
    wrong=1
  fi
}

compile() {
  : >objects
  for unit in low/a low/b high/c tool/one/d tool/two/e; do
    mkdir -p "build/CMakeFiles/house.dir/src/${unit%/*}"
    "${CC:-cc}" -Isrc -c "src/$unit.c" -o "build/CMakeFiles/house.dir/src/$unit.c.o" || exit 2
    echo "build/CMakeFiles/house.dir/src/$unit.c.o" >>objects
  done
  rm -f libhouse.a
  ar rc libhouse.a build/CMakeFiles/house.dir/src/*/*.o build/CMakeFiles/house.dir/src/*/*/*.o
}

mkdir -p src/low src/high src/tool/one src/tool/two
echo 'int pni_a(void);' >src/low/a.h
printf '#include "low/a.h"\nint pni_a(void) { return 1; }\n' >src/low/a.c
printf '#include "low/a.h"\nint pni_b(void);\n' >src/low/b.h
printf '#include "b.h"\nint pni_b(void) { return pni_a(); }\n' >src/low/b.c
printf '#include "low/b.h"\nint pn_c(void);\nint pn_c(void) { return pni_b(); }\n' >src/high/c.c
printf '#include "low/a.h"\nint pni_d(void);\nint pni_d(void) { return pni_a(); }\n' >src/tool/one/d.c
printf 'int pni_e(void);\nint pni_e(void) { return 2; }\n' >src/tool/two/e.c
echo '#include "low/y.glsl"' >src/low/x.glsl
echo 'float y;' >src/low/y.glsl
printf '#define PN_API\nPN_API int pn_c(void);\n' >public.h
printf 'low | low/a |\n | low/ |\ntool | tool/*/ | low\nhigh | high/c | low tool # all\n' >table
compile
says 0 '' includes src
says 0 '' symbols objects
says 0 '' arrows src table objects
says 0 '' gl src low
says 0 '' names libhouse.a public.h
says 0 '' columns .
says 2 'no sources in' includes nowhere
says 2 'no sources in' gl nowhere low
says 2 '' symbols nowhere

# Circles: of a header with a source, of shaders, of symbols alone.
printf '#include "low/b.h"\nint pni_a(void) { return 1; }\n' >src/low/a.c
says 1 'low/a -> low/b (src/low/a.c:1)' includes src
printf 'int pni_a(void) { return 1; }\n' >src/low/a.c
says 0 '' includes src
printf '\n#include "x.glsl"\n' >src/low/y.glsl
says 1 'low/y.glsl -> low/x.glsl (src/low/y.glsl:2)' includes src
says 1 'a circle of 2: ' includes src
echo 'float y;' >src/low/y.glsl
printf 'int pni_c2(void);\nint pni_a(void) { return pni_c2(); }\n' >src/low/a.c
printf '#include "low/b.h"\nint pni_c2(void) { return 0; }\nint pn_c(void) { return pni_b(); }\n' >src/high/c.c
compile
says 1 'low/a -> high/c (pni_c2)' symbols objects
says 1 'a circle of 3: ' symbols objects

# Arrows: upwards by a symbol, between two rooms of one entry by an include, from and to where there is no room.
says 1 'low may not use high: low/a -> high/c (pni_c2)' arrows src table objects
printf '#include "tool/one/d.h"\n' >src/tool/two/e.h
: >src/tool/one/d.h
says 1 'tool may not use tool: tool/two/e -> tool/one/d (src/tool/two/e.h:1)' arrows src table
printf 'low | low/ |\ntool | tool/*/ | low\n' >part
says 1 'high/c: the table has no room for it' arrows src part
printf 'low | low/ | high\nhigh | high/ | low\ntool | tool/ |\n' >part
says 1 'low may use high, which is not above it' arrows src part
printf 'low | low/ |\ntool | tool/*/ | *\nhigh | high/c | *\n' >all
says 1 'tool may not use tool: tool/two/e -> tool/one/d (src/tool/two/e.h:1)' arrows src all

# GL: a call, a macro, a constant, a type, a header; comments and strings are none.
cat >src/high/d.h <<'END'
int glow(int globe); // glClear(GL_COLOR)
/* GLuint
   glFinish() */ const char *s = "glEnd()\" GL_X"; char c = '"';
END
says 0 '' gl src low
for text in 'glFinish()' 'x = GL (Enable)(1)' 'int i = GL_RED;' 'GLuint i;' '#include <epoxy/gl.h>' \
  '/* */ glFinish ();'; do
  printf '\n%s\n' "$text" >src/high/d.h
  says 1 'src/high/d.h:2: ' gl src low
done

# Names: one that is neither, one that the header lacks, one that is not there.
printf 'int c(void) { return 0; }\nint pn_d(void) { return 0; }\n' >src/high/c.c
compile
says 1 'c.c.o: c begins with neither pn_ nor pni_' names libhouse.a public.h
says 1 'c.c.o: pn_d is not declared in the public header' names libhouse.a public.h
says 1 'pn_c is declared in the public header, and nothing defines it' names libhouse.a public.h

# Columns are counted in characters.
printf '%0119d\n%0118d\303\266\303\266\n%0121d\n' 0 0 0 >src/high/d.h
says 1 'src/high/d.h:3: longer than 120 columns' columns .
[ "$(wc -l <out)" -eq 1 ] || { cat out; wrong=1; }
exit $wrong
