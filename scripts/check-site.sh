#!/usr/bin/env bash
# Builds the documentation as a site (target/site/book) and fails where a link or an anchor leads nowhere, or where a page is
# wider than a telephone or a screen. mdBook is compiled into target/tools the first time, which takes some minutes, so that
# .ci/run does without it.
#
#   scripts/check-site.sh            builds and checks
#   scripts/check-site.sh --look     and leaves pictures of some pages in target/site/look
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

version=0.5.4
mdbook=target/tools/bin/mdbook
if [ "$($mdbook --version 2>/dev/null)" != "mdbook v$version" ]; then
    # Without its server, which nobody starts here, and without optimisation: it is quick enough for forty pages.
    CARGO_PROFILE_DEV_DEBUG=false cargo install --debug --locked --root target/tools --version "$version" \
        --no-default-features --features search mdbook
fi

rm -rf target/site/book
scripts/site.py lay
"$mdbook" build
scripts/site.py check

scripts/install-tools.sh chromium
for page in index.html docs/methods.html docs/architecture.html docs/fleet.html docs/glossary.html crates/phugoid/index.html; do
    scripts/check-width.sh "target/site/book/$page" 390 1100
done
if [ "${1:-}" = --look ]; then
    mkdir -p target/site/look
    for page in index docs/methods docs/architecture docs/fleet; do
        for width in 390 1100; do
            scripts/look.sh "target/site/book/$page.html" "$width" "target/site/look/$(basename "$page")-$width.png" 2400
        done
    done
fi
