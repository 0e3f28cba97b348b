#!/usr/bin/env bash
# Proves the README's two commands on a machine with nothing installed: makes a minimal Debian 12
# root, clones HEAD (or another commit) into it, and calls ./dev run or ./dev test there, as an
# ordinary user who has sudo, or as root. See usage below; ./dev bare calls it.
#
# The root lives in mount and process namespaces of its own: whatever ends this script ends all
# that runs there and takes its mounts away.
set -euo pipefail

root=$(cd "$(dirname "${BASH_SOURCE[0]}")/../.." && pwd)
cache=${XDG_CACHE_HOME:-$HOME/.cache}/voxcast
suite=bookworm
tarball_days=30 # then one is made anew, for newer packages
exit_cannot=77  # no root can be made here

say() { printf '== bare: %s\n' "$*" >&2; }
die() { printf 'dev bare: %s\n' "$*" >&2; exit 1; }
cannot() { printf 'dev bare: skipped, no bare root can be made here: %s\n' "$*" >&2; exit "$exit_cannot"; }

usage() {
    cat <<'END'
usage: ./dev bare [run|test] [--as user|root] [--commit COMMIT]

  run     ./dev run on a bare Debian 12; passes when a client outside has the first frame, /readyz
          says ready, the page shows the picture, Ctrl+C ends the daemon, and a second ./dev run
          is quick (default)
  test    ./dev test on a bare Debian 12

  --as user|root    who calls it there: an ordinary user who has sudo (default), or root
  --commit COMMIT   what is cloned (default HEAD)

The minimal root is kept as a tarball below ~/.cache/voxcast. Exit status 77: no root can be made here.
END
}

what=run user=user commit=HEAD
while [ $# -gt 0 ]; do
    case $1 in
    run | test) what=$1 ;;
    --as) [ $# -gt 1 ] || die "--as wants user or root"; user=$2 && shift ;;
    --commit) [ $# -gt 1 ] || die "--commit wants a commit"; commit=$2 && shift ;;
    -h | --help) usage && exit 0 ;;
    *) usage >&2 && exit 2 ;;
    esac
    shift
done
[ "$user" = user ] || [ "$user" = root ] || die "--as wants user or root"
[ "$(id -u)" -eq 0 ] || cannot "not root"
unshare --mount --pid --fork true 2>/dev/null || cannot "no right to mount"
command -v mmdebstrap >/dev/null || die "mmdebstrap is missing; ./dev bare installs it"
commit=$(git -C "$root" rev-parse --verify --quiet "$commit^{commit}") || die "--commit: no such commit"

work='' inside_pid=''

# Of the namespace: the only child of unshare.
first_process() {
    local child=''
    { read -r child _ <"/proc/$inside_pid/task/$inside_pid/children"; } 2>/dev/null || true
    printf '%s' "${child:-none}"
}

cleanup() {
    # The first process of the namespace takes all others and all mounts with it; then unshare ends.
    if [ -n "$inside_pid" ]; then
        # It fails where the process has ended by itself.
        kill -KILL "$inside_pid" 2>/dev/null || true
        wait "$inside_pid" 2>/dev/null || true # the status of a killed process
    fi
    [ -z "$work" ] || rm -rf --one-file-system "$work"
}
trap cleanup EXIT
trap 'exit 130' INT
trap 'exit 143' TERM HUP

seconds() { awk -v from="$1" -v to="$EPOCHREALTIME" 'BEGIN { printf "%.1f", to - from }'; }

# A minimal Debian: what is essential, apt, and sudo for the ordinary user. Nothing else.
make_tarball() {
    local tarball=$1 from=$EPOCHREALTIME packages=()
    [ "$user" = root ] || packages=(--include=sudo)
    if [ -n "$(find "$tarball" -mtime "-$tarball_days" 2>/dev/null)" ]; then return 0; fi
    say "making a minimal Debian 12"
    mkdir -p "$cache"
    mmdebstrap --quiet --variant=minbase "${packages[@]}" "$suite" "$tarball.new.tar" >"$tarball.log" 2>&1 ||
        {
            tail -n 20 "$tarball.log" >&2
            [ -e "$tarball" ] || die "mmdebstrap failed"
            say "taking the one of before"
            return 0
        }
    mv "$tarball.new.tar" "$tarball"
    say "made in $(seconds "$from") s"
}

