# Called by .ci/run: the sdist with the README as PyPI shows it, the wheel that this sdist alone makes, and
# tests of that wheel once installed.

packaging=$(mktemp -d)
trap 'rm -rf "$packaging"' EXIT

rm -rf dist
.venv/bin/maturin sdist --out "$packaging"
tar -xzf "$packaging"/gym_babble-*.tar.gz -C "$packaging"
.venv/bin/python .ci/pypi_readme.py "$packaging"/gym_babble-*/
# The same target directory, where the dependencies are compiled already; our own crates look newer
# than what lies there, so that they are compiled from what the sdist holds.
find "$packaging" -name '*.rs' -exec touch {} +
# The page needs Node, so it is built before and only packed here; without it the wheel goes without the lab.
if [[ -d gym_babble/lab/page ]]; then cp -R gym_babble/lab/page "$packaging"/gym_babble-*/gym_babble/lab/; fi
(
    export CARGO_TARGET_DIR=${CARGO_TARGET_DIR:-$PWD/target}
    maturin=$PWD/.venv/bin/maturin dist=$PWD/dist
    cd "$packaging"/gym_babble-*/
    "$maturin" sdist --out "$dist"
    "$maturin" build --release --out "$dist"
)
.venv/bin/python .ci/check_dist.py dist

# Installed in empty environments, for every Python that we support and find here: all tests of the
# wheel with the oldest libraries that pyproject.toml admits, which have wheels up to Python 3.12, and
# a few seconds of tests with the newest, with which `make test` ran.
tests=--oldest
untested=""
for version in 3.10 3.11 3.12 3.13 3.14; do
    if python=$(python_of "$version"); then
        [[ $version == 3.1[012] ]] || tests=--smoke
        .venv/bin/python .ci/wheel_tests.py dist/*.whl --python "$python" $tests
        tests=--smoke
    else
        untested+=" $version"
    fi
done
[[ $untested == "" ]] || shout "THE WHEEL WAS NOT TESTED ON PYTHON$untested: not found here"
