#!/bin/sh
# SPDX-FileCopyrightText: The Explica developers
# SPDX-License-Identifier: Apache-2.0
# Makes build/release/ from build/: Debian packages, the wheel, an archive of the program with its libraries that
# runs from any folder, checksums, and the notes of this version out of CHANGELOG.md. Every one is tried:
# the archive in a shell without environment, packages and wheel by Testing/check-package.sh.
set -eu
cd "$(dirname "$0")/.."
version=$(sed -n 's/^project(Explica VERSION \([0-9.]*\).*/\1/p' CMakeLists.txt)
release=build/release
rm -rf "$release"
mkdir -p "$release"

Testing/check-package.sh
cp build/packages/*.deb "$release/"
/usr/bin/python3 Wrapping/Python/tools/make_wheel.py build "$release" >/dev/null

# The archive: what `cmake --install` puts under a prefix, and every library but those of the C and C++ runtime.
name=explica-$version-linux-$(uname -m)
tree=$release/$name
cmake --install build --prefix "$tree" --component program --strip >/dev/null
mkdir -p "$tree/lib"
ldd "$tree/bin/explica" | awk '$3 ~ "^/" && $1 !~ /^(libc|libm|libdl|librt|libpthread|ld-linux.*)\.so/ { print $3 }' |
  xargs cp -L -t "$tree/lib"
patchelf --set-rpath '$ORIGIN/../lib' "$tree/bin/explica"
find "$tree/lib" -maxdepth 1 -name '*.so*' -exec patchelf --set-rpath '$ORIGIN' {} +
cp LICENSE README.md "$tree/"
elsewhere=$(mktemp -d)
trap 'rm -rf "$elsewhere"' EXIT
tar -C "$release" --owner=0 --group=0 --sort=name --mtime=@0 -czf "$release/$name.tar.gz" "$name"
rm -rf "$tree"
tar -C "$elsewhere" -xzf "$release/$name.tar.gz"
if env -i ldd "$elsewhere/$name/bin/explica" | grep -v "$elsewhere" | grep '=> /' |
  grep -Ev '^[[:space:]]*(libc|libm|libdl|librt|libpthread)\.so'; then
  echo "the archive takes these libraries from this machine"
  exit 1
fi
env -i "$elsewhere/$name/bin/explica" phantom shell --size 16 --quiet --out "$elsewhere/shell"
env -i "$elsewhere/$name/bin/explica" verify "$elsewhere/shell" --quiet >/dev/null

awk -v version="$version" '/^## / { on = index($2, version) == 1 || index($0, version) } on' CHANGELOG.md >"$release/RELEASE_NOTES.md"
(cd "$release" && sha256sum -- *.deb *.whl *.tar.gz >SHA256SUMS)
ls -l "$release"
