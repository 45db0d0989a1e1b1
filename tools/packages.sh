# Sourced by ./run and ./test: installs what tools/packages.txt and the package-lock.json of tests/hosts and web list
# and the machine lacks.

say() { printf 'chronormal: %s\n' "$*" >&2; }

# listed_packages SECTION...: the packages of those sections.
listed_packages() {
  local wanted=" $* "
  awk -v wanted="$wanted" '
    /^\[/ { section = substr($0, 2, length($0) - 2); next }
    NF && !/^#/ && index(wanted, " " section " ") { print }
  ' "$root/tools/packages.txt"
}

# install_packages SECTION...: silent where nothing is missing.
install_packages() {
  if ! command -v dpkg-query >/dev/null; then
    say "this is not Debian: the packages of tools/packages.txt must be there under the names of your system"
    return 0
  fi
  local missing=() package
  for package in $(listed_packages "$@"); do
    [ "$(dpkg-query -W -f '${db:Status-Status}' "$package" 2>/dev/null)" = installed ] || missing+=("$package")
  done
  [ ${#missing[@]} -eq 0 ] && return 0

  local as_root=()
  if [ "$(id -u)" -ne 0 ]; then
    if ! command -v sudo >/dev/null; then
      say "packages are missing, and there is neither root nor sudo to install them; as root, run"
      say "  apt-get install --no-install-recommends ${missing[*]}"
      return 1
    fi
    as_root=(sudo)
  fi
  say "installing ${missing[*]}"
  if ! { "${as_root[@]}" apt-get update -q &&
         "${as_root[@]}" env DEBIAN_FRONTEND=noninteractive apt-get install -q -y --no-install-recommends \
           "${missing[@]}"; } </dev/null >&2; then
    say "the packages could not be installed; is there a network, and is this Debian 12 (apt-get says why above)?"
    return 1
  fi
}

# has_node: whether there is a Node.js that is new enough, with npm.
has_node() {
  command -v npm >/dev/null && node -e 'process.exit(parseInt(process.versions.node) < 18 ? 1 : 0)' 2>/dev/null
}

# install_npm FOLDER: the npm packages that its package-lock.json lists, those of tests/hosts (the tests in real glTF hosts)
# or of web (the pages); silent where nothing is missing.
install_npm() {
  local folder=$root/$1
  local installed=$folder/node_modules/.installed
  cmp -s "$folder/package-lock.json" "$installed" && return 0
  say "installing the npm packages of $1"
  if ! (cd "$folder" && npm ci --ignore-scripts --no-audit --no-fund --loglevel=error) </dev/null >&2; then
    say "the npm packages could not be installed; does npm reach its registry (npm says why above)?"
    return 1
  fi
  cp "$folder/package-lock.json" "$installed"
}
