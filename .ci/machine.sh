# Functions that .ci/run calls to get a bare machine ready. Nothing is fetched that is there already.

shout() { printf '\n!!! %s\n\n' "$*" >&2; }

# Sets and exports PYTHON, which the Makefile reads: the caller's choice, or the first that is new enough.
find_python() {
    local candidate
    for candidate in ${PYTHON:-python3 python3.14 python3.13 python3.12 python3.11 python3.10}; do
        if "$candidate" -c 'import sys; sys.exit(sys.version_info < (3, 10))' 2>/dev/null; then
            export PYTHON=$candidate
            "$PYTHON" --version
            return
        fi
    done
    shout "no Python 3.10 or newer found"
    return 1
}

# Prints an interpreter of that version with a lock: on the PATH, or one of pyenv's.
python_of() {
    local candidate check
    check="import sys, sysconfig
sys.exit(sys.version_info[:2] != (3, ${1#3.}) or bool(sysconfig.get_config_var('Py_GIL_DISABLED')))"
    for candidate in "python$1" "${PYENV_ROOT:-$HOME/.pyenv}/versions/$1".*/bin/python; do
        "$candidate" -c "$check" 2>/dev/null && echo "$candidate" && return
    done
    return 1
}

# Debian packages: a help where we may install them, no reason to stop where we may not.
debian_install() {
    if [[ $(id -u) -eq 0 ]] && command -v apt-get >/dev/null; then
        apt-get update -qq && DEBIAN_FRONTEND=noninteractive apt-get install -qq -y --no-install-recommends "$@"
    else
        return 1
    fi
}

ensure_compiler() {
    command -v cc >/dev/null || debian_install gcc libc6-dev || {
        shout "no C compiler to link with: install gcc (Debian: gcc libc6-dev)"
        return 1
    }
    command -v make >/dev/null || debian_install make || {
        shout "no make found"
        return 1
    }
    command -v cargo >/dev/null || {
        shout "no cargo found: install Rust (rustup is the usual way)"
        return 1
    }
    cargo --version
}

# Some Debian Pythons come without ensurepip. Leaves a .venv with pip for the Makefile to fill.
ensure_venv() {
    [[ -x .venv/bin/pip ]] && return
    "$PYTHON" -m venv .venv && return
    rm -rf .venv
    debian_install python3-venv && "$PYTHON" -m venv .venv && return
    rm -rf .venv
    "$PYTHON" -m pip install --quiet --user virtualenv && "$PYTHON" -m virtualenv --quiet .venv && return
    shout "neither venv nor virtualenv makes an environment for $PYTHON"
    return 1
}

ensure_rust_components() {
    cargo fmt --version && cargo clippy --version && return
    command -v rustup >/dev/null && rustup component add rustfmt clippy && return
    shout "rustfmt or clippy is missing and rustup cannot add it: going on without linting Rust"
    return 1
}

# npm builds the lab's page, and a browser tests it. A Node that is too old counts as none.
ensure_lab() {
    command -v npm >/dev/null || debian_install nodejs npm || {
        shout "no npm found, and it cannot be installed: going on without the lab"
        return 1
    }
    node -e 'const [a, b] = process.versions.node.split(".").map(Number); process.exit(a > 20 || (a == 20 && b >= 19) ? 0 : 1)' || {
        shout "the lab needs Node 20.19 or newer, and this is $(node --version): going on without the lab"
        return 1
    }
    [[ -d lab/node_modules ]] || npm view preact version >/dev/null 2>&1 || {
        shout "npm reaches no registry: going on without the lab"
        return 1
    }
}

# Prints a browser for the lab's tests.
chromium_of() {
    local candidate
    for candidate in "${CHROMIUM:-chromium}" chromium-browser google-chrome; do
        command -v "$candidate" && return
    done
    debian_install chromium >&2 && command -v chromium
}

# Node runs what is compiled for WebAssembly.
ensure_wasm() {
    command -v node >/dev/null || debian_install nodejs || {
        shout "no node found, and it cannot be installed: going on without WebAssembly"
        return 1
    }
    [[ -d $(rustc --print target-libdir --target wasm32-unknown-unknown) ]] && return
    command -v rustup >/dev/null && rustup target add wasm32-unknown-unknown && return
    shout "rustup cannot add the target wasm32-unknown-unknown: going on without WebAssembly"
    return 1
}
