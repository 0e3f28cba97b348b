#!/usr/bin/env bash
# Shows that the working tree draws the same bits as an older revision: builds bit_equal of both and
# compares. Usage: tests/bit_equal/bit_equal.sh REVISION [SCENE...]; see bit_equal.c.
set -euo pipefail

[ $# -ge 1 ] || { echo "usage: $0 REVISION [SCENE...]" >&2; exit 2; }
cd "$(dirname "$0")/../.."
root=$PWD
export VOXCAST_SCENES=${VOXCAST_SCENES:-$root/../shared/scenes}
commit=$(git rev-parse --verify --quiet "$1^{commit}") || { echo "bit_equal: no revision $1" >&2; exit 2; }
shift

work=$(mktemp -d)
trap 'rm -rf "$work"; git worktree prune' EXIT

# Builds what tree $1 holds.
build() { (cd "$1" && cmake --preset test >/dev/null && cmake --build build/test --target bit_equal >/dev/null); }

git worktree add --quiet --detach "$work/tree" "$commit"
build "$work/tree"
build "$root"
"$work/tree/build/test/bin/bit_equal" keep "$work/pictures" "$@"
build/test/bin/bit_equal compare "$work/pictures" "$@"
