# SPDX-License-Identifier: Apache-2.0
# Sourced by scripts that use clean Debian systems in folders: test-fresh, package-roots, test-arm64. The script sets `script` (its real path),
# then calls prepare_roots, and make_root for each system. From this machine come only the settings for Debian's and npm's registries: mirror,
# proxies, certificates. Needs root and mmdebstrap.
# The caller may set: keep=yes (the folders stay), ccache=yes (one compiler cache for all runs), shared=DIR (mounted as ../shared, read-only),
# mounted=DIR (mounted as /dtsd).

roots_cache=/var/cache/dtsd-fresh # clean systems, which are made again after a day, and the compiler cache
roots_scratch=${TMPDIR:-/var/tmp}
roots_name=${script##*/}
roots_folders=() roots_child='' roots_unfinished=''

cannot() { echo "$roots_name: cannot set up a clean system on this machine: $*" >&2; exit 77; }
fail() { echo "$roots_name: $*" >&2; exit 1; }
say() { printf '\033[1m%s\033[0m\n' "$*" >&2; }

# as_root WORD...: starts the script again with sudo, unless root runs it.
as_root() {
  [ "$(id -u)" -ne 0 ] || return 0
  command -v sudo >/dev/null || cannot "that takes root, and there is no sudo"
  exec sudo --preserve-env=CI,DTS_JOBS,TMPDIR,http_proxy,https_proxy,no_proxy "$script" "$@"
}

# remove_root FOLDER. The kernel may still be ending processes that write in there.
remove_root() { rm -rf --one-file-system "$1" 2>/dev/null || { sleep 2; rm -rf --one-file-system "$1"; }; }

leave_roots() {
  [ -z "$roots_child" ] || { kill -KILL "$roots_child" && wait "$roots_child" || true; } 2>/dev/null # unshare blocks the milder signals
  rm -f "$roots_unfinished"
  local folder
  for folder in "${roots_folders[@]}"; do
    [ -z "${keep:-}" ] || { echo "kept: $folder (enter it with: chroot $folder)" >&2; continue; }
    remove_root "$folder"
  done
}

# prepare_roots: checks that this machine can do it, removes what a killed run left, and sets the traps that clean up.
prepare_roots() {
  export LC_ALL=C.UTF-8
  mkdir -p "$roots_cache"
  # Git may refuse a tree that belongs to somebody else.
  export GIT_CONFIG_GLOBAL=$roots_cache/gitconfig
  printf '[safe]\n\tdirectory = *\n' >"$GIT_CONFIG_GLOBAL"
  # A folder's name says which process made it.
  local folder
  for folder in "$roots_scratch"/dts-fresh.*; do
    [[ $folder =~ /dts-fresh\.([0-9]+)\.[^/]*$ ]] || continue
    [ -d "/proc/${BASH_REMATCH[1]}" ] || rm -rf --one-file-system "$folder"
  done
  trap leave_roots EXIT
  trap 'exit 130' INT
  trap 'exit 143' TERM
  unshare --mount --pid --fork mount -t tmpfs tmpfs "$roots_scratch" || cannot "mounts or name spaces are not allowed (a container without privileges?)"
  exec 9>"$roots_cache/lock" # another script may be installing it just now
  flock 9
  if ! command -v mmdebstrap >/dev/null; then
    say 'Installing mmdebstrap'
    apt-get update -qq && apt-get install -y -qq --no-install-recommends mmdebstrap >/dev/null 2>&1 ||
      fail "mmdebstrap is missing, and could not be installed (apt-get install mmdebstrap)"
  fi
  exec 9>&-
}

# Where this machine gets Debian from, and how. uri_of LABEL DEFAULT
uri_of() {
  local uri
  uri=$(apt-get indextargets --format '$(REPO_URI)' 'Created-By: Packages' 'Origin: Debian' "Label: $1" 2>/dev/null | grep -m 1 '^https\?:' || true)
  echo "${uri:-$2}"
}
apt_settings() { apt-config dump | grep -E '^Acquire::(http|https|Check-Valid-Until|Check-Date|Retries|ForceIPv[46])\b' || true; }

# sources_of SUITE: lines of sources.list.
sources_of() {
  local debian
  debian=$(uri_of Debian http://deb.debian.org/debian)
  printf 'deb %s main\n' "$debian $1" "$debian $1-updates" "$(uri_of Debian-Security http://deb.debian.org/debian-security) $1-security"
}

# make_root SUITE: a minimal Debian in a new folder; sets `folder`. It is unpacked from an archive that is made anew once a day.
make_root() {
  local suite=$1 archive=$roots_cache/$1.tar options=(--dpkgopt=force-unsafe-io) option file # nothing in there has to survive a power cut
  if [ -z "$(find "$archive" -mmin -1440 2>/dev/null)" ]; then
    say "Making a clean Debian ($suite)"
    roots_unfinished=$archive.$$
    while IFS= read -r option; do [ -z "$option" ] || options+=("--aptopt=$option"); done <<<"$(apt_settings)"
    sources_of "$suite" |
      mmdebstrap --quiet --mode=root --format=tar --variant=minbase --include=git "${options[@]}" "$suite" "$roots_unfinished" - ||
      fail "mmdebstrap failed"
    mv "$roots_unfinished" "$archive"
  fi
  [ "$(df --output=avail -BG "$roots_scratch" | tail -n 1 | tr -dc 0-9)" -ge 8 ] || fail "less than 8 GB are free in $roots_scratch"
  folder=$(mktemp -d "$roots_scratch/dts-${keep:+kept-}fresh.$$.XXXXXX") || fail "cannot make a folder in $roots_scratch"
  roots_folders+=("$folder")
  chmod 755 "$folder"
  tar -C "$folder" --numeric-owner -xf "$archive" || fail "cannot unpack $archive"
  # How this machine reaches the registries: names, its own certificates, settings of apt and npm.
  for file in /etc/resolv.conf /etc/hosts /etc/npmrc /etc/apt/auth.conf /etc/apt/auth.conf.d /usr/local/share/ca-certificates \
    /etc/ssl/certs/ca-certificates.crt; do
    [ ! -e "$file" ] || tar -C / -chf - "${file#/}" | tar -C "$folder" -xf -
  done
  apt_settings >"$folder/etc/apt/apt.conf.d/99registry"
  file=$(getent passwd "${SUDO_USER:-root}" | cut -d: -f6)/.npmrc
  [ ! -e "$file" ] || cp "$file" "$folder/root/.npmrc"
}

# enter USER COMMAND...: runs it in $folder, in mounts and processes of its own, which end with it, with this script, and when that is killed.
enter() {
  local status=0
  setpriv --pdeathsig KILL unshare --mount --pid --fork --kill-child bash -c '
    set -e
    root=$1 user=$2 cache=$3 shared=$4 mounted=$5 home=$(chroot "$1" sh -c "echo ~$2")
    shift 5
    mount -t proc proc "$root/proc"
    mount --rbind /sys "$root/sys"
    mount --rbind /dev "$root/dev"
    mount -t tmpfs tmpfs "$root/dev/shm"
    variables=(HOME="$home" USER="$user" LANG=C.UTF-8 TERM="${TERM:-dumb}" PATH=/usr/local/sbin:/usr/local/bin:/usr/sbin:/usr/bin:/sbin:/bin)
    for name in CI http_proxy https_proxy no_proxy DTS_JOBS; do [ -z "${!name:-}" ] || variables+=("$name=${!name}"); done
    if [ -n "$cache" ]; then
      mkdir -p "$cache/$user" "$root/ccache"
      mount --bind "$cache/$user" "$root/ccache"
      chroot "$root" chown -R "$user:" /ccache # a copy of the cache may belong to somebody else
      variables+=(CCACHE_DIR=/ccache)
    fi
    [ -z "$shared" ] || { mkdir -p "$root$home/shared"; mount -o bind,ro "$shared" "$root$home/shared"; }
    [ -z "$mounted" ] || { mkdir -p "$root/dtsd"; mount -o bind,ro "$mounted" "$root/dtsd"; }
    exec chroot --userspec="$user" "$root" env -i "${variables[@]}" sh -c "cd && [ ! -d dtsd ] || cd dtsd; exec \"\$@\"" - "$@"
  ' - "$folder" "$1" "${ccache:+$roots_cache/ccache}" "${shared:-}" "${mounted:-}" "${@:2}" </dev/null &
  roots_child=$!
  wait "$roots_child" || status=$?
  roots_child=
  return "$status"
}
