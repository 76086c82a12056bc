# What Doxygen reads in place of a header, line by line. Comments of ours are plain text with words in `code`; lines set in by
# three spaces are equations, which stay as they are. A comment at the margin with nothing below it, or a namespace, is about
# the file.
/^ *\/\/\/( |$)/ { block[++n] = $0; next }
{ write_block(); print }
END { write_block() }

function write_block(   k, text, equation, before, after) {
  if (!n) return
  match(block[1], /^ *\/\/\//)
  after = (RLENGTH == 3 && ($0 == "" || $0 ~ /^namespace/) ? " \\file" : "") " */"
  for (k = 1; k <= n; ++k) {
    text = block[k]
    before = k == 1 ? "/** " : ""
    sub(/^ *\/\/\//, "", text)
    gsub(/\*\//, "* /", text)
    if ((text ~ /^   /) != equation) { equation = !equation; before = before (equation ? "\\verbatim " : "\\endverbatim ") }
    if (equation) sub(/^   /, "", text)
    else {
      gsub(/[\\@<>#&%"$]/, "\\\\&", text)
      while (match(text, /`([^`.]|[.][A-Za-z0-9])+`/))   # another point ends the sentence that is shown first
        text = substr(text, 1, RSTART - 1) "<code>" substr(text, RSTART + 1, RLENGTH - 2) "</code>" substr(text, RSTART + RLENGTH)
    }
    print before text (k < n ? "" : (equation ? " \\endverbatim" : "") after)
  }
  n = 0
}
