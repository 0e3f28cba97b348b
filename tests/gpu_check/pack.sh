#!/usr/bin/env bash
# Packs what a machine with a GPU and no network needs for tests/gpu_check/run: programs of
# build/test, their libraries, shaders, golden images. libEGL and the GL driver are that machine's.
set -euo pipefail
root=$(cd "$(dirname "${BASH_SOURCE[0]}")/../.." && pwd)
folder=${1:-$root/build/gpu-check}
bin=$root/build/test/bin
rm -rf "$folder" "$folder.tar.xz"
mkdir -p "$folder"/{bin,lib,libc}
tests=()
for source in "$root"/tests/gpu/test_*.c; do
    name=$(basename "$source" .c)
    # Needs glslangValidator, and no GPU.
    [ "$name" = test_glslang ] || tests+=("$name")
done
printf '%s\n' "${tests[@]}" >"$folder/tests"
for name in voxcast test_golden "${tests[@]}"; do
    strip -o "$folder/bin/$name" "$bin/$name"
done
ldd "$folder"/bin/* | awk '$3 ~ /^\// { print $3 }' | sort -u | while read -r library; do
    case $(basename "$library") in
    libc.so.* | libm.so.* | libdl.so.* | libpthread.so.* | librt.so.* | libstdc++.so.* | libgcc_s.so.*)
        cp -L "$library" "$folder/libc/" ;;
    libGL* | libEGL* | libdrm* | libgbm*) ;;
    *) cp -L "$library" "$folder/lib/" ;;
    esac
done
cp -L /lib64/ld-linux-x86-64.so.2 "$folder/libc/"
cp -r "$root/shaders" "$folder/"
cp -r "$root/tests/golden/pictures" "$folder/"
cp "$root/tests/gpu_check/run" "$folder/"
git -C "$root" describe --always --dirty --exclude='*' >"$folder/revision"
tar -C "$(dirname "$folder")" -I "xz -1 -T0" -cf "$folder.tar.xz" "$(basename "$folder")"
bytes=$(stat -c %s "$folder.tar.xz")
printf '%s, %s.tar.xz (%d MB)\n' "$folder" "$folder" $((bytes / 1000000))
[ "$bytes" -le $((64 << 20)) ] || { echo "gpu-check: more than 64 MiB" >&2; exit 1; }
