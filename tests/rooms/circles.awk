# Input: node TAB node TAB why. Prints every circle with its members and the arrows between them; nothing where there is
# none.
function walk(from, at,    list, i, count) {
  if ((from, at) in reaches) return
  reaches[from, at] = 1
  count = split(next_of[at], list, "\t")
  for (i = 1; i <= count; i++) walk(from, list[i])
}

function in_circle(a, b) { return (a, b) in reaches && (b, a) in reaches }

function show(first,    i, list, members) {
  members = 0
  for (i = 1; i <= nodes; i++)
    if (in_circle(first, node[i])) {
      list = list (members++ ? ", " : "") node[i]
      shown[node[i]] = 1
    }
  print "a circle of " members ": " list
  for (i = 1; i <= edges; i++)
    if (in_circle(first, from_of[i]) && in_circle(first, to_of[i]))
      print "  " from_of[i] " -> " to_of[i] " (" why[from_of[i], to_of[i]] ")"
}

function add(name) {
  if (name in is_node) return
  is_node[name] = 1
  node[++nodes] = name
}

$1 != $2 {
  add($1)
  add($2)
  if (($1, $2) in why) {
    if (many[$1, $2]++ < 3) why[$1, $2] = why[$1, $2] ", " $3
    if (many[$1, $2] == 4) why[$1, $2] = why[$1, $2] ", ..."
    next
  }
  why[$1, $2] = $3
  from_of[++edges] = $1
  to_of[edges] = $2
  next_of[$1] = next_of[$1] ($1 in next_of && next_of[$1] != "" ? "\t" : "") $2
}

END {
  # A node reaches itself only by way of another.
  for (i = 1; i <= edges; i++) walk(from_of[i], to_of[i])
  for (i = 1; i <= nodes; i++)
    if (!(node[i] in shown) && (node[i], node[i]) in reaches) show(node[i])
}
