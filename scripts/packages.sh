# Debian packages, one list each for building and for testing; sourced by the scripts beside it.

build_packages="g++ cmake ninja-build libeigen3-dev libtbb-dev libfmt-dev nlohmann-json3-dev libcli11-dev zlib1g-dev libocct-data-exchange-dev"
test_packages="libgtest-dev python3 python3-numpy python3-scipy python3-meshio chromium fonts-dejavu-core"
fuzz_packages="clang libclang-rt-14-dev"
race_packages="libbenchmark-dev python3 python3-numpy python3-scipy libocct-modeling-algorithms-dev libocct-modeling-data-dev libsisl-dev"

# Installs those of the named packages that are missing, or says the one line that would.
need() {
    local missing=() package
    for package in "$@"; do
        dpkg-query -W -f '${Status}' "$package" 2>/dev/null | grep -q 'ok installed' || missing+=("$package")
    done
    [ ${#missing[@]} -eq 0 ] && return
    local line="apt-get install -y --no-install-recommends ${missing[*]}"
    local as=()
    if [ "$(id -u)" -ne 0 ]; then
        if ! command -v sudo >/dev/null || ! sudo -n true 2>/dev/null; then
            echo "missing packages; run as root:  $line" >&2
            exit 1
        fi
        as=(sudo)
    fi
    echo "installing: ${missing[*]}"
    export DEBIAN_FRONTEND=noninteractive
    if ! { "${as[@]}" apt-get update -qq && "${as[@]}" $line -qq >/dev/null; }; then
        echo "the packages could not be installed; run as root:  apt-get update && $line" >&2
        exit 1
    fi
}

# The viewer's packages, for building the report page and testing it in a browser.
need_viewer() {
    local log
    command -v npm >/dev/null || need nodejs npm
    [ -d viewer/node_modules ] && [ viewer/node_modules -nt viewer/package-lock.json ] && return
    echo "installing the viewer's packages"
    log=$(mktemp)
    if ! npm ci --prefix viewer --no-audit --no-fund >"$log" 2>&1; then
        rm -rf viewer/node_modules
        tail -n 30 "$log" >&2
        rm -f "$log"
        echo "the viewer's packages could not be installed: npm ci in viewer/ failed" >&2
        exit 1
    fi
    rm -f "$log"
    touch viewer/node_modules
}

# Configures and builds a preset, silent unless something is wrong.
build() {
    local preset=$1 log
    log=$(mktemp)
    if ! { cmake --preset "$preset" "${@:2}" && cmake --build --preset "$preset"; } >"$log" 2>&1; then
        tail -n 60 "$log" >&2
        rm -f "$log"
        exit 1
    fi
    rm -f "$log"
}
