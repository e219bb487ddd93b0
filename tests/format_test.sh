#!/usr/bin/env bash
# Every source file is as clang-format 14 leaves it. Skipped (77) where that version is not installed.
set -u
cd "$(dirname "$0")/.."
command -v clang-format-14 >/dev/null || { echo "clang-format-14 is not installed"; exit 77; }
find core drivers messages daemon tools tests \( -name '*.h' -o -name '*.cpp' \) -print0 | xargs -0 clang-format-14 --dry-run -Werror 2>&1 | grep -E 'error' | sort -u
[ "${PIPESTATUS[2]}" -ne 0 ]
