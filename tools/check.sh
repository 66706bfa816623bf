#!/usr/bin/env bash
# The quick part of tools/test: builds and runs the unit tests and the house rules. Installs nothing.
set -euo pipefail
root=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)
"$root/tools/build" dev --preset dev
exec ctest --test-dir "$root/build/dev" --output-on-failure --parallel "$(nproc)" --label-regex '^(unit|rules)$' "$@"
