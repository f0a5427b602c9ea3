# Input: the table of rooms, then unit TAB unit TAB why. Prints each arrow that the table does not allow, each unit that
# it has no room for, and each circle in the table itself.
function words(text, out) { return split(text, out, /[ \t]+/) }

function trim(text) {
  gsub(/^[ \t]+|[ \t]+$/, "", text)
  return text
}

# room | files | rooms it may use; * for all that are above it
function read_room(line,    part, list, i, count, above) {
  split(line, part, "|")
  if (trim(part[1]) != "") name = trim(part[1]) # else the row before goes on
  count = words(trim(part[2]), list)
  for (i = 1; i <= count; i++) room_of[list[i]] = name
  count = words(trim(part[3]), list)
  for (i = 1; i <= count; i++) allowed[name, list[i]] = 1
  if ((name, "*") in allowed)
    for (above in rank)
      if (above != name) allowed[name, above] = 1
  if (!(name in rank)) rank[name] = ++rooms
  for (i = 1; i <= count; i++)
    if (list[i] != "*" && (!(list[i] in rank) || list[i] == name))
      print FILENAME ":" FNR ": " name " may use " list[i] ", which is not above it in the table"
}

# The unit's own entry, else that of its folder, of each folder around that; DIR/*/ makes a room of each folder in DIR.
# Sets place too: two rooms of one entry have the same name and different places.
function find_room(unit,    path, parent) {
  place = path = unit
  while (path != "" && !(path in room_of)) {
    sub(/[^\/]*\/?$/, "", path)
    place = path
    if (path in room_of) break
    parent = path
    sub(/[^\/]*\/$/, "", parent)
    if (parent "*/" in room_of) return room_of[parent "*/"]
  }
  if (path == "") return ""
  place = room_of[path]
  return place
}

FNR == 1 { file++ }
file == 1 {
  sub(/#.*/, "")
  if (/[|]/) read_room($0)
  next
}
{
  from = find_room($1)
  from_place = place
  to = find_room($2)
  if (from == "" || to == "") {
    homeless = from == "" ? $1 : $2
    if (!told[homeless]++) print homeless ": the table has no room for it"
  } else if (from_place != place && !((from, to) in allowed)) {
    print from " may not use " to ": " $1 " -> " $2 " (" $3 ")"
  }
}
END {
  if (!rooms) {
    print "the table has no rooms" > "/dev/stderr"
    exit 2
  }
}
