# Standard input: paths of sources below folder. Prints unit TAB unit TAB why for each include of one by another; an
# include in quotes is looked for beside the file and from the folder.
function unit(path) {
  sub(/\.[ch]$/, "", path)
  return path
}

function read_includes(path,    number, line, target, beside, where) {
  where = folder path
  beside = path
  if (!sub(/[^\/]*$/, "", beside)) beside = ""
  number = 0
  while ((getline line < where) > 0) {
    number++
    if (line !~ /^[ \t]*#[ \t]*include[ \t]*"/) continue
    target = line
    sub(/^[^"]*"/, "", target)
    sub(/".*/, "", target)
    if (beside target in known)
      target = beside target
    else if (!(target in known))
      continue
    if (unit(target) != unit(path)) print unit(path) "\t" unit(target) "\t" where ":" number
  }
  close(where)
}

{
  path = substr($0, length(folder) + 1)
  known[path] = 1
  order[++count] = path
}

END {
  for (i = 1; i <= count; i++) read_includes(order[i])
}
