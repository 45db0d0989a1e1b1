# Builds the pages of web/ with the npm packages that are installed there. ./run and ./test source this file.

# build_report_page: makes the page of a report, without data, at the place where the program looks for it. Does nothing
# if the page is up to date.
build_report_page() {
  local page=$root/build/share/chronormal/report.html
  if [ -e "$page" ] && [ -z "$(find "$root/web/src" "$root/web/build.mjs" "$root/web/package-lock.json" "$root/js/src/drive.js" -newer "$page")" ]; then return 0; fi
  install_npm web || return 1
  say "building ${page#"$PWD/"}"
  node "$root/web/build.mjs" report "$page" >&2
}

# build_page PRESET: makes the page that contains the program, from the wasm module of build/PRESET.
build_page() {
  install_npm web || return 1
  node "$root/web/build.mjs" page "$root/build/$1/package" "$root/build/web/chronormal.html"
}
