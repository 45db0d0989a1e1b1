# Installs the packages that tools/packages.txt and the package-lock.json of tests/viewers and web list, as far as the
# machine lacks them. ./run and ./test source this file.

say() { printf 'chronormal: %s\n' "$*" >&2; }

# listed_packages SECTION...: prints the packages of the named sections of tools/packages.txt.
listed_packages() {
  local wanted=" $* "
  awk -v wanted="$wanted" '
    /^\[/ { section = substr($0, 2, length($0) - 2); next }
    NF && !/^#/ && index(wanted, " " section " ") { print }
  ' "$root/tools/packages.txt"
}

# update_lists APT-GET...: runs `apt-get update`, and waits while another program holds the lock of the lists. By
# itself, apt-get waits only for the lock of an installation.
update_lists() {
  local deadline=$((SECONDS + 300)) said
  until said=$("$@" update 2>&1); do
    printf '%s\n' "$said"
    if [[ $said != *"Could not get lock"* ]] || [ "$SECONDS" -ge "$deadline" ]; then return 1; fi
    say "another program holds the lock of the lists of packages: trying again in five seconds"
    sleep 5
  done
}

# install_packages SECTION...: installs the packages of the named sections of tools/packages.txt. Prints nothing if all
# of them are installed.
install_packages() {
  if ! command -v dpkg-query >/dev/null; then
    say "this is not Debian; install the packages of tools/packages.txt under the names that they have on your system"
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
  # Another process may hold the locks of dpkg or of the lists for a while. apt-get waits at most five minutes, and
  # prints that it waits.
  local apt=("${as_root[@]}" env DEBIAN_FRONTEND=noninteractive apt-get -q -o DPkg::Lock::Timeout=300)
  if ! { update_lists "${apt[@]}" && "${apt[@]}" install -y --no-install-recommends "${missing[@]}"; } </dev/null >&2; then
    say "the packages could not be installed, and apt-get says why above; check that there is a network, that this is Debian 12,"
    say "and that no other program holds the lock of dpkg"
    return 1
  fi
}

# has_node: succeeds if there is a Node.js that is new enough, with npm.
has_node() {
  command -v npm >/dev/null && node -e 'process.exit(parseInt(process.versions.node) < 18 ? 1 : 0)' 2>/dev/null
}

# install_npm FOLDER: installs the npm packages that the package-lock.json of FOLDER lists, which is tests/viewers (the
# tests in real glTF viewers) or web (the pages). Prints nothing if all are installed.
install_npm() {
  local folder=$root/$1
  local installed=$folder/node_modules/.installed
  cmp -s "$folder/package-lock.json" "$installed" && return 0
  say "installing the npm packages of $1"
  if ! (cd "$folder" && npm ci --ignore-scripts --no-audit --no-fund --loglevel=error) </dev/null >&2; then
    say "the npm packages could not be installed, and npm says why above; check that npm reaches its registry"
    return 1
  fi
  cp "$folder/package-lock.json" "$installed"
}
