# Input: the public header, then nm -A -P -g of the static library. Prints each outside name that is not pni_..., nor
# pn_... and declared in the header, and each that the header declares and nothing defines.
FNR == 1 { file++ }
file == 1 {
  if (/PN_API/) declaring = 1
  if (declaring && match($0, /(^|[^a-z_0-9])pn_[a-z_0-9]+\(/)) {
    name = substr($0, RSTART, RLENGTH - 1)
    sub(/^[^p]/, "", name)
    declared[name] = FNR
    declaring = 0
  }
  next
}
{
  sub(/^.*[\/\[]/, "") # lib.a[gpu.c.o]: and a path before it
  sub(/\]:/, ":")
}
$3 ~ /^[A-TV-Z]$/ {
  defined[$2] = 1
  if ($2 ~ /^pni_/ || $2 in declared) next
  print $1 " " $2 ($2 ~ /^pn_/ ? " is not declared in the public header" : " begins with neither pn_ nor pni_")
}
END {
  for (name in declared)
    if (!(name in defined)) print name " is declared in the public header, and nothing defines it"
}
