#!/usr/bin/env bash
# Run once when the autograder's image is built: Python's packages, and bubblewrap for the isolation.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")"
if ! command -v bwrap >/dev/null || ! python3 -c 'import venv, ensurepip' 2>/dev/null; then
    apt-get update -qq
    DEBIAN_FRONTEND=noninteractive apt-get install -y -qq python3 python3-venv bubblewrap libseccomp2
fi
python3 -m venv .venv
.venv/bin/pip install --quiet --disable-pip-version-check uv
.venv/bin/uv pip install --quiet --python .venv/bin/python --require-hashes -r requirements.lock
.venv/bin/uv pip install --quiet --python .venv/bin/python --no-deps --no-build-isolation --editable .
