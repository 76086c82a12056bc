# What Doxygen reads in place of a header. Comments of ours are plain text; lines set in by three spaces are equations, which
# stay as they are. A comment at the margin with nothing below it, or a namespace, is about the file.
/^ *\/\/\/( |$)/ { block[++n] = $0; next }
{ write_block(); print }
END { write_block() }

function write_block(   k, head, text, verbatim) {
  if (!n) return
  match(block[1], /^ *\/\/\//)
  head = substr(block[1], 1, RLENGTH)
  if (head == "///" && ($0 == "" || $0 ~ /^namespace/)) print head " \\file"
  for (k = 1; k <= n; ++k) {
    text = substr(block[k], length(head) + 1)
    if ((text ~ /^   /) != verbatim) { verbatim = !verbatim; print head (verbatim ? " \\verbatim" : " \\endverbatim") }
    if (!verbatim) gsub(/[\\@<>#&%"$]/, "\\\\&", text)
    print head text
  }
  if (verbatim) print head " \\endverbatim"
  n = 0
}
