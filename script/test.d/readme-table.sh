#!/bin/sh
# The README's table is what the command prints now.
exec "$(dirname "$0")/../readme-table" --check
