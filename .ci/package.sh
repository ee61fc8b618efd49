# Called by .ci/run: the sdist, the wheel that the sdist alone makes, and that wheel in an empty environment.

packaging=$(mktemp -d)
trap 'rm -rf "$packaging"' EXIT

rm -rf dist
.venv/bin/maturin sdist --out dist
tar -xzf dist/gym_babble-*.tar.gz -C "$packaging"
# The same target directory, where the dependencies are compiled already; our own crates look newer
# than what lies there, so that they are compiled from what the sdist holds.
find "$packaging" -name '*.rs' -exec touch {} +
(
    export CARGO_TARGET_DIR=${CARGO_TARGET_DIR:-$PWD/target}
    maturin=$PWD/.venv/bin/maturin dist=$PWD/dist
    cd "$packaging"/gym_babble-*/
    "$maturin" build --release --out "$dist"
)
.venv/bin/python .ci/check_dist.py dist

# The oldest releases that pyproject.toml admits, while `make test` ran on the newest.
"$PYTHON" -m venv "$packaging/venv"
"$packaging/venv/bin/python" -m pip install --quiet --disable-pip-version-check \
    --constraint constraints-oldest.txt dist/*.whl
(cd "$packaging" && venv/bin/python -W error -c 'import gym_babble' && venv/bin/gym-babble --help >/dev/null)
echo "the wheel imports in an empty environment"
