# Input: nm -A -P -g. Prints unit TAB unit TAB symbol where one object file uses what another defines. A unit is named
# by its source, as CMake names objects: build/CMakeFiles/TARGET.dir/src/gl/gpu.c.o and lib.a[gpu.c.o] come from gl/gpu
# and gpu.
function unit(object) {
  if (object ~ /\]$/) gsub(/^.*\[|\]$/, "", object)
  sub(/CMakeFiles\/[^\/]*\.dir\//, "", object)
  gsub(/\/\.\//, "/", object)
  if (!sub(/^.*\/(src|app)\//, "", object)) sub(/^.*\/generated\//, "generated/", object)
  sub(/(\.c)?\.o$/, "", object)
  return object
}

# "path: symbol type value size"; a path may have blanks.
{
  at = index($0, ": ")
  split(substr($0, at + 2), field, " ")
  symbol = field[1]
  if (field[2] ~ /^[A-TV-Z]$/) defined_in[symbol] = unit(substr($0, 1, at - 1))
  if (field[2] ~ /^[Uvw]$/) {
    user[++count] = unit(substr($0, 1, at - 1))
    used[count] = symbol
  }
}

END {
  for (i = 1; i <= count; i++)
    if (used[i] in defined_in && defined_in[used[i]] != user[i]) print user[i] "\t" defined_in[used[i]] "\t" used[i]
}
