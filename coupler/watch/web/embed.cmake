# Writes SOURCE: the files of the page in PAGE as arrays of bytes, with the colours of COLOURS in its style sheet.
#   cmake -DSOURCE=page.cpp -DPAGE=coupler/watch/page -DCOLOURS=coupler/report/colours.css -P embed.cmake
set(arrays)
set(entries)
set(n 0)
function(embed name type)
  set(hex)
  foreach(path IN LISTS ARGN)
    file(READ ${path} piece HEX)
    string(APPEND hex ${piece})
  endforeach()
  string(REGEX REPLACE "(..)" "\\\\x\\1" text "${hex}")
  set(arrays "${arrays}constexpr char file_${n}[] =\n    \"${text}\";\n" PARENT_SCOPE)
  set(entries "${entries}    {\"${name}\", \"${type}\", std::string_view(file_${n}, sizeof file_${n} - 1)},\n" PARENT_SCOPE)
  math(EXPR n "${n} + 1")
  set(n ${n} PARENT_SCOPE)
endfunction()
embed("" "text/html; charset=utf-8" ${PAGE}/index.html)
embed("page.js" "text/javascript; charset=utf-8" ${PAGE}/bundle/page.js)
embed("page.css" "text/css; charset=utf-8" ${COLOURS} ${PAGE}/bundle/uplot.css ${PAGE}/page.css)
file(WRITE ${SOURCE}.part "// Made from coupler/watch/page.
#include \"coupler/watch/web/http_api.hpp\"

namespace strake::watch {
namespace {

${arrays}
constexpr PageFile files[] = {
${entries}};

}  // namespace

std::span<const PageFile> page_files() {
  return files;
}

}  // namespace strake::watch
")
file(RENAME ${SOURCE}.part ${SOURCE})
