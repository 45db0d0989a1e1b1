# Makes the files of a release, in dist/. ./run sources this file.

# The steps in their order. A user may name single steps: ./run dist program sums.
dist_steps=(source program others wheel deb npm page core site blender sbom sums)

# dist STEP...: makes the named steps, or all steps if none is named.
dist() {
  local step begin
  for step; do
    [[ " ${dist_steps[*]} " == *" $step "* ]] && continue
    say "there is no step '$step'; choose one of" "${dist_steps[@]}"
    return 2
  done
  dist=$root/dist version=$(sed -n 's/^project(chronormal VERSION \([0-9.]*\).*/\1/p' "$root/CMakeLists.txt")
  if ! SOURCE_DATE_EPOCH=$(git -C "$root" log -1 --format=%ct); then
    say "this folder is not a clone of the repository, but a release is made from a commit; clone the repository first"
    return 1
  fi
  # SOURCE_DATE_EPOCH is the time of all files in archives, so that an archive has the same bytes when it is made again.
  export SOURCE_DATE_EPOCH
  [ -z "$(git -C "$root" status --porcelain)" ] || say "some files here differ from the commit, and the archive will have the files of the commit; commit the changes that belong to the release"
  mkdir -p "$dist"
  [ $# -gt 0 ] || { rm -f "$dist"/*; set -- "${dist_steps[@]}"; }
  for step in "${dist_steps[@]}"; do
    [[ " $* " == *" $step "* ]] || continue
    begin=$SECONDS
    "dist_$step"
    say "$step: $((SECONDS - begin)) s"
  done
  (cd "$dist" && stat -c '%12s  %n' -- *) >&2
}

# dist_packages SECTION...: installs the packages of the named sections of tools/packages.txt.
dist_packages() {
  local sections=("$@")
  has_node || sections+=(node)
  install_packages run dist "${sections[@]}"
}

# pack FOLDER FILE: makes an archive of a folder. Equal files give equal bytes.
pack() {
  local as=(--sort=name --owner=0 --group=0 --numeric-owner --mtime="@$SOURCE_DATE_EPOCH")
  tar -C "$(dirname "$1")" "${as[@]}" -cf - "$(basename "$1")" | gzip -9n >"$2"
}

dist_source() {
  local name=chronormal-$version
  git -C "$root" archive --format=tar --prefix="$name/" HEAD | gzip -9n >"$dist/$name.tar.gz"
}

# build_dist TARGET: builds a target in build/dist, with libraries that are compiled from their sources.
build_dist() {
  fetch_sources "$root/build/wasm-sources"
  build_report_page
  [ -e "$root/build/dist/build.ninja" ] || (cd "$root" && cmake --preset dist) >&2
  cmake --build "$root/build/dist" --target "$1" >&2
}

# dist_program: builds the program for every Linux on this kind of machine. The program needs no libraries, not even a C
# library.
dist_program() {
  dist_packages python
  build_dist chronormal_cli
  unpacked_program "$root/build/dist/chronormal-$version-linux-$(uname -m)" strip "$root/build/dist/chronormal" program
  pack "$folder" "$dist/$(basename "$folder").tar.gz"
}

# unpacked_program FOLDER STRIP PROGRAM ARTEFACT: makes the folder, sets `folder` to it, and copies PROGRAM to it
# without symbols, by the command STRIP, together with the manual page, the completions and the licences. The program of
# this machine writes the manual page and completions.
unpacked_program() {
  local writer=$root/build/dist/chronormal
  folder=$1
  rm -rf "$folder" && mkdir -p "$folder/share/man/man1" "$folder/share/completions"
  "$2" -o "$folder/$(basename "$3")" "$3"
  cp "$root/LICENSE" "$folder"
  "$writer" --manual-page >"$folder/share/man/man1/chronormal.1"
  "$writer" --completions bash >"$folder/share/completions/chronormal"
  "$writer" --completions zsh >"$folder/share/completions/_chronormal"
  "$writer" --completions fish >"$folder/share/completions/chronormal.fish"
  /usr/bin/python3 "$root/tools/dist/components.py" licences "$4" "$folder/THIRD_PARTY"
}

# dist_others: builds the program for Linux on 64-bit ARM, and the program and the C library for Windows.
dist_others() {
  local build
  dist_packages python cross
  build_dist chronormal_cli
  build_cross arm64
  build=$root/build/arm64
  unpacked_program "$build/chronormal-$version-linux-arm64" aarch64-linux-gnu-strip "$build/chronormal" arm64
  pack "$folder" "$dist/$(basename "$folder").tar.gz"
  build_cross windows
  build=$root/build/windows
  unpacked_program "$build/chronormal-$version-windows-x64" x86_64-w64-mingw32-strip "$build/chronormal.exe" windows
  rm -rf "$folder/share"
  x86_64-w64-mingw32-strip --strip-unneeded -o "$folder/chronormal_c.dll" "$build/chronormal_c.dll"
  cp "$build/chronormal_c.dll.a" "$root/include/chronormal_c.h" "$folder"
  /usr/bin/python3 "$root/tools/dist/zip_folder.py" "$folder" "$dist/$(basename "$folder").zip"
}

# dist_wheel: builds the Python package for Debian's Python. The tag of the package says that the package needs this
# machine's version of the C library or a newer version.
dist_wheel() {
  dist_packages python
  build_dist _chronormal
  local build=$root/build/dist glibc
  glibc=$(getconf GNU_LIBC_VERSION | sed 's/glibc //; s/\./_/')
  /usr/bin/python3 "$root/tools/dist/components.py" licences wheel "$build/THIRD_PARTY"
  printf '[bdist_wheel]\nplat_name = manylinux_%s_%s\n' "$glibc" "$(uname -m)" >"$build/wheel.cfg"
  strip --strip-unneeded "$build"/python/chronormal/_chronormal*.so
  rm -rf "$root/python/build" "$build/wheel"
  DIST_EXTRA_CONFIG=$build/wheel.cfg CHRONORMAL_BUILD=$build /usr/bin/python3 -m pip wheel -q \
    --no-index --no-deps --no-build-isolation -w "$build/wheel" "$root/python"
  cp "$build/wheel"/*.whl "$dist"
}

# dist_deb: builds Debian's package from the archive of sources alone, in build/source.
dist_deb() {
  dist_packages
  build_report_page
  local archive=$dist/chronormal-$version.tar.gz unpacked=$root/build/source
  local source=$unpacked/chronormal-$version
  local build=$source/build/program
  [ -e "$archive" ] || dist_source
  if ! cmp -s "$archive" "$unpacked/archive"; then
    rm -rf "$unpacked" && mkdir -p "$unpacked"
    tar -C "$unpacked" -xzf "$archive"
    cp "$archive" "$unpacked/archive"
  fi
  mkdir -p "$source/build/share/chronormal"
  cp "$root/build/share/chronormal/report.html" "$source/build/share/chronormal"
  [ -e "$build/build.ninja" ] || (cd "$source" && cmake --preset program) >&2
  cmake --build "$build" >&2
  rm -rf "$build/deb"
  cpack --config "$build/CPackConfig.cmake" -B "$build/deb" >&2
  cp "$build/deb"/*.deb "$dist"
}

dist_npm() {
  dist_packages wasm
  build_npm >&2
  cp "$root/build/npm"/*.tgz "$dist"
}

dist_page() {
  dist_packages wasm
  build_wasm wasm npm_package >&2
  build_page wasm >&2
  cp "$root/build/web/chronormal.html" "$dist/chronormal-$version.html"
}

# dist_core: writes the library as two files.
dist_core() { /usr/bin/python3 "$root/tools/two_files.py" "$dist"; }

# dist_site: makes the site, which has the pages and the reference of the headers, for a disk or a server.
dist_site() {
  dist_packages site
  local name=chronormal-$version-site
  mkdir -p "$root/build/dist"
  "$root/tools/site/make" "$root/build/dist/$name"
  pack "$root/build/dist/$name" "$dist/$name.tar.gz"
}

# blender_system ARCHITECTURE: prints the name that the Blender add-on has for this kind of machine.
blender_system() { case $1 in x86_64) echo linux-x64 ;; aarch64 | arm64) echo linux-arm64 ;; *) echo "linux-$1" ;; esac; }

# dist_blender: packs the add-on for Blender. The add-on contains the program for each kind of machine whose archive is
# in dist/, including archives that were built on other machines.
dist_blender() {
  local archive machine folder unpacked=$root/build/dist/blender
  local programs=()
  [ -e "$dist/chronormal-$version-linux-$(uname -m).tar.gz" ] || dist_program
  rm -rf "$unpacked" && mkdir -p "$unpacked"
  for archive in "$dist/chronormal-$version-linux-"*.tar.gz; do
    tar -C "$unpacked" -xzf "$archive"
    folder=$unpacked/$(basename "$archive" .tar.gz)
    machine=${folder##*-linux-}
    programs+=("$(blender_system "$machine")=$folder")
  done
  for archive in "$dist/chronormal-$version-windows-x64.zip"; do
    [ -e "$archive" ] || continue
    /usr/bin/python3 -m zipfile -e "$archive" "$unpacked"
    programs+=("windows-x64=$unpacked/$(basename "$archive" .zip)")
  done
  /usr/bin/python3 "$root/tools/dist/blender_addon.py" "$dist/chronormal-blender-$version.zip" "${programs[@]}"
}

# dist_sbom: writes an SPDX list of the files of the release and of the components of other projects in them.
dist_sbom() {
  dist_packages
  local list=$dist/chronormal-$version.spdx.json
  /usr/bin/python3 "$root/tools/dist/components.py" sbom "$version" "$dist" >"$list.new"
  mv "$list.new" "$list"
}

dist_sums() {
  rm -f "$dist/SHA256SUMS"
  (cd "$dist" && LC_ALL=C sha256sum -- * >"$root/build/SHA256SUMS")
  mv "$root/build/SHA256SUMS" "$dist"
}