# Whose certificates this machine trusts beyond Debian's, the root trusts, too, for npm.
environment=(LANG=C.UTF-8 "PATH=/usr/local/sbin:/usr/local/bin:/usr/sbin:/usr/bin:/sbin:/bin" VOXCASTD_PORT=0)
fill_root() {
    local home=$1 variable
    tar -C "$work/root" -xf "$2"
    mkdir -p "$work/root$home"
    if [ "$user" = user ]; then
        # As images of cloud machines have it: no password, in a group that would need one.
        chroot "$work/root" useradd --no-create-home --shell /bin/bash --groups sudo user
        printf 'user ALL=(ALL) NOPASSWD: ALL\nDefaults env_keep += "http_proxy https_proxy no_proxy"\n' \
            >"$work/root/etc/sudoers.d/user"
    fi
    # No hard links: the clone's owner is another.
    git clone --quiet --no-hardlinks --no-checkout "$root" "$work/root$home/voxcast"
    git -C "$work/root$home/voxcast" checkout --quiet --detach "$commit"
    chroot "$work/root" chown -R "$user:" "$home"
    environment+=("HOME=$home" "USER=$user" "LOGNAME=$user")
    for variable in http_proxy https_proxy no_proxy CI; do
        [ -z "${!variable:-}" ] || environment+=("$variable=${!variable}")
    done
    if [ -n "${NODE_EXTRA_CA_CERTS:-}" ]; then
        cp "$NODE_EXTRA_CA_CERTS" "$work/root/etc/extra-ca.pem"
        environment+=(NODE_EXTRA_CA_CERTS=/etc/extra-ca.pem)
    fi
    printf '127.0.0.1 localhost %s\n::1 localhost\n' "$(hostname)" >"$work/root/etc/hosts"
    cp /etc/resolv.conf "$work/root/etc/resolv.conf"
}

# Runs a command as the user in the root, in the clone. Ends with this script, however that ends.
inside() {
    local home=$1 scenes=${VOXCAST_SCENES:-$root/../shared/scenes}
    shift
    # shellcheck disable=SC2016 # the inner shell expands its own arguments
    exec setpriv --pdeathsig KILL unshare --mount --pid --fork --kill-child --propagation private bash -c '
        set -euo pipefail
        root=$1 home=$2 user=$3 scenes=$4
        shift 4
        mount -t proc proc "$root/proc"
        mount --rbind /sys "$root/sys"
        mount --rbind /dev "$root/dev"
        if [ -d "$scenes" ]; then
            mkdir -p "$root$home/shared/scenes"
            mount --bind -o ro "$scenes" "$root$home/shared/scenes"
        fi
        cd "$root"
        exec chroot --userspec="$user" "$root" "$@"
    ' _ "$work/root" "$home" "$user" "$scenes" \
        /usr/bin/env -i "${environment[@]}" /bin/bash -c 'cd ~/voxcast && exec "$@"' _ "$@"
}

# Waits for a line of a log that matches; fails when what writes it has ended.
wait_for() {
    local pattern=$1 log=$2
    until grep -qsE "$pattern" "$log"; do
        kill -0 "$inside_pid" 2>/dev/null || return 1
        sleep 0.05
    done
}

