# Prints where a C source names GL: a call of gl...() or GL(), a GL_ constant, a GL type. Comments and strings may.
BEGIN {
  types = "enum|boolean|bitfield|byte|short|int|sizei|ubyte|ushort|uint|half|float|clampf|double|clampd|char|int64"
  types = types "|uint64|sync|intptr|sizeiptr|fixed|void"
  named = "[^A-Za-z0-9_](GL[ \t]*\\(|gl[A-Z][A-Za-z0-9]*[ \t]*\\(|GL_[A-Z0-9_]+|GL(" types ")[^A-Za-z0-9_])"
}

function strip(line,    out, at, rest) {
  out = ""
  while (line != "") {
    if (in_comment) {
      at = index(line, "*/")
      if (!at) return out
      line = substr(line, at + 2)
      in_comment = 0
    } else if (match(line, /\/\*|\/\/|"|'/)) {
      out = out substr(line, 1, RSTART - 1) " "
      rest = substr(line, RSTART)
      if (rest ~ /^\/\//) return out
      if (rest ~ /^\/\*/) {
        in_comment = 1
        line = substr(rest, 3)
      } else if (match(rest, rest ~ /^"/ ? "^\"(\\\\.|[^\"\\\\])*\"" : "^'(\\\\.|[^'\\\\])*'")) {
        line = substr(rest, RLENGTH + 1)
      } else {
        line = substr(rest, 2)
      }
    } else {
      return out line
    }
  }
  return out
}

{
  text = " " strip($0) " "
  found = ""
  while (match(text, named)) {
    token = substr(text, RSTART + 1, RLENGTH - 1)
    gsub(/[ \t(),;*]+$/, "", token)
    if (!index(" " found " ", " " token " ")) found = found (found == "" ? "" : " ") token
    text = substr(text, RSTART + RLENGTH - 1)
  }
  if (text ~ /#[ \t]*include[ \t]*<(epoxy|GL|GLES[23]|KHR)\//) found = found (found == "" ? "" : " ") "#include"
  if (found != "") print FILENAME ":" FNR ": " found
}
