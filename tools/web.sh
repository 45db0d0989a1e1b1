# Sourced by ./run and ./test: builds the pages of web/ with the npm packages that are installed there.

# build_report_page: makes the page of a report, without data, where the program looks for it, unless it is up to date.
build_report_page() {
  local page=$root/build/share/chronormal/report.html
  if [ -e "$page" ] && [ -z "$(find "$root/web/src" "$root/web/build.mjs" "$root/web/package-lock.json" "$root/js/src/drive.js" -newer "$page")" ]; then return 0; fi
  install_npm web || return 1
  say "building ${page#"$PWD/"}"
  node "$root/web/build.mjs" report "$page" >&2
}

# build_page PRESET: makes the page with the engine inside, from the wasm module of build/PRESET.
build_page() {
  install_npm web || return 1
  node "$root/web/build.mjs" page "$root/build/$1/package" "$root/build/web/chronormal.html"
}