# One ./dev run: starts it, has a client look at it, and stops it as Ctrl+C does. Sets url_s, frame_s
# and stop_s.
run_once() {
    local home=$1 log=$work/$2.log from=$EPOCHREALTIME url status=0
    : >"$log"
    inside "$home" ./dev run >"$log" 2>&1 &
    inside_pid=$!
    tail -n +1 --pid="$inside_pid" -f "$log" >&2 &
    wait_for '^voxcastd: open http' "$log" || die "./dev run ended without a URL"
    url_s=$(seconds "$from")
    url=$(sed -n 's/^voxcastd: open //p' "$log")
    frame_s=$(node "$root/tests/bare/first_frame.mjs" "$url" "${@:3}") || die "a client did not get what it wants from $url"
    frame_s=$(awk -v url="$url_s" -v frame="$frame_s" 'BEGIN { printf "%.1f", url + frame }')
    from=$EPOCHREALTIME
    # ./dev becomes the daemon, which is the namespace's first process.
    kill -INT "$(first_process)"
    wait "$inside_pid" || status=$?
    inside_pid=
    stop_s=$(seconds "$from")
    [ "$status" -eq 0 ] || die "after Ctrl+C the daemon's exit status was $status"
}

# The packages of tests must not be here, or what asks for them would not be noticed: configuring the
# tests must fail, as ./dev run did while it configured them.
prove_bare() {
    if (inside "$1" cmake --preset test) >"$work/bare.log" 2>&1; then
        die "the root has the packages of tests: this run proves nothing"
    fi
    grep -q cmocka "$work/bare.log" || { tail -n 5 "$work/bare.log" >&2; die "configuring tests failed without naming cmocka"; }
}

# Roots of runs that were killed before they could clean up.
remove_abandoned() {
    local folder
    for folder in "$cache"/bare.*/; do
        if [ -e "$folder/pid" ] && ! kill -0 "$(cat "$folder/pid")" 2>/dev/null; then rm -rf --one-file-system "$folder"; fi
    done
}

disk_mb() { du -sm --one-file-system "$work/root" | cut -f 1; }

check_run() {
    local home=$1 before_mb url_first_s frame_first_s stop_first_s
    before_mb=$(disk_mb)
    run_once "$home" first --page
    url_first_s=$url_s frame_first_s=$frame_s stop_first_s=$stop_s
    say "a second ./dev run"
    run_once "$home" second
    prove_bare "$home"
    # ./dev tells the seconds of each stage.
    sed -n -E 's/^.*== ([a-z ]+): done in ([0-9.]+) s.*/\1\t\2/p' "$work/first.log" |
        awk -F '\t' -v url="$url_first_s" -v frame="$frame_first_s" -v stop="$stop_first_s" \
            -v again="$frame_s" -v stop_again="$stop_s" -v mb="$(($(disk_mb) - before_mb))" '
            function row(name, s) { printf "  %-24s %6.1f s\n", name, s }
            { row($1, $2); stages += $2 }
            END {
                row("start", url - stages)
                row("URL, from nothing", url)
                row("first frame", frame - url)
                row("second run, first frame", again)
                row("end by Ctrl+C", stop)
                row("second run, end", stop_again)
                printf "  %-24s %6d MB\n", "installed and built", mb
            }'
}

check_tests() {
    local status=0
    inside "$1" ./dev test &
    inside_pid=$!
    wait "$inside_pid" || status=$?
    inside_pid=
    [ "$status" -eq 0 ] || die "./dev test ended with $status"
}

main() {
    local home=/home/user tarball
    [ "$user" = user ] || home=/root
    tarball=$cache/bare-$suite-$user-$(dpkg --print-architecture).tar
    make_tarball "$tarball"
    remove_abandoned
    work=$(mktemp -d "$cache/bare.XXXXXX")
    printf '%s\n' "$$" >"$work/pid"
    mkdir "$work/root"
    say "root in $work"
    fill_root "$home" "$tarball"
    say "./dev $what as $user, at commit $(git -C "$root" rev-parse --short "$commit")"
    if [ "$what" = run ]; then
        check_run "$home"
    else
        check_tests "$home"
    fi
    say "passed"
}

main
