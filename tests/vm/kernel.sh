# SPDX-License-Identifier: Apache-2.0
# Sourced by what makes guests: Debian's kernel, its modules, and a Debian that is quiet. Nothing is installed on the host.

kernel_package=linux-image-amd64  # not the cloud kernel: it has no USB

say() { echo "test-vm: $*" >&2; }

# Sets real_package and package_version: linux-image-amd64 is an empty package that depends on the present kernel.
find_kernel() {
  real_package=$(apt-cache depends "$kernel_package" | awk '/Depends: linux-image-[0-9]/ {print $2; exit}')
  [ -n "$real_package" ] || { echo "no kernel package found: is this Debian, and did apt-get update run?" >&2; exit 77; }
  package_version=$(apt-cache policy "$real_package" | awk '/Candidate:/ {print $2}')
}

download() { (cd "$work" && apt-get -o APT::Sandbox::User=root download -qq "$1" >&2); }

# Unpacks the kernel into $work/kernel and sets version, the name of its modules' folder.
fetch_kernel() {
  say "kernel $real_package $package_version: downloading (about 70 MB), not installing"
  download "$real_package"
  mkdir -p "$work/kernel"
  dpkg-deb --fsys-tarfile "$work"/"$real_package"_*.deb | tar -x -C "$work/kernel"
  version=$(ls "$work/kernel/lib/modules")
  depmod -b "$work/kernel" "$version"
}

# module_files MODULE...: these and what they need, in the order in which they are loaded.
module_files() {
  local module
  for module in "$@"; do
    modprobe -S "$version" -d "$work/kernel" --show-depends "$module" | awk '/^insmod/ {print $2}'
  done | awk '!seen[$0]++'
}

# copy_modules ROOT MODULE...
copy_modules() {
  local root=$1 into=$1/usr/lib/modules/$version file inside
  shift
  mkdir -p "$into"
  cp "$work/kernel/lib/modules/$version"/modules.* "$into/"
  module_files "$@" | while read -r file; do
    inside=${file#*/lib/modules/"$version"/}
    mkdir -p "$into/$(dirname "$inside")"
    cp "$file" "$into/$inside"
  done
  depmod -b "$root" "$version"
}

# make_quiet ROOT: a machine of its own name, without terminals and timers.
make_quiet() {
  local root=$1 unit
  echo dtsd-vm >"$root/etc/hostname"
  : >"$root/etc/machine-id"
  : >"$root/etc/fstab"
  for unit in apt-daily.timer apt-daily-upgrade.timer dpkg-db-backup.timer e2scrub_all.timer fstrim.timer systemd-timesyncd.service \
    getty@tty1.service serial-getty@ttyS0.service e2scrub_reap.service; do
    ln -sf /dev/null "$root/etc/systemd/system/$unit"
  done
}
